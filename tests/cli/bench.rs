//! `lumiflow bench`: what is measured is what it says, and what is done is kept.

use std::fs;

use lumiflow::image::write_png;
use serde_json::Value;

use super::{BLIND, Place, without_run};

/// The small room with a reference of ours, made with a seed that is not measured.
pub(super) fn measured_room() -> Place {
    let place = Place::with_room();
    let render = ["render", "room.xml", "-q", "--spp", "256", "--seed", "99"];
    let reference = ["--aov", "variance", "-o", "reference.exr"];
    place.succeed(&[&render[..], &reference].concat());
    fs::copy(place.path("reference.exr"), place.path("reference_var.exr")).unwrap();
    place
}

pub(super) fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

pub(super) fn read(place: &Place, name: &str) -> String {
    fs::read_to_string(place.path(name)).unwrap()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The only file in a folder whose name begins and ends so.
pub(super) fn only(place: &Place, folder: &str, begin: &str, end: &str) -> String {
    let names = fs::read_dir(place.path(folder)).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let found: Vec<String> = names
        .filter(|name| name.starts_with(begin) && name.ends_with(end))
        .collect();
    assert_eq!(found.len(), 1, "{begin}…{end}: {found:?}");
    format!("{folder}/{}", found[0])
}

/// Checks the constants of twelve runs, and their medians.
fn check_sums(all: &Value) {
    let runs = all["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 12);
    for run in runs {
        let corrected = number(&run["relmse"]) - number(&run["reference_noise"]);
        // Reading JSON rounds the last digit.
        assert!((number(&run["relmse_corrected"]) - corrected).abs() < 1e-12 * corrected);
        let efficiency = number(&run["efficiency_constant"]);
        assert!(efficiency > 0.0);
        let eff = 1.0 / (number(&run["cpu_s"]) * number(&run["err"]));
        assert!((number(&run["eff"]) - eff).abs() < 1e-9 * eff, "{run}");
        let product = corrected * number(&run["cpu_s"]);
        assert!((efficiency - product).abs() < 1e-12 * product, "{run}");
    }
    let summary = all["summary"].as_array().unwrap();
    assert_eq!(summary.len(), 4);
    for row in summary {
        let same = |run: &&Value| ["integrator", "budget"].iter().all(|k| run[*k] == row[*k]);
        let own = runs.iter().filter(same);
        let values: Vec<f64> = own.map(|run| number(&run["efficiency_constant"])).collect();
        assert_eq!(values.len(), 3);
        assert_eq!(
            number(&row["efficiency_constant"]["median"]),
            median(values)
        );
        assert!(number(&row["mean_ratio"]["standard_error"]) > 0.0);
    }
}

#[test]
fn every_run_is_measured_and_the_seeds_are_put_together() {
    let place = measured_room();
    let bench = ["bench", "room.xml", "-i", "path,direct", "--spp", "2,4"];
    let rest = ["--set", "path.max_depth=4", "--seeds", "3", "-o", "out"];
    let done = place.succeed(&[&bench[..], &rest].concat());

    let lines: Vec<&str> = done
        .stdout
        .lines()
        .take_while(|l| l.starts_with('|'))
        .collect();
    let head: Vec<&str> = lines[0]
        .trim_matches('|')
        .split('|')
        .map(str::trim)
        .collect();
    let columns = "scene,integrator,budget,seeds,CPU s,MSE,relMSE,corrected,FLIP,mean ratio,Err,Eff,\
                   constant,min … max";
    assert_eq!(head.join(","), columns);
    let work = done.stdout.lines().find(|line| line.contains("wall s"));
    let work: Vec<&str> = work.unwrap().split('|').map(str::trim).collect();
    assert_eq!(work[4..8], ["wall s", "passes", "spp", "Mpaths/CPU s"]);
    assert_eq!(lines.len(), 2 + 4, "{}", done.stdout);
    assert!(
        lines
            .iter()
            .all(|l| l.chars().count() == lines[0].chars().count())
    );
    assert!(
        done.stdout
            .contains("- room: 384 of 384 pixels count; the reference's noise is ")
    );
    assert_eq!(
        done.stderr.lines().count(),
        12,
        "a line for each run: {}",
        done.stderr
    );

    assert!(read(&place, "out/bench.md").contains(done.stdout.trim_end()));
    for file in ["room-error.svg", "room-crops.png"] {
        assert!(read(&place, "out/bench.md").contains(&format!("![room]({file})")));
        assert!(place.path(&format!("out/{file}")).is_file());
    }
    assert_eq!(curves(&read(&place, "out/room-error.svg")), 2);
    assert_eq!(read(&place, "out/bench.csv").lines().count(), 1 + 12);
    let all: Value = serde_json::from_str(&read(&place, "out/bench.json")).unwrap();
    assert_eq!(all["complete"], true);
    assert_eq!(all["scenes"][0]["integrators"]["path"]["max_depth"], 4);
    check_sums(&all);
}

/// Number of curves in a plot: the lines two pixels wide.
fn curves(svg: &str) -> usize {
    let lines = svg.split("<polyline").skip(1);
    let lines = lines.map(|line| line.split("/>").next().unwrap_or_default());
    lines
        .filter(|line| line.contains("stroke-width=\"2\""))
        .count()
}

#[test]
fn a_run_is_what_render_and_compare_make_of_it() {
    let place = measured_room();
    let bench = [
        "bench", "room.xml", "--spp", "3", "--seeds", "2", "--seed", "7",
    ];
    let done = place.succeed(&[&bench[..], &["-o", "out", "-q", "--json"]].concat());
    assert_eq!(done.stderr, "");
    let run = done.json()["runs"][0].clone();
    assert_eq!(
        (run["seed"].as_u64(), run["spp"].as_u64()),
        (Some(7), Some(3))
    );
    assert_eq!(run["paths"], 3 * 24 * 16);
    let render = [
        "render", "room.xml", "--spp", "3", "--seed", "7", "-q", "-o", "a.exr",
    ];
    place.succeed(&render);
    // The image of the first seed is kept.
    let image = place.exr(&only(&place, "out/runs", "room-path-3spp-seed7-", ".exr"));
    assert!(without_run(image) == without_run(place.exr("a.exr")));
    only(&place, "out/runs", "room-path-3spp-", ".png");
    let compare = ["compare", "a.exr", "reference.exr", "--json"];
    let variance = ["--reference-variance", "reference.exr"];
    let found = place.succeed(&[&compare[..], &variance].concat()).json();
    for name in [
        "mse",
        "err",
        "relmse",
        "relmse_corrected",
        "reference_noise",
        "flip",
    ] {
        assert_eq!(run[name], found[name], "{name}");
    }
    assert_eq!(run["mean_ratio"], found["means"]["luminance"]["ratio"]);
}

#[test]
fn masks_rows_and_crops_leave_pixels_out() {
    let place = measured_room();
    let pixels = |more: &[&str]| {
        let bench = [
            "bench", "room.xml", "--spp", "1", "--seeds", "1", "-q", "--json",
        ];
        let found = place.succeed(&[&bench[..], more].concat()).json();
        found["scenes"][0]["pixels"].as_u64().unwrap()
    };
    assert_eq!(pixels(&["--skip-rows", "1"]), 24 * 14);
    let mask: Vec<[f32; 3]> = (0..24 * 16)
        .map(|i| if i % 24 < 4 { [1.0; 3] } else { [0.0; 3] })
        .collect();
    write_png(&place.path("emitter_mask.png"), 24, 16, &mask, 0.0).unwrap();
    assert_eq!(pixels(&[]), 20 * 16);
    assert_eq!(pixels(&["--mask", "none"]), 24 * 16);
    assert_eq!(pixels(&["--crop", "2,0,4,16", "--skip-rows", "2"]), 2 * 12);
}

#[test]
fn several_scenes_have_references_of_their_own() {
    let place = measured_room();
    let room = read(&place, "room.xml");
    for name in ["a", "b"] {
        place.write(&format!("{name}/scene.xml"), &room);
        fs::copy(
            place.path("reference.exr"),
            place.path(&format!("{name}/{name}.exr")),
        )
        .unwrap();
    }
    let scenes = [
        "bench",
        "a/scene.xml",
        "b/scene.xml",
        "--spp",
        "1",
        "-q",
        "--seeds",
        "1",
    ];
    let done = place.succeed(&[&scenes[..], &["--reference", "{dir}/{name}.exr"]].concat());
    assert!(done.stdout.contains("| a     | path") && done.stdout.contains("| b     | path"));
    assert!(done.stdout.contains("the reference's noise is unknown"));
    let one_for_all = [&scenes[..], &["--reference", "reference.exr"]].concat();
    place.fail(&one_for_all, 2, "several scenes need {dir} or {name}");
    let same_name = [
        "bench",
        "a/scene.xml",
        "a/scene.xml",
        "--spp",
        "1",
        "--reference",
        "{dir}/a.exr",
    ];
    place.fail(&same_name, 2, "scene: a is given twice");
    // A scene that fails does not keep the other from being measured.
    place.write(
        "a/scene.xml",
        "<scene version=\"3.0.0\"><bsdf type=\"difuse\"/></scene>",
    );
    let half = place.run(&[&scenes[..], &["--reference", "{dir}/{name}.exr"]].concat());
    assert_eq!(half.code, Some(3));
    assert!(half.stdout.contains("| b     | path") && half.stdout.contains("Incomplete: 1 of 2"));
}

#[test]
fn mistakes_are_told_before_anything_is_rendered() {
    let place = Place::with_room();
    let bench =
        |more: &[&'static str]| [&["bench", "room.xml", "--spp", "1", "-o", "out"], more].concat();
    let missing = "no reference for room.xml: there is no file ./reference.exr; name another";
    place.fail(&bench(&[]), 4, missing);
    place.fail(
        &bench(&["--reference", "x.exr"]),
        4,
        "there is no file x.exr",
    );
    let place = measured_room();
    let before = place.names();
    place.fail(&bench(&["-i", "path,dirct"]), 2, "did you mean \"direct\"?");
    place.fail(
        &bench(&["--set", "depth.x=1"]),
        2,
        "no integrator \"depth\" takes part",
    );
    place.fail(&["bench", "room.xml"], 2, "--time");
    assert_eq!(place.names(), before);
    let show = bench(&["--show", "20,0,8,8"]);
    place.fail(&show, 2, "--show 20,0,8,8 reaches beyond the 24x16 pixels");
    let peer = bench(&["--peer", "other=x {scene} {out}"]);
    place.fail(&peer, 2, "--peer other: {spp} is missing");
    assert_eq!(place.names(), before);
    let sizes = "room.xml is 12x8, but ./reference.exr is 24x16";
    place.fail(&bench(&["--size", "12x8"]), 2, sizes);
    assert_eq!(place.names(), before);
    let equal = bench(&["--seed", "98", "--seeds", "2"]);
    let done = place.succeed(&equal);
    assert!(
        done.stderr.contains("was rendered with seed 99"),
        "{}",
        done.stderr
    );
}

#[test]
fn entrants_that_do_not_find_beams_are_named() {
    let place = measured_room();
    place.write_room_with_beam();
    let names = "path,bdpt,erpt:seeds=bdpt,erpt:chain_length=9";
    let effort = ["--spp", "1", "--seeds", "1"];
    let bench = |scene| [&["bench", scene, "-i", names], &effort[..]].concat();
    let done = place.succeed(&bench("beam.xml"));
    let expected = format!("warning: \"path\", \"erpt:chain_length=9\" do {BLIND}");
    assert!(done.stderr.contains(&expected), "{}", done.stderr);
    let done = place.succeed(&bench("room.xml"));
    assert!(!done.stderr.contains(BLIND), "{}", done.stderr);
    place.fail(&[&bench("beam.xml")[..], &["--strict"]].concat(), 3, BLIND);
}
