//! Subpaths from both sides: their weights against densities worked out one by one, and each technique
//! against the others.

use lumiflow::emitter::EmitterClass;
use lumiflow::math::Vec2;
use lumiflow::path::{Bidirectional, Connection, Event, Path, Tolerance, VertexKind, Weighing};

use crate::support::effort::{samples, seed};
use crate::support::render::Replicas;
use crate::support::seeds::{LIGHT_PATHS, from_both_sides, space, trace_both_sides};
use crate::support::stages::{SIDE, Stage, stages};
use crate::support::techniques::{Densities, MISTAKES, Mistake};
use crate::support::two_sided_light::beams;

/// Weight of a technique from the densities of all.
fn weight(weighing: Weighing, densities: &[f64], technique: usize) -> f64 {
    let own = densities[technique];
    let ratio = |density: &f64| density / own;
    match weighing {
        Weighing::Maximum => {
            let is_first = densities[..technique].iter().all(|p| p * 1.001 < own);
            f64::from(u8::from(
                is_first && densities.iter().all(|p| ratio(p) <= 1.001),
            ))
        }
        Weighing::Balance => 1.0 / densities.iter().map(ratio).sum::<f64>(),
        Weighing::Square => 1.0 / densities.iter().map(|p| ratio(p).powi(2)).sum::<f64>(),
        Weighing::Power(power) => 1.0 / densities.iter().map(|p| ratio(p).powf(power)).sum::<f64>(),
    }
}

/// What the weights of many paths have been compared to.
#[derive(Debug, Default)]
struct Comparison {
    count: u32,
    /// Paths whose weight is another.
    wrong: u32,
    /// How many paths had so many techniques.
    techniques: [u32; 8],
}

fn compare(stage: &Stage, weighing: Weighing, mistake: Mistake, count: u32) -> Comparison {
    let space = space(stage);
    let densities = Densities {
        space: &space,
        light_paths: LIGHT_PATHS,
        mistake,
    };
    let mut comparison = Comparison::default();
    let mut path = Path::default();
    let tracing = from_both_sides(weighing);
    for sample in 0..count {
        trace_both_sides(&tracing, &space, (seed(31), sample), |both, found| {
            if !both.assemble(&space, found, &mut path) {
                return;
            }
            let all = densities.all(&path);
            let expected = weight(weighing, &all, found.eye);
            // Grazing directions are not exact.
            let is_wrong = (f64::from(found.weight) - expected).abs() > 0.01;
            comparison.count += 1;
            comparison.wrong += u32::from(is_wrong || expected.is_nan());
            comparison.techniques[all.iter().filter(|p| **p > 0.0).count()] += 1;
        });
    }
    comparison
}

#[test]
fn carried_weights_are_those_of_all_densities() {
    for stage in stages().into_iter().chain([beams().into()]) {
        for weighing in [
            Weighing::Balance,
            Weighing::Square,
            Weighing::Power(0.7),
            Weighing::Maximum,
        ] {
            let found = compare(&stage, weighing, Mistake::None, samples(150));
            assert!(found.count > 20, "{}: {found:?}", stage.name);
            assert!(
                f64::from(found.wrong) <= 2e-3 * f64::from(found.count),
                "{}, {weighing:?}: {found:?}",
                stage.name
            );
        }
    }
}

#[test]
fn planted_errors_of_densities_are_found() {
    let all = stages();
    for mistake in MISTAKES {
        let share = |stage: &Stage| {
            let found = compare(stage, Weighing::Balance, mistake, 150);
            f64::from(found.wrong) / f64::from(found.count)
        };
        let worst = all.iter().map(share).fold(0.0, f64::max);
        assert!(worst > 0.05, "{mistake:?}: {worst}");
    }
}

#[test]
fn paths_of_two_subpaths_are_what_they_say() {
    for stage in stages().into_iter().chain([beams().into()]) {
        let space = space(&stage);
        let mut path = Path::default();
        let (mut count, mut broken) = (0, Vec::new());
        for sample in 0..100 {
            let tracing = from_both_sides(Weighing::Balance);
            trace_both_sides(&tracing, &space, (seed(33), sample), |both, found| {
                if both.assemble(&space, found, &mut path) {
                    count += 1;
                    let checked = path.verify(&space, &Tolerance::default());
                    broken.extend(checked.err());
                }
            });
        }
        let share = broken.len() as f64 / f64::from(count);
        assert!(count > 10 && share < 0.01, "{}: {broken:?}", stage.name);
    }
}

/// A function of paths without Dirac vertices and without parallel light that is small where an edge is short, so that no technique has
/// a singularity; zero for all other paths.
fn tame(path: &Path) -> f64 {
    let vertices = path.vertices();
    let is_parallel = |event| event == Event::Emission(EmitterClass::Directional);
    let all = || vertices.iter().map(|vertex| vertex.event);
    if all().any(|event| event.is_dirac() || is_parallel(event)) {
        return 0.0;
    }
    vertices[1..]
        .windows(2)
        .filter(|pair| pair[1].kind != VertexKind::Infinity)
        .map(|pair| {
            let distance = pair[0].position().distance_squared(pair[1].position());
            f64::from(distance / (distance + 0.3))
        })
        .product()
}

/// Largest number of edges of paths that are made by each technique alone.
const EDGES: usize = 3;

/// Means of the tame part of the image by each technique alone.
fn by_technique(stage: &Stage, edges: usize, fault: impl Fn(&Connection) -> f64) -> Replicas {
    const REPLICAS: u64 = 16;
    let space = space(stage);
    let tracing = Bidirectional {
        max_depth: edges as u32,
        ..from_both_sides(Weighing::Balance)
    };
    let mut path = Path::default();
    let count = samples(1500);
    Replicas::new(seed(700), REPLICAS, |seed| {
        let mut sums = vec![0.0; edges + 1];
        for sample in 0..count {
            trace_both_sides(&tracing, &space, (seed, sample), |both, found| {
                if found.edges() == edges && both.assemble(&space, found, &mut path) {
                    let is_on_film = found.raster.cmpge(Vec2::ZERO).all()
                        && found.raster.cmplt(Vec2::splat(SIDE as f32)).all();
                    if is_on_film {
                        let value = f64::from(found.value.luminance()) * fault(found);
                        sums[found.eye] += value * tame(&path) / f64::from(count);
                    }
                }
            });
        }
        sums
    })
}

/// Compares all techniques with the one that samples lights; returns how many see light.
fn check_techniques(found: &Replicas) -> Result<usize, String> {
    let summary = found.summary();
    let (expected, error) = summary[summary.len() - 2];
    for (technique, (mean, variance)) in summary.iter().enumerate() {
        // Lights that no ray meets.
        if technique + 1 == summary.len() && *mean == 0.0 {
            continue;
        }
        let z = (mean - expected) / (variance + error).sqrt().max(1e-12);
        // Of sixteen replicas; about a hundred comparisons.
        if z.abs() > 5.5 {
            return Err(format!("technique {technique}: z = {z}, {summary:?}"));
        }
    }
    Ok(summary.iter().filter(|(mean, _)| *mean > 0.0).count())
}

#[test]
fn each_technique_alone_sees_the_same_light() {
    for edges in 2..=EDGES {
        let mut full = 0;
        for stage in stages() {
            let count = check_techniques(&by_technique(&stage, edges, |_| 1.0))
                .unwrap_or_else(|error| panic!("{}, {edges} edges: {error}", stage.name));
            full += u32::from(count >= edges);
        }
        // Some stages have no such paths without Dirac events.
        assert!(full >= 5, "{full} stages with {edges} edges");
    }
}

#[test]
fn a_technique_that_is_wrong_by_a_few_per_cent_is_found() {
    let stage = &stages()[0];
    for wrong in [0, 1] {
        let fault = |found: &Connection| if found.eye == wrong { 1.1 } else { 1.0 };
        assert!(check_techniques(&by_technique(stage, 2, fault)).is_err());
    }
}
