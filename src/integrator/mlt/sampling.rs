//! Chains of paths.

use std::ops::Range;

use super::Mlt;
use super::kernel::MltKernel;
use crate::energy::{Walker, run_chain};
use crate::film::{Canvas, Filter};
use crate::integrator::chains::{ChainFilm, PathWalker};
use crate::integrator::metropolis::{ChainPlan, Sampling, Seed, counted};
use crate::integrator::render::Counters;
use crate::math::Vec2;
use crate::mutation::Perturbation;
use crate::path::{Found, Path, PathSpace, camera_sample};
use crate::random::{PixelAddress, Purpose, Sampler, SamplerKind};

/// Chains of paths as what Metropolis sampling samples.
pub(in crate::integrator) struct PathSampling<'a> {
    mlt: &'a Mlt,
    perturbation: Perturbation,
}

/// Luminance of a path that may become a seed; zero for one that is not finite.
fn luminance(found: &Found<'_>) -> f64 {
    let luminance = found.luminance();
    if luminance > 0.0 && luminance.is_finite() {
        luminance
    } else {
        0.0
    }
}

impl<'a> PathSampling<'a> {
    pub(super) fn new(mlt: &'a Mlt, film: &ChainFilm<'_>) -> Self {
        let film_size = film.settings.film_size;
        Self {
            mlt,
            perturbation: mlt
                .mutations
                .perturbation(film.sensor, film_size, film.moves),
        }
    }
}

/// Traces a sample of the bootstrap set; hands out its paths that go to chains.
///
/// - `wants_paths`: false where their light is enough.
fn trace(
    plan: &ChainPlan<'_>,
    (sample, wants_paths): (u32, bool),
    (space, path): (&PathSpace<'_>, &mut Path),
    found: &mut impl FnMut(Found<'_>, Vec2),
) {
    let film = plan.film;
    let sampler = |purpose| {
        let address = PixelAddress {
            seed: film.settings.seed,
            purpose,
            pixel: sample,
            sample: plan.pass,
        };
        Sampler::new(SamplerKind::Independent, address)
    };
    let mut numbers = sampler(Purpose::Bootstrap);
    let (low, size) = plan.cells.cell(sample);
    let place = low + size * numbers.next_2d();
    let raster = film.raster_of(place);
    let Some(tracing) = &film.seeds.both_sides else {
        film.trace_at(place, (space, path), u32::MAX, &mut numbers, &mut |path| {
            found(path, raster);
        });
        return;
    };
    let ray = camera_sample(space, raster, &mut numbers);
    let samplers = [&mut numbers, &mut sampler(Purpose::Light)];
    let workers = (space, wants_paths.then_some(path));
    film.trace_both_sides(tracing, workers, (raster, &ray), samplers, &mut |at| {
        if film.seeds.goes_to_chains(at.path.edges) {
            found(at.path, at.raster);
        }
    });
}

impl Sampling for PathSampling<'_> {
    fn bootstrap(&self, plan: &ChainPlan<'_>, samples: Range<u32>) -> (Vec<f64>, Counters) {
        let space = plan.film.space();
        let mut path = Path::default();
        let all = |sample| {
            let mut sum = 0.0;
            let workers = (&space, &mut path);
            trace(plan, (sample, false), workers, &mut |found, raster| {
                sum += luminance(&found) * plan.importance.at(raster);
            });
            sum
        };
        let luminances: Vec<f64> = samples.map(all).collect();
        counted(luminances, space.rays())
    }

    fn run_chain(&self, plan: &ChainPlan<'_>, index: u32, seed: Seed) -> Counters {
        let space = plan.film.space();
        let landing = plan.landing();
        let kernel = MltKernel::new(self.mlt, &self.perturbation, plan.importance);
        let mut walker = PathWalker::new(landing, &space, kernel, 0);
        walker.draw_from(plan.chain_numbers(index));
        let mut path = Path::default();
        // What rounding makes of sums must not lead beyond the last path.
        let mut within = seed.within * (1.0 - 1e-9);
        let mut is_found = false;
        trace(
            plan,
            (seed.sample, true),
            (&space, &mut path),
            &mut |found, raster| {
                let luminance = luminance(&found) * plan.importance.at(raster);
                if is_found || luminance == 0.0 {
                    return;
                }
                within -= luminance;
                if within >= 0.0 {
                    return;
                }
                is_found = true;
                run(
                    plan,
                    &mut walker,
                    (&found, raster),
                    self.mlt.expected_values,
                );
            },
        );
        Counters {
            rays: space.rays(),
            chains: 1,
            mutations: walker.chain.statistics,
            ..Counters::default()
        }
    }
}

/// Runs the chain of a seed; lets its energy land where it is if nothing can move it.
fn run(
    plan: &ChainPlan<'_>,
    walker: &mut PathWalker<'_, MltKernel<'_>>,
    (found, raster): (&Found<'_>, Vec2),
    expected_values: bool,
) {
    if found.path.is_some_and(|seed| walker.start(seed)) {
        walker.restart();
        run_chain(walker, plan.length, plan.deposit, expected_values);
        walker.flush();
    } else {
        let energy = plan.deposit * f64::from(plan.length) / found.luminance();
        plan.landing()
            .land_unmoved(raster, found.energy * energy as f32);
    }
    if let Some(place) = plan.film.places.chains {
        plan.layers[place].add(&Filter::pixel_box(), raster, [1.0]);
    }
}
