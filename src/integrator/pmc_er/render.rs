//! The passes of population Monte Carlo energy redistribution: each is a batch over the whole image.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::kernel::{Batch, Memory, RadiusKernel, can_move};
use super::map::KernelMap;
use super::pool::Pool;
use super::{Adaptation, PmcEr};
use crate::energy::{Account, Births, Member, Population, PopulationRule};
use crate::film::{Canvas, Filter, Layer, PassBuffer, Unit, Window};
use crate::integrator::camera::pixel_index;
use crate::integrator::chains::{ChainFilm, PathWalker, Pause};
use crate::integrator::pixel::PixelSettings;
use crate::integrator::render::{Counters, Driver, Integrator};
use crate::mutation::Perturbation;
use crate::path::{Path, PathSpace};
use crate::random::{Purpose, Stream};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// Replicas after which a map starts from nothing again: a render can be shared out by so many.
const REPLICAS_OF_MAP: u32 = 64;

/// Most camera samples traced before members get their turn.
const MOST_SAMPLES: usize = 1 << 14;

/// Members, or camera samples, that a thread takes at a time.
const SHARE: usize = 64;

/// A render by population Monte Carlo energy redistribution.
pub(super) struct PmcErRender<'s> {
    pmc_er: &'s PmcEr,
    film: ChainFilm<'s>,
    rule: PopulationRule,
    perturbations: Vec<Perturbation>,
    /// Changes between passes only.
    map: Mutex<KernelMap>,
}

/// A path of the population.
#[derive(Clone)]
struct Wanderer {
    pause: Pause,
    memory: Memory,
}

/// A path of the population with its energy and its time.
type PathMember = Member<Wanderer>;

/// Members that begin at a path.
type Seed = (Births, Wanderer);

impl<'s> PmcErRender<'s> {
    /// Prepares a render: makes the estimate that fixes the energy of a deposit and the film's unit.
    pub(super) fn new(
        scene: &'s Scene,
        sensor: &'s Sensor,
        pmc_er: &'s PmcEr,
        settings: PixelSettings,
    ) -> Self {
        let film_size = settings.film_size;
        let film = ChainFilm::new(scene, sensor, &pmc_er.seeds, settings);
        let perturbations = pmc_er.perturbations(sensor, film_size, film.moves);
        Self {
            pmc_er,
            rule: pmc_er.rule(film.deposit),
            map: Mutex::new(Self::new_map(pmc_er, &film)),
            film,
            perturbations,
        }
    }

    fn new_map(pmc_er: &PmcEr, film: &ChainFilm<'_>) -> KernelMap {
        let cell = match pmc_er.adaptation {
            Adaptation::Map { cell } => cell,
            // One cell that nobody asks.
            Adaptation::Member | Adaptation::Off => 1 << 16,
        };
        KernelMap::new(film.domain, cell, pmc_er.radii.len())
    }

    /// One batch: all that one new path in every pixel leads to; `None` when it was cancelled before its
    /// end.
    ///
    /// Source: Lai et al. 2007, Fig. 2.
    fn run_batch(&self, pass: u32, batch: Batch<'_>, driver: &Driver<'_>) -> Option<Counters> {
        let settings = &self.film.settings;
        let mut pool = Pool::new(self.film.sampled);
        let mut population = Population::new(self.rule, self.pmc_er.population);
        let mut log = Log::new(driver);
        let mut born = 0;
        for round in 0.. {
            while population.vacancies() > 0 && pool.has_more() {
                let positions = pool.take(self.positions_for(population.vacancies()));
                let (seeds, counters) = self.trace(pass, &positions, batch);
                log.count(positions.len(), counters);
                seeds.into_iter().for_each(|seed| population.enqueue(seed));
            }
            population.admit(|member| {
                member.state.pause.random = Stream::new(settings.seed, Purpose::Chain, born, pass);
                born += 1;
            });
            if population.is_empty() || driver.is_cancelled() {
                break;
            }
            let (children, counters) = self.mutate(population.members_mut(), batch);
            log.count(0, counters);
            population.turn_over(children);
            if pool.has_more() || population.has_queue() {
                let mut random = Stream::new(settings.seed, Purpose::Elimination, round, pass);
                let u = f64::from(random.next_f32());
                population.eliminate(self.pmc_er.resampling_rate, u);
            }
        }
        log.counters.chains = u64::from(born);
        (!driver.is_cancelled()).then_some(log.counters)
    }

    /// How many positions to take for a number of new members.
    fn positions_for(&self, members: usize) -> usize {
        let wanted = members as f64 * self.pmc_er.samples_per_member();
        (wanted.ceil() as usize).clamp(256, MOST_SAMPLES)
    }

    /// Traces the paths of new positions; returns what begins members. What cannot be moved lands.
    fn trace(
        &self,
        pass: u32,
        positions: &[(i32, i32)],
        batch: Batch<'_>,
    ) -> (Vec<Seed>, Counters) {
        let shares = positions.par_chunks(SHARE).with_max_len(1).map(|share| {
            let space = self.film.space();
            let mut path = Path::default();
            let mut seeds = Vec::new();
            for pixel in share {
                self.trace_pixel(pass, *pixel, (&space, &mut path), batch, &mut seeds);
            }
            let counters = Counters {
                paths: share.len() as u64,
                rays: space.rays(),
                ..Counters::default()
            };
            (seeds, counters)
        });
        gather(shares.collect())
    }

    fn trace_pixel(
        &self,
        pass: u32,
        pixel: (i32, i32),
        workers: (&PathSpace<'_>, &mut Path),
        batch: Batch<'_>,
        seeds: &mut Vec<Seed>,
    ) {
        let settings = &self.film.settings;
        let index = pixel_index(settings, pixel.0, pixel.1);
        let mut random = Stream::new(settings.seed, Purpose::Birth, index, pass);
        let mut chains = 0;
        let layers = batch.layers;
        let take = |seed: &Path, energy| {
            if !can_move(&self.pmc_er.choice, seed) {
                return false;
            }
            let births = self.rule.births(energy, f64::from(random.next_f32()));
            if births.count > 0 {
                chains += births.count;
                let wanderer = Wanderer {
                    pause: Pause::new(seed, random.clone()),
                    memory: Memory::new(),
                };
                seeds.push((births, wanderer));
            }
            true
        };
        let raster = self.film.sample_pixel(pixel, pass, workers, layers, take);
        if let Some(place) = self.film.places.chains {
            layers[place].add(&Filter::pixel_box(), raster, [chains as f32]);
        }
    }

    /// A round of mutations of all members; returns their children.
    fn mutate(&self, members: &mut [PathMember], batch: Batch<'_>) -> (Vec<PathMember>, Counters) {
        let shares = members.par_chunks_mut(SHARE).with_max_len(1).map(|share| {
            let space = self.film.space();
            let kernel = RadiusKernel::new(batch);
            let landing = self.film.landing(batch.layers);
            let mut walker = PathWalker::new(landing, &space, kernel, 0);
            let mut children = Vec::new();
            for member in share {
                let Wanderer { pause, memory } = &mut member.state;
                let age = member.account.age;
                walker.kernel.begin_round(&pause.path, memory, age);
                walker.resume(pause);
                self.rule
                    .play_round(&mut member.account, &mut walker, |walker, account| {
                        children.push(child(walker, account));
                    });
                walker.pause(pause);
                walker.kernel.end_round(memory);
            }
            let counters = Counters {
                rays: space.rays(),
                mutations: walker.chain.statistics,
                ..Counters::default()
            };
            (children, counters)
        });
        gather(shares.collect())
    }
}

/// A member that starts at a walker's proposal.
fn child(walker: &mut PathWalker<'_, RadiusKernel<'_>>, account: Account) -> PathMember {
    let random = walker.fork();
    Member {
        account,
        state: Wanderer {
            pause: Pause::new(walker.chain.proposal(), random),
            memory: Memory::new(),
        },
    }
}

/// Puts together what shares of the work have brought, in their order.
fn gather<T>(shares: Vec<(Vec<T>, Counters)>) -> (Vec<T>, Counters) {
    let mut all = Vec::new();
    let mut sum = Counters::default();
    for (part, counters) in shares {
        all.extend(part);
        sum += counters;
    }
    (all, sum)
}

/// What a batch has done so far.
struct Log<'a> {
    driver: &'a Driver<'a>,
    counters: Counters,
}

impl<'a> Log<'a> {
    fn new(driver: &'a Driver<'a>) -> Self {
        Self {
            driver,
            counters: Counters::default(),
        }
    }

    fn count(&mut self, positions: usize, counters: Counters) {
        self.driver.report(positions as u64, counters);
        self.counters += counters;
    }
}

impl Integrator for PmcErRender<'_> {
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
        // As finely as progress can tell: one unit for each camera sample.
        self.film.sampled.width * self.film.sampled.height
    }

    fn run_pass(&self, pass: u32, layers: &[PassBuffer], driver: &Driver<'_>) -> Option<Counters> {
        let mut map = self.map.lock().unwrap_or_else(PoisonError::into_inner);
        let replica = self.passes_per_replica();
        if pass % (replica * REPLICAS_OF_MAP) == 0 {
            *map = Self::new_map(self.pmc_er, &self.film);
        } else if pass % replica == 0 {
            // The passes of a replica are spread against each other: seen from within, none is a sample of the
            // whole image by itself.
            map.adapt(self.pmc_er.learning, &self.pmc_er.radii);
        }
        let batch = Batch {
            pmc_er: self.pmc_er,
            perturbations: &self.perturbations,
            map: &map,
            places: self.film.places,
            layers,
        };
        self.run_batch(pass, batch, driver)
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
