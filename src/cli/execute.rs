//! Running a plan: the one place where an integrator meets threads, the clock and signals.

use std::ops::ControlFlow;
use std::thread;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::budget::{Budget, Goal};
use super::console::size;
use super::failure::Failure;
use super::memory;
use super::monitor::Monitor;
use super::plan::Plan;
use super::signals::Interruption;
use crate::accel;
use crate::film::{Filter, Layer, Window};
use crate::integrator::{PixelSettings, Progress, Rendered, film_memory, render};
use crate::output::Run;
use crate::scene::import::{Imported, View};

/// Number of threads that run at once on this machine.
pub(super) fn all_cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Whether the system tells how much processor time this process took.
///
/// # Errors
/// When it does not.
pub(super) fn check_cpu_clock() -> Result<(), Failure> {
    let clock = ProcessTime::try_now();
    clock
        .map(|_| ())
        .map_err(|error| Failure::File(format!("the system tells no processor time: {error}")))
}

/// Threads to render with.
///
/// # Errors
/// When the system has no more.
pub(super) fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("render {index}"))
        .start_handler(|_| accel::prepare_worker())
        .build()
        .map_err(|error| Failure::File(format!("cannot start {threads} threads: {error}")))
}

/// A render to be made, in a pool of [`pool`].
pub(super) struct Job<'a> {
    /// The scene.
    pub(super) imported: &'a Imported,
    /// Which of its sensors.
    pub(super) view: &'a View,
    /// With which integrator, and which layers.
    pub(super) plan: &'a Plan,
    /// The reconstruction filter.
    pub(super) filter: Filter,
    /// Start of the random numbers.
    pub(super) seed: u64,
    /// How long.
    pub(super) goal: Goal,
    /// Threads of the pool, for the record.
    pub(super) threads: usize,
}

/// A finished render with its costs.
pub(super) struct Finished {
    /// The sums.
    pub(super) rendered: Rendered,
    /// What it took, preparations of the integrator included, without loading and writing.
    pub(super) run: Run,
    /// Seconds of the integrator's preparations.
    pub(super) prepare_seconds: f64,
    /// Memory of the film, in bytes.
    pub(super) film_memory: u64,
    /// By how many seconds the time was overrun.
    pub(super) overrun: Option<f64>,
}

impl Job<'_> {
    /// Renders until the goal is reached or a signal comes.
    ///
    /// - `title`: name under which progress is shown; `None` shows nothing.
    /// - `remark`: told what the integrator has to say before the first pass.
    ///
    /// # Errors
    /// [`Failure::Memory`] when there is none for the film.
    pub(super) fn execute(
        &self,
        interruption: &Interruption,
        title: Option<&str>,
        remark: impl FnOnce(String),
    ) -> Result<Finished, Failure> {
        interruption.save_from_now_on();
        let (start, cpu) = (Instant::now(), ProcessTime::try_now().ok());
        let (scene, sensor) = (&self.imported.scene, &self.view.sensor);
        let work = self.plan.integrator.start(scene, sensor, self.settings());
        let prepare_seconds = start.elapsed().as_secs_f64();
        if let Some(text) = work.remark() {
            remark(text);
        }
        let elapsed = || self.elapsed(start, cpu);
        let keep_variance = |layer: &Layer| self.plan.variance && work.has_variance(layer);
        let film_memory = film_memory(&*work, keep_variance);
        self.check_film(film_memory, memory::available())?;
        let mut budget = Budget::new(self.goal, elapsed());
        let progress = Progress::default();
        let mut passes = || {
            let cancelled = interruption.cancelled();
            render(&*work, keep_variance, cancelled, &progress, |step| {
                if budget.allows_another(step.passes, elapsed()) {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            })
        };
        let rendered = match title {
            None => passes(),
            Some(name) => {
                let monitor = Monitor {
                    name,
                    goal: self.goal,
                    start,
                    cpu,
                    work: Some((work.unit_count(), &progress)),
                };
                monitor.during(passes)
            }
        };
        let (wall, of_goal) = (start.elapsed(), elapsed());
        let cpu_seconds = cpu.and_then(|cpu| cpu.try_elapsed().ok());
        Ok(Finished {
            rendered,
            run: Run {
                wall_seconds: wall.as_secs_f64(),
                cpu_seconds: cpu_seconds.map_or(f64::NAN, |time| time.as_secs_f64()),
                threads: self.threads,
            },
            prepare_seconds,
            film_memory,
            overrun: budget.overrun(of_goal).map(|over| over.as_secs_f64()),
        })
    }

    /// Whether there is memory for the film.
    ///
    /// - `available`: in bytes, where that is known.
    fn check_film(&self, film: u64, available: Option<u64>) -> Result<(), Failure> {
        match available {
            Some(available) if available < film => {
                let Window { width, height, .. } = self.view.window;
                Err(Failure::Memory(format!(
                    "the film of {width}x{height} pixels with its layers needs {} of memory, and {} \
                     are available beside the scene's {}; a smaller --size, a crop window, fewer \
                     layers and no --aov variance need less",
                    size(film),
                    size(available),
                    size(self.imported.scene.memory().held()),
                )))
            }
            _ => Ok(()),
        }
    }

    /// Time since the start by the clock that the goal means; endless where there is no such clock.
    fn elapsed(&self, start: Instant, cpu: Option<ProcessTime>) -> Duration {
        match self.goal {
            Goal::CpuTime(_) => {
                let spent = cpu.and_then(|cpu| cpu.try_elapsed().ok());
                spent.unwrap_or(Duration::MAX)
            }
            Goal::Passes(_) | Goal::Time(_) => start.elapsed(),
        }
    }

    fn settings(&self) -> PixelSettings {
        PixelSettings {
            seed: self.seed,
            film_size: self.view.film_size,
            window: self.view.window,
            filter: self.filter,
            sampler: self.view.sampler,
            alpha: self.view.alpha,
            second_moment: self.imported.integrator.second_moment,
            aovs: self.plan.aovs.clone(),
            own_layers: self.plan.own_layers.clone(),
        }
    }
}
