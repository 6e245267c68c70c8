//! Mixtures of mutations of several radii keep detailed balance, with the density of the kernel that made a move
//! and with that of all of them; see `balance` for how flows tell.

use lumiflow::math::statistics::{sidak, two_sided_p};
use lumiflow::mutation::{
    CausticKernel, Chain, Choice, ChoiceAt, Choose, Component, Mutation, Perturbation,
    RasterKernel, mixture_density,
};
use lumiflow::path::{Path, PathSpace};

use crate::support::effort::{level, samples, seed};
use crate::support::factors::factors;
use crate::support::flow::Flow;
use crate::support::seeds::{TRACING, numbers, space, trace};
use crate::support::stages::{SIDE, Stage, moves_in_pixels, stage_of, stages};

const PROPOSALS: u32 = 2;
const SAMPLES: u32 = 40_000;
const RADII: [f32; 3] = [1.5, 4.0, 9.0];
/// A flow of fewer proposals than this is not judged.
const FEWEST: u64 = 1_000;

/// What is in the acceptance.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ratio {
    /// The probability of choosing the kernel.
    Kernel,
    /// The density of the whole mixture.
    Mixture,
    /// Planted: nothing of the choice.
    Nothing,
    /// Planted: the mixture as seen from the path left, for both ways.
    OneSided,
}

/// A mixture of three radii, which depends on where a path is seen.
struct Kernels<'a> {
    all: &'a [Perturbation],
    at: ChoiceAt,
    chosen: usize,
    ratio: Ratio,
}

/// Probabilities of the radii.
fn weights(path: &Path) -> [f64; 3] {
    if path.raster().x < 0.5 * SIDE as f32 {
        [0.9, 0.08, 0.02]
    } else {
        [0.02, 0.08, 0.9]
    }
}

impl Kernels<'_> {
    fn component(&self, weights: [f64; 3], kernel: usize, mutation: Mutation) -> Component<'_> {
        Component {
            mutation,
            settings: &self.all[kernel],
            probability: weights[kernel] * self.at.probability(mutation),
        }
    }

    fn mixture(
        &self,
        space: &PathSpace<'_>,
        at: &Path,
        mutation: Mutation,
        ends: (&Path, &Path),
    ) -> f64 {
        let weights = weights(at);
        let components = (0..RADII.len()).flat_map(|kernel| {
            let of = move |mutation: &Mutation| self.component(weights, kernel, *mutation);
            Mutation::ALL.iter().map(of)
        });
        let maker = self.component(weights, self.chosen, mutation);
        mixture_density(space, maker, components, ends)
    }
}

impl Choose for Kernels<'_> {
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        self.at.choose(path, u)
    }

    fn density(&self, space: &PathSpace<'_>, from: &Path, to: &Path, mutation: Mutation) -> f64 {
        match self.ratio {
            Ratio::Kernel => weights(from)[self.chosen] * self.at.probability(mutation),
            Ratio::Mixture => self.mixture(space, from, mutation, (from, to)),
            Ratio::Nothing => 1.0,
            // The radii's probabilities do not go with the path.
            Ratio::OneSided => {
                let left = if from.raster().x < to.raster().x {
                    from
                } else {
                    to
                };
                self.mixture(space, left, mutation, (from, to))
            }
        }
    }
}

fn perturbations(stage: &Stage) -> [Perturbation; 3] {
    let moves = moves_in_pixels(&stage.sensor);
    RADII.map(|radius| {
        let caustic = match moves.caustic {
            CausticKernel::Pixels { angle_of_pixel, .. } => CausticKernel::Pixels {
                pixels: radius,
                angle_of_pixel,
            },
            other => other,
        };
        Perturbation {
            raster: RasterKernel::Disk { radius },
            caustic,
            ..moves
        }
    })
}

/// The flow of a stage's energy.
fn flow(stage: &Stage, ratio: Ratio, (seed, count): (u64, u32)) -> Flow {
    let choice = Choice {
        weights: [1.0, 1.0, 0.0, 1.0],
        by_rule: false,
    };
    assert_eq!(Mutation::ALL[2], Mutation::LaiLens);
    let space = space(stage);
    let all = perturbations(stage);
    let mut flow = Flow::default();
    let (mut path, mut chain) = (Path::default(), Chain::default());
    for sample in 0..count {
        let mut random = numbers(seed, sample);
        trace(&space, &TRACING, (seed, sample), &mut path, &mut |found| {
            let energy = found.luminance();
            let Some(x) = found.path.filter(|_| energy > 0.0) else {
                return;
            };
            let at = choice.at(x);
            if at.is_empty() {
                return;
            }
            let from = factors(&space, x);
            chain.start(x);
            for _ in 0..PROPOSALS {
                let u = f64::from(random.next_f32());
                let [small, middle, _] = weights(x);
                let chosen = usize::from(u >= small) + usize::from(u >= small + middle);
                let kernels = Kernels {
                    all: &all,
                    at,
                    chosen,
                    ratio,
                };
                let settings = &all[chosen];
                if let Some(proposed) = chain.propose(&space, settings, &kernels, &mut random) {
                    let to = factors(&space, chain.proposal());
                    flow.add(energy * proposed.acceptance, &from, &to);
                    chain.settle(proposed, false);
                }
            }
        });
        flow.end_sample();
    }
    flow
}

#[test]
fn energy_flows_back_with_either_density() {
    let count = samples(SAMPLES);
    let mut found = Vec::new();
    for (index, stage) in stages().iter().enumerate() {
        for ratio in [Ratio::Kernel, Ratio::Mixture] {
            let flow = flow(stage, ratio, (seed(1200 + index as u64), count));
            if flow.proposals < FEWEST {
                continue;
            }
            let (worst, z) = flow.worst(count);
            println!(
                "{}, {ratio:?}: {} proposals, {worst} {z:.2}",
                stage.name, flow.proposals
            );
            found.extend(
                flow.z(count)
                    .map(|(name, z)| (format!("{}, {ratio:?}: {name}", stage.name), z)),
            );
        }
    }
    let level = sidak(level(1e-3), found.len());
    for (name, z) in found {
        assert!(two_sided_p(z) > level, "{name}: z = {z:.2}");
    }
}

#[test]
fn kernels_left_out_of_the_ratio_are_found() {
    let stage = stage_of(stages()[0].name);
    let count = samples(3 * SAMPLES);
    for ratio in [Ratio::Nothing, Ratio::OneSided] {
        let (worst, z) = flow(&stage, ratio, (seed(1300), count)).worst(count);
        println!("{ratio:?}: {worst} {z:.1}");
        assert!(two_sided_p(z) < 1e-6, "{ratio:?}: {worst} {z}");
    }
}
