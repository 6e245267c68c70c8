//! What an EXR file tells about how it was made.

use std::collections::BTreeMap;

use crate::image::AttributeValue;
use crate::mutation::{Move, MoveStatistics, MutationStatistics, Rejection};

/// Beginning of the names of the attributes that differ between two runs of the same render: times
/// and threads. All others are the same bytes for any number of threads.
pub const RUN_PREFIX: &str = "lumiflow.run.";

/// How an image was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Name of the scene.
    pub scene: String,
    /// Hash of the scene's files and definitions.
    pub scene_hash: u64,
    /// Name of the integrator.
    pub integrator: String,
    /// Its options with their values, defaults included.
    pub options: Vec<(String, String)>,
    /// Name of the tracer.
    pub accel: String,
    /// Name of the sampler.
    pub sampler: String,
    /// Name of the reconstruction filter.
    pub filter: String,
    /// The render's seed.
    pub seed: u64,
    /// Passes in the image.
    pub passes: u32,
    /// Samples a pixel.
    pub samples: u32,
    /// Camera samples with all that follows from them.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Estimates that were not finite or out of range, and were left out.
    pub rejected: u64,
    /// Markov chains run.
    pub chains: u64,
    /// What became of the chains' mutations.
    pub mutations: MoveStatistics,
    /// What stands in for something that the scene asks for.
    pub replaced: Vec<String>,
    /// What differs between runs.
    pub run: Run,
}

/// What differs between two runs of the same render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Seconds that rendering took, without loading and writing.
    pub wall_seconds: f64,
    /// Processor time of the same, in seconds, all threads together.
    pub cpu_seconds: f64,
    /// Threads that rendered.
    pub threads: usize,
}

impl Record {
    /// The options as `name=value`, with spaces between.
    fn options_text(&self) -> String {
        let pairs = self.options.iter();
        let texts: Vec<String> = pairs
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        texts.join(" ")
    }

    /// What became of the mutations that were tried, a line for each kind.
    pub fn mutations_text(&self) -> String {
        let tried = Move::all().zip(&self.mutations);
        let lines: Vec<String> = tried
            .filter(|(_, statistics)| statistics.proposed > 0)
            .map(|(mutation, statistics)| mutation_line(mutation, statistics))
            .collect();
        lines.join("\n")
    }
}

/// Numbers of one kind of mutation, reasons of rejections as shares of all that were tried.
fn mutation_line(mutation: Move, statistics: &MutationStatistics) -> String {
    let proposed = statistics.proposed as f64;
    let mut line = format!(
        "{}: {} proposed, {} accepted, mean acceptance {:.4}",
        mutation.name(),
        statistics.proposed,
        statistics.accepted,
        statistics.mean_acceptance()
    );
    for (reason, name) in Rejection::NAMES {
        let count = statistics.rejections(reason);
        if count > 0 {
            line += &format!(", {name} {:.4}", count as f64 / proposed);
        }
    }
    line
}

/// The attributes of an EXR file.
///
/// - `revision`: of the sources, as `git describe` gives it.
///
/// 64-bit counts are texts, since the format has 32-bit integers only.
pub fn metadata(record: &Record, revision: &str) -> BTreeMap<String, AttributeValue> {
    let text = |value: &dyn ToString| AttributeValue::String(value.to_string());
    let small = |value: u32| AttributeValue::Int(i32::try_from(value).unwrap_or(i32::MAX));
    let mut attributes: Vec<(&str, AttributeValue)> = vec![
        ("version", text(&env!("CARGO_PKG_VERSION"))),
        ("revision", text(&revision)),
        ("scene", text(&record.scene)),
        ("scene_hash", text(&format!("{:016x}", record.scene_hash))),
        ("integrator", text(&record.integrator)),
        ("options", text(&record.options_text())),
        ("accel", text(&record.accel)),
        ("sampler", text(&record.sampler)),
        ("filter", text(&record.filter)),
        ("seed", text(&record.seed)),
        ("passes", small(record.passes)),
        ("samples", small(record.samples)),
        ("paths", text(&record.paths)),
        ("rays", text(&record.rays)),
        ("rejected", text(&record.rejected)),
        (
            "run.wall_seconds",
            AttributeValue::Double(record.run.wall_seconds),
        ),
        (
            "run.cpu_seconds",
            AttributeValue::Double(record.run.cpu_seconds),
        ),
        (
            "run.threads",
            small(u32::try_from(record.run.threads).unwrap_or(u32::MAX)),
        ),
    ];
    if record.chains > 0 {
        attributes.push(("chains", text(&record.chains)));
    }
    let mutations = record.mutations_text();
    if !mutations.is_empty() {
        attributes.push(("mutations", text(&mutations)));
    }
    if !record.replaced.is_empty() {
        attributes.push(("replaced", text(&record.replaced.join("\n"))));
    }
    attributes
        .into_iter()
        .map(|(name, value)| (format!("lumiflow.{name}"), value))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(wall_seconds: f64, threads: usize) -> Record {
        Record {
            scene: "box".to_owned(),
            scene_hash: 0xabc,
            integrator: "path".to_owned(),
            accel: "embree".to_owned(),
            options: vec![
                ("max_depth".to_owned(), "-1".to_owned()),
                ("mis".to_owned(), "power".to_owned()),
            ],
            sampler: "independent".to_owned(),
            filter: "box".to_owned(),
            seed: u64::MAX,
            passes: 3,
            samples: 3,
            paths: 12,
            rays: 1 << 40,
            rejected: 0,
            chains: 0,
            mutations: Default::default(),
            replaced: Vec::new(),
            run: Run {
                wall_seconds,
                cpu_seconds: 2.0 * wall_seconds,
                threads,
            },
        }
    }

    #[test]
    fn large_numbers_and_options_are_readable() {
        let attributes = metadata(&record(1.0, 2), "v1-dirty");
        let text = |name: &str| attributes.get(name).cloned();
        let string = |value: &str| Some(AttributeValue::String(value.to_owned()));
        assert_eq!(text("lumiflow.seed"), string("18446744073709551615"));
        assert_eq!(text("lumiflow.rays"), string("1099511627776"));
        assert_eq!(text("lumiflow.options"), string("max_depth=-1 mis=power"));
        assert_eq!(text("lumiflow.scene_hash"), string("0000000000000abc"));
        assert_eq!(text("lumiflow.passes"), Some(AttributeValue::Int(3)));
        assert_eq!(text("lumiflow.replaced"), None);
    }

    #[test]
    fn what_differs_between_runs_has_names_of_its_own() {
        let stable = |record: &Record| {
            let mut attributes = metadata(record, "v1");
            attributes.retain(|name, _| !name.starts_with(RUN_PREFIX));
            attributes
        };
        assert_eq!(stable(&record(1.0, 2)), stable(&record(5.0, 7)));
        assert_ne!(
            metadata(&record(1.0, 2), "v1"),
            metadata(&record(5.0, 7), "v1")
        );
    }
}
