//! Small scenes whose light is found from either side.

use std::sync::Arc;

use lumiflow::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, Leaning, MicrofacetKind, Mixture, NormalMap, Null,
    RelativeIor, RoughConductor, Roughness,
};
use lumiflow::emitter::{Beam, Collimated, Constant, Directional, Point, Spot};
use lumiflow::image::{self, Texels};
use lumiflow::math::{Mat3, Mat4, Rgb, Vec2, Vec3};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::texture::{self, Checkerboard, Filter, Wrap};

use super::hard_scenes::View;
use super::scenes::{Part, camera, faceted_sphere, part, rectangle, scene, sphere, thin_lens};
use super::stages::{SIDE, stage_of};

fn white() -> Diffuse {
    Diffuse::new(Rgb::new(0.7, 0.7, 0.6))
}

fn floor(bsdf: impl Into<Bsdf>) -> Part {
    part(rectangle(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0), bsdf)
}

pub(crate) fn lamp(middle: Vec3) -> Part {
    let shape = rectangle(middle, Vec3::X * 0.4, Vec3::Z * 0.3);
    part(shape, Diffuse::new(0.3)).glowing(Rgb::new(8.0, 6.0, 5.0))
}

fn view(name: &'static str, scene: Scene) -> View {
    View {
        name,
        scene,
        sensor: camera(
            Vec3::new(-0.3, 1.6, 2.2),
            Vec3::new(0.0, 0.2, 0.0),
            50.0,
            SIDE,
        ),
    }
}

fn glass() -> Dielectric {
    Dielectric::new(RelativeIor::new(1.5, 1.0).expect("positive"), 1.0, 1.0)
}

fn metal(alpha: f32) -> RoughConductor {
    let roughness = Roughness::isotropic(MicrofacetKind::Ggx, alpha);
    RoughConductor::new(roughness, None, Rgb::new(0.9, 0.7, 0.5))
}

/// The light that a glass ball gathers; the ball itself is not in the picture.
pub(crate) fn caustic() -> View {
    let ball = part(sphere(Vec3::new(0.0, 0.8, 0.0), 0.4), glass());
    View {
        name: "caustic",
        scene: scene([floor(white()), ball, lamp(Vec3::Y * 2.0)], |_| {}),
        sensor: camera(Vec3::new(0.0, 0.9, 2.6), Vec3::Y * -0.1, 20.0, SIDE),
    }
}

/// Rough metal, and a ball of few facets with normals as if it were round.
pub(crate) fn metals() -> View {
    let place = Mat4::from_translation(Vec3::new(-0.5, 0.5, 0.0));
    let facets = faceted_sphere(5, place * Mat4::from_scale(Vec3::splat(0.45)));
    let parts = [
        floor(metal(0.4)),
        part(facets, white()),
        part(sphere(Vec3::new(0.6, 0.45, 0.0), 0.4), metal(0.2)),
        lamp(Vec3::new(0.2, 1.8, 0.0)),
    ];
    view("metals", scene(parts, |_| {}))
}

/// Light from a lamp with squares on it, through a pane with holes.
pub(crate) fn patterned() -> View {
    let mut builder = SceneBuilder::new();
    let squares = |a: f32, b: f32| {
        let colours = [Rgb::new(a, 0.5 * a, 0.2 * a), Rgb::new(b, b, 2.0 * b)];
        Checkerboard::new(colours, Mat3::from_scale(Vec2::splat(3.0)))
    };
    let pane = rectangle(Vec3::Y * 0.9, Vec3::Z * 0.5, Vec3::X * 0.5);
    let half = Mixture::new([(0.6, white().into()), (0.4, Null.into())]);
    let floor = floor(Diffuse::new(squares(0.2, 0.4)));
    let lamp = lamp(Vec3::new(0.0, 1.7, 0.0));
    for (part, radiance) in [
        (floor, None),
        (part(pane, half.expect("the weights add up")), None),
        (lamp, Some(squares(12.0, 0.5).into())),
    ] {
        let bsdf = builder.add_bsdf(part.bsdf);
        let added = builder.add_shape(part.shape, bsdf, radiance);
        added.expect("the shape has an area");
    }
    view("patterned", builder.build().expect("a scene"))
}

/// A material with steep normals, all of which turn to the eye.
fn turning(nested: impl Into<Bsdf>) -> NormalMap {
    let colours = vec![
        0.9, 0.6, 0.7, 0.2, 0.2, 0.7, 0.5, 0.05, 0.6, 0.1, 0.6, 0.8, 0.5, 0.95, 0.7, 0.6, 0.6, 1.0,
    ];
    let image = image::Bitmap::new(3, 2, 3, Texels::Float(colours)).expect("3 × 2 colours");
    let scale = Mat3::from_scale(Vec2::splat(3.0));
    let normals = texture::Bitmap::new(Arc::new(image), Filter::Nearest, Wrap::Repeat, scale);
    let leaning = Leaning {
        shadowing: true,
        turning: true,
    };
    NormalMap::new(normals, leaning, nested)
}

/// Normals that turn to the eye.
pub(crate) fn turned() -> View {
    turned_around(metal(0.15))
}

/// The same with a mirror.
pub(crate) fn turned_mirror() -> View {
    turned_around(Conductor::new(None, 0.9))
}

fn turned_around(bsdf: impl Into<Bsdf>) -> View {
    let ball = sphere(Vec3::new(0.6, 0.5, 0.0), 0.4);
    let parts = [
        floor(turning(white())),
        part(ball, turning(bsdf)),
        part(sphere(Vec3::new(-0.5, 0.4, 0.0), 0.35), turning(metal(0.4))),
        lamp(Vec3::new(0.2, 1.8, 0.0)),
    ];
    view("turned", scene(parts, |_| {}))
}

fn blocks() -> [Part; 3] {
    let wall = rectangle(Vec3::new(0.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Y * 1.0);
    let ball = sphere(Vec3::new(0.1, 0.5, 0.0), 0.45);
    [floor(white()), part(wall, white()), part(ball, white())]
}

/// Lights that no ray meets.
pub(crate) fn points() -> View {
    let lights = |builder: &mut SceneBuilder| {
        builder.add_emitter(Point::new(Vec3::new(0.8, 1.2, 0.8), Rgb::grey(1.0)));
        let place = Mat4::from_translation(Vec3::new(-0.8, 1.5, 0.5));
        let aim = place * Mat4::from_rotation_x(1.9);
        let spot = Spot::new(aim, Rgb::new(3.0, 2.0, 1.0), Beam::new(1.0), None);
        builder.add_emitter(spot.expect("the lamp is one"));
    };
    view("points", scene(blocks(), lights))
}

/// Light from infinity.
pub(crate) fn outdoors() -> View {
    let lights = |builder: &mut SceneBuilder| {
        builder.add_emitter(Constant::new(Rgb::new(0.5, 0.6, 0.8)));
        let sun = Directional::new(Vec3::new(-1.0, -2.0, -0.5), Rgb::grey(1.5));
        builder.add_emitter(sun.expect("the sun shines somewhere"));
    };
    view("outdoors", scene(blocks(), lights))
}

pub(crate) fn through_a_lens() -> View {
    View {
        sensor: thin_lens(
            Vec3::new(-0.3, 1.6, 2.2),
            Vec3::new(0.0, 0.2, 0.0),
            (50.0, SIDE),
            (0.3, 2.0),
        ),
        ..metals()
    }
}

/// Seen by the sensor of one of the stages, whose films are as wide as ours.
pub(crate) fn seen_by(stage: &'static str) -> View {
    let stage = stage_of(stage);
    View {
        name: stage.name,
        sensor: stage.sensor,
        ..metals()
    }
}

/// A beam without width from one point to another.
///
/// - `flux`: its power in W.
pub(crate) fn beam(from: Vec3, to: Vec3, flux: Rgb) -> Collimated {
    let z = (to - from).normalize();
    let x = z.any_orthonormal_vector();
    let axes = [x, z.cross(x), z].map(|axis| axis.extend(0.0));
    let place = Mat4::from_cols(axes[0], axes[1], axes[2], from.extend(1.0));
    Collimated::new(place, flux).expect("the beam goes somewhere")
}

/// Beams without width, one of them by a mirror that is not in the picture, and a weak lamp.
pub(crate) fn beams() -> View {
    let mirror = rectangle(Vec3::Y * 3.0, Vec3::X * 0.8, Vec3::Z * 0.8);
    let silver = Conductor::new(None, Rgb::new(0.9, 0.8, 0.7));
    let lights = |builder: &mut SceneBuilder| {
        let onto_floor = beam(
            Vec3::new(0.8, 1.5, 0.2),
            Vec3::new(0.7, 0.0, 0.6),
            Rgb::new(3.0, 2.0, 1.0),
        );
        let onto_mirror = beam(
            Vec3::new(0.9, 1.0, 0.7),
            Vec3::new(0.4, 3.0, 0.3),
            Rgb::new(1.0, 2.0, 3.0),
        );
        builder.add_emitter(onto_floor);
        builder.add_emitter(onto_mirror);
        builder.add_emitter(Point::new(Vec3::new(-0.8, 1.2, 0.8), Rgb::grey(0.2)));
    };
    let parts = blocks().into_iter().chain([part(mirror, silver)]);
    view("beams", scene(parts, lights))
}
