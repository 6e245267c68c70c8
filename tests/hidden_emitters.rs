//! The camera sees through emitters that are to be hidden; all other paths meet them.

use lumiflow::bsdf::Diffuse;
use lumiflow::emitter::Constant;
use lumiflow::math::{Rgb, Vec3};
use lumiflow::scene::Scene;

use crate::support::render::{mean, picture, settings};
use crate::support::scenes::{camera, part, rectangle, scene};

/// A lamp between the camera and a wall, and the wall's light from all around.
fn lamp_before_wall() -> Scene {
    let wall = rectangle(Vec3::ZERO, Vec3::X * 9.0, Vec3::Y * 9.0);
    let lamp = rectangle(Vec3::Z, Vec3::X, Vec3::Y);
    let parts = [
        part(wall, Diffuse::new(0.5)),
        part(lamp, Diffuse::new(0.5)).glowing(Rgb::grey(20.0)),
    ];
    scene(parts, |builder| {
        builder.add_emitter(Constant::new(Rgb::grey(0.2)));
    })
}

/// Mean radiance that a camera at a height above the wall sees, looking down on it.
fn seen_from(height: f32, text: &str) -> f64 {
    // The same patch of wall from every height.
    let degrees = 2.0 * (0.2 / height).atan().to_degrees();
    let sensor = camera(Vec3::Z * height, Vec3::ZERO, degrees, 8);
    mean(&picture(
        &lamp_before_wall(),
        &sensor,
        text,
        settings(3, 8),
        256,
    ))
}

#[test]
fn the_camera_sees_the_wall_behind_a_hidden_lamp() {
    for name in ["path", "direct", "bdpt"] {
        let depth = if name == "direct" { "" } else { " max_depth=2" };
        let behind_lamp = seen_from(0.9, &format!("{name}{depth}"));
        let through_lamp = seen_from(4.0, &format!("{name}{depth} hide_emitters=true"));
        let at_lamp = seen_from(4.0, &format!("{name}{depth}"));
        assert!(
            (through_lamp / behind_lamp - 1.0).abs() < 0.02,
            "{through_lamp} {behind_lamp}"
        );
        assert!(at_lamp > 15.0, "the lamp's front is bright: {at_lamp}");
        assert!(
            behind_lamp < 1.0,
            "the lamp's back lies over the wall: {behind_lamp}"
        );
    }
}

#[test]
fn a_hidden_environment_is_black_to_the_camera_only() {
    let sensor = camera(Vec3::Z * 4.0, Vec3::Z * 9.0, 40.0, 8);
    let sky = |text| {
        mean(&picture(
            &lamp_before_wall(),
            &sensor,
            text,
            settings(3, 8),
            4,
        ))
    };
    assert_eq!(sky("path hide_emitters=true"), 0.0);
    assert!((sky("path") - 0.2).abs() < 1e-6);
}
