//! Signals: what is rendered is written, whole or not at all.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command};
use std::thread;
use std::time::{Duration, Instant};

use lumiflow::image::AttributeValue;

use super::{Done, Place, without_run};

/// Sends a signal by its name, such as `INT`.
pub(super) fn send(signal: &str, child: &Child) {
    // A small system has no such program, but each shell has the command.
    let status = Command::new("sh")
        .args(["-c", "kill -s $0 $1", signal, &child.id().to_string()])
        .status()
        .expect("the shell runs");
    assert!(status.success());
}

fn finish(child: Child) -> Done {
    Done::from(child.wait_with_output().expect("the command ends"))
}

/// Starts an endless render and interrupts it when it has worked for a while.
fn interrupted(place: &Place, signal: &str) -> Done {
    let render = ["render", "room.xml", "--time", "1000000", "--json", "-q"];
    let child = place.command(&render).spawn().expect("the command starts");
    thread::sleep(Duration::from_millis(1500));
    send(signal, &child);
    finish(child)
}

#[test]
fn signals_keep_whole_passes() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let place = Place::with_room();
        let done = interrupted(&place, signal);
        assert_eq!(done.code, Some(code), "{}", done.stderr);
        let found = done.json();
        assert_eq!(found["interrupted"], true);
        let passes = found["passes"].as_u64().unwrap();
        assert!(passes >= 1);
        assert_eq!(found["paths"], passes * 24 * 16);
        assert_eq!(place.names(), ["room.exr", "room.xml"]);
        let image = place.exr("room.exr");
        let noted = i32::try_from(passes).unwrap();
        assert_eq!(
            image.metadata.get("lumiflow.passes"),
            Some(&AttributeValue::Int(noted))
        );
        let count = passes.to_string();
        place.succeed(&[
            "render",
            "room.xml",
            "-q",
            "--passes",
            &count,
            "-o",
            "again.exr",
        ]);
        assert!(without_run(image) == without_run(place.exr("again.exr")));
    }
}

#[test]
fn nothing_rendered_leaves_no_file() {
    let place = Place::with_room();
    // A single pass over this film takes far longer than the test waits.
    let render = [
        "render",
        "room.xml",
        "--size",
        "8192x8192",
        "--spp",
        "1",
        "-i",
        "path",
    ];
    let mut child = place.command(&render).spawn().expect("the command starts");
    thread::sleep(Duration::from_millis(1500));
    let start = Instant::now();
    send("INT", &child);
    let mut stderr = String::new();
    let pipe = child.stderr.take().expect("stderr is piped");
    BufReader::new(pipe).read_to_string(&mut stderr).unwrap();
    let done = finish(child);
    assert_eq!(done.code, Some(130), "{stderr}");
    assert!(stderr.contains("no file is written"), "{stderr}");
    assert!(start.elapsed() < Duration::from_secs(20));
    assert_eq!(place.names(), ["room.xml"]);
}

#[test]
fn a_folder_that_vanishes_is_a_failure_of_writing() {
    let place = Place::with_room();
    place.write("out/keep", "");
    let render = [
        "render",
        "room.xml",
        "--time",
        "1000000",
        "-q",
        "-o",
        "out/a.exr",
    ];
    let child = place.command(&render).spawn().expect("the command starts");
    thread::sleep(Duration::from_millis(1500));
    std::fs::remove_dir_all(place.path("out")).unwrap();
    send("TERM", &child);
    let done = finish(child);
    assert_eq!(done.code, Some(4), "{}", done.stderr);
    assert!(
        done.stderr.contains("cannot write out/a.exr"),
        "{}",
        done.stderr
    );
}

#[test]
fn lines_tell_of_progress_where_there_is_no_terminal() {
    let place = Place::with_room();
    let render = ["render", "room.xml", "--time", "1000000"];
    let mut child = place.command(&render).spawn().expect("the command starts");
    let pipe = child.stderr.take().expect("stderr is piped");
    let mut line = String::new();
    BufReader::new(pipe).read_line(&mut line).unwrap();
    send("TERM", &child);
    finish(child);
    for part in ["room: ", "% ", "Msamples/s", "Mrays/s", " left"] {
        assert!(line.contains(part.trim()), "{part}: {line}");
    }
}

#[test]
fn a_cross_check_tells_what_it_has_found_so_far() {
    let place = Place::with_room();
    let check = ["crosscheck", "room.xml", "--rays", "1000000000", "--json"];
    let mut child = place.command(&check).spawn().expect("the command starts");
    let mut lines = BufReader::new(child.stderr.take().expect("stderr is piped")).lines();
    let progress = lines.next().expect("a line of progress").unwrap();
    send("INT", &child);
    let said: Vec<String> = lines.map(Result::unwrap).collect();
    let done = finish(child);
    assert_eq!(done.code, Some(130), "{said:?}");
    assert!(
        progress.contains("crosscheck: ") && progress.contains(" left"),
        "{progress}"
    );
    let found: serde_json::Value =
        serde_json::from_str(done.stdout.trim_end().lines().last().expect("a line")).unwrap();
    assert_eq!(found["interrupted"], true);
    let rays = found["rays"].as_u64().expect("a number");
    assert!(0 < rays && rays < 1_000_000_000, "{rays}");
    assert!(
        said.iter().any(|line| line.contains("stopped early")),
        "{said:?}"
    );
}
