//! One technique at a time: as it is in a whole sample, and with a number that chooses it.

use lumiflow::path::{Bidirection, Bidirectional, Connection, Path, PathSpace, Weighing};
use lumiflow::random::{Purpose, Stream};

use crate::support::effort::{level, samples, seed};
use crate::support::primary::Sample;
use crate::support::render::Replicas;
use crate::support::seeds::{self, TRACING, from_both_sides, space};
use crate::support::stages::{Stage, stage_of, stages};

const MAX_DEPTH: usize = 6;

fn tracing(rr_depth: u32) -> Bidirectional {
    Bidirectional {
        rr_depth,
        ..from_both_sides(Weighing::Square)
    }
}

/// What a sample makes by all techniques.
fn connections(
    sample: &mut Sample,
    space: &PathSpace<'_>,
    tracing: &Bidirectional,
) -> Vec<Connection> {
    let mut found = Vec::new();
    let add = &mut |_: &Bidirection<'_>, made: &Connection| found.push(*made);
    sample.trace((space, &mut Bidirection::default()), tracing, add);
    found
}

fn pairs() -> impl Iterator<Item = (usize, usize)> {
    (1..=MAX_DEPTH).flat_map(|edges| (0..=edges).map(move |light| (edges - light, light)))
}

#[test]
fn a_technique_alone_makes_what_it_makes_in_a_whole_sample() {
    for stage in stages() {
        let space = space(&stage);
        let (mut kept, mut both) = (Sample::new(), Bidirection::default());
        let mut count = 0;
        for sample in 0..samples(60) {
            kept.begin(seed(41), sample);
            let whole = connections(&mut kept, &space, &tracing(u32::MAX));
            for (eye, light) in pairs() {
                let expected = whole.iter().find(|c| c.eye == eye && c.light == light);
                let workers = (&space, &mut both);
                let found = kept.trace_technique(workers, &tracing(1), (eye, light));
                assert_eq!(found.as_ref(), expected, "{}: {eye}, {light}", stage.name);
                count += u32::from(found.is_some());
            }
        }
        assert!(count > 20, "{}: {count}", stage.name);
    }
}

/// What Russian roulette leaves of a sample's paths is the same with the same numbers, but stronger.
#[test]
fn roulette_only_makes_paths_stronger() {
    let (mut count, mut stronger) = (0, 0);
    for stage in stages() {
        let space = space(&stage);
        let (mut kept, mut both) = (Sample::new(), Bidirection::default());
        for sample in 0..samples(60) {
            kept.begin(seed(42), sample);
            for left in connections(&mut kept, &space, &tracing(1)) {
                let workers = (&space, &mut both);
                let pair = (left.eye, left.light);
                let alone = kept.trace_technique(workers, &tracing(1), pair);
                let alone = alone.unwrap_or_else(|| panic!("{}: {left:?}", stage.name));
                assert_eq!((alone.weight, alone.raster), (left.weight, left.raster));
                let ratio = f64::from(left.value.luminance() / alone.value.luminance());
                assert!(ratio > 0.999, "{}: {ratio}", stage.name);
                count += 1;
                stronger += u32::from(ratio > 1.01);
            }
        }
    }
    assert!(stronger > count / 10, "{stronger} of {count}");
}

/// What can be wrong with a target over numbers and techniques.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    None,
    /// That there are several techniques is forgotten.
    NoCount,
    /// So are the weights between them.
    NoWeight,
    /// So is the light image, by which there is one more.
    OneLess,
    /// A path of another length is made.
    OtherLength,
}

/// Light of paths of 2 to 6 edges, each estimated by a technique that a number chooses.
fn multiplexed(stage: &Stage, mistake: Mistake) -> Replicas {
    let space = space(stage);
    let count = samples(3000);
    Replicas::new(seed(800), 16, |seed| {
        let (mut kept, mut both) = (Sample::new(), Bidirection::default());
        let mut sums = vec![0.0; MAX_DEPTH - 1];
        for sample in 0..count {
            kept.begin(seed, sample);
            let mut choice = Stream::new(seed, Purpose::Resampling, 0, sample);
            for edges in 2..=MAX_DEPTH {
                let made = match mistake {
                    Mistake::OtherLength => edges - 1,
                    _ => edges,
                };
                let techniques = made as f32 + 1.0;
                let light = ((choice.next_f32() * techniques) as usize).min(made);
                let workers = (&space, &mut both);
                let found = kept.trace_technique(workers, &tracing(1), (made - light, light));
                let Some(found) = found else { continue };
                let value = match mistake {
                    Mistake::NoWeight => found.value,
                    _ => found.energy(),
                };
                let factor = match mistake {
                    Mistake::NoCount => 1.0,
                    Mistake::OneLess => techniques - 1.0,
                    _ => techniques,
                };
                sums[edges - 2] += f64::from(value.luminance() * factor) / f64::from(count);
            }
        }
        sums
    })
}

/// The same light by path tracing.
fn traced(stage: &Stage) -> Replicas {
    let space = space(stage);
    let count = samples(6000);
    Replicas::new(seed(850), 16, |seed| {
        let mut path = Path::default();
        let mut sums = vec![0.0; MAX_DEPTH - 1];
        for sample in 0..count {
            let place = (seed, sample);
            seeds::trace(&space, &TRACING, place, &mut path, &mut |found| {
                if found.edges >= 2 {
                    sums[found.edges as usize - 2] += found.luminance() / f64::from(count);
                }
            });
        }
        sums
    })
}

/// Stages on which path tracing finds all light.
const STAGES: [&str; 3] = ["diffuse box", "thin lens", "mirror hall"];

#[test]
fn numbers_and_techniques_find_the_light_of_every_length() -> Result<(), String> {
    for name in STAGES {
        let stage = stage_of(name);
        let found = multiplexed(&stage, Mistake::None);
        found
            .check_same(&traced(&stage), level(1e-3))
            .map_err(|error| format!("{name}: {error}"))?;
    }
    Ok(())
}

#[test]
fn planted_errors_of_targets_are_found() {
    let stage = stage_of(STAGES[0]);
    let expected = traced(&stage);
    for mistake in [
        Mistake::NoCount,
        Mistake::NoWeight,
        Mistake::OneLess,
        Mistake::OtherLength,
    ] {
        let found = multiplexed(&stage, mistake);
        assert!(
            found.check_same(&expected, level(1e-3)).is_err(),
            "{mistake:?}"
        );
    }
}
