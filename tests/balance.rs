//! Mutations keep detailed balance.
//!
//! A seed x̄ of energy e makes a proposal ȳ that is accepted with probability a. Under detailed balance
//! as much energy goes from x̄ to ȳ as back, so that for every function g of a path
//! `E[e · a(x̄ → ȳ) · (g(ȳ) − g(x̄))] = 0`. The functions are the logarithms of all factors of all targets
//! and where the path is seen: a factor that is wrong shows in its own function first. Differences
//! are cut off at ±3, and those that may be rounding count as none, which keeps them antisymmetric.
//!
//! The paths of one camera sample depend on each other; samples do not.

use lumiflow::math::statistics::{sidak, two_sided_p};
use lumiflow::mutation::{
    CausticPerturbation, Chain, Choose, Fault, Mutate, Mutation, Perturbation,
};
use lumiflow::path::{Path, PathSpace};

use crate::support::effort::{is_proof, level, samples, seed};
use crate::support::factors::{NAMES, factors};
use crate::support::flow::Flow;
use crate::support::planted::{Planted, all_planted};
use crate::support::seeds::{TRACING, numbers, space, trace};
use crate::support::stages::{Stage, moves, moves_in_pixels, stage_of, stages};

/// Proposals from each seed.
const PROPOSALS: u32 = 2;
/// Camera samples without a fault.
const SAMPLES: u32 = 120_000;
/// A mutation with fewer proposals than this on a stage is not judged there.
const FEWEST: u64 = 1_000;

/// Chooses one mutation wherever it applies.
#[derive(Clone, Copy)]
struct Only {
    mutation: Mutation,
    /// Whether it is chosen less often on the left half of the film.
    is_uneven: bool,
    /// Whether it is chosen only where the eye sees a caustic.
    is_caustic: bool,
}

impl Only {
    fn applies(&self, path: &Path) -> bool {
        let is_meant = !self.is_caustic || CausticPerturbation::is_caustic(path);
        is_meant && self.mutation.site(path).is_some()
    }

    /// Chance of being chosen where it applies.
    fn chance(&self, path: &Path) -> f64 {
        if self.is_uneven && path.raster().x < 8.0 {
            0.3
        } else {
            1.0
        }
    }
}

impl Choose for Only {
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        let chance = self.chance(path);
        (f64::from(u) < chance && self.applies(path)).then_some(self.mutation)
    }

    fn density(&self, _: &PathSpace<'_>, from: &Path, _: &Path, _: Mutation) -> f64 {
        self.chance(from)
    }
}

/// One mutation with its settings, and the flow that it has made.
struct Case {
    name: String,
    choice: Only,
    settings: Perturbation,
    flow: Flow,
}

impl Case {
    fn new(name: &str, mutation: Mutation, settings: Perturbation) -> Self {
        let name = format!("{name}, {}", mutation.name());
        let choice = Only {
            mutation,
            is_uneven: false,
            is_caustic: false,
        };
        Self::with(name, choice, settings)
    }

    fn with(name: String, choice: Only, settings: Perturbation) -> Self {
        Self {
            name,
            choice,
            settings,
            flow: Flow::default(),
        }
    }
}

/// Lets the energy of a stage's paths flow.
fn run(stage: &Stage, cases: &mut [Case], (seed, count): (u64, u32)) {
    let space = space(stage);
    let (mut path, mut chain) = (Path::default(), Chain::default());
    for sample in 0..count {
        let mut random = numbers(seed, sample);
        trace(&space, &TRACING, (seed, sample), &mut path, &mut |found| {
            let energy = found.luminance();
            let Some(x) = found.path.filter(|_| energy > 0.0) else {
                return;
            };
            let from = factors(&space, x);
            for case in &mut *cases {
                if !case.choice.applies(x) {
                    continue;
                }
                chain.start(x);
                for _ in 0..PROPOSALS {
                    let choice = &case.choice;
                    let Some(proposed) = chain.propose(&space, &case.settings, choice, &mut random)
                    else {
                        continue;
                    };
                    let to = factors(&space, chain.proposal());
                    case.flow.add(energy * proposed.acceptance, &from, &to);
                    chain.settle(proposed, false);
                }
            }
        });
        cases.iter_mut().for_each(|case| case.flow.end_sample());
    }
}

/// Every mutation; the caustic perturbation also for caustics alone and in its other form, and a choice
/// that depends on the path.
fn all_cases(stage: &Stage) -> Vec<Case> {
    let mut cases: Vec<Case> = Mutation::ALL
        .iter()
        .map(|mutation| Case::new(stage.name, *mutation, moves()))
        .collect();
    for settings in [moves(), moves_in_pixels(&stage.sensor)] {
        let in_pixels = settings != moves();
        for is_caustic in [false, true].into_iter().filter(|only| *only || in_pixels) {
            let mut case = Case::new(stage.name, Mutation::Caustic, settings);
            case.choice.is_caustic = is_caustic;
            case.name += if is_caustic { ", caustics" } else { "" };
            case.name += if in_pixels { ", in pixels" } else { "" };
            cases.push(case);
        }
    }
    let mut uneven = Case::new(stage.name, Mutation::Lens, moves());
    uneven.choice.is_uneven = true;
    uneven.name += ", unevenly chosen";
    cases.push(uneven);
    cases
}

#[test]
fn energy_flows_back_as_it_flows_away() {
    let count = samples(SAMPLES);
    let mut found = Vec::new();
    for (index, stage) in stages().iter().enumerate() {
        let mut cases = all_cases(stage);
        run(stage, &mut cases, (seed(900 + index as u64), count));
        for case in cases.iter().filter(|case| case.flow.proposals >= FEWEST) {
            let (worst, z) = case.flow.worst(count);
            println!(
                "{}: {} proposals, {worst} {z:.2}",
                case.name, case.flow.proposals
            );
            let all = case.flow.z(count);
            found.extend(all.map(|(name, z)| (format!("{}: {name}", case.name), z)));
        }
    }
    let level = sidak(level(1e-3), found.len());
    for (name, z) in found {
        assert!(two_sided_p(z) > level, "{name}: z = {z:.2}");
    }
}

/// The same mutation without and with the fault.
fn run_planted(planted: &Planted, count: u32) -> [Case; 2] {
    let stage = stage_of(planted.stage);
    let settings = match planted.fault {
        Fault::LargestAngle | Fault::WayBack => moves_in_pixels(&stage.sensor),
        _ => moves(),
    };
    let choice = Only {
        mutation: planted.mutation,
        is_uneven: planted.fault == Fault::Choice,
        is_caustic: planted.is_caustic,
    };
    let case = |fault| Case::with(String::new(), choice, Perturbation { fault, ..settings });
    let mut cases = [case(Fault::None), case(planted.fault)];
    run(&stage, &mut cases, (seed(77), count));
    cases
}

/// Number of samples; the smallest fault needs more than the suite has time for: there are none.
fn planted_count(planted: &Planted) -> u32 {
    match planted.fault {
        Fault::Ratio if !is_proof() => 0,
        _ => samples(planted.samples),
    }
}

#[test]
fn planted_errors_are_found() {
    println!("| fault | stage | mutation | proposals | function | z | largest | z | right |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let all = all_planted();
    let level = sidak(1e-3, all.len() * NAMES.len());
    let mut missed = Vec::new();
    for planted in &all {
        let count = planted_count(planted);
        if count == 0 {
            continue;
        }
        let [right, wrong] = run_planted(planted, count);
        let own = wrong.flow.z(count).find(|(name, _)| *name == planted.own);
        let own = own.map_or(0.0, |(_, z)| z);
        let (largest, z) = wrong.flow.worst(count);
        let (_, clean) = right.flow.worst(count);
        let caustics = if planted.is_caustic { ", caustics" } else { "" };
        println!(
            "| {:?} | {} | {}{caustics} | {} | {} | {own:.1} | {largest} | {z:.1} | {clean:.1} |",
            planted.fault,
            planted.stage,
            planted.mutation.name(),
            wrong.flow.proposals,
            planted.own,
        );
        let is_found = two_sided_p(z) < level && two_sided_p(clean) > level;
        if !is_found {
            missed.push(format!(
                "{:?} on {}: z = {z:.1}, {clean:.1}",
                planted.fault, planted.stage
            ));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}
