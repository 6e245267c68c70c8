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

/// A render of a peer that came to nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missed {
    /// Name of the scene.
    pub scene: String,
    /// Name of the peer.
    pub integrator: String,
    /// How much was to be rendered.
    pub budget: String,
    /// The render's seed.
    pub seed: u64,
    /// What went wrong.
    pub reason: String,
}

/// All that was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bench {
    /// How it was made: pairs of name and value.
    pub about: Vec<(String, String)>,
    /// The scenes.
    pub scenes: Vec<BenchScene>,
    /// The trials, in the order of the race.
    pub trials: Vec<Trial>,
    /// What came to nothing, likewise.
    pub missed: Vec<Missed>,
    /// Number of trials that were to be made.
    pub wanted: usize,
}

/// Columns of texts in the tables, before the numbers.
const TEXTS: [&str; 3] = ["scene", "integrator", "budget"];

/// Columns of numbers in the table of errors.
const ERRORS: [&str; 11] = [
    "seeds",
    "CPU s",
    "MSE",
    "relMSE",
    "corrected",
    "FLIP",
    "mean ratio",
    "Err",
    "Eff",
    "constant",
    "min … max",
];

/// Columns of numbers in the table of work, before the further statistics.
const WORK: [&str; 3] = ["wall s", "passes", "spp"];

impl Bench {
    /// Two tables in Markdown with a row for each scene, budget and integrator, errors and work, and
    /// what they need to be understood.
    pub fn markdown(&self) -> String {
        let standings = standings(&self.trials);
        let names = statistic_names(&self.trials);
        let mut errors = Table::new(&TEXTS, &ERRORS);
        let numbers: Vec<&str> = WORK
            .into_iter()
            .chain(names.iter().map(String::as_str))
            .collect();
        let mut work = Table::new(&TEXTS, &numbers);
        for standing in &standings {
            errors.push(&error_cells(standing));
            work.push(&work_cells(standing, &names));
        }
        for missed in self.wholly_missed() {
            let texts = [&missed.scene, &missed.integrator, &missed.budget];
            let mut cells: Vec<String> = texts.into_iter().cloned().collect();
            cells.push("0".to_owned());
            cells.resize(TEXTS.len() + ERRORS.len(), "–".to_owned());
            errors.push(&cells);
        }
        let mut lines = errors.lines();
        lines.push(String::new());
        lines.extend(self.remarks(&standings));
        lines.push(String::new());
        lines.extend(work.lines());
        lines.join("\n")
    }

    /// The first of the renders of each integrator and budget of which none came to something.
    fn wholly_missed(&self) -> Vec<&Missed> {
        let mut found: Vec<&Missed> = Vec::new();
        for missed in &self.missed {
            let names = [&missed.scene, &missed.integrator, &missed.budget];
            let of_trial = |t: &Trial| names == [&t.scene, &t.integrator, &t.budget];
            let of_other = |m: &&Missed| names == [&m.scene, &m.integrator, &m.budget];
            if !self.trials.iter().any(of_trial) && !found.iter().any(of_other) {
                found.push(missed);
            }
        }
        found
    }

    /// What stands between the tables, a line each.
    fn remarks(&self, standings: &[Standing]) -> Vec<String> {
        let mut lines = vec![
            "- Medians over the seeds; mean ratio ± its standard error.".to_owned(),
            "- Err: mean squared error of luminance. Eff = 1 / (CPU s × Err), higher is better."
                .to_owned(),
            "- constant, of efficiency: (relMSE − reference's noise) × CPU s, lower is better; its \
             spread over the seeds."
                .to_owned(),
        ];
        let scenes = self.scenes.iter();
        lines.extend(scenes.filter_map(|scene| self.scene_line(scene)));
        if standings.iter().any(|standing| !standing.beyond_noise) {
            lines.push(
                "- ! relMSE is below twice the reference's noise: a better reference is needed."
                    .to_owned(),
            );
        }
        lines.extend(standings.iter().filter_map(overrun_line));
        lines.extend(self.missed.iter().map(|missed| {
            let (scene, name, reason) = (&missed.scene, &missed.integrator, &missed.reason);
            let (budget, seed) = (&missed.budget, missed.seed);
            format!("- FAILED: {scene} {name} {budget} seed {seed}: {reason}")
        }));
        if self.trials.len() < self.wanted {
            let (done, wanted) = (self.trials.len(), self.wanted);
            lines.push(format!("- Incomplete: {done} of {wanted} renders."));
        }
        lines
    }

    /// What counts on a scene; `None` where nothing was measured.
    fn scene_line(&self, scene: &BenchScene) -> Option<String> {
        let mut of_scene = self.trials.iter().filter(|trial| trial.scene == scene.name);
        let noise = match of_scene.next()?.errors.reference_noise {
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
            let work = trial.work.as_ref();
            let counts = work.map(|work| [work.paths, work.rays, work.rejected]);
            let counts = counts.map_or_else(Default::default, |counts| {
                counts.map(|count| count.to_string())
            });
            let mut row = vec![
                trial.scene.clone(),
                trial.integrator.clone(),
                trial.budget.clone(),
                trial.seed.to_string(),
            ];
            row.extend(Measure::NAMES.map(|(_, measure)| full(measure.of(trial))));
            row.extend::<[String; 3]>(counts);
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
        let missed: Vec<Value> = self.missed.iter().map(missed_json).collect();
        all.insert("complete".to_owned(), json!(runs.len() == self.wanted));
        all.insert("scenes".to_owned(), json!(scenes));
        all.insert("summary".to_owned(), json!(summary));
        all.insert("runs".to_owned(), json!(runs));
        all.insert("failures".to_owned(), json!(missed));
        Value::Object(all)
    }
}

fn text_cells(standing: &Standing) -> Vec<String> {
    let texts = [&standing.scene, &standing.integrator, &standing.budget];
    texts.into_iter().cloned().collect()
}

fn error_cells(standing: &Standing) -> Vec<String> {
    let median = |measure| three_digits(standing.spread(measure).median);
    let mark = if standing.beyond_noise { "" } else { "! " };
    let ratio = standing.ratio;
    let error = ratio.standard_error;
    let error = error.map_or_else(String::new, |error| format!(" ± {error:.4}"));
    let constant = standing.spread(Measure::EfficiencyConstant);
    let (min, max) = (three_digits(constant.min), three_digits(constant.max));
    let mut cells = text_cells(standing);
    cells.extend([
        standing.seeds.to_string(),
        median(Measure::Cpu),
        median(Measure::Mse),
        format!("{mark}{}", median(Measure::RelativeMse)),
        median(Measure::Corrected),
        median(Measure::Flip),
        format!("{:.4}{error}", ratio.value),
        median(Measure::Err),
        median(Measure::Eff),
        three_digits(constant.median),
        format!("{min} … {max}"),
    ]);
    cells
}

fn work_cells(standing: &Standing, statistics: &[String]) -> Vec<String> {
    let median = |measure| standing.spread(measure).median;
    let whole = |measure| {
        let count: f64 = median(measure);
        if count.is_nan() {
            three_digits(count)
        } else {
            count.to_string()
        }
    };
    let mut cells = text_cells(standing);
    cells.extend([
        three_digits(median(Measure::Wall)),
        whole(Measure::Passes),
        whole(Measure::Samples),
    ]);
    cells.extend(statistics.iter().map(|name| {
        let mut known = standing.statistics.iter();
        let found = known.find(|(known, _)| known == name);
        three_digits(found.map_or(f64::NAN, |(_, spread)| spread.median))
    }));
    cells
}

/// By how much a budget was overrun at most; `None` where it was kept by all.
fn overrun_line(standing: &Standing) -> Option<String> {
    let most = standing.spread(Measure::Overrun).max;
    let (scene, name, budget) = (&standing.scene, &standing.integrator, &standing.budget);
    (most > 0.0).then(|| {
        let most = three_digits(most);
        format!("- {scene} {name} {budget}: over the budget by up to {most} s.")
    })
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
    if let Some(work) = trial.work {
        // Whole numbers, without ".0".
        all["passes"] = json!(work.passes);
        all["spp"] = json!(work.samples);
    }
    all["paths"] = json!(trial.work.map(|work| work.paths));
    all["rays"] = json!(trial.work.map(|work| work.rays));
    all["rejected"] = json!(trial.work.map(|work| work.rejected));
    let statistics = trial.statistics.iter();
    all["statistics"] = statistics
        .map(|(name, value)| (name.clone(), json!(value)))
        .collect();
    all
}

fn missed_json(missed: &Missed) -> Value {
    json!({
        "scene": missed.scene,
        "integrator": missed.integrator,
        "budget": missed.budget,
        "seed": missed.seed,
        "reason": missed.reason,
    })
}
