//! `lumiflow bench`: what is done is kept and not done again, and other programs take part.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::Command;
use std::thread;
use std::time::Duration;

use serde_json::Value;

use super::bench::{measured_room, number, only, read};
use super::interrupt::send;
use super::{Done, Place};

/// The names of a folder's files that end so, sorted.
fn files(place: &Place, folder: &str, end: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(place.path(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> = paths
        .filter(|path| path.to_str().unwrap().ends_with(end))
        .collect();
    found.sort();
    found
}

#[test]
fn a_signal_keeps_the_runs_that_are_complete() {
    let place = measured_room();
    let bench = ["bench", "room.xml", "--spp", "1,1000000000", "-o", "out"];
    let mut child = place.command(&bench).spawn().expect("the command starts");
    let mut stderr = BufReader::new(child.stderr.take().expect("stderr is piped"));
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(
        line.contains("room path 1 spp seed 1 (1/10): relMSE "),
        "{line}"
    );
    send("INT", &child);
    let done = Done::from(child.wait_with_output().expect("the command ends"));
    stderr.read_to_string(&mut line).unwrap();
    assert_eq!(done.code, Some(130), "{line}");
    assert!(
        done.stdout.contains("| path       | 1 spp  |     1 |"),
        "{}",
        done.stdout
    );
    assert!(
        done.stdout.contains("Incomplete: 1 of 10 renders."),
        "{}",
        done.stdout
    );
    let all: Value = serde_json::from_str(&read(&place, "out/bench.json")).unwrap();
    assert_eq!(
        (&all["complete"], all["runs"].as_array().unwrap().len()),
        (&Value::Bool(false), 1)
    );
}

#[test]
fn a_signal_ends_the_peer_and_what_it_started() {
    let place = measured_room();
    let peer = "other=sleep 300 & echo $! > sleeper; wait; true {scene} {spp} {out}";
    let bench = [
        "bench", "room.xml", "--peer", peer, "--spp", "1", "-o", "out",
    ];
    let child = place.command(&bench).spawn().expect("the command starts");
    let sleeper = place.path("sleeper");
    while fs::read_to_string(&sleeper).map_or(true, |text| !text.ends_with('\n')) {
        thread::sleep(Duration::from_millis(20));
    }
    send("INT", &child);
    let done = Done::from(child.wait_with_output().expect("the command ends"));
    assert_eq!(done.code, Some(130), "{}", done.stderr);
    assert!(
        done.stderr
            .contains("stopped before the first render was complete")
    );
    let script = format!("kill -0 {}", read(&place, "sleeper").trim());
    let mut alive = 0;
    while Command::new("sh")
        .args(["-c", &script])
        .status()
        .unwrap()
        .success()
    {
        // A process that nobody waits for stays until the system notices.
        alive += 1;
        assert!(alive < 500, "the peer's child is still there");
        thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn what_is_there_is_not_made_again() {
    let place = measured_room();
    let bench = [
        "bench",
        "room.xml",
        "-i",
        "path,direct",
        "-o",
        "out",
        "--json",
    ];
    let few = [&bench[..], &["--spp", "1", "--seeds", "2"]].concat();
    let first = place.succeed(&few);
    assert_eq!(files(&place, "out/runs", ".json").len(), 4);
    let again = place.succeed(&few);
    let said = "room: 4 of 4 renders are there, and not made again\n";
    assert_eq!(again.stderr, said);
    assert_eq!(again.json()["runs"], first.json()["runs"]);
    assert_eq!(again.json()["summary"], first.json()["summary"]);

    // More seeds and budgets: only those are made. Others of the options make all of it anew.
    let more = [&bench[..], &["--spp", "1,2", "--seeds", "3"]].concat();
    let done = place.succeed(&more);
    assert!(
        done.stderr.starts_with("room: 4 of 12 renders are there"),
        "{}",
        done.stderr
    );
    assert_eq!(done.stderr.lines().count(), 1 + 8);
    assert_eq!(done.json()["runs"][0], first.json()["runs"][0]);
    for other in [
        ["--set", "path.rr_depth=3"],
        ["--skip-rows", "1"],
        ["-D", "spp=5"],
    ] {
        let done = place.succeed(&[&few[..], &other].concat());
        let there = if other[0] == "--set" { 1 } else { 0 };
        assert_eq!(
            done.stderr.contains("2 of 4 renders are there"),
            there == 1,
            "{other:?}"
        );
        assert_eq!(
            done.stderr.lines().count(),
            4 - 2 * there + there,
            "{other:?}"
        );
    }
}

#[test]
fn a_kept_image_belongs_to_its_record() {
    let place = measured_room();
    let bench = [
        "bench", "room.xml", "--spp", "1", "--seeds", "2", "-o", "out",
    ];
    place.succeed(&bench);
    assert_eq!(files(&place, "out/runs", ".exr").len(), 1);
    let all = [&bench[..], &["--all-images"]].concat();
    let done = place.succeed(&all);
    assert!(
        done.stderr.contains("1 of 2 renders are there"),
        "{}",
        done.stderr
    );
    assert_eq!(files(&place, "out/runs", ".exr").len(), 2);
    assert!(
        place
            .succeed(&all)
            .stderr
            .contains("2 of 2 renders are there")
    );
}

#[test]
fn damaged_records_are_named_before_anything_is_rendered() {
    let place = measured_room();
    let bench = [
        "bench", "room.xml", "--spp", "1", "--seeds", "2", "-o", "out",
    ];
    place.succeed(&bench);
    let record = only(&place, "out/runs", "room-path-1spp-seed2-", ".json");
    let text = read(&place, &record);
    let digit = text.replace("\"passes\": 1", "\"passes\": 2");
    assert_ne!(digit, text);
    for (damaged, reason) in [
        (&text[..text.len() / 2], "it is not whole"),
        ("", "it is not whole"),
        (&digit, "its checksum is not that of its content"),
    ] {
        place.write(&record, damaged);
        let part = format!("{record}: damaged record: {reason}; delete it");
        let done = place.fail(&bench, 4, &part);
        assert_eq!(done.stdout, "");
        assert!(!done.stderr.contains("seed 1"), "{}", done.stderr);
    }
    fs::remove_file(place.path(&record)).unwrap();
    let done = place.succeed(&bench);
    assert!(
        done.stderr.starts_with("room: 1 of 2 renders are there"),
        "{}",
        done.stderr
    );
}

#[test]
fn processor_time_can_be_the_budget() {
    let place = measured_room();
    let bench = [
        "bench", "room.xml", "--cpu", "0.05,0.4", "--seeds", "1", "-q", "--json",
    ];
    let found = place.succeed(&bench).json();
    let runs = found["runs"].as_array().unwrap();
    let budgets: Vec<&Value> = runs.iter().map(|run| &run["budget"]).collect();
    assert_eq!(budgets, ["0.05 CPU s", "0.4 CPU s"]);
    for (run, limit) in runs.iter().zip([0.05, 0.4]) {
        // What is beyond the last pass, such as looking at the clock, is little.
        let over = number(&run["overrun_s"]);
        assert!(number(&run["cpu_s"]) <= limit + over + 0.02, "{run}");
        assert!(number(&run["passes"]) >= 1.0);
    }
    assert!(number(&runs[1]["passes"]) > number(&runs[0]["passes"]));
    // One pass is made in any case, and that this was too long is told.
    let short = ["bench", "room.xml", "--cpu", "1e-6", "--seeds", "1"];
    let done = place.succeed(&short);
    assert!(
        done.stdout
            .contains("- room path 0.000001 CPU s: over the budget by up to ")
    );
    assert!(done.stderr.contains(" over the budget"), "{}", done.stderr);
}

#[test]
fn mutations_tell_what_became_of_them() {
    let place = measured_room();
    let bench = [
        "bench",
        "room.xml",
        "-i",
        "erpt,erpt:chain_length=20",
        "--spp",
        "1",
    ];
    let found = place
        .succeed(&[&bench[..], &["--seeds", "1", "-q", "--json"]].concat())
        .json();
    for run in found["runs"].as_array().unwrap() {
        let told = run["statistics"].as_object().unwrap();
        let of_kinds = told
            .iter()
            .filter(|(name, _)| name.starts_with("acceptance of "));
        let values: Vec<f64> = of_kinds.map(|(_, value)| number(value)).collect();
        assert!(!values.is_empty(), "{run}");
        let mean = number(&told["acceptance"]);
        let (least, most) = (
            values.iter().copied().fold(1.0, f64::min),
            values.iter().copied().fold(0.0, f64::max),
        );
        assert!(
            mean > 0.0 && least <= mean + 1e-12 && mean <= most + 1e-12,
            "{run}"
        );
    }
    let options = &found["scenes"][0]["integrators"];
    assert_eq!(options["erpt:chain_length=20"]["chain_length"], 20);
    assert_ne!(options["erpt"]["chain_length"], 20);
}

#[test]
fn peers_are_measured_like_integrators() {
    let place = measured_room();
    place.succeed(&[
        "render", "room.xml", "-q", "--spp", "4", "--seed", "5", "-o", "copy.exr",
    ]);
    let script = "test -f \"$1\" && test \"$3\" -ge 1 && cp copy.exr \"$2\" && echo copied for $4";
    place.write("copy.sh", script);
    let peer = "copier=sh copy.sh {scene} {out} {seed} {spp}";
    let bench = [
        "bench", "room.xml", "-i", "path", "--peer", peer, "--spp", "2", "--seeds", "2",
    ];
    let done = place.succeed(&[&bench[..], &["-o", "out dir", "--json"]].concat());
    let found = done.json();
    let of_peer = |run: &&Value| run["integrator"] == "copier";
    let runs: Vec<&Value> = found["runs"]
        .as_array()
        .unwrap()
        .iter()
        .filter(of_peer)
        .collect();
    assert_eq!(runs.len(), 2);
    let compared = place
        .succeed(&["compare", "copy.exr", "reference.exr", "--json"])
        .json();
    for run in runs {
        assert_eq!(run["relmse"], compared["relmse"]);
        assert!(number(&run["cpu_s"]) > 0.0 && number(&run["wall_s"]) > 0.0);
        assert!(run["passes"].is_null() && run["paths"].is_null());
    }
    let kept = only(&place, "out dir/runs", "room-copier-2spp-seed1-", ".exr");
    assert!(place.exr(&kept) == place.exr("copy.exr"));
    let log = only(&place, "out dir/runs", "room-copier-2spp-seed2-", ".log");
    assert_eq!(read(&place, &log), "copied for 2\n");
    assert!(files(&place, "out dir/runs", ".peer.exr").is_empty());
    let again = place.succeed(&[&bench[..], &["-o", "out dir"]].concat());
    assert!(
        again.stderr.contains("4 of 4 renders are there"),
        "{}",
        again.stderr
    );
}

#[test]
fn a_peer_that_fails_is_named_and_the_others_finish() {
    let place = measured_room();
    place.succeed(&[
        "render",
        "room.xml",
        "-q",
        "--spp",
        "1",
        "--size",
        "12x8",
        "-o",
        "small.exr",
    ]);
    let bench = [
        "bench", "room.xml", "-i", "path", "--time", "0.05", "--seeds", "1", "-o", "out",
    ];
    let peers = [
        "broken=echo no licence >&2; exit 7; {scene} {seconds} {out}",
        "lazy=true {scene} {seconds} {out}",
        "small=cp small.exr {out}; true {scene} {seconds}",
        "text=echo x > {out}; true {scene} {seconds}",
        "slow=sleep 60; true {scene} {seconds} {out}",
    ];
    let peers = peers.iter().flat_map(|peer| ["--peer", *peer]);
    let words: Vec<&str> = bench
        .into_iter()
        .chain(peers)
        .chain(["--peer-timeout", "3"])
        .collect();
    let done = place.run(&words);
    assert_eq!(done.code, Some(4), "{}", done.stderr);
    for part in [
        "- FAILED: room broken 0.05 s seed 1: it ended with exit status: 7: \"no licence\"",
        "- FAILED: room lazy 0.05 s seed 1: it wrote no picture",
        "- FAILED: room small 0.05 s seed 1: room.xml is 24x16, but ",
        "- FAILED: room text 0.05 s seed 1: ",
        "- FAILED: room slow 0.05 s seed 1: it was ended after 3 s",
        "| room  | path ",
        "- Incomplete: 1 of 6 renders.",
    ] {
        assert!(done.stdout.contains(part), "{part}: {}", done.stdout);
    }
    let all: Value = serde_json::from_str(&read(&place, "out/bench.json")).unwrap();
    assert_eq!(all["failures"].as_array().unwrap().len(), 5);
    // What failed is tried again.
    let again = place.run(&words);
    assert_eq!(again.code, Some(4), "{}", again.stderr);
    assert!(
        again.stderr.contains("room: 1 of 6 renders are there"),
        "{}",
        again.stderr
    );
}
