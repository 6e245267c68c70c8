//! `lumiflow bench`.

mod entrants;
mod files;
mod yardstick;

use std::path::Path;
use std::sync::Arc;

use super::args::BenchArgs;
use super::console::{duration, print_line, say};
use super::execute::{self, Finished, Job};
use super::failure::Failure;
use super::notes::Notes;
use super::outputs::Target;
use super::plan::Plan;
use super::signals::Interruption;
use super::summary::Summary;
use super::version;
use crate::image::{Image, Precision};
use crate::output::{LayerChoice, metadata, picture};
use crate::report::{Bench, BenchScene, Comparison, Measure, Trial, three_digits};
use crate::scene::import::{Imported, View};
use entrants::{Effort, Entrant, efforts, entrants, only_once};
use files::{Folder, save_all};
use yardstick::{Course, Yardstick};

/// Races integrators against references; returns the exit code.
///
/// A scene that fails says so and does not keep the others from being measured; the first failure
/// decides about the exit code.
///
/// # Errors
/// What the command line has wrong, missing references, and files that cannot be written.
pub(super) fn run(args: &BenchArgs) -> Result<u8, Failure> {
    let (entrants, efforts) = (entrants(args)?, efforts(&args.effort)?);
    let courses = courses(args)?;
    let folder = args.output.as_deref().map(Folder);
    folder.as_ref().map_or(Ok(()), Folder::prepare)?;
    let interruption = Interruption::listen()?;
    let threads = usize::from(args.threads);
    let pool = execute::pool(threads)?;
    let rounds = args.seeds as usize * entrants.len() * efforts.len();
    let mut race = Race {
        args,
        entrants,
        efforts,
        folder,
        interruption: &interruption,
        bench: Bench {
            about: about(threads),
            wanted: rounds * courses.len(),
            ..Bench::default()
        },
        begun: 0,
    };
    let code = race.run(&courses, |race, course| {
        pool.install(|| race.measure(course))
    });
    if race.bench.trials.is_empty() {
        if interruption.exit_code().is_some() {
            say("stopped before the first render was complete; nothing is written");
        }
        return Ok(code);
    }
    print_line(&if args.json {
        race.bench.json().to_string()
    } else {
        race.bench.markdown()
    })?;
    Ok(code)
}

/// The scenes with their references.
fn courses(args: &BenchArgs) -> Result<Vec<Course>, Failure> {
    let reference = args.reference.as_deref().unwrap_or("{dir}");
    if args.scenes.len() > 1 && !reference.contains("{dir}") && !reference.contains("{name}") {
        return Err(Failure::Usage(
            "--reference: several scenes need {dir} or {name} in the name of the file".to_owned(),
        ));
    }
    let found = args.scenes.iter().map(|scene| Course::find(scene, args));
    let courses: Vec<Course> = found.collect::<Result<_, _>>()?;
    let names: Vec<&str> = courses.iter().map(|course| course.name.as_str()).collect();
    only_once("scene", &names)?;
    Ok(courses)
}

/// How the numbers are made.
fn about(threads: usize) -> Vec<(String, String)> {
    let words: Vec<String> = std::env::args().collect();
    [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("revision", version::REVISION.to_owned()),
        ("command", words.join(" ")),
        ("threads", threads.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}

/// A bench under way.
struct Race<'a> {
    args: &'a BenchArgs,
    entrants: Vec<Entrant>,
    efforts: Vec<Effort>,
    folder: Option<Folder<'a>>,
    interruption: &'a Arc<Interruption>,
    bench: Bench,
    /// Renders that were begun.
    begun: usize,
}

/// One of the renders.
#[derive(Clone, Copy)]
struct Start<'a> {
    course: &'a Course,
    imported: &'a Imported,
    view: &'a View,
    plan: &'a Plan,
    effort: &'a Effort,
    seed: u64,
}

impl Race<'_> {
    /// Measures scene after scene; the exit code.
    fn run(
        &mut self,
        courses: &[Course],
        measure: impl Fn(&mut Self, &Course) -> Result<(), Failure>,
    ) -> u8 {
        let mut code = 0;
        for course in courses {
            if let Err(failure) = measure(self, course) {
                failure.report("bench");
                code = if code == 0 { failure.exit_code() } else { code };
            }
            if let Some(interrupted) = self.interruption.exit_code() {
                return if code == 0 { interrupted } else { code };
            }
        }
        code
    }

    /// Measures all integrators on a scene. The seeds go around last, so that what changes on the
    /// machine meets all integrators, and what is interrupted has as many of each.
    fn measure(&mut self, course: &Course) -> Result<(), Failure> {
        let imported = self.load(course)?;
        let warnings = imported.warnings.clone();
        let mut notes = Notes::new(self.args.scene.strictness(), self.args.quiet, warnings);
        let Some(view) = imported.views.first() else {
            let scene = course.scene.display();
            return Err(Failure::Usage(format!("{scene} has no sensor")));
        };
        let size = (view.window.width, view.window.height);
        let yardstick = Yardstick::read(course, self.args, size)?;
        let plan = |entrant: &Entrant| Plan::new(&entrant.wish(), &imported.integrator, &mut notes);
        let plans: Vec<Plan> = self.entrants.iter().map(plan).collect::<Result<_, _>>()?;
        self.warn_of_equal_seeds(course, &yardstick, &mut notes);
        notes.settle()?;
        self.bench
            .scenes
            .push(described(course, size, &yardstick, &plans));

        for seed in (0..self.args.seeds).map(|n| self.args.seed.wrapping_add(u64::from(n))) {
            for effort in &self.efforts.clone() {
                for plan in &plans {
                    let start = Start {
                        course,
                        imported: &imported,
                        view,
                        plan,
                        effort,
                        seed,
                    };
                    self.render(&start, &yardstick, &notes)?;
                    if self.interruption.exit_code().is_some() {
                        return Ok(());
                    }
                }
            }
        }
        Ok(())
    }

    /// Reads a scene; its wishes for further layers would cost time that is not the integrators'.
    fn load(&self, course: &Course) -> Result<Imported, Failure> {
        let mut imported = self.args.scene.load(&course.scene)?;
        imported.integrator.aovs.clear();
        imported.integrator.second_moment = false;
        Ok(imported)
    }

    /// Renders once and takes down how it went; a render that is interrupted leaves nothing.
    fn render(
        &mut self,
        start: &Start<'_>,
        yardstick: &Yardstick,
        notes: &Notes,
    ) -> Result<(), Failure> {
        self.begun += 1;
        let (name, label) = (&start.plan.name, &start.effort.label);
        let title = format!(
            "{} {name} {label} seed {} ({}/{})",
            start.course.name, start.seed, self.begun, self.bench.wanted
        );
        let job = start.job(usize::from(self.args.threads));
        let finished = job.execute(self.interruption, (!self.args.quiet).then_some(&*title));
        if self.interruption.exit_code().is_some() {
            return Ok(());
        }
        let choice = LayerChoice {
            precision: Precision::Float,
            variance: false,
        };
        let image = picture(&finished.rendered, start.view.film_size, choice);
        let trial = start.trial(&finished, yardstick.measure(&image)?);
        if !self.args.quiet {
            say(&format!(
                "{title}: relMSE {}, efficiency {} in {}",
                three_digits(Measure::RelativeMse.of(&trial)),
                three_digits(Measure::Efficiency.of(&trial)),
                duration(trial.wall_seconds)
            ));
        }
        self.bench.trials.push(trial);
        if let Some(folder) = &self.folder {
            if start.seed == self.args.seed {
                start.save(folder, image, &finished, notes)?;
            }
            folder.write(&self.bench)?;
        }
        Ok(())
    }

    fn warn_of_equal_seeds(&self, course: &Course, yardstick: &Yardstick, notes: &mut Notes) {
        let Some(seed) = yardstick.reference_seed else {
            return;
        };
        if seed.wrapping_sub(self.args.seed) < u64::from(self.args.seeds) {
            let reference = course.reference.display();
            notes.remark(format!(
                "{reference} was rendered with seed {seed}, which is among those measured: equal noise \
                 looks like no error; choose others with --seed"
            ));
        }
    }
}

impl Start<'_> {
    fn job(&self, threads: usize) -> Job<'_> {
        Job {
            imported: self.imported,
            view: self.view,
            plan: self.plan,
            filter: self.view.filter,
            seed: self.seed,
            goal: self.effort.goal,
            threads,
        }
    }

    fn trial(&self, finished: &Finished, (comparison, flip): (Comparison, f64)) -> Trial {
        let (rendered, run) = (&finished.rendered, finished.run);
        Trial {
            scene: self.course.name.clone(),
            integrator: self.plan.name.clone(),
            budget: self.effort.label.clone(),
            seed: self.seed,
            wall_seconds: run.wall_seconds,
            cpu_seconds: run.cpu_seconds,
            passes: rendered.passes,
            samples: rendered.passes,
            counters: rendered.counters,
            comparison,
            flip,
            statistics: statistics(finished),
        }
    }

    fn save(
        &self,
        folder: &Folder<'_>,
        mut image: Image,
        finished: &Finished,
        notes: &Notes,
    ) -> Result<(), Failure> {
        let target = Target {
            scene: self.course.scene.clone(),
            name: self.course.name.clone(),
            files: folder.images(&self.course.name, &self.plan.name, &self.effort.label),
        };
        let summary = Summary {
            target: &target,
            imported: self.imported,
            plan: self.plan,
            view: self.view,
            rendered: &finished.rendered,
            run: finished.run,
            seed: self.seed,
            filter: self.view.filter.kind().name(),
        };
        image.metadata = metadata(&summary.record(notes), version::REVISION);
        save_all(&target.files, &image)
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
    statistics
}

fn described(
    course: &Course,
    size: (u32, u32),
    yardstick: &Yardstick,
    plans: &[Plan],
) -> BenchScene {
    let shown = |path: &Path| path.display().to_string();
    let integrators = plans
        .iter()
        .map(|plan| (plan.name.clone(), plan.options.clone()));
    BenchScene {
        name: course.name.clone(),
        file: shown(&course.scene),
        size,
        pixels: yardstick.pixels(),
        reference: shown(&course.reference),
        reference_variance: course.variance.as_deref().map(shown),
        mask: course.mask.as_deref().map(shown),
        integrators: integrators.collect(),
    }
}
