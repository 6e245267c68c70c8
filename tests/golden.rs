//! Pictures of small scenes keep their stored means.
//!
//! Stored are tile means with their variances, not bits: a change of the order of random numbers
//! passes, a change of the picture does not. `LUMIFLOW_ACCEPT=1 cargo test --test tests golden`
//! stores what is rendered; say why in `tests/golden/PROVENANCE.md`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use lumiflow::image::{ExrOptions, Image, Precision, write_exr};
use lumiflow::math::{Mat4, Rgb};
use lumiflow::scene::Scene;
use lumiflow::sensor::Sensor;

use crate::support::render::{Replicas, picture, settings, tiles};
use crate::support::scenes::{cornell, cornell_camera, studio, studio_camera};

const SIDE: u32 = 24;
const TILE: usize = 6;
/// Replicas of a stored result and of a test, and the passes of each.
const STORED: (u64, u32) = (64, 256);
const TESTED: (u64, u32) = (16, 32);
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

/// The values of one picture: tile means of red, then green, then blue.
fn values(image: &[Rgb]) -> Vec<f64> {
    let channel = |of: fn(Rgb) -> f32| {
        let grey: Vec<_> = image.iter().map(|c| Rgb::grey(of(*c))).collect();
        tiles(&grey, TILE)
    };
    [Rgb::r, Rgb::g, Rgb::b]
        .into_iter()
        .flat_map(channel)
        .collect()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

fn stored(name: &str) -> Vec<(f64, f64)> {
    let file = folder().join(format!("{name}.txt"));
    let text = fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let number = |text: &str| text.parse::<f64>().expect("a number");
    text.lines()
        .map(|line| line.split_once(' ').expect("mean and variance"))
        .map(|(mean, variance)| (number(mean), number(variance)))
        .collect()
}

fn store(name: &str, replicas: &Replicas) {
    let mut text = String::new();
    for (mean, variance) in replicas.summary() {
        writeln!(text, "{mean:.8e} {variance:.3e}").expect("text can be written");
    }
    fs::write(folder().join(format!("{name}.txt")), text).expect("the result can be stored");
}

/// Writes a picture for people to look at, and says where.
fn show(name: &str, image: &[Rgb]) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    fs::create_dir_all(&folder).expect("the target folder can be written");
    let file = folder.join(format!("{name}.exr"));
    let pixels: Vec<_> = image.iter().map(|c| c.to_array()).collect();
    let mut exr = Image::new(SIDE, SIDE);
    exr.push_rgb("", Precision::Float, &pixels);
    let report = write_exr(&file, &exr, &ExrOptions::default());
    assert!(report.is_ok(), "{report:?}");
    file.display().to_string()
}

fn check(name: &str, scene: &Scene, sensor: &Sensor, text: &str) -> Result<(), String> {
    let replicas = |first: u64, (count, passes): (u64, u32)| {
        Replicas::new(first, count, |seed| {
            values(&picture(scene, sensor, text, settings(seed, SIDE), passes))
        })
    };
    if env::var_os("LUMIFLOW_ACCEPT").is_some() {
        store(name, &replicas(10_000, STORED));
    }
    let found = replicas(1, TESTED).check_against(&stored(name), STORED.0 as usize, LEVEL);
    found.map_err(|error| {
        let image = picture(scene, sensor, text, settings(1, SIDE), 256);
        format!("{name}: {error}; see {}", show(name, &image))
    })
}

#[test]
fn pictures_are_as_they_were() -> Result<(), String> {
    let to_world = Mat4::IDENTITY;
    check(
        "cornell",
        &cornell(to_world),
        &cornell_camera(to_world, SIDE),
        "path",
    )?;
    check(
        "studio",
        &studio(1.0, |_| {}),
        &studio_camera(SIDE),
        "path max_depth=8",
    )
}

#[test]
fn another_picture_is_found() {
    if env::var_os("LUMIFLOW_ACCEPT").is_some() {
        return;
    }
    let sensor = studio_camera(SIDE);
    let error = check("studio", &studio(1.02, |_| {}), &sensor, "path max_depth=8").unwrap_err();
    assert!(error.contains("studio.exr"), "{error}");
}
