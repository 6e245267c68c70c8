//! Beams without width: what they light, in closed form.

use std::f64::consts::FRAC_1_PI;

use lumiflow::bsdf::{Conductor, Diffuse};
use lumiflow::math::{Rgb, Vec3};
use lumiflow::scene::Scene;

use crate::determinism::{bits, on_threads};
use crate::support::render::{integrator, mean, picture, run, settings};
use crate::support::scenes::{camera, part, rectangle, scene};
use crate::support::two_sided_light::{beam, beams};

const SIDE: u32 = 9;
const FLUX: Rgb = Rgb::new(3.0, 2.0, 0.5);
const ALBEDO: f32 = 0.6;

/// A plate that a beam meets in the middle, at 45 degrees: at once, or by a mirror.
fn plate(by_mirror: bool) -> Scene {
    let plate = rectangle(Vec3::ZERO, Vec3::X, Vec3::Y);
    let mirror = rectangle(Vec3::new(1.0, 0.0, 1.0), Vec3::Z * 0.2, Vec3::Y * 0.2);
    let silver = Conductor::new(None, 1.0);
    let from = if by_mirror {
        Vec3::new(0.0, 0.0, 2.0)
    } else {
        Vec3::new(-1.0, 0.0, 1.0)
    };
    let to = if by_mirror {
        Vec3::new(1.0, 0.0, 1.0)
    } else {
        Vec3::ZERO
    };
    let parts = [part(plate, Diffuse::new(ALBEDO)), part(mirror, silver)];
    scene(parts, |builder| {
        builder.add_emitter(beam(from, to, FLUX));
    })
}

/// The plate scatters `Φ ρ / π` into each steradian and projected area; the pixel in the middle of a film with `n` pixels
/// along tan 30°, three metres above, takes in `n²/(2 tan 30°)²` pixels a steradian.
fn expected() -> f64 {
    let tangent = 30.0_f64.to_radians().tan();
    let pixels_per_steradian = (f64::from(SIDE) / (2.0 * tangent)).powi(2);
    let luminance = f64::from(FLUX.luminance()) * f64::from(ALBEDO) * FRAC_1_PI;
    luminance * pixels_per_steradian / 9.0 / f64::from(SIDE * SIDE)
}

/// What finds the light of beams.
const SEERS: [&str; 8] = [
    "ptracer",
    "bdpt",
    "bdpt mis=maximum",
    "mmlt luminance_samples=256 chains=8",
    "pssmlt bidirectional=true deposits=expected luminance_samples=256 chains=8",
    "mlt seeds=bdpt luminance_samples=256 chains=8",
    "erpt seeds=bdpt direct_samples=3",
    "pmc-er seeds=bdpt population=50 rounds=2",
];

fn lit(scene: &Scene, text: &str) -> f64 {
    let sensor = camera(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO, 60.0, SIDE);
    let image = picture(scene, &sensor, text, settings(5, SIDE), 2);
    mean(&image)
}

#[test]
fn a_beam_lights_a_plate_with_its_whole_power() {
    let scene = plate(false);
    for text in SEERS {
        let found = lit(&scene, &format!("{text} max_depth=2"));
        assert!((found / expected() - 1.0).abs() < 1e-3, "{text}: {found}");
    }
}

/// Paths of three edges go to chains, none of which can move: every vertex is where the beam has put it.
#[test]
fn a_beam_by_a_mirror_lights_as_much() {
    let scene = plate(true);
    for text in SEERS {
        let found = lit(&scene, &format!("{text} max_depth=3"));
        assert!((found / expected() - 1.0).abs() < 1e-3, "{text}: {found}");
    }
}

#[test]
fn what_begins_at_the_eye_finds_nothing() {
    for by_mirror in [false, true] {
        let scene = plate(by_mirror);
        for text in ["path", "direct", "bdpt light_image=false", "erpt", "mlt"] {
            assert_eq!(lit(&scene, text), 0.0, "{text}");
        }
    }
}

#[test]
fn who_finds_beams_says_so() {
    for text in SEERS {
        assert!(integrator(text).shows_traced_light(), "{text}");
    }
    for text in ["path", "direct", "depth", "erpt", "pmc-er", "mlt", "pssmlt"] {
        assert!(!integrator(text).shows_traced_light(), "{text}");
    }
}

#[test]
fn any_number_of_threads_makes_the_same_bits() {
    let view = beams();
    for text in SEERS {
        let rendered = |threads| {
            on_threads(threads, || {
                let chosen = integrator(&format!("{text} max_depth=5"));
                let settings = settings(3, 16);
                bits(&run(
                    &view.scene,
                    &view.sensor,
                    chosen.as_ref(),
                    settings,
                    2,
                ))
            })
        };
        assert_eq!(rendered(1), rendered(3), "{text}");
    }
}
