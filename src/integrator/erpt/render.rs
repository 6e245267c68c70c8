//! The passes of energy redistribution path tracing.

use super::Erpt;
use crate::energy::FlowRule;
use crate::film::{Canvas, Filter, Layer, PassBuffer, Unit, Window};
use crate::integrator::camera::pixel_index;
use crate::integrator::chains::{ChainFilm, Kernel, PathWalker};
use crate::integrator::pixel::PixelSettings;
use crate::integrator::render::{Counters, Driver, Integrator};
use crate::mutation::{Chain, ChoiceAt, Perturbation, Proposed};
use crate::path::{Path, PathSpace};
use crate::random::{Purpose, Stream};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// A render by energy redistribution path tracing: every pass makes one camera sample in each pixel and
/// spreads the energy of all its paths.
pub(super) struct ErptRender<'s> {
    erpt: &'s Erpt,
    film: ChainFilm<'s>,
    rule: FlowRule,
    perturbation: Perturbation,
}

/// Mutations of one size, chosen by the kind of path.
struct SignatureKernel<'a> {
    render: &'a ErptRender<'a>,
    /// The mutations that apply to the seed and to all that becomes of it.
    choice: ChoiceAt,
}

impl Kernel for SignatureKernel<'_> {
    fn prepare(&mut self, seed: &Path) -> bool {
        self.choice = self.render.erpt.mutations.choice.at(seed);
        !self.choice.is_empty()
    }

    #[inline]
    fn propose(
        &mut self,
        chain: &mut Chain,
        space: &PathSpace<'_>,
        random: &mut Stream,
    ) -> Option<Proposed> {
        chain.propose(space, &self.render.perturbation, &self.choice, random)
    }
}

impl<'s> ErptRender<'s> {
    /// Prepares a render: makes the estimate that fixes the energy of a deposit and the film's unit.
    pub(super) fn new(
        scene: &'s Scene,
        sensor: &'s Sensor,
        erpt: &'s Erpt,
        settings: PixelSettings,
    ) -> Self {
        let film_size = settings.film_size;
        let film = ChainFilm::new(scene, sensor, &erpt.seeds, settings);
        let perturbation = erpt.mutations.perturbation(sensor, film_size, film.moves);
        Self {
            erpt,
            rule: erpt.flow_rule(film.deposit),
            film,
            perturbation,
        }
    }

    /// Makes one camera sample in each pixel of a block and spreads the energy of its paths.
    fn run_unit(&self, pass: u32, unit: u32, layers: &[PassBuffer]) -> Counters {
        let film = &self.film;
        let space = film.space();
        let kernel = SignatureKernel {
            render: self,
            choice: ChoiceAt::default(),
        };
        let block = film.sampled.block(unit);
        let tile = film.tile(block, layers);
        let landing = film.landing(layers).on_tile(&tile);
        let mut walker = PathWalker::new(landing, &space, kernel, self.rule.levels());
        let mut path = Path::default();
        let mut counters = Counters::default();
        for pixel in block.pixels() {
            let index = pixel_index(&film.settings, pixel.0, pixel.1);
            walker.draw_from(Stream::new(film.settings.seed, Purpose::Chain, index, pass));
            let mut chains = 0;
            let workers = (&space, &mut path);
            let raster = film.sample_pixel(pixel, pass, workers, layers, |seed, energy| {
                let can_move = walker.start(seed);
                if can_move {
                    chains += u64::from(self.rule.spread(&mut walker, energy));
                }
                can_move
            });
            if let Some(place) = film.places.chains {
                layers[place].add(&Filter::pixel_box(), raster, [chains as f32]);
            }
            counters.chains += chains;
            counters.paths += 1;
        }
        walker.flush();
        counters.rays = space.rays();
        counters.mutations = walker.chain.statistics;
        counters
    }
}

impl Integrator for ErptRender<'_> {
    fn layers(&self) -> Vec<Layer> {
        self.film.layers.clone()
    }

    fn units(&self) -> Vec<Unit> {
        self.film.units()
    }

    fn window(&self) -> Window {
        self.film.settings.window
    }

    fn remark(&self) -> Option<String> {
        self.film.seeds.remark(&self.film.mean)
    }

    fn passes_per_replica(&self) -> u32 {
        self.film.settings.sampler.group()
    }

    fn unit_count(&self) -> u32 {
        self.film.sampled.unit_count()
    }

    fn run_pass(&self, pass: u32, layers: &[PassBuffer], driver: &Driver<'_>) -> Option<Counters> {
        driver.run_units(self.unit_count(), |unit| self.run_unit(pass, unit, layers))
    }

    fn finish_pass(&self, layers: &mut [PassBuffer]) {
        self.film.finish_pass(layers);
    }

    fn has_variance(&self, layer: &Layer) -> bool {
        ChainFilm::has_variance(layer)
    }

    fn resolve(&self, means: &mut [Vec<f32>]) {
        self.film.resolve(means);
    }
}
