//! Mutations keep detailed balance.
//!
//! A seed x̄ of energy e makes a proposal ȳ that is accepted with probability a. Under detailed balance
//! as much energy goes from x̄ to ȳ as back, so that for every function g of a path
//! `E[e · a(x̄ → ȳ) · (g(ȳ) − g(x̄))] = 0`. The functions are the logarithms of all factors of all targets
//! and where the path is seen: a factor that is wrong shows in its own function first. Differences
//! are cut off at ±3, which keeps them antisymmetric.
//!
//! The paths of one camera sample depend on each other; samples do not.

use lumiflow::math::statistics::{sidak, two_sided_p};
use lumiflow::mutation::{
    CausticPerturbation, Chain, Choose, Fault, Mutate, Mutation, Perturbation,
};
use lumiflow::path::Path;

use crate::support::effort::{level, samples, seed};
use crate::support::factors::{Factors, NAMES, factors};
use crate::support::seeds::{TRACING, numbers, space, trace};
use crate::support::stages::{Stage, moves, moves_in_pixels, stage_of, stages};

/// Proposals from each seed.
const PROPOSALS: u32 = 2;
/// Camera samples without a fault.
const SAMPLES: u32 = 40_000;
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
        is_meant && self.mutation.last_changed(path).is_some()
    }
}

impl Choose for Only {
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        let chance = self.probability(path, self.mutation);
        (f64::from(u) < chance && self.applies(path)).then_some(self.mutation)
    }

    fn probability(&self, path: &Path, _: Mutation) -> f64 {
        if self.is_uneven && path.raster().x < 8.0 {
            0.3
        } else {
            1.0
        }
    }
}

/// One mutation with its settings, and the flow that it has made.
struct Case {
    name: String,
    choice: Only,
    settings: Perturbation,
    proposals: u64,
    sample: Factors,
    sums: Factors,
    squares: Factors,
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
            proposals: 0,
            sample: [0.0; NAMES.len()],
            sums: [0.0; NAMES.len()],
            squares: [0.0; NAMES.len()],
        }
    }

    /// Counts a flow.
    fn flow(&mut self, energy: f64, from: &Factors, to: &Factors) {
        self.proposals += 1;
        for (sum, (from, to)) in self.sample.iter_mut().zip(from.iter().zip(to)) {
            *sum += energy * (to - from).clamp(-3.0, 3.0);
        }
    }

    fn end_sample(&mut self) {
        for (index, value) in self.sample.iter_mut().enumerate() {
            self.sums[index] += *value;
            self.squares[index] += *value * *value;
            *value = 0.0;
        }
    }

    /// For each function that varied, its mean in standard errors.
    fn z(&self, count: u32) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let count = f64::from(count);
        NAMES.into_iter().enumerate().filter_map(move |(i, name)| {
            let (sum, square) = (self.sums[i], self.squares[i]);
            let deviation = (square - sum * sum / count).max(0.0).sqrt();
            // What varies by rounding alone is a constant.
            let largest = self.squares.iter().copied().fold(0.0, f64::max);
            (square > 1e-8 * largest).then(|| (name, sum / deviation))
        })
    }

    /// The function that is farthest out.
    fn worst(&self, count: u32) -> (&'static str, f64) {
        self.z(count)
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .unwrap_or(("nothing", 0.0))
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
                    case.flow(energy * proposed.acceptance, &from, &to);
                    chain.settle(proposed, false);
                }
            }
        });
        cases.iter_mut().for_each(Case::end_sample);
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
        for case in cases.iter().filter(|case| case.proposals >= FEWEST) {
            let (worst, z) = case.worst(count);
            println!(
                "{}: {} proposals, {worst} {z:.2}",
                case.name, case.proposals
            );
            let all = case.z(count);
            found.extend(all.map(|(name, z)| (format!("{}: {name}", case.name), z)));
        }
    }
    let level = sidak(level(1e-3), found.len());
    for (name, z) in found {
        assert!(two_sided_p(z) > level, "{name}: z = {z:.2}");
    }
}

/// A fault, where it is planted, and the function that it should show in.
struct Planted {
    fault: Fault,
    stage: &'static str,
    mutation: Mutation,
    /// Caustics alone.
    is_caustic: bool,
    /// Thousands of camera samples.
    thousands: u32,
    own: &'static str,
}

fn planted(
    fault: Fault,
    (stage, mutation, is_caustic): (&'static str, Mutation, bool),
    thousands: u32,
    own: &'static str,
) -> Planted {
    Planted {
        fault,
        stage,
        mutation,
        is_caustic,
        thousands,
        own,
    }
}

/// Every fault at least once.
fn all_planted() -> Vec<Planted> {
    use Mutation::{Caustic, LaiLens, Lens, MultiChain};
    let on = |stage, mutation| (stage, mutation, false);
    let caustics = |stage| (stage, Caustic, true);
    let all = vec![
        planted(
            Fault::HeadCosine,
            on("point and spot", Caustic),
            30,
            "head cosine",
        ),
        planted(Fault::HeadCosine, caustics("mirror"), 200, "head cosine"),
        planted(
            Fault::ImageCosine,
            on("rough metal", Caustic),
            30,
            "image cosine",
        ),
        planted(Fault::ImageCosine, caustics("tank"), 200, "image cosine"),
        planted(
            Fault::ImageDistance,
            on("rough metal", Caustic),
            30,
            "image distance²",
        ),
        planted(
            Fault::ImageDistance,
            caustics("glass ball"),
            200,
            "image distance²",
        ),
        planted(
            Fault::PixelsPerSteradian,
            on("point and spot", Caustic),
            40,
            "pixels/sr",
        ),
        planted(
            Fault::PixelsPerSteradian,
            caustics("glass ball"),
            200,
            "pixels/sr",
        ),
        planted(
            Fault::FirstCosine,
            on("plastic", Caustic),
            30,
            "first cosine",
        ),
        planted(Fault::FirstCosine, caustics("mirror"), 200, "first cosine"),
        planted(Fault::Adjoint, caustics("tank"), 200, "adjoint"),
        planted(
            Fault::ShadingNormals,
            caustics("smooth glass"),
            300,
            "shading part",
        ),
        planted(
            Fault::ShadingNormals,
            caustics("smooth mirror"),
            300,
            "shading part",
        ),
        planted(
            Fault::LargestAngle,
            on("diffuse box", Caustic),
            20,
            "largest angle",
        ),
        planted(
            Fault::WayBack,
            on("diffuse box", Caustic),
            20,
            "largest angle",
        ),
        planted(
            Fault::ConnectionCosine,
            on("diffuse box", Lens),
            20,
            "connection cosine",
        ),
        planted(
            Fault::ConnectionDistance,
            on("diffuse box", Lens),
            20,
            "connection distance²",
        ),
        planted(
            Fault::ConnectionCosine,
            on("tank", MultiChain),
            200,
            "connection cosine",
        ),
        planted(
            Fault::Coefficient,
            on("open air", Lens),
            30,
            "Dirac coefficients",
        ),
        planted(
            Fault::Coefficient,
            on("tank", Lens),
            60,
            "Dirac coefficients",
        ),
        planted(
            Fault::Coefficient,
            caustics("textures"),
            200,
            "Dirac coefficients",
        ),
        planted(Fault::Selection, on("open air", Lens), 30, "selection"),
        planted(Fault::Selection, caustics("glass ball"), 300, "selection"),
        planted(Fault::Area, on("open air", LaiLens), 40, "aimed area"),
        planted(Fault::Aim, on("tank", MultiChain), 100, "turned cosine"),
        planted(Fault::Aim, on("open air", MultiChain), 40, "turned cosine"),
        planted(Fault::Choice, on("mirror", Lens), 20, "left half"),
        planted(Fault::Ratio, on("diffuse box", Lens), 600, "luminance"),
    ];
    // The smallest one takes a proof.
    let is_proof = samples(1) > 1;
    let is_possible = |planted: &Planted| is_proof || planted.fault != Fault::Ratio;
    all.into_iter().filter(is_possible).collect()
}

impl Planted {
    /// The same mutation without and with the fault.
    fn run(&self) -> [Case; 2] {
        let stage = stage_of(self.stage);
        let settings = match self.fault {
            Fault::LargestAngle | Fault::WayBack => moves_in_pixels(&stage.sensor),
            _ => moves(),
        };
        let choice = Only {
            mutation: self.mutation,
            is_uneven: self.fault == Fault::Choice,
            is_caustic: self.is_caustic,
        };
        let case = |fault| Case::with(String::new(), choice, Perturbation { fault, ..settings });
        let mut cases = [case(Fault::None), case(self.fault)];
        run(&stage, &mut cases, (seed(77), self.count()));
        cases
    }

    fn count(&self) -> u32 {
        // Only the smallest fault needs more in a proof.
        let thousand = match self.fault {
            Fault::Ratio => samples(1_000),
            _ => 1_000,
        };
        thousand * self.thousands
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
        let [right, wrong] = planted.run();
        let count = planted.count();
        let own = wrong.z(count).find(|(name, _)| *name == planted.own);
        let own = own.map_or(0.0, |(_, z)| z);
        let (largest, z) = wrong.worst(count);
        let (_, clean) = right.worst(count);
        let caustics = if planted.is_caustic { ", caustics" } else { "" };
        println!(
            "| {:?} | {} | {}{caustics} | {} | {} | {own:.1} | {largest} | {z:.1} | {clean:.1} |",
            planted.fault,
            planted.stage,
            planted.mutation.name(),
            wrong.proposals,
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
