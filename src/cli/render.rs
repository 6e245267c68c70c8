//! `lumiflow render`.

use std::sync::Arc;
use std::time::Duration;

use super::args::{CompressionName, RenderArgs};
use super::budget::Goal;
use super::console::{print_line, say};
use super::execute::{self, Finished, Job};
use super::failure::Failure;
use super::notes::Notes;
use super::outputs::{self, Target};
use super::plan::{self, Plan, Wish};
use super::signals::Interruption;
use super::summary::Summary;
use super::version;
use crate::film::Filter;
use crate::image::{Compression, ExrOptions, Precision, Rows};
use crate::output::{LayerChoice, Picture, SaveOptions, metadata, save};
use crate::scene::import::{Imported, View};

/// Renders the scenes one after the other; returns the exit code.
///
/// A scene that fails says so and does not keep the others from being rendered; the first failure
/// decides about the exit code.
///
/// # Errors
/// What the command line has wrong, and files that cannot be written.
pub(super) fn run(args: &RenderArgs) -> Result<u8, Failure> {
    plan::check_names(&wish(args))?;
    let targets = outputs::targets(&args.scenes, &args.output)?;
    outputs::check_writable(&targets)?;
    let interruption = Interruption::listen()?;
    let threads = args.threads.map_or_else(execute::all_cores, usize::from);
    let pool = execute::pool(threads)?;
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

/// What all scenes of a call share.
struct Session<'a> {
    args: &'a RenderArgs,
    interruption: &'a Arc<Interruption>,
    threads: usize,
}

impl Session<'_> {
    /// Renders one scene and writes its files.
    fn render(&self, target: &Target) -> Result<(), Failure> {
        let args = self.args;
        let engine = args.tracer.accel.engine();
        let loaded = args.scene.load(&target.scene, args.quiet, engine)?;
        let (mut imported, load) = (loaded.imported, loaded.cost);
        let warnings = std::mem::take(&mut imported.warnings);
        let mut notes = Notes::new(args.scene.strictness(), args.quiet, warnings);
        let view = self.view(&imported, target)?;
        let plan = Plan::new(&wish(args), &imported.integrator, &mut notes)?;
        plan::note_unseen_beams(&imported.scene, [(&*plan.name, &plan)], &mut notes);
        notes.settle()?;

        let job = Job {
            imported: &imported,
            view,
            plan: &plan,
            filter: self.filter(view),
            seed: args.seed,
            goal: goal(args, view),
            threads: self.threads,
        };
        let title = (!args.quiet).then_some(target.name.as_str());
        let finished = job.execute(self.interruption, title, |text| notes.remark_now(text))?;
        if finished.rendered.passes == 0 {
            say(&format!(
                "{}: stopped before the first pass was complete; no file is written",
                target.name
            ));
            return Ok(());
        }
        remark(&finished, &job, &mut notes);
        let record = Summary {
            target,
            imported: &imported,
            plan: &plan,
            view,
            finished: &finished,
            seed: args.seed,
            filter: job.filter.kind().name(),
        };
        let choice = LayerChoice {
            precision: self.precision(view),
            variance: plan.variance,
        };
        let mut image = Picture::new(&finished.rendered, view.film_size, choice);
        image.metadata = metadata(&record.record(&notes), version::REVISION);
        let written = self.write(target, &image, &mut notes);
        notes.settle()?;
        written?;
        if !args.quiet {
            say(&record.lines(&notes));
        }
        if args.json {
            let interrupted = self.interruption.exit_code().is_some();
            let json = record.json(&notes, &image, &load, interrupted);
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

    /// Writes all files, also when one of them fails.
    fn write(&self, target: &Target, image: &dyn Rows, notes: &mut Notes) -> Result<(), Failure> {
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

/// What the arguments wish of the integrator.
fn wish(args: &RenderArgs) -> Wish<'_> {
    Wish {
        integrator: args.integrator.as_deref(),
        settings: &args.settings,
        layers: &args.aov,
    }
}

/// How long to render.
fn goal(args: &RenderArgs, view: &View) -> Goal {
    match args.effort.time {
        Some(seconds) => Goal::Time(Duration::from_secs_f64(seconds)),
        None => {
            let count = args.effort.spp.or(args.effort.passes);
            Goal::Passes(count.unwrap_or(view.sample_count).max(1))
        }
    }
}

/// Notes what went otherwise than one may expect.
fn remark(finished: &Finished, job: &Job<'_>, notes: &mut Notes) {
    let rendered = &finished.rendered;
    if let (Some(over), Goal::Time(limit)) = (finished.overrun, job.goal) {
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
    let group = job.view.sampler.group();
    if job.plan.variance && rendered.passes <= group {
        let sampler = job.view.sampler.name();
        notes.remark(format!(
            "no layer \"variance\": with the sampler \"{sampler}\" it needs more than {group} \
             samples a pixel"
        ));
    }
}
