//! `lumiflow render`.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::thread;
use std::time::Instant;

use cpu_time::ProcessTime;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::args::{CompressionName, RenderArgs};
use super::budget::{Budget, Goal};
use super::console::{print_line, say};
use super::failure::Failure;
use super::monitor::Monitor;
use super::notes::Notes;
use super::outputs::{self, Target};
use super::plan::{self, Plan};
use super::signals::Interruption;
use super::summary::Summary;
use super::version;
use crate::accel;
use crate::film::{Filter, Layer};
use crate::image::{Compression, ExrOptions, Image, Precision};
use crate::integrator::{PixelSettings, Progress, Rendered, render};
use crate::output::{LayerChoice, Run, SaveOptions, metadata, picture, save};
use crate::scene::import::{Imported, View};

/// Renders the scenes one after the other; returns the exit code.
///
/// A scene that fails says so and does not keep the others from being rendered; the first failure
/// decides about the exit code.
///
/// # Errors
/// What the command line has wrong, and files that cannot be written.
pub(super) fn run(args: &RenderArgs) -> Result<u8, Failure> {
    plan::check_names(args)?;
    let targets = outputs::targets(&args.scenes, &args.output)?;
    outputs::check_writable(&targets)?;
    let interruption = Interruption::listen()?;
    let threads = args.threads.map_or_else(all_cores, usize::from);
    let pool = pool(threads)?;
    let session = Session {
        args,
        interruption: &interruption,
        threads,
    };
    let mut code = 0;
    for target in &targets {
        let failed = match pool.install(|| session.render(target)) {
            Ok(()) => None,
            // It would be wrong for the other scenes, too.
            Err(failure @ Failure::Usage(_)) => return Err(failure),
            Err(failure) => {
                failure.report("render");
                Some(failure.exit_code())
            }
        };
        if let Some(interrupted) = interruption.exit_code() {
            return Ok(failed.unwrap_or(interrupted));
        }
        if code == 0 {
            code = failed.unwrap_or(0);
        }
    }
    Ok(code)
}

fn all_cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

fn pool(threads: usize) -> Result<ThreadPool, Failure> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|index| format!("render {index}"))
        .start_handler(|_| accel::prepare_worker())
        .build()
        .map_err(|error| Failure::File(format!("cannot start {threads} threads: {error}")))
}

/// What all scenes of a call share.
struct Session<'a> {
    args: &'a RenderArgs,
    interruption: &'a Arc<Interruption>,
    threads: usize,
}

/// A finished render with its costs.
struct Finished {
    rendered: Rendered,
    run: Run,
    /// By how many seconds `--time` was overrun.
    overrun: Option<f64>,
}

impl Session<'_> {
    /// Renders one scene and writes its files.
    fn render(&self, target: &Target) -> Result<(), Failure> {
        let args = self.args;
        let loading = Instant::now();
        let mut imported = args.scene.load(&target.scene)?;
        let load_seconds = loading.elapsed().as_secs_f64();
        let warnings = std::mem::take(&mut imported.warnings);
        let mut notes = Notes::new(args.scene.strictness(), args.quiet, warnings);
        let view = self.view(&imported, target)?;
        let plan = Plan::new(args, &imported.integrator, &mut notes)?;
        notes.settle()?;

        let finished = self.run_passes(target, &imported, view, &plan);
        if finished.rendered.passes == 0 {
            say(&format!(
                "{}: stopped before the first pass was complete; no file is written",
                target.name
            ));
            return Ok(());
        }
        remark(&finished, view, &plan, args, &mut notes);
        let record = Summary {
            target,
            imported: &imported,
            plan: &plan,
            view,
            rendered: &finished.rendered,
            run: finished.run,
            seed: args.seed,
            filter: self.filter(view).kind().name(),
        };
        let choice = LayerChoice {
            precision: self.precision(view),
            variance: plan.variance,
        };
        let mut image = picture(&finished.rendered, view.film_size, choice);
        image.metadata = metadata(&record.record(&notes), version::REVISION);
        let written = self.write(target, &image, &mut notes);
        notes.settle()?;
        written?;
        if !args.quiet {
            say(&record.line());
        }
        if args.json {
            let interrupted = self.interruption.exit_code().is_some();
            let json = record.json(&notes, &image, load_seconds, interrupted);
            print_line(&json.to_string())?;
        }
        Ok(())
    }

    fn view<'i>(&self, imported: &'i Imported, target: &Target) -> Result<&'i View, Failure> {
        let (wanted, count) = (self.args.sensor, imported.views.len());
        imported.views.get(wanted).ok_or_else(|| {
            let sensors = match count {
                1 => "one sensor, --sensor 0".to_owned(),
                _ => format!("{count} sensors, --sensor 0 to {}", count.saturating_sub(1)),
            };
            let scene = target.scene.display();
            Failure::Usage(format!("--sensor {wanted}: {scene} has {sensors}"))
        })
    }

    fn filter(&self, view: &View) -> Filter {
        let wanted = self.args.filter.and_then(plan::filter);
        wanted.unwrap_or(view.filter)
    }

    fn precision(&self, view: &View) -> Precision {
        let file = &self.args.file;
        if file.half || (view.half && !file.float) {
            Precision::Half
        } else {
            Precision::Float
        }
    }

    /// Renders until the goal is reached or a signal comes.
    fn run_passes(
        &self,
        target: &Target,
        imported: &Imported,
        view: &View,
        plan: &Plan,
    ) -> Finished {
        self.interruption.save_from_now_on();
        let (start, cpu) = (Instant::now(), ProcessTime::try_now().ok());
        let settings = PixelSettings {
            seed: self.args.seed,
            film_size: view.film_size,
            window: view.window,
            filter: self.filter(view),
            sampler: view.sampler,
            alpha: view.alpha,
            second_moment: imported.integrator.second_moment,
            aovs: plan.aovs.clone(),
            own_layers: plan.own_layers.clone(),
        };
        let work = plan
            .integrator
            .start(&imported.scene, &view.sensor, settings);
        let goal = plan::goal(self.args, view);
        let mut budget = Budget::new(goal, start.elapsed());
        let progress = Progress::default();
        let mut passes = || {
            let keep_variance = |layer: &Layer| plan.variance && work.has_variance(layer);
            let cancelled = self.interruption.cancelled();
            render(&*work, keep_variance, cancelled, &progress, |step| {
                if budget.allows_another(step.passes, start.elapsed()) {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            })
        };
        let rendered = if self.args.quiet {
            passes()
        } else {
            let monitor = Monitor {
                name: &target.name,
                goal,
                start,
                units_per_pass: work.unit_count(),
                progress: &progress,
            };
            monitor.during(passes)
        };
        let wall = start.elapsed();
        let cpu_seconds = cpu.and_then(|cpu| cpu.try_elapsed().ok());
        Finished {
            rendered,
            run: Run {
                wall_seconds: wall.as_secs_f64(),
                cpu_seconds: cpu_seconds.map_or(f64::NAN, |time| time.as_secs_f64()),
                threads: self.threads,
            },
            overrun: budget.overrun(wall).map(|over| over.as_secs_f64()),
        }
    }

    /// Writes all files, also when one of them fails.
    fn write(&self, target: &Target, image: &Image, notes: &mut Notes) -> Result<(), Failure> {
        let options = SaveOptions {
            exr: ExrOptions {
                compression: compression(self.args.file.compression),
                ..ExrOptions::default()
            },
            exposure: self.args.file.exposure,
        };
        let mut failures = Vec::new();
        for file in &target.files {
            match save(file, image, &options) {
                Ok(0) => {}
                Ok(clamped) => notes.remark(format!(
                    "{}: {clamped} values were too large for half floats and became 65504; --float \
                     keeps them",
                    file.display()
                )),
                Err(error) => failures.push(error.to_string()),
            }
        }
        if failures.is_empty() {
            Ok(())
        } else {
            Err(Failure::File(failures.join("\nerror: ")))
        }
    }
}

fn compression(name: CompressionName) -> Compression {
    match name {
        CompressionName::None => Compression::None,
        CompressionName::Rle => Compression::Rle,
        CompressionName::Zips => Compression::Zips,
        CompressionName::Zip => Compression::Zip,
        CompressionName::Piz => Compression::Piz,
    }
}

/// Notes what went otherwise than one may expect.
fn remark(finished: &Finished, view: &View, plan: &Plan, args: &RenderArgs, notes: &mut Notes) {
    let rendered = &finished.rendered;
    if let (Some(over), Goal::Time(limit)) = (finished.overrun, plan::goal(args, view)) {
        notes.remark(format!(
            "the render took {over:.2} s longer than the {} s that it was given",
            limit.as_secs_f64()
        ));
    }
    let rejected = rendered.counters.rejected;
    if rejected > 0 {
        notes.remark(format!(
            "{rejected} estimates were not finite or out of range and were left out"
        ));
    }
    let group = view.sampler.group();
    if plan.variance && rendered.passes <= group {
        let sampler = view.sampler.name();
        notes.remark(format!(
            "no layer \"variance\": with the sampler \"{sampler}\" it needs more than {group} \
             samples a pixel"
        ));
    }
}
