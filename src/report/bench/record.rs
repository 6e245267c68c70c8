//! What a bench leaves: a table for people, a line for each trial, and all of it.

use serde_json::{Map, Value, json};

use super::table::{Table, three_digits};
use super::{Measure, Spread, Standing, Trial, standings};

/// A scene of a bench, and what it is measured against.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchScene {
    /// Its name.
    pub name: String,
    /// The scene file.
    pub file: String,
    /// Width and height of what is rendered, in pixels.
    pub size: (u32, u32),
    /// Pixels that count.
    pub pixels: usize,
    /// The image that it should become.
    pub reference: String,
    /// Variance of the reference, where that is known.
    pub reference_variance: Option<String>,
    /// What tells which pixels do not count.
    pub mask: Option<String>,
    /// The integrators, each with its options, defaults included.
    pub integrators: Vec<(String, Vec<(String, String)>)>,
}

/// All that was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bench {
    /// How it was made: pairs of name and value.
    pub about: Vec<(String, String)>,
    /// The scenes.
    pub scenes: Vec<BenchScene>,
    /// The trials, in the order in which they were made.
    pub trials: Vec<Trial>,
    /// Number of trials that were to be made.
    pub wanted: usize,
}

/// Columns of texts in the table, before the numbers.
const TEXTS: [&str; 3] = ["scene", "integrator", "budget"];

/// Columns of numbers in the table, before the further statistics.
const NUMBERS: [&str; 9] = [
    "seeds",
    "CPU s",
    "spp",
    "relMSE",
    "corrected",
    "FLIP",
    "mean ratio",
    "efficiency",
    "min … max",
];

impl Bench {
    /// A table in Markdown with a row for each scene, budget and integrator, and what it needs to be
    /// understood.
    pub fn markdown(&self) -> String {
        let standings = standings(&self.trials);
        let names = statistic_names(&self.trials);
        let mut numbers = NUMBERS.to_vec();
        numbers.extend(names.iter().map(String::as_str));
        let mut table = Table::new(&TEXTS, &numbers);
        for standing in &standings {
            table.push(&cells(standing, &names));
        }
        let mut lines = table.lines();
        lines.push(String::new());
        lines.push(
            "- Medians over the seeds; mean ratio ± its standard error; efficiency = (relMSE − \
             reference's noise) × CPU s, lower is better."
                .to_owned(),
        );
        lines.extend(
            self.scenes
                .iter()
                .filter_map(|scene| self.scene_line(scene)),
        );
        if standings.iter().any(|standing| !standing.beyond_noise) {
            lines.push(
                "- ! relMSE is below twice the reference's noise: a better reference is needed."
                    .to_owned(),
            );
        }
        if self.trials.len() < self.wanted {
            let (done, wanted) = (self.trials.len(), self.wanted);
            lines.push(format!("- Incomplete: {done} of {wanted} renders."));
        }
        lines.join("\n")
    }

    /// What counts on a scene; `None` where nothing was measured.
    fn scene_line(&self, scene: &BenchScene) -> Option<String> {
        let mut of_scene = self.trials.iter().filter(|trial| trial.scene == scene.name);
        let noise = match of_scene.next()?.comparison.reference_noise {
            Some(noise) => format!("the reference's noise is {}", three_digits(noise)),
            None => "the reference's noise is unknown and taken for none".to_owned(),
        };
        let (width, height) = scene.size;
        let all = u64::from(width) * u64::from(height);
        let (name, pixels) = (&scene.name, scene.pixels);
        Some(format!(
            "- {name}: {pixels} of {all} pixels count; {noise}."
        ))
    }

    /// A line for each trial, as comma-separated values; what is not known is empty.
    ///
    /// # Errors
    /// None are expected: all is written to memory.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let names = statistic_names(&self.trials);
        let mut writer = csv::Writer::from_writer(Vec::new());
        let measures = Measure::NAMES.map(|(name, _)| name);
        let texts = ["scene", "integrator", "budget", "seed"];
        let counts = ["paths", "rays", "rejected"];
        let head = texts.iter().chain(&measures).chain(&counts).copied();
        writer.write_record(head.chain(names.iter().map(String::as_str)))?;
        for trial in &self.trials {
            let counters = trial.counters;
            let mut row = vec![
                trial.scene.clone(),
                trial.integrator.clone(),
                trial.budget.clone(),
                trial.seed.to_string(),
            ];
            row.extend(Measure::NAMES.map(|(_, measure)| full(measure.of(trial))));
            row.extend([counters.paths, counters.rays, counters.rejected].map(|n| n.to_string()));
            let statistics = names.iter().map(|name| trial.statistic(name));
            row.extend(statistics.map(|value| value.map_or_else(String::new, full)));
            writer.write_record(&row)?;
        }
        writer.into_inner().map_err(|error| {
            let error: std::io::Error = error.into_error();
            error.into()
        })
    }

    /// Everything; what is not known, infinite or not a number is null.
    pub fn json(&self) -> Value {
        let about = self.about.iter();
        let mut all: Map<String, Value> = about
            .map(|(name, value)| (name.clone(), json!(value)))
            .collect();
        let scenes: Vec<Value> = self.scenes.iter().map(scene_json).collect();
        let standings = standings(&self.trials);
        let summary: Vec<Value> = standings.iter().map(standing_json).collect();
        let runs: Vec<Value> = self.trials.iter().map(trial_json).collect();
        all.insert("complete".to_owned(), json!(runs.len() == self.wanted));
        all.insert("scenes".to_owned(), json!(scenes));
        all.insert("summary".to_owned(), json!(summary));
        all.insert("runs".to_owned(), json!(runs));
        Value::Object(all)
    }
}

/// The row of a standing.
fn cells(standing: &Standing, statistics: &[String]) -> Vec<String> {
    let median = |measure| three_digits(standing.spread(measure).median);
    let efficiency = standing.spread(Measure::Efficiency);
    let mark = if standing.beyond_noise { "" } else { "! " };
    let ratio = standing.ratio;
    let error = ratio.standard_error;
    let error = error.map_or_else(String::new, |error| format!(" ± {error:.4}"));
    let samples = standing.spread(Measure::Samples).median;
    let range = |spread: Spread| {
        let (min, max) = (three_digits(spread.min), three_digits(spread.max));
        format!("{min} … {max}")
    };
    let mut cells = vec![
        standing.scene.clone(),
        standing.integrator.clone(),
        standing.budget.clone(),
        standing.seeds.to_string(),
        median(Measure::Cpu),
        format!("{samples}"),
        format!("{mark}{}", median(Measure::RelativeMse)),
        median(Measure::Corrected),
        median(Measure::Flip),
        format!("{:.4}{error}", ratio.value),
        median(Measure::Efficiency),
        range(efficiency),
    ];
    cells.extend(statistics.iter().map(|name| {
        let mut found = standing
            .statistics
            .iter()
            .filter(|(known, _)| known == name);
        let value = found.next().map_or(f64::NAN, |(_, spread)| spread.median);
        three_digits(value)
    }));
    cells
}

/// Names of the further statistics, in the order in which they first appear.
fn statistic_names(trials: &[Trial]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in trials.iter().flat_map(|trial| &trial.statistics) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// All digits of a number, nothing for none.
fn full(value: f64) -> String {
    if value.is_nan() {
        String::new()
    } else {
        value.to_string()
    }
}

fn scene_json(scene: &BenchScene) -> Value {
    let integrators = scene.integrators.iter().map(|(name, options)| {
        let options = options.iter();
        let options: Map<String, Value> = options
            .map(|(name, value)| (name.clone(), option_value(value)))
            .collect();
        (name.clone(), Value::Object(options))
    });
    json!({
        "name": scene.name,
        "file": scene.file,
        "width": scene.size.0,
        "height": scene.size.1,
        "pixels": scene.pixels,
        "reference": scene.reference,
        "reference_variance": scene.reference_variance,
        "mask": scene.mask,
        "integrators": integrators.collect::<Map<String, Value>>(),
    })
}

/// The value of an option as JSON: booleans and numbers as such.
pub fn option_value(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|_| Value::from(text))
}

fn standing_json(standing: &Standing) -> Value {
    let mut all = json!({
        "scene": standing.scene,
        "integrator": standing.integrator,
        "budget": standing.budget,
        "seeds": standing.seeds,
        "mean_ratio": { "mean": standing.ratio.value, "standard_error": standing.ratio.standard_error },
        "beyond_noise": standing.beyond_noise,
    });
    let measures = Measure::NAMES.iter();
    for (name, measure) in measures.filter(|(_, measure)| *measure != Measure::Ratio) {
        all[*name] = spread_json(standing.spread(*measure));
    }
    let statistics = standing.statistics.iter();
    all["statistics"] = statistics
        .map(|(name, spread)| (name.clone(), spread_json(*spread)))
        .collect();
    all
}

fn spread_json(spread: Spread) -> Value {
    json!({
        "median": spread.median,
        "min": spread.min,
        "lower_quartile": spread.lower_quartile,
        "upper_quartile": spread.upper_quartile,
        "max": spread.max,
    })
}

fn trial_json(trial: &Trial) -> Value {
    let mut all = json!({
        "scene": trial.scene,
        "integrator": trial.integrator,
        "budget": trial.budget,
        "seed": trial.seed,
    });
    for (name, measure) in Measure::NAMES {
        all[name] = json!(measure.of(trial));
    }
    all["passes"] = json!(trial.passes);
    all["spp"] = json!(trial.samples);
    all["paths"] = json!(trial.counters.paths);
    all["rays"] = json!(trial.counters.rays);
    all["rejected"] = json!(trial.counters.rejected);
    let statistics = trial.statistics.iter();
    all["statistics"] = statistics
        .map(|(name, value)| (name.clone(), json!(value)))
        .collect();
    all
}
