//! The passes of Metropolis sampling.

use std::ops::Range;
use std::sync::{Mutex, OnceLock, PoisonError};

use super::bootstrap::{BLOCK, Bootstrap, Cells, Seed, block};
use super::importance::NoiseMap;
use super::options::Work;
use super::{Importance, MetropolisOptions};
use crate::film::{Layer, PassBuffer, Unit, Window};
use crate::integrator::Algorithm;
use crate::integrator::chains::{ChainFilm, Landing, OWN_LAYERS, SeedOptions};
use crate::integrator::pixel::PixelSettings;
use crate::integrator::render::{Counters, Driver, Integrator};
use crate::path::Path;
use crate::random::{Purpose, SamplerKind, Stream};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// A pass, for those who make its samples and chains.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct ChainPlan<'a> {
    pub(in crate::integrator) film: &'a ChainFilm<'a>,
    /// Number of the pass.
    pub(in crate::integrator) pass: u32,
    /// Where the bootstrap samples are.
    pub(in crate::integrator) cells: Cells,
    /// Number of chains.
    pub(in crate::integrator) chains: u32,
    /// Mutations of a chain.
    pub(in crate::integrator) length: u32,
    /// What the target is multiplied by, and what lands divided.
    pub(in crate::integrator) importance: &'a Importance,
    /// Energy of a mutation's deposit, as luminance times importance.
    pub(in crate::integrator) deposit: f64,
    /// Where energy lands.
    pub(in crate::integrator) layers: &'a [PassBuffer],
}

impl<'a> ChainPlan<'a> {
    /// Where the energy of chains lands.
    pub(in crate::integrator) fn landing(&self) -> Landing<'a> {
        self.film.landing(self.layers).divided_by(self.importance)
    }

    /// The numbers that a bootstrap sample is made of.
    pub(in crate::integrator) fn bootstrap_numbers(&self, sample: u32) -> Stream {
        let seed = self.film.settings.seed;
        Stream::new(seed, Purpose::Bootstrap, sample, self.pass)
    }

    /// The numbers of the light's side of a sample.
    pub(in crate::integrator) fn light_numbers(&self, index: u32) -> Stream {
        Stream::new(self.film.settings.seed, Purpose::Light, index, self.pass)
    }

    /// The numbers of a chain.
    pub(in crate::integrator) fn chain_numbers(&self, chain: u32) -> Stream {
        Stream::new(self.film.settings.seed, Purpose::Chain, chain, self.pass)
    }

    /// Number of pixels that paths are seen at.
    pub(in crate::integrator) fn pixels(&self) -> f64 {
        self.film.domain.pixels()
    }
}

/// Luminances of bootstrap samples, with the count of what they have cost.
pub(in crate::integrator) fn counted(luminances: Vec<f64>, rays: u64) -> (Vec<f64>, Counters) {
    let counters = Counters {
        paths: luminances.len() as u64,
        rays,
        ..Counters::default()
    };
    (luminances, counters)
}

/// What chains walk over.
pub(in crate::integrator) trait Sampling: Sync {
    /// Makes samples of the bootstrap set, and returns their luminances times importance; zero for what is
    /// not finite.
    fn bootstrap(&self, plan: &ChainPlan<'_>, samples: Range<u32>) -> (Vec<f64>, Counters);

    /// Runs a chain.
    ///
    /// - `index`: its number.
    fn run_chain(&self, plan: &ChainPlan<'_>, index: u32, seed: Seed) -> Counters;
}

/// An integrator by Metropolis sampling.
pub(in crate::integrator) trait Metropolis: Send + Sync {
    /// What its chains walk over.
    type Sampling<'s>: Sampling
    where
        Self: 's;

    /// What the family's integrators share.
    fn options(&self) -> (&SeedOptions, &MetropolisOptions);

    /// What chains walk over, on a film.
    fn sampling<'s>(&'s self, film: &ChainFilm<'s>) -> Self::Sampling<'s>;
}

impl<M: Metropolis> Algorithm for M {
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's> {
        Box::new(MetropolisRender::new(self, (scene, sensor), settings))
    }

    fn has_second_moment(&self) -> bool {
        // What lands on a pixel at once is no sample of it.
        false
    }

    fn shows_traced_light(&self) -> bool {
        self.options().0.both_sides.is_some()
    }

    fn own_layers(&self) -> &'static [&'static str] {
        OWN_LAYERS
    }
}

/// A render by Metropolis sampling.
struct MetropolisRender<'s, S> {
    film: ChainFilm<'s>,
    work: Work,
    cells: Cells,
    /// Changes between passes only.
    noise: Option<Mutex<NoiseMap>>,
    sampling: S,
}

impl<'s, S: Sampling> MetropolisRender<'s, S> {
    /// Prepares a render: makes the estimate that fixes the film's unit.
    fn new<M: Metropolis<Sampling<'s> = S>>(
        algorithm: &'s M,
        (scene, sensor): (&'s Scene, &'s Sensor),
        settings: PixelSettings,
    ) -> Self {
        let (seeds, options) = algorithm.options();
        // A pass is a replica: nothing is spread over several.
        let settings = PixelSettings {
            sampler: SamplerKind::Independent,
            ..settings
        };
        let film = ChainFilm::new(scene, sensor, seeds, settings);
        let size = film.domain.high - film.domain.low;
        let work = options.work(film.domain.pixels());
        Self {
            cells: Cells::new(work.samples, size),
            work,
            noise: options
                .noise_aware
                .then(|| Mutex::new(NoiseMap::new(film.domain))),
            sampling: algorithm.sampling(&film),
            film,
        }
    }

    /// Units of work that fill what chains do not fill.
    fn pixel_units(&self) -> u32 {
        if self.film.needs_pixels() {
            self.film.sampled.unit_count()
        } else {
            0
        }
    }

    fn bootstrap_units(&self) -> u32 {
        self.cells.count().div_ceil(BLOCK)
    }

    /// The weights for a pass.
    fn importance(&self, pass: u32) -> Importance {
        self.noise.as_ref().map_or_else(
            || Importance::flat(&self.film.domain),
            |noise| {
                let mut noise = noise.lock().unwrap_or_else(PoisonError::into_inner);
                noise.for_pass(pass)
            },
        )
    }

    fn run_pixels(&self, pass: u32, unit: u32, layers: &[PassBuffer]) -> Counters {
        let space = self.film.space();
        let mut path = Path::default();
        let mut counters = Counters::default();
        for pixel in self.film.sampled.block(unit).pixels() {
            let workers = (&space, &mut path);
            self.film.sample_apart(pixel, pass, workers, layers);
            counters.paths += 1;
        }
        counters.rays = space.rays();
        counters
    }
}

impl<S: Sampling> Integrator for MetropolisRender<'_, S> {
    fn layers(&self) -> Vec<Layer> {
        self.film.layers.clone()
    }

    fn units(&self) -> Vec<Unit> {
        self.film.units()
    }

    fn window(&self) -> Window {
        self.film.settings.window
    }

    fn passes_per_replica(&self) -> u32 {
        1
    }

    fn unit_count(&self) -> u32 {
        self.pixel_units() + self.bootstrap_units() + self.work.chains
    }

    fn run_pass(&self, pass: u32, layers: &[PassBuffer], driver: &Driver<'_>) -> Option<Counters> {
        let mut counters = driver.run_units(self.pixel_units(), |unit| {
            self.run_pixels(pass, unit, layers)
        })?;
        let samples = self.cells.count();
        let importance = self.importance(pass);
        let mut plan = ChainPlan {
            film: &self.film,
            pass,
            cells: self.cells,
            chains: self.work.chains,
            length: self.work.length,
            importance: &importance,
            deposit: 0.0,
            layers,
        };
        let blocks = vec![OnceLock::new(); self.bootstrap_units() as usize];
        counters += driver.run_units(self.bootstrap_units(), |unit| {
            let (luminances, counters) = self.sampling.bootstrap(&plan, block(unit, samples));
            blocks[unit as usize].get_or_init(|| luminances);
            counters
        })?;
        let blocks = blocks.into_iter().map(OnceLock::into_inner);
        let bootstrap = Bootstrap::new(blocks.map(Option::unwrap_or_default));
        let mutations = f64::from(plan.chains) * f64::from(plan.length);
        plan.deposit = bootstrap.mean() * plan.pixels() / mutations;
        let seed = self.film.settings.seed;
        let mut random = Stream::new(seed, Purpose::Resampling, 0, pass);
        let seeds = bootstrap.seeds(plan.chains, f64::from(random.next_f32()));
        let chains = driver.run_units(plan.chains, |chain| {
            let seed = seeds.get(chain as usize);
            seed.map_or_else(Counters::default, |seed| {
                self.sampling.run_chain(&plan, chain, *seed)
            })
        });
        counters += chains?;
        Some(counters)
    }

    fn finish_pass(&self, layers: &mut [PassBuffer]) {
        if let Some(noise) = &self.noise {
            let mut noise = noise.lock().unwrap_or_else(PoisonError::into_inner);
            noise.observe(self.film.redistributed(layers));
        }
        self.film.finish_pass(layers);
    }

    fn has_variance(&self, layer: &Layer) -> bool {
        ChainFilm::has_variance(layer)
    }

    fn resolve(&self, means: &mut [Vec<f32>]) {
        self.film.resolve(means);
    }
}
