//! One render of a race.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use super::entrants::{Effort, Entrant, Runner};
use super::files::Folder;
use super::peer::{self, Peer, Stopped};
use super::race::{Rules, Slot};
use super::stage::Stage;
use crate::cli::budget::Goal;
use crate::cli::console::say;
use crate::cli::execute::{Finished, Job};
use crate::cli::failure::{Failure, sizes_differ};
use crate::cli::monitor::Monitor;
use crate::cli::outputs::Target;
use crate::cli::pictures::pixels;
use crate::cli::plan::Plan;
use crate::cli::summary::Summary;
use crate::cli::version;
use crate::image::{ExrOptions, Image, Precision, write_png};
use crate::math::Rgb;
use crate::mutation::Move;
use crate::output::{LayerChoice, Picture, SaveOptions, metadata, save};
use crate::report::{Errors, Missed, Pixels, Trial, Work};
use crate::scene::import::{Imported, View};

/// Time that a peer has beside three times its budget.
const PEER_EXTRA: Duration = Duration::from_secs(60);

/// What came of a render.
pub(super) enum Outcome {
    Measured(Trial),
    /// A peer failed.
    Missed(Missed),
    /// A signal came, and nothing is left of it.
    Interrupted,
}

/// A render to be made.
#[derive(Clone, Copy)]
pub(super) struct Start<'a> {
    pub(super) rules: &'a Rules<'a>,
    pub(super) stage: &'a Stage,
    pub(super) slot: &'a Slot,
    pub(super) entrant: &'a Entrant,
    pub(super) effort: &'a Effort,
    /// What it is called while it runs.
    pub(super) title: &'a str,
}

/// What a render took.
#[derive(Clone, Copy, Debug)]
struct Cost {
    wall_seconds: f64,
    cpu_seconds: f64,
    overrun_seconds: f64,
}

impl Start<'_> {
    /// Renders and measures.
    ///
    /// - `imported`: the scene; peers read it themselves.
    ///
    /// # Errors
    /// For files that cannot be written.
    pub(super) fn make(&self, imported: Option<&Imported>) -> Result<Outcome, Failure> {
        let plan = self.stage.plans[self.slot.entrant].as_ref();
        match (&self.entrant.runner, plan, imported) {
            (Runner::Peer(peer), _, _) => self.run_peer(peer),
            (Runner::Integrator { .. }, Some(plan), Some(imported)) => {
                self.render(plan, imported, self.stage.view(imported)?)
            }
            _ => unreachable!("an integrator has a plan and a scene"),
        }
    }

    fn render(&self, plan: &Plan, imported: &Imported, view: &View) -> Result<Outcome, Failure> {
        let job = Job {
            imported,
            view,
            plan,
            filter: view.filter,
            seed: self.slot.seed,
            goal: self.effort.goal,
            threads: usize::from(self.rules.args.threads),
        };
        let title = (!self.rules.args.quiet).then_some(self.title);
        let remark = |text| {
            if let Some(title) = title {
                say(&format!("{title}: warning: {text}"));
            }
        };
        let finished = job.execute(self.rules.interruption, title, remark)?;
        if self.rules.interruption.exit_code().is_some() {
            return Ok(Outcome::Interrupted);
        }
        let choice = LayerChoice {
            precision: Precision::Float,
            variance: false,
        };
        let image = Image::from_rows(&Picture::new(&finished.rendered, view.film_size, choice));
        let (errors, _) = self.stage.yardstick.measure(colours(&image))?;
        let cost = Cost {
            wall_seconds: finished.run.wall_seconds,
            cpu_seconds: finished.run.cpu_seconds,
            overrun_seconds: finished.overrun.unwrap_or(0.0),
        };
        let mut trial = self.trial(cost, errors);
        let (rendered, counters) = (&finished.rendered, &finished.rendered.counters);
        trial.work = Some(Work {
            passes: rendered.passes,
            samples: rendered.passes,
            paths: counters.paths,
            rays: counters.rays,
            rejected: counters.rejected,
        });
        trial.statistics = statistics(&finished);
        if let Some(folder) = self.folder_for_image() {
            self.save(folder, image, (plan, imported, view), &finished)?;
        }
        Ok(Outcome::Measured(trial))
    }

    fn folder_for_image(&self) -> Option<&Folder<'_>> {
        let folder = self.rules.folder.as_ref();
        folder.filter(|_| self.rules.keeps_image(self.slot.seed))
    }

    fn trial(&self, cost: Cost, errors: Errors) -> Trial {
        Trial {
            scene: self.stage.course.name.clone(),
            integrator: self.entrant.label.clone(),
            budget: self.effort.label.clone(),
            seed: self.slot.seed,
            wall_seconds: cost.wall_seconds,
            cpu_seconds: cost.cpu_seconds,
            overrun_seconds: cost.overrun_seconds,
            work: None,
            errors,
            statistics: Vec::new(),
        }
    }

    fn save(
        &self,
        folder: &Folder<'_>,
        mut image: Image,
        (plan, imported, view): (&Plan, &Imported, &View),
        finished: &Finished,
    ) -> Result<(), Failure> {
        let target = Target {
            scene: self.stage.course.scene.clone(),
            name: self.stage.course.name.clone(),
            files: ["png", "exr"]
                .map(|kind| folder.of_run(&self.slot.stem, kind))
                .to_vec(),
        };
        let summary = Summary {
            target: &target,
            imported,
            plan,
            view,
            finished,
            seed: self.slot.seed,
            filter: view.filter.kind().name(),
        };
        image.metadata = metadata(&summary.record(&self.stage.notes), version::REVISION);
        let options = SaveOptions {
            exr: ExrOptions::default(),
            exposure: self.rules.args.exposure,
        };
        for file in &target.files {
            save(file, &image, &options)?;
        }
        Ok(())
    }

    /// Lets a peer render, and measures what it wrote.
    fn run_peer(&self, peer: &Peer) -> Result<Outcome, Failure> {
        let Some(folder) = &self.rules.folder else {
            unreachable!("peers need a folder, which the arguments ensure");
        };
        let absolute = |path: &Path| {
            let error = |error| Failure::File(format!("cannot find {}: {error}", path.display()));
            std::path::absolute(path).map_err(error)
        };
        let written = absolute(&folder.of_run(&self.slot.stem, "peer.exr"))?;
        // What an earlier run left behind is no result.
        let _ = fs::remove_file(&written);
        let scene = absolute(&self.stage.course.scene)?;
        let line = peer.line(&self.values(&scene, &written));
        let log = folder.of_run(&self.slot.stem, "log");
        self.rules.interruption.save_from_now_on();
        let ran = self.watch(|| peer::run(&line, self.limit(), &log, self.rules.interruption));
        let read = ran.and_then(|ran| {
            let read = self.read(&written).map_err(Stopped::Failed)?;
            Ok((ran, read))
        });
        let outcome = match read {
            Err(Stopped::Interrupted) => Outcome::Interrupted,
            Err(Stopped::Failed(reason)) => self.missed(reason),
            Ok((ran, image)) => {
                self.keep(folder, &written, &image)?;
                let (errors, broken) = self.stage.yardstick.measure(image)?;
                if broken > 0 {
                    self.missed(format!("{broken} pixels of its picture are not finite"))
                } else {
                    let cost = self.cost_of_peer(ran);
                    Outcome::Measured(self.trial(cost, errors))
                }
            }
        };
        let _ = fs::remove_file(&written);
        Ok(outcome)
    }

    fn cost_of_peer(&self, ran: peer::Ran) -> Cost {
        let over = match self.effort.goal {
            Goal::Passes(_) => 0.0,
            Goal::Time(limit) => ran.wall_seconds - limit.as_secs_f64(),
            Goal::CpuTime(limit) => ran.cpu_seconds - limit.as_secs_f64(),
        };
        Cost {
            wall_seconds: ran.wall_seconds,
            cpu_seconds: ran.cpu_seconds,
            overrun_seconds: over.max(0.0),
        }
    }

    /// What to put into the gaps of a peer's command.
    fn values(&self, scene: &Path, out: &Path) -> Vec<(&'static str, String)> {
        let (width, height) = self.stage.size;
        vec![
            ("scene", scene.display().to_string()),
            ("out", out.display().to_string()),
            ("seed", self.slot.seed.to_string()),
            ("threads", self.rules.args.threads.to_string()),
            ("width", width.to_string()),
            ("height", height.to_string()),
            self.effort.amount.clone(),
        ]
    }

    /// After which time a peer has failed.
    fn limit(&self) -> Option<Duration> {
        let given = self.rules.args.peer_timeout.map(Duration::from_secs_f64);
        given.or(match self.effort.goal {
            Goal::Passes(_) => None,
            Goal::Time(limit) | Goal::CpuTime(limit) => Some(3 * limit + PEER_EXTRA),
        })
    }

    /// Shows the time while a peer runs.
    fn watch<R>(&self, work: impl FnOnce() -> R) -> R {
        if self.rules.args.quiet {
            return work();
        }
        let goal = match self.effort.goal {
            // Its processor time is known at its end only.
            Goal::CpuTime(limit) => Goal::Time(limit),
            other => other,
        };
        let monitor = Monitor {
            name: self.title,
            goal,
            start: Instant::now(),
            cpu: None,
            work: None,
        };
        monitor.during(work)
    }

    /// The picture that a peer wrote; what is wrong with it.
    fn read(&self, written: &Path) -> Result<Pixels, String> {
        if !written.is_file() {
            return Err("it wrote no picture".to_owned());
        }
        let image = pixels(written).map_err(|error| error.to_string())?;
        let size = (image.width, image.height);
        if size != self.stage.size {
            let scene = &self.stage.course.scene;
            let Failure::Usage(message) = sizes_differ(scene, self.stage.size, written, size)
            else {
                unreachable!("sizes are a matter of use");
            };
            return Err(message);
        }
        Ok(image)
    }

    /// Keeps a peer's picture, if it is one of those that are kept.
    fn keep(&self, folder: &Folder<'_>, written: &Path, image: &Pixels) -> Result<(), Failure> {
        if self.folder_for_image().is_none() {
            return Ok(());
        }
        let png = folder.of_run(&self.slot.stem, "png");
        let colours: Vec<[f32; 3]> = image.colours.iter().map(|c| c.to_array()).collect();
        let exposure = self.rules.args.exposure;
        write_png(&png, image.width, image.height, &colours, exposure)?;
        let kept = folder.of_run(&self.slot.stem, "exr");
        fs::rename(written, &kept)
            .map_err(|error| Failure::File(format!("cannot write {}: {error}", kept.display())))
    }

    fn missed(&self, reason: String) -> Outcome {
        Outcome::Missed(Missed {
            scene: self.stage.course.name.clone(),
            integrator: self.entrant.label.clone(),
            budget: self.effort.label.clone(),
            seed: self.slot.seed,
            reason,
        })
    }
}

fn colours(image: &Image) -> Pixels {
    let colours = image.rgb("").unwrap_or_default();
    Pixels {
        width: image.width(),
        height: image.height(),
        colours: colours.into_iter().map(Rgb::from).collect(),
    }
}

/// What tables show beside errors and times; what an integrator counts of its own goes here.
fn statistics(finished: &Finished) -> Vec<(String, f64)> {
    let counters = &finished.rendered.counters;
    let per_second = |count: u64| count as f64 / 1e6 / finished.run.cpu_seconds;
    let mut statistics = vec![("Mpaths/CPU s".to_owned(), per_second(counters.paths))];
    if counters.mutation_count() > 0 {
        let mutations = per_second(counters.mutation_count());
        statistics.push(("Mmutations/CPU s".to_owned(), mutations));
        statistics.push(("acceptance".to_owned(), counters.mean_acceptance()));
    }
    let kinds = Move::all().zip(&counters.mutations);
    let tried = kinds.filter(|(_, kind)| kind.proposed > 0);
    statistics.extend(tried.map(|(mutation, kind)| {
        let name = format!("acceptance of {}", mutation.name());
        (name, kind.mean_acceptance())
    }));
    statistics
}
