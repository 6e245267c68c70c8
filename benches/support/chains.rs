//! Chains of one kind of mutation, with the sizes of moves that `erpt` has by default.

use lumiflow::math::Vec2;
use lumiflow::mutation::{
    AngleKernel, BidirectionalMutation, CausticKernel, Chain, Choice, Fault, Mutate, Mutation,
    Perturbation, RasterDomain, RasterKernel,
};
use lumiflow::path::{Heuristic, Path, PathRules, PathSpace, PathTracing, camera_sample};
use lumiflow::random::{PixelAddress, Purpose, Sampler, SamplerKind, Stream};
use lumiflow::scene::Scene;
use lumiflow::sensor::Sensor;

use crate::scenes::SIDE;

/// Seeds that chains begin at.
const SEEDS: usize = 32;

/// Steps of each of them.
const STEPS: u32 = 64;

/// Mutations with a scene in which the paths that they move are frequent; no mutation stands for the
/// bidirectional one.
pub(crate) const CASES: [(Option<Mutation>, &str, &str); 6] = [
    (Some(Mutation::Lens), "lens", "cornell-box"),
    (Some(Mutation::Lens), "lens", "coloured-mirrors"),
    (Some(Mutation::MultiChain), "multi_chain", "cornell-caustic"),
    (Some(Mutation::LaiLens), "lai_lens", "cornell-caustic"),
    (Some(Mutation::Caustic), "caustic", "cornell-caustic"),
    (None, "bidirectional", "cornell-box"),
];

/// A space of paths, with seeds for a mutation.
pub(crate) struct Start<'s> {
    space: PathSpace<'s>,
    seeds: Vec<Path>,
    mutation: Option<Mutation>,
}

impl<'s> Start<'s> {
    /// Finds seeds by path tracing.
    pub(crate) fn new(scene: &'s Scene, sensor: &'s Sensor, mutation: Option<Mutation>) -> Self {
        let space = PathSpace::new(scene, sensor, PathRules::default());
        let seeds = seeds(&space, |path| match mutation {
            Some(mutation) => mutation.site(path).is_some(),
            None => true,
        });
        assert_eq!(seeds.len(), SEEDS, "seeds are frequent");
        Self {
            space,
            seeds,
            mutation,
        }
    }

    /// Steps that [`Start::run`] makes.
    pub(crate) const fn steps() -> u64 {
        SEEDS as u64 * STEPS as u64
    }

    /// Runs a chain from every seed; returns how many proposals were accepted.
    #[inline(never)]
    pub(crate) fn run(&self, chain: &mut Chain) -> u64 {
        let settings = perturbation();
        let mut bidirectional = BidirectionalMutation::new(2, 12);
        let mut accepted = 0;
        for (index, seed) in (0..).zip(&self.seeds) {
            let mut random = Stream::new(2, Purpose::Check, index, 0);
            chain.start(seed);
            for _ in 0..STEPS {
                let proposed = match self.mutation {
                    Some(mutation) => {
                        chain.propose(&self.space, &settings, &only(mutation), &mut random)
                    }
                    None => {
                        let mutation = (&mut bidirectional, |_: &Path| 1.0);
                        chain.propose_bidirectional(&self.space, &settings, mutation, &mut random)
                    }
                };
                if let Some(proposed) = proposed {
                    let is_accepted = f64::from(random.next_f32()) < proposed.acceptance;
                    chain.settle(proposed, is_accepted);
                    accepted += u64::from(is_accepted);
                }
            }
        }
        accepted
    }
}

/// Always the same mutation.
fn only(mutation: Mutation) -> Choice {
    let mut weights = [0.0; Mutation::COUNT];
    weights[mutation as usize] = 1.0;
    Choice {
        weights,
        by_rule: false,
    }
}

fn perturbation() -> Perturbation {
    Perturbation {
        raster: RasterKernel::Square { side: 9.0 },
        angle: AngleKernel::default(),
        caustic: CausticKernel::Logarithmic(AngleKernel::default()),
        lens: 0.25,
        domain: RasterDomain {
            low: Vec2::ZERO,
            high: Vec2::splat(SIDE as f32),
        },
        fault: Fault::None,
    }
}

/// Paths of more than two edges that fit.
fn seeds(space: &PathSpace<'_>, fits: impl Fn(&Path) -> bool) -> Vec<Path> {
    let tracing = PathTracing {
        max_depth: 10,
        rr_depth: 5,
        heuristic: Heuristic::default(),
    };
    let (mut path, mut seeds) = (Path::default(), Vec::new());
    for pixel in 0..1 << 20 {
        let address = PixelAddress {
            seed: 1,
            purpose: Purpose::Check,
            pixel,
            sample: 0,
        };
        let mut sampler = Sampler::new(SamplerKind::Independent, address);
        let raster = sampler.next_2d() * SIDE as f32;
        let ray = camera_sample(space, raster, &mut sampler);
        // One a sample, so that many places are among them.
        let mut seed = None;
        let from = (raster, &ray);
        tracing.trace(space, &mut path, from, &mut sampler, &mut |found| {
            let found = found.path.filter(|path| path.edges() > 2 && fits(path));
            seed = seed.take().or_else(|| found.cloned());
        });
        seeds.extend(seed);
        if seeds.len() == SEEDS {
            break;
        }
    }
    seeds
}
