//! `lumiflow bench`.

mod entrants;
mod files;
mod peer;
mod race;
mod render;
mod show;
mod stage;
mod yardstick;

use super::args::BenchArgs;
use super::console::{print_line, say};
use super::execute;
use super::failure::Failure;
use super::signals::Interruption;
use super::version;
use entrants::{Entrant, efforts, entrants, only_once};
use files::Folder;
use race::{Race, Rules};
use stage::Stage;
use yardstick::Course;

/// Races integrators and other programs against references; returns the exit code.
///
/// A scene that is broken says so and does not keep the others from being measured, nor does a peer
/// that fails; the first failure decides about the exit code.
///
/// # Errors
/// What the command line has wrong, missing references, images that do not fit, damaged records, and
/// files that cannot be written.
pub(super) fn run(args: &BenchArgs) -> Result<u8, Failure> {
    let efforts = efforts(&args.effort)?;
    let entrants = entrants(args, &efforts)?;
    let courses = courses(args)?;
    let interruption = Interruption::listen()?;
    let threads = usize::from(args.threads);
    let pool = execute::pool(threads)?;
    let wanted = args.seeds as usize * entrants.len() * efforts.len() * courses.len();
    let (stages, broken) = pool.install(|| stages(args, courses, &entrants))?;
    let folder = args.output.as_deref().map(Folder);
    let rules = Rules {
        args,
        entrants,
        efforts,
        folder,
        interruption: &interruption,
        about: about(threads, args),
        wanted,
    };
    let mut race = Race::new(rules, stages)?;
    race.rules.folder.as_ref().map_or(Ok(()), Folder::prepare)?;
    let code = pool.install(|| race.run());
    let bench = race.bench();
    if bench.trials.is_empty() && bench.missed.is_empty() {
        if interruption.exit_code().is_some() {
            say("stopped before the first render was complete; nothing is written");
        }
    } else {
        print_line(&if args.json {
            bench.json().to_string()
        } else {
            bench.markdown()
        })?;
    }
    Ok(broken.unwrap_or(code))
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

/// Makes the scenes ready; the broken ones say so and are left out, which decides about the exit
/// code. Only the first stays in memory.
fn stages(
    args: &BenchArgs,
    courses: Vec<Course>,
    entrants: &[Entrant],
) -> Result<(Vec<Stage>, Option<u8>), Failure> {
    let (mut stages, mut code) = (Vec::new(), None);
    for course in courses {
        match Stage::prepare(course, args, entrants) {
            Ok(mut stage) => {
                if !stages.is_empty() {
                    stage.forget_scene();
                }
                stages.push(stage);
            }
            Err(failure @ Failure::Scene(_)) => {
                failure.report("bench");
                code = code.or(Some(failure.exit_code()));
            }
            Err(failure) => return Err(failure),
        }
    }
    Ok((stages, code))
}

/// How the numbers are made.
fn about(threads: usize, args: &BenchArgs) -> Vec<(String, String)> {
    let words: Vec<String> = std::env::args().collect();
    [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("revision", version::REVISION.to_owned()),
        ("command", words.join(" ")),
        ("threads", threads.to_string()),
        ("accel", args.tracer.accel.engine().name().to_owned()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}
