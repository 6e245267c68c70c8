//! All integrators have one mean, on scenes that are hard in one way each.

use crate::support::effort::{level, samples, seed};
use crate::support::hard_scenes::{View, body_in_glass, door_ajar, mirror_caustic};
use crate::support::render::{Replicas, picture, settings, tiles};
use crate::support::stages::{SIDE, stage_of};
use crate::support::two_sided_light::{beams, metals, outdoors, patterned, points, through_a_lens};

const REPLICAS: u64 = 16;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

/// Where an integrator's paths begin: what it cannot see hangs on that alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum From {
    /// At the eye: no ray meets a point or a beam of light.
    Eye,
    /// At the lights: none of their rays meets the lens.
    Lights,
    Both,
}

/// Every integrator that shows the whole picture, with passes for a replica.
const WAYS: [(From, &str, u32); 13] = [
    (From::Eye, "path", 16),
    (From::Both, "bdpt", 16),
    (From::Lights, "ptracer", 32),
    (From::Eye, "erpt mutations_per_sample=4", 16),
    (From::Both, "erpt seeds=bdpt mutations_per_sample=4", 16),
    (
        From::Eye,
        "pmc-er population=200 rounds=3 mutations_per_sample=4",
        16,
    ),
    (
        From::Both,
        "pmc-er seeds=bdpt population=200 rounds=3 mutations_per_sample=4",
        16,
    ),
    (From::Eye, "mlt luminance_samples=1024 chains=40", 4),
    (
        From::Both,
        "mlt seeds=bdpt luminance_samples=1024 chains=40",
        4,
    ),
    (From::Eye, "pssmlt luminance_samples=1024 chains=40", 4),
    (
        From::Eye,
        "pssmlt target=path luminance_samples=1024 chains=40",
        4,
    ),
    (
        From::Both,
        "pssmlt bidirectional=true luminance_samples=1024 chains=40",
        4,
    ),
    (From::Both, "mmlt luminance_samples=1024 chains=40", 4),
];

fn replicas(view: &View, text: &str, (first, passes): (u64, u32)) -> Replicas {
    Replicas::new(seed(first), REPLICAS, |seed| {
        let settings = settings(seed, SIDE);
        let image = picture(&view.scene, &view.sensor, text, settings, samples(passes));
        tiles(&image, 4)
    })
}

/// Compares all integrators with the first that sees everything.
///
/// - `blind`: the integrators that cannot see some of the light, by where their paths begin. That they do not is checked, too:
///   nothing is left out that could be compared.
fn check(view: &View, max_depth: u32, blind: &[From]) {
    let sees = |from: From| !blind.contains(&from);
    let reference = WAYS.into_iter().find(|(from, ..)| sees(*from));
    let (_, name, passes) = reference.expect("some see everything");
    let of_depth = |text: &str| format!("{text} max_depth={max_depth}");
    let expected = replicas(view, &of_depth(name), (1000, 8 * passes));
    let level = level(LEVEL) / WAYS.len() as f64;
    let wrong = WAYS.into_iter().filter_map(|(from, text, passes)| {
        let found = replicas(view, &of_depth(text), (2000, passes));
        match (sees(from), found.check_same(&expected, level)) {
            (true, Err(error)) => Some(format!("{text}: {error}")),
            (false, Ok(())) => Some(format!("{text}: sees what it cannot see")),
            _ => None,
        }
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "{}: {wrong:#?}", view.name);
}

#[test]
fn one_mean_in_deep_glass() {
    // The glass is seen, and what is in it through it alone.
    check(&body_in_glass(SIDE), 8, &[From::Lights]);
}

#[test]
fn one_mean_through_a_thin_lens() {
    check(&through_a_lens(), 5, &[]);
}

#[test]
fn one_mean_under_point_lights() {
    check(&points(), 5, &[]);
}

/// Light that a glass ball gathers from a point is met by no ray from the eye; so is what is seen in the ball by none
/// from the lights, which the picture has, too.
#[test]
fn one_mean_under_point_lights_behind_glass() {
    let stage = stage_of("point and spot");
    let view = View {
        name: stage.name,
        scene: stage.scene,
        sensor: stage.sensor,
    };
    check(&view, 5, &[From::Eye, From::Lights]);
}

/// Beams without width light single points, which no ray from the eye meets.
#[test]
fn one_mean_under_beams() {
    check(&beams(), 5, &[From::Eye]);
}

#[test]
fn one_mean_in_an_environment() {
    check(&outdoors(), 5, &[]);
}

#[test]
fn one_mean_beside_a_coloured_mirror() {
    // It is seen, and what it shows.
    check(&mirror_caustic(SIDE), 6, &[From::Lights]);
}

#[test]
fn one_mean_behind_a_door() {
    check(&door_ajar(SIDE), 7, &[]);
}

#[test]
fn one_mean_on_rough_metal() {
    check(&metals(), 5, &[]);
}

#[test]
fn one_mean_on_textures() {
    check(&patterned(), 5, &[]);
}
