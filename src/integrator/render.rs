//! Running passes.

use std::ops::{AddAssign, ControlFlow};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use crate::film::{Accumulator, Layer, PassBuffer, Unit, Window};
use crate::mutation::MoveStatistics;

/// What an algorithm is to the driver: layers, and units of work that fill them.
pub trait Integrator: Sync {
    /// The layers of the result; the first is the image itself.
    fn layers(&self) -> Vec<Layer>;

    /// The fixed-point unit of each layer.
    fn units(&self) -> Vec<Unit>;

    /// The pixels that are rendered.
    fn window(&self) -> Window;

    /// Number of consecutive passes that are spread against each other: one replica.
    fn passes_per_replica(&self) -> u32;

    /// What its options lead to that one may not expect; told before the first pass.
    fn remark(&self) -> Option<String> {
        None
    }

    /// Number of work units in a pass.
    fn unit_count(&self) -> u32;

    /// Does the work of one pass; `None` when it was cancelled before its end.
    ///
    /// - `layers`: one buffer for each of [`Integrator::layers`].
    fn run_pass(&self, pass: u32, layers: &[PassBuffer], driver: &Driver<'_>) -> Option<Counters>;

    /// Ends a pass whose work is all done: layers that follow from others are made here.
    fn finish_pass(&self, layers: &mut [PassBuffer]) {
        let _ = layers;
    }

    /// Whether the spread of a layer's replicas tells the noise of something that is looked at.
    fn has_variance(&self, layer: &Layer) -> bool {
        layer.name.is_empty()
    }

    /// Turns the means of all passes into what the layers show.
    ///
    /// - `means`: for each of [`Integrator::layers`] its values, pixel by pixel.
    fn resolve(&self, means: &mut [Vec<f32>]) {
        let _ = means;
    }
}

/// Counts of work done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Camera samples with all that follows from them.
    pub paths: u64,
    /// Rays traced: closest hits and shadow rays.
    pub rays: u64,
    /// Estimates that were not finite or out of range, and were left out.
    pub rejected: u64,
    /// Markov chains run.
    pub chains: u64,
    /// What became of the chains' mutations.
    pub mutations: MoveStatistics,
}

impl Counters {
    /// Mutations tried, of all kinds.
    pub fn mutation_count(&self) -> u64 {
        self.mutations.iter().map(|kind| kind.proposed).sum()
    }

    /// Mean acceptance probability of all mutations tried; zero when there were none.
    pub fn mean_acceptance(&self) -> f64 {
        let sum: f64 = self
            .mutations
            .iter()
            .map(|kind| kind.mean_acceptance() * kind.proposed as f64)
            .sum();
        sum / self.mutation_count().max(1) as f64
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.rejected += other.rejected;
        self.chains += other.chains;
        for (sum, kind) in self.mutations.iter_mut().zip(other.mutations) {
            *sum += kind;
        }
    }
}

/// Work done so far, the pass under way included: what another thread may look at meanwhile.
#[derive(Debug, Default)]
pub struct Progress {
    units: AtomicU64,
    paths: AtomicU64,
    rays: AtomicU64,
}

impl Progress {
    /// Units of work done, in all passes together; divided by [`Integrator::unit_count`], passes.
    pub fn units(&self) -> u64 {
        self.units.load(Relaxed)
    }

    /// Camera samples made.
    pub fn paths(&self) -> u64 {
        self.paths.load(Relaxed)
    }

    /// Rays traced.
    pub fn rays(&self) -> u64 {
        self.rays.load(Relaxed)
    }

    fn add(&self, units: u64, counters: Counters) {
        self.units.fetch_add(units, Relaxed);
        self.paths.fetch_add(counters.paths, Relaxed);
        self.rays.fetch_add(counters.rays, Relaxed);
    }
}

/// What runs units of work on all threads.
#[derive(Clone, Copy, Debug)]
pub struct Driver<'a> {
    cancelled: &'a AtomicBool,
    progress: &'a Progress,
}

impl<'a> Driver<'a> {
    /// - `cancelled`: once true, no further unit is begun.
    /// - `progress`: counts the work as it is done.
    pub fn new(cancelled: &'a AtomicBool, progress: &'a Progress) -> Self {
        Self {
            cancelled,
            progress,
        }
    }

    /// Runs all units of a pass; `None` when it was cancelled before its end.
    ///
    /// - `run`: does one unit of work, whatever the thread.
    pub fn run_units(&self, count: u32, run: impl Fn(u32) -> Counters + Sync) -> Option<Counters> {
        let total = Mutex::new(Counters::default());
        let run = |unit| {
            if self.is_cancelled() {
                return;
            }
            let counters = run(unit);
            // Integer counts: their sum does not depend on the order.
            match total.lock() {
                Ok(mut total) => *total += counters,
                Err(poisoned) => *poisoned.into_inner() += counters,
            }
            self.progress.add(1, counters);
        };
        if rayon::current_num_threads() == 1 {
            (0..count).for_each(run);
        } else {
            // Left to itself rayon hands out runs of units that nobody can take a part of: at the end of a
            // pass, threads would wait for the longest.
            let units = (0..count).into_par_iter().with_max_len(1);
            units.for_each(run);
        }
        let counters = total
            .into_inner()
            .unwrap_or_else(|poisoned| poisoned.into_inner());
        (!self.is_cancelled()).then_some(counters)
    }

    /// True once the pass under way is to be dropped.
    pub(super) fn is_cancelled(&self) -> bool {
        self.cancelled.load(Relaxed)
    }

    /// Reports work that was done otherwise.
    ///
    /// - `units`: whole units of it.
    pub(super) fn report(&self, units: u64, counters: Counters) {
        self.progress.add(units, counters);
    }
}

/// What the caller of [`render`] is told before each pass.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Passes done.
    pub passes: u32,
    /// Work done so far.
    pub counters: Counters,
}

/// The sums of a render.
#[derive(Debug)]
pub struct Rendered {
    /// The layers, with their sums.
    pub layers: Vec<(Layer, Accumulator)>,
    /// What each layer shows, pixel by pixel.
    pub means: Vec<Vec<f32>>,
    /// The pixels that were rendered.
    pub window: Window,
    /// Passes in the sums.
    pub passes: u32,
    /// Work done.
    pub counters: Counters,
}

/// Memory of the film that [`render`] sets aside, in bytes: for each value of each layer the sums of a
/// pass and of all passes, and what tells their spread.
///
/// - `keep_variance`: as for [`render`].
pub fn film_memory(integrator: &dyn Integrator, keep_variance: impl Fn(&Layer) -> bool) -> u64 {
    let pixels = integrator.window().pixel_count() as u64;
    let layers = integrator.layers();
    let of_layer = |layer: &Layer| {
        let values = pixels * layer.channels.len() as u64;
        PassBuffer::memory(values) + Accumulator::memory(values, keep_variance(layer))
    };
    layers.iter().map(of_layer).sum()
}

/// Renders passes, numbered from zero, until the caller says that it is enough.
///
/// - `keep_variance`: for each layer, whether to keep the spread of its replicas.
/// - `cancelled`: once true, the pass under way is dropped and the render ends.
/// - `progress`: counts the work as it is done; what it shows decides nothing.
/// - `next`: asked before each pass, with what was done so far.
pub fn render(
    integrator: &dyn Integrator,
    keep_variance: impl Fn(&Layer) -> bool,
    cancelled: &AtomicBool,
    progress: &Progress,
    mut next: impl FnMut(Step) -> ControlFlow<()>,
) -> Rendered {
    let (window, layers, units) = (integrator.window(), integrator.layers(), integrator.units());
    let mut buffers: Vec<PassBuffer> = Vec::with_capacity(layers.len());
    let mut sums = Vec::with_capacity(layers.len());
    for (layer, unit) in layers.iter().zip(units) {
        let channels = layer.channels.len();
        buffers.push(PassBuffer::new(window, channels, unit));
        let replicas = keep_variance(layer).then(|| integrator.passes_per_replica());
        sums.push(Accumulator::new(
            window.pixel_count() * channels,
            unit,
            replicas,
        ));
    }
    let mut done = Step {
        passes: 0,
        counters: Counters::default(),
    };
    let driver = Driver {
        cancelled,
        progress,
    };
    while !cancelled.load(Relaxed) && next(done).is_continue() {
        let counters = integrator.run_pass(done.passes, &buffers, &driver);
        let Some(mut counters) = counters else { break };
        integrator.finish_pass(&mut buffers);
        for (sum, buffer) in sums.iter_mut().zip(&mut buffers) {
            counters.rejected += buffer.rejected();
            sum.fold(buffer);
        }
        done.counters += counters;
        done.passes += 1;
    }
    // What they take is enough for the means.
    drop(buffers);
    let layers: Vec<_> = layers.into_iter().zip(sums).collect();
    let mut means: Vec<_> = layers.iter().map(|(_, sum)| sum.mean()).collect();
    integrator.resolve(&mut means);
    Rendered {
        layers,
        means,
        window,
        passes: done.passes,
        counters: done.counters,
    }
}
