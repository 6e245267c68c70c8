//! `lumiflow crosscheck`.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use serde_json::{Map, Value, json};

use super::args::CrosscheckArgs;
use super::console::{duration, print_line, say};
use super::execute;
use super::failure::Failure;
use super::monitor::{Status, watch};
use super::notes::Notes;
use super::signals::Interruption;
use crate::accel::{Accel, AccelError, Engine, Hit, Ray};
use crate::report::crosscheck::{
    Camera, Class, Crosscheck, Finding, Kind, KindTally, Outcome, Right, Subject, ray_text,
};
use crate::scene::import::Imported;

/// Exit code for a real disagreement.
const DISAGREEMENT: u8 = 1;

/// Compares both tracers on a scene; returns the exit code.
///
/// # Errors
/// A file that cannot be read, a scene that cannot be traced, and an address that no ray has.
pub(super) fn run(args: &CrosscheckArgs) -> Result<u8, Failure> {
    let engine = args.accel.engine();
    if engine == Engine::Obvhs {
        let message =
            "--accel obvhs: obvhs is what others are compared with; expected embree or embree-fast";
        return Err(Failure::Usage(message.to_owned()));
    }
    let interruption = Interruption::listen()?;
    let threads = args.threads.map_or_else(execute::all_cores, usize::from);
    let pool = execute::pool(threads)?;
    pool.install(|| {
        let loaded = args.scene.load(&args.file, args.quiet, engine)?;
        let mut imported = loaded.imported;
        let warnings = std::mem::take(&mut imported.warnings);
        let mut notes = Notes::new(args.scene.strictness(), args.quiet, warnings);
        notes.settle()?;
        let subject = Subject::of(&imported.scene);
        let obvhs = subject.build(Engine::Obvhs).map_err(refused)?;
        let check = crosscheck(args, &imported, &subject, &obvhs);
        match replayed(args, &check)? {
            Some(ray) => replay(args, &check, &ray),
            None => compare(args, &check, &interruption),
        }
    })
}

fn refused(error: AccelError) -> Failure {
    Failure::File(error.to_string())
}

fn crosscheck<'a>(
    args: &CrosscheckArgs,
    imported: &'a Imported,
    subject: &'a Subject,
    obvhs: &'a Accel,
) -> Crosscheck<'a> {
    let camera = imported.views.first().map(|view| Camera {
        sensor: &view.sensor,
        film_size: view.film_size,
    });
    let engines = [imported.scene.accel(), obvhs];
    Crosscheck::new(subject, engines, camera, args.seed)
}

/// The one ray that is asked for.
fn replayed(args: &CrosscheckArgs, check: &Crosscheck<'_>) -> Result<Option<Ray>, Failure> {
    let Some(address) = args.replay else {
        return Ok(args.ray);
    };
    let ray = check.ray(address).ok_or_else(|| {
        let scene = args.file.display();
        Failure::Usage(format!(
            "--replay {address}: {scene} has no surface to aim at"
        ))
    })?;
    Ok(Some(ray))
}

fn compare(
    args: &CrosscheckArgs,
    check: &Crosscheck<'_>,
    interruption: &Interruption,
) -> Result<u8, Failure> {
    interruption.save_from_now_on();
    let (start, done) = (Instant::now(), AtomicU64::new(0));
    let work = || check.run(args.rays, &done, interruption.cancelled());
    let outcome = if args.quiet {
        work()
    } else {
        let share = || done.load(Relaxed) as f64 / f64::from(args.rays);
        watch("crosscheck", || Status::of_share(start, share()), work)
    };
    let seconds = start.elapsed().as_secs_f64();
    for finding in &outcome.real {
        say(&named(finding));
    }
    print_line(&outcome.tally.table())?;
    if !args.quiet {
        let (rays, real) = (outcome.tally.total().rays, outcome.tally.real());
        let time = duration(seconds);
        let stopped = if outcome.interrupted {
            ", stopped early"
        } else {
            ""
        };
        say(&format!(
            "{rays} rays in {time}{stopped}; real disagreements: {real}"
        ));
    }
    if args.json {
        print_line(&json_line(args, &outcome, seconds).to_string())?;
    }
    let found = (outcome.tally.real() > 0).then_some(DISAGREEMENT);
    Ok(found.or(interruption.exit_code()).unwrap_or(0))
}

/// A real disagreement for people.
fn named(finding: &Finding) -> String {
    let right = match finding.right {
        Right::Embree => "obvhs cannot be right",
        Right::Obvhs => "Embree cannot be right",
        Right::Both | Right::Neither => "neither can be right",
    };
    let (query, address) = (finding.query.name(), finding.address);
    let ray = ray_text(&finding.ray);
    format!("real: {address}, {query}: {right}; --replay {address} or --ray {ray}")
}

fn json_line(args: &CrosscheckArgs, outcome: &Outcome, seconds: f64) -> Value {
    let counts = |counts: &KindTally| {
        let classes = |of: [u64; 4]| -> Map<String, Value> {
            let classes = [Class::Tie, Class::Silhouette, Class::Limit, Class::Real];
            let pairs = classes.into_iter().zip(of);
            pairs
                .map(|(class, count)| (class.name().to_owned(), json!(count)))
                .collect()
        };
        let sides = [Right::Embree, Right::Obvhs, Right::Both, Right::Neither];
        let sides = sides.into_iter().zip(counts.right);
        let sides = sides.map(|(side, count)| (side.name().to_owned(), json!(count)));
        json!({
            "rays": counts.rays,
            "hits": counts.hits,
            "closest": classes(counts.closest),
            "any": classes(counts.any),
            "referee": sides.collect::<Map<_, _>>(),
        })
    };
    let kinds = Kind::ALL.iter().zip(&outcome.tally.kinds);
    let kinds = kinds.map(|(kind, tally)| (kind.name().to_owned(), counts(tally)));
    let real = outcome.real.iter().map(|finding| {
        json!({
            "address": finding.address.to_string(),
            "query": finding.query.name(),
            "right": finding.right.name(),
            "ray": ray_text(&finding.ray),
        })
    });
    json!({
        "scene": args.file.display().to_string(),
        "accel": args.accel.engine().name(),
        "seed": args.seed,
        "rays": outcome.tally.total().rays,
        "real": outcome.tally.real(),
        "kinds": kinds.collect::<Map<_, _>>(),
        "all": counts(&outcome.tally.total()),
        "first_real": real.collect::<Vec<_>>(),
        "interrupted": outcome.interrupted,
        "wall_s": seconds,
    })
}

/// Tells all about one ray.
fn replay(args: &CrosscheckArgs, check: &Crosscheck<'_>, ray: &Ray) -> Result<u8, Failure> {
    let (answers, found) = check.replay(ray);
    let mut lines = vec![format!("ray         {}", ray_text(ray))];
    for (engine, (hit, occluded)) in [args.accel.engine(), Engine::Obvhs]
        .into_iter()
        .zip(answers.closest.iter().zip(answers.occluded))
    {
        let name = engine.name();
        lines.push(format!(
            "{name:<12}{}; any hit: {occluded}",
            hit_text(hit.as_ref())
        ));
    }
    lines.push(format!(
        "referee     {}",
        answers.refereed().map_or("miss".to_owned(), |hit| {
            let (distance, instance, geometry, primitive) = hit;
            let instance = instance.map_or(String::new(), |i| format!("instance {i}, "));
            format!("distance {distance}, {instance}geometry {geometry}, primitive {primitive}")
        })
    ));
    let is_real = found.iter().any(|(_, class, _)| *class == Class::Real);
    lines.extend(found.iter().map(|(query, class, right)| {
        let name = query.name();
        format!("{name:<12}{}; right: {}", class.name(), right.name())
    }));
    if found.is_empty() {
        lines.push("both agree".to_owned());
    }
    print_line(&lines.join("\n"))?;
    if args.json {
        let found = found.iter().map(|(query, class, right)| {
            json!({ "query": query.name(), "class": class.name(), "right": right.name() })
        });
        let found: Vec<Value> = found.collect();
        print_line(&json!({ "ray": ray_text(ray), "disagreements": found }).to_string())?;
    }
    Ok(if is_real { DISAGREEMENT } else { 0 })
}

fn hit_text(hit: Option<&Hit>) -> String {
    hit.map_or("miss".to_owned(), |hit| {
        let instance = hit
            .instance
            .map_or(String::new(), |i| format!("instance {i}, "));
        format!(
            "distance {:?}, {instance}geometry {}, primitive {}, u {:?}, v {:?}, normal {:?}",
            hit.distance, hit.geometry, hit.primitive, hit.u, hit.v, hit.normal
        )
    })
}
