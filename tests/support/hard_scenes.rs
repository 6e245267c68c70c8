//! Small scenes that each have one kind of path that is hard to find.

use lumiflow::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, MicrofacetKind, Plastic, RelativeIor, RoughConductor,
    Roughness,
};
use lumiflow::math::{Mat4, Rgb, Vec3};
use lumiflow::scene::Scene;
use lumiflow::sensor::Sensor;

use super::scenes::{
    Part, camera, cornell, cornell_camera, cuboid, faceted_sphere, part, rectangle, scene, sphere,
    studio, studio_camera, thin_lens, walls,
};

/// A scene and who looks at it.
pub(crate) struct View {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) sensor: Sensor,
}

impl From<View> for super::stages::Stage {
    fn from(view: View) -> Self {
        Self {
            name: view.name,
            scene: view.scene,
            sensor: view.sensor,
        }
    }
}

fn ior() -> RelativeIor {
    RelativeIor::new(1.5, 1.0).expect("the indices are positive")
}

fn glass() -> Bsdf {
    Dielectric::new(ior(), 1.0, 1.0).into()
}

fn plastic(colour: Rgb) -> Bsdf {
    Plastic::new(ior(), 1.0, colour, true).into()
}

/// Bodies in a box that is open towards the camera, under a lamp of a quarter of its ceiling.
///
/// - `strength`, `brightness`: factors on the lamp, and on the walls' colours: dark ones leave little indirect light
///   but that of the bodies.
/// - `floor`: its material; the walls are diffuse.
fn booth(
    (strength, brightness): (f32, f32),
    floor: impl Into<Bsdf>,
    bodies: impl IntoIterator<Item = Part>,
) -> Scene {
    let [left, right, bottom, top, back, _front] = walls(Mat4::IDENTITY);
    let wall = |colour: Rgb| Diffuse::new(colour * brightness);
    let lamp = rectangle(
        Vec3::new(0.0, 0.95, 0.0),
        Vec3::X * 0.5,
        Vec3::Z * 0.5, // towards −y
    );
    let shell = [
        part(left, wall(Rgb::new(0.7, 0.3, 0.2))),
        part(right, wall(Rgb::new(0.2, 0.4, 0.7))),
        part(bottom, floor),
        part(top, wall(Rgb::grey(0.5))),
        part(back, wall(Rgb::grey(0.6))),
        part(lamp, Diffuse::new(0.0)).glowing(Rgb::new(4.0, 3.5, 3.0) * strength),
    ];
    scene(shell.into_iter().chain(bodies), |_| {})
}

const DARK: f32 = 0.2;

fn grey_floor() -> Diffuse {
    Diffuse::new(Rgb::new(0.7, 0.7, 0.6))
}

const FROM: Vec3 = Vec3::new(0.2, 0.1, 3.4);
const TO: Vec3 = Vec3::new(0.0, -0.2, 0.0);

fn view(name: &'static str, scene: Scene, side: u32) -> View {
    let sensor = camera(FROM, TO, 42.0, side);
    View {
        name,
        scene,
        sensor,
    }
}

/// Light that goes around among diffuse surfaces.
pub(crate) fn indirect(side: u32) -> View {
    View {
        name: "diffuse box",
        scene: cornell(Mat4::IDENTITY),
        sensor: cornell_camera(Mat4::IDENTITY, side),
    }
}

/// Light that a glass sphere gathers.
pub(crate) fn glass_caustic(side: u32, strength: f32) -> View {
    let ball = part(sphere(Vec3::new(0.1, -0.55, 0.1), 0.4), glass());
    view(
        "glass sphere",
        booth((strength, DARK), grey_floor(), [ball]),
        side,
    )
}

/// Light that a mirror sphere sends to floor and walls.
pub(crate) fn mirror_caustic(side: u32) -> View {
    let mirror = Conductor::new(None, Rgb::new(0.9, 0.8, 0.7));
    let ball = part(sphere(Vec3::new(-0.2, -0.5, -0.1), 0.5), mirror);
    view(
        "mirror sphere",
        booth((1.0, DARK), grey_floor(), [ball]),
        side,
    )
}

/// A diffuse body in a cube of glass: all of its light comes and goes through glass.
pub(crate) fn body_in_glass(side: u32) -> View {
    let middle = Vec3::new(0.0, -0.5, 0.1);
    let bodies = [
        part(cuboid(middle, Vec3::splat(0.45)), glass()),
        part(sphere(middle, 0.3), Diffuse::new(Rgb::new(0.8, 0.6, 0.3))),
    ];
    view(
        "body in glass",
        booth((1.0, DARK), grey_floor(), bodies),
        side,
    )
}

/// A sphere and a floor that scatter and mirror at once.
pub(crate) fn plastics(side: u32) -> View {
    let ball = part(
        sphere(Vec3::new(0.2, -0.5, 0.0), 0.5),
        plastic(Rgb::new(0.7, 0.2, 0.1)),
    );
    let floor = plastic(Rgb::grey(0.5));
    view("plastic", booth((1.0, 1.0), floor, [ball]), side)
}

/// A mirror of few facets with normals as if it were round, and a rough one.
pub(crate) fn bumpy_mirror(side: u32) -> View {
    let place = Mat4::from_translation(Vec3::new(-0.4, -0.55, 0.0));
    let facets = faceted_sphere(6, place * Mat4::from_scale(Vec3::splat(0.45)));
    let roughness = Roughness::isotropic(MicrofacetKind::Ggx, 0.15);
    let bodies = [
        part(facets, Conductor::new(None, 0.9)),
        part(
            sphere(Vec3::new(0.5, -0.65, 0.3), 0.35),
            RoughConductor::new(roughness, None, 0.9),
        ),
    ];
    view(
        "bumpy mirror",
        booth((1.0, DARK), grey_floor(), bodies),
        side,
    )
}

/// Glass and a mirror out of focus.
pub(crate) fn out_of_focus(side: u32) -> View {
    let bodies = [
        part(sphere(Vec3::new(-0.4, -0.6, 0.5), 0.35), glass()),
        part(
            sphere(Vec3::new(0.4, -0.5, -0.4), 0.45),
            Conductor::new(None, 0.9),
        ),
    ];
    View {
        name: "thin lens",
        scene: booth((1.0, DARK), grey_floor(), bodies),
        sensor: thin_lens(FROM, TO, (42.0, side), (0.15, 3.0)),
    }
}

/// Environment, point light and lamps over plastic, glass and rough metal.
pub(crate) fn many_lights(side: u32) -> View {
    View {
        name: "many lights",
        scene: studio(1.0, |_| {}),
        sensor: studio_camera(side),
    }
}

/// A room of mirrors with a lamp in it: much of its light has gone from wall to wall dozens of times.
pub(crate) fn hall_of_mirrors(side: u32) -> View {
    let mirror = || Conductor::new(None, Rgb::new(0.97, 0.96, 0.95));
    let room = walls(Mat4::IDENTITY).map(|wall| part(wall, mirror()));
    let lamp = part(sphere(Vec3::new(0.3, 0.2, -0.4), 0.2), Diffuse::new(0.0));
    let parts = room.into_iter().chain([lamp.glowing(Rgb::grey(1.0))]);
    View {
        name: "hall of mirrors",
        scene: scene(parts, |_| {}),
        sensor: camera(
            Vec3::new(-0.5, -0.6, 0.7),
            Vec3::new(0.1, 0.2, -0.3),
            70.0,
            side,
        ),
    }
}

/// A room without lamps, beside one with a lamp: light comes through a gap in the wall between.
pub(crate) fn door_ajar(side: u32) -> View {
    let room = walls(Mat4::IDENTITY).map(|wall| part(wall, Diffuse::new(0.7)));
    let between = cuboid(Vec3::new(0.0, 0.0, -0.4), Vec3::new(0.03, 1.1, 0.7));
    let lamp = rectangle(Vec3::new(0.6, 0.9, 0.0), Vec3::X * 0.2, Vec3::Z * 0.2);
    let parts = [
        part(between, Diffuse::new(Rgb::new(0.6, 0.5, 0.4))),
        part(lamp, Diffuse::new(0.0)).glowing(Rgb::new(40.0, 35.0, 30.0)),
    ];
    View {
        name: "door ajar",
        scene: scene(room.into_iter().chain(parts), |_| {}),
        sensor: camera(
            Vec3::new(-0.3, 0.2, 0.9),
            Vec3::new(-0.6, -0.2, -0.5),
            70.0,
            side,
        ),
    }
}
