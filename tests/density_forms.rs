//! The ratio of an acceptance in three forms: the rules of Cline et al. on top of the tracer's own
//! estimates, measures of area with all geometry terms, and the targets that chains use.

use lumiflow::math::Rgb;
use lumiflow::mutation::{
    Chain, Choose, Mutate, Mutation, Perturbation, log_ratio_by_measure, log_ratio_by_rules,
    log_transition,
};
use lumiflow::path::{Coordinates, Generation, Path, PathSpace, PathVertex, Technique, VertexKind};

use crate::support::effort::samples;
use crate::support::seeds::{TRACING, numbers, space, trace};
use crate::support::stages::{moves, moves_in_pixels, stage_of, stages};

const TECHNIQUES: [Technique; 2] = [Technique::Implicit, Technique::Explicit];

fn made(technique: Technique, rr_depth: u32) -> Generation {
    Generation {
        technique,
        rr_depth,
    }
}

/// Estimates of each technique that makes a path, times its weight.
fn energies(space: &PathSpace<'_>, path: &Path) -> Vec<Rgb> {
    // The weights of the tracer leave Russian roulette out.
    let densities = TECHNIQUES.map(|technique| {
        let made = made(technique, u32::MAX);
        space.estimate(path, made)?;
        space.density(path, made, Coordinates::default())
    });
    let weight = |own: usize| match (densities[0], densities[1]) {
        (Some(a), Some(b)) if own == 0 => TRACING.heuristic.first_weight(a as f32, b as f32),
        (Some(a), Some(b)) => TRACING.heuristic.second_weight(a as f32, b as f32),
        _ => 1.0,
    };
    TECHNIQUES
        .into_iter()
        .enumerate()
        .filter_map(|(index, technique)| {
            let estimate = space.estimate(path, made(technique, TRACING.rr_depth))?;
            Some(Rgb(estimate.as_vec3()) * weight(index))
        })
        .collect()
}

#[test]
fn estimates_are_what_the_tracer_counts() {
    let mut all: Vec<(f32, String)> = Vec::new();
    for stage in stages() {
        let space = space(&stage);
        let mut path = Path::default();
        for sample in 0..samples(1_000) {
            trace(&space, &TRACING, (40, sample), &mut path, &mut |found| {
                let Some(path) = found.path else { return };
                let off = |energy: &Rgb| {
                    let difference = (energy.0 - found.energy.0).abs().max_element();
                    difference / found.energy.max_channel()
                };
                let energies = energies(&space, path);
                let nearest = energies.iter().map(off).fold(f32::INFINITY, f32::min);
                all.push((nearest, format!("{} {}", stage.name, path.signature())));
            });
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("{} paths, worst: {:?}", all.len(), &all[..8]);
    // Where a lamp is seen edge-on, rounded positions change a small value by more: at worst by as much
    // as itself.
    assert!(all.len() > 10_000);
    assert!(
        all[all.len() / 1000].0 < 1e-3,
        "{:?}",
        all[all.len() / 1000]
    );
    assert!(all[all.len() / 10_000].0 < 0.02, "{:?}", all[0]);
}

/// Proposes one mutation wherever it applies.
struct Only(Mutation);

impl Choose for Only {
    fn choose(&self, path: &Path, _: f32) -> Option<Mutation> {
        self.0.site(path).map(|_| self.0)
    }

    fn density(&self, _: &PathSpace<'_>, _: &Path, _: &Path, _: Mutation) -> f64 {
        1.0
    }
}

/// How far the directions at the middle one of three vertices may be off, in radians.
fn direction_error(around: &[PathVertex]) -> f64 {
    let length = |pair: &[PathVertex]| match pair[1].kind {
        VertexKind::Infinity => f32::INFINITY,
        _ => pair[0].position().distance(pair[1].position()),
    };
    let error = around.iter().map(|v| v.point.error).fold(0.0, f32::max);
    let shortest = around.windows(2).map(length).fold(f32::INFINITY, f32::min);
    f64::from(4.0 * error / shortest)
}

/// How often forms were compared, and how far they were apart.
#[derive(Default)]
struct Comparison {
    rules: u64,
    measures: u64,
    differences: Vec<f64>,
    /// The largest difference, in units of what rounding allows, with its logarithm's size.
    worst: (f64, f64, String),
}

/// How far apart the logarithms of two forms may be.
///
/// Positions are rounded, and rays start a little off them: directions are off by some 10⁻⁵, by more on
/// a short edge, and cosines by as much. Near total reflection, refraction makes of it what the square of the cosine divides.
fn allowed(space: &PathSpace<'_>, paths: [&Path; 2]) -> f64 {
    let error = |path: &Path| {
        let vertices = path.vertices();
        let at = |index: usize| {
            let vertex = &vertices[index];
            let cos = |other: usize| {
                let (direction, _) = space.edge(vertex, &vertices[other]).expect("an edge");
                f64::from(vertex.geometric_cos(direction))
            };
            let cos = cos(index - 1).min(cos(index + 1));
            let power = if vertex.event.is_dirac() { 2 } else { 1 };
            (1e-5 + direction_error(&vertices[index - 1..=index + 1])) / cos.powi(power)
        };
        (1..path.edges()).map(at).sum::<f64>()
    };
    1e-3 + paths.map(error).iter().sum::<f64>()
}

impl Comparison {
    fn add(&mut self, (form, target): (f64, f64), allowed: f64, what: impl Fn() -> String) {
        let off = (form - target).abs();
        self.differences.push(off);
        let excess = off / allowed;
        if excess.is_nan() || excess > self.worst.0 {
            self.worst = (excess, off, what());
        }
    }

    /// Compares the forms of one proposal.
    fn compare(
        &mut self,
        (mutation, name): (Mutation, &str),
        space: &PathSpace<'_>,
        settings: &Perturbation,
        (x, y): (&Path, &Path),
    ) {
        let site = mutation.site(x).expect("the mutation applies");
        let target = |path| mutation.target(space, settings, path, site);
        let target = (target(y) / target(x)).ln();
        if !target.is_finite() {
            return;
        }
        let allowed = allowed(space, [x, y]);
        let what = |form: &str| format!("{form}, {name} {}: {}", mutation.name(), x.signature());
        let by_measure = log_ratio_by_measure(mutation, space, settings, (x, y));
        let by_measure = by_measure.unwrap_or(f64::NAN);
        self.measures += 1;
        self.add((by_measure, target), allowed, || what("measures"));
        for technique in TECHNIQUES {
            let made = made(technique, TRACING.rr_depth);
            let by_rules = log_ratio_by_rules(mutation, space, settings, made, (x, y));
            if let Some(by_rules) = by_rules.filter(|_| space.estimate(x, made).is_some()) {
                self.rules += 1;
                self.add((by_rules, target), allowed, || {
                    what(&format!("rules, {technique:?}"))
                });
            }
        }
    }
}

#[test]
fn three_forms_of_the_acceptance_agree() {
    let mut comparison = Comparison::default();
    for stage in stages() {
        let space = space(&stage);
        let (mut path, mut chain) = (Path::default(), Chain::default());
        let in_pixels = moves_in_pixels(&stage.sensor);
        for sample in 0..samples(800) {
            let mut random = numbers(41, sample);
            trace(&space, &TRACING, (41, sample), &mut path, &mut |found| {
                let Some(seed) = found.path else { return };
                for settings in [moves(), in_pixels] {
                    for mutation in Mutation::ALL {
                        chain.start(seed);
                        let only = Only(*mutation);
                        let proposed = chain.propose(&space, &settings, &only, &mut random);
                        let Some(proposed) = proposed else { continue };
                        let paths = (chain.current(), chain.proposal());
                        let what = (*mutation, stage.name);
                        comparison.compare(what, &space, &settings, paths);
                        chain.settle(proposed, false);
                    }
                }
            });
        }
    }
    let Comparison {
        rules,
        measures,
        mut differences,
        worst,
    } = comparison;
    differences.sort_by(f64::total_cmp);
    let quantile = |q: f64| differences[(q * (differences.len() - 1) as f64) as usize];
    let largest = quantile(1.0);
    println!("{rules} by rules, {measures} by measures; largest {largest:.1e}, worst {worst:?}");
    println!(
        "median {:.1e}, 99 % {:.1e}, 99.9 % {:.1e}",
        quantile(0.5),
        quantile(0.99),
        quantile(0.999)
    );
    assert!(rules > 5_000 && measures > 10_000);
    assert!(quantile(0.9999) <= 1e-3);
    assert!(worst.0 <= 1.0, "{worst:?}");
}

#[test]
fn directions_turn_as_far_wherever_the_lens_moves() {
    let stage = stage_of("thin lens");
    let space = space(&stage);
    let settings = Perturbation {
        lens: 2.0,
        ..moves_in_pixels(&stage.sensor)
    };
    let (mut path, mut chain) = (Path::default(), Chain::default());
    let mut compared = 0;
    for sample in 0..samples(6_000) {
        let mut random = numbers(42, sample);
        trace(&space, &TRACING, (42, sample), &mut path, &mut |found| {
            let Some(seed) = found.path else { return };
            chain.start(seed);
            let caustic = Only(Mutation::Caustic);
            let Some(proposed) = chain.propose(&space, &settings, &caustic, &mut random) else {
                return;
            };
            let (x, y) = (chain.current(), chain.proposal());
            for (from, to) in [(x, y), (y, x)] {
                let density = log_transition(Mutation::Caustic, &space, &settings, (from, to));
                assert!(
                    density.is_some(),
                    "{}: there is no such move",
                    x.signature()
                );
            }
            compared += 1;
            chain.settle(proposed, false);
        });
    }
    assert!(compared > 400, "{compared}");
}
