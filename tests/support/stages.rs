//! Small scenes in which the paths of every mutation are frequent.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use lumiflow::bsdf::{
    Bsdf, BumpMap, Conductor, Dielectric, Diffuse, Leaning, MicrofacetKind, Plastic, RelativeIor,
    RoughConductor, Roughness,
};
use lumiflow::emitter::{Beam, Constant, Directional, Point, Spot};
use lumiflow::image::{self, Texels};
use lumiflow::math::{Mat3, Mat4, Rgb, Transform, Vec2, Vec3};
use lumiflow::mutation::{
    AngleKernel, CausticKernel, Fault, Perturbation, RasterDomain, RasterKernel,
};
use lumiflow::scene::Scene;
use lumiflow::sensor::{
    FieldOfViewAxis, Orthographic, PerspectiveSettings, Sensor, SensorModel, Spherical, ThinLens,
};
use lumiflow::shape::TriangleMesh;
use lumiflow::shape::mesh::MeshData;
use lumiflow::texture::{self, Checkerboard, Filter, Wrap};

use super::scenes::{
    Part, camera, cornell, cornell_camera, cuboid, part, rectangle, scene, sphere,
};

/// Width and height of the film in pixels.
pub(crate) const SIDE: u32 = 16;

/// A scene with its sensor.
pub(crate) struct Stage {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) sensor: Sensor,
}

/// Moves that are large, so that what they change varies much.
pub(crate) fn moves() -> Perturbation {
    let angle = AngleKernel {
        inner: 0.01,
        outer: 0.6,
    };
    Perturbation {
        raster: RasterKernel::Square { side: 7.0 },
        angle,
        caustic: CausticKernel::Logarithmic(angle),
        lens: 0.5,
        domain: RasterDomain {
            low: Vec2::ZERO,
            high: Vec2::splat(SIDE as f32),
        },
        fault: Fault::None,
    }
}

/// The same with turns at the head that are uniform up to a number of pixels.
pub(crate) fn moves_in_pixels(sensor: &Sensor) -> Perturbation {
    let middle = Vec2::splat(0.5 * SIDE as f32);
    let seen = sensor.sample_ray(middle, Vec2::splat(0.5)).direction;
    Perturbation {
        caustic: CausticKernel::Pixels {
            pixels: 4.0,
            angle_of_pixel: 1.0 / sensor.pixels_per_steradian(seen).sqrt(),
        },
        ..moves()
    }
}

fn glass(ior: f32) -> Dielectric {
    let ior = RelativeIor::new(ior, 1.0).expect("the indices are positive");
    Dielectric::new(ior, 1.0, Rgb::new(0.9, 1.0, 0.8))
}

fn squares(scale: f32) -> Checkerboard {
    let colours = [Rgb::new(0.9, 0.7, 0.5), Rgb::new(0.1, 0.2, 0.3)];
    Checkerboard::new(colours, Mat3::from_scale(Vec2::splat(scale)))
}

fn floor(bsdf: impl Into<Bsdf>) -> Part {
    part(rectangle(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0), bsdf)
}

/// A lamp that shines down.
fn lamp() -> Part {
    let shape = rectangle(Vec3::new(0.5, 2.2, 0.3), Vec3::X * 0.8, Vec3::Z * 0.8);
    part(shape, Diffuse::new(0.0)).glowing(Rgb::new(4.0, 5.0, 6.0))
}

/// A lamp that shines towards −x.
fn side_lamp() -> Part {
    let shape = rectangle(Vec3::new(1.6, 0.8, 0.2), Vec3::Z * 0.7, Vec3::Y * 0.7);
    part(shape, Diffuse::new(0.0)).glowing(Rgb::new(6.0, 5.0, 4.0))
}

fn ball(bsdf: impl Into<Bsdf>) -> Part {
    part(sphere(Vec3::new(0.0, 0.7, 0.0), 0.5), bsdf)
}

/// The camera of most stages.
fn view() -> Sensor {
    camera(
        Vec3::new(-0.3, 1.6, 2.2),
        Vec3::new(0.0, 0.2, 0.0),
        50.0,
        SIDE,
    )
}

/// A ball of few triangles whose normals are those of a sphere.
fn coarse_ball(centre: Vec3, radius: f32) -> TriangleMesh {
    const STEPS: u32 = 6;
    const TURNS: u32 = 9;
    let normal = |step: u32, turn: u32| {
        let (sin, cos) = (PI * step as f32 / STEPS as f32).sin_cos();
        let (y, x) = (TAU * turn as f32 / TURNS as f32).sin_cos();
        Vec3::new(sin * x, cos, -sin * y)
    };
    let normals: Vec<Vec3> = (0..=STEPS)
        .flat_map(|step| (0..TURNS).map(move |turn| normal(step, turn)))
        .collect();
    let at = |step: u32, turn: u32| step * TURNS + turn % TURNS;
    let mut indices = Vec::new();
    for (step, turn) in (0..STEPS).flat_map(|s| (0..TURNS).map(move |t| (s, t))) {
        let [a, b] = [at(step, turn), at(step, turn + 1)];
        let [c, d] = [at(step + 1, turn), at(step + 1, turn + 1)];
        if step > 0 {
            indices.push([a, c, b]);
        }
        if step + 1 < STEPS {
            indices.push([b, c, d]);
        }
    }
    let data = MeshData {
        positions: normals
            .iter()
            .map(|n| (centre + *n * radius).to_array())
            .collect(),
        normals: Some(normals.iter().map(|n| n.to_array()).collect()),
        indices,
        ..MeshData::default()
    };
    data.validate().expect("the ball is sound");
    data.into()
}

fn coarse(bsdf: impl Into<Bsdf>) -> Part {
    part(coarse_ball(Vec3::new(0.0, 0.7, 0.0), 0.5), bsdf)
}

fn stage(name: &'static str, parts: impl IntoIterator<Item = Part>) -> Stage {
    Stage {
        name,
        scene: scene(parts, |_| {}),
        sensor: view(),
    }
}

/// All stages.
pub(crate) fn stages() -> Vec<Stage> {
    let white = || Diffuse::new(0.7);
    let mirror = || Conductor::new(None, Rgb::new(0.9, 0.8, 0.7));
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    let plastic = || Plastic::new(ior, 1.0, Rgb::new(0.6, 0.3, 0.2), true);
    let metal = |alpha| {
        let roughness = Roughness::isotropic(MicrofacetKind::Ggx, alpha);
        RoughConductor::new(roughness, None, 0.9)
    };
    let inner = sphere(Vec3::new(0.0, 0.6, 0.0), 0.3);
    let case = cuboid(Vec3::new(0.0, 0.6, 0.0), Vec3::splat(0.45));
    vec![
        Stage {
            name: "diffuse box",
            scene: cornell(Mat4::IDENTITY),
            sensor: cornell_camera(Mat4::IDENTITY, SIDE),
        },
        stage("glass ball", [floor(white()), ball(glass(1.5)), lamp()]),
        stage("mirror", [floor(white()), ball(mirror()), side_lamp()]),
        tank(),
        stage(
            "ball in glass",
            [
                floor(white()),
                part(inner, white()),
                part(case, glass(1.5)),
                lamp(),
            ],
        ),
        stage("plastic", [floor(plastic()), ball(plastic()), side_lamp()]),
        stage("rough metal", [floor(metal(0.4)), ball(metal(0.2)), lamp()]),
        stage("smooth glass", [floor(white()), coarse(glass(1.5)), lamp()]),
        stage(
            "smooth mirror",
            [floor(white()), coarse(mirror()), side_lamp()],
        ),
        stage(
            "textures",
            [floor(Diffuse::new(squares(6.0))), ball(tinted()), lamp()],
        ),
        stage(
            "bumpy glass",
            [floor(white()), ball(bumpy(0.02, glass(1.5))), lamp()],
        ),
        stage(
            "bumpy mirror",
            [floor(white()), ball(bumpy(0.06, mirror())), side_lamp()],
        ),
        mirror_hall(),
        open_air(),
        point_and_spot(),
        through_a_lens(),
        along_parallels(),
        all_around(),
    ]
}

/// One of the stages.
pub(crate) fn stage_of(name: &str) -> Stage {
    let found = stages().into_iter().find(|stage| stage.name == name);
    found.expect("there is such a stage")
}

/// Glass whose transmittance is a texture.
fn tinted() -> Dielectric {
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    Dielectric::new(ior, squares(4.0), squares(8.0))
}

/// A material on waves, whose height is in metres.
fn bumpy(height: f32, nested: impl Into<Bsdf>) -> BumpMap {
    let wave = |x: u32, y: u32| (x as f32 * 1.6).sin() * (y as f32 * 1.1).cos();
    let texels = (0..16).flat_map(|y| (0..16).map(move |x| wave(x, y)));
    let image = image::Bitmap::new(16, 16, 1, Texels::Float(texels.collect()));
    let image = Arc::new(image.expect("a picture of 16 × 16"));
    let waves = texture::Bitmap::new(image, Filter::Bilinear, Wrap::Repeat, Mat3::IDENTITY);
    let leaning = Leaning {
        shadowing: true,
        turning: true,
    };
    BumpMap::new(waves, height, leaning, nested)
}

/// Two liquids side by side, which meet the air in one plane; the lamp is at their bottom.
fn tank() -> Stage {
    let surface = |x: f32, ior: f32| {
        let shape = rectangle(Vec3::new(x, 0.0, 0.0), Vec3::Z * 1.5, Vec3::X * 1.0);
        part(shape, glass(ior))
    };
    let wall = rectangle(Vec3::new(0.0, 1.0, -0.8), Vec3::X * 2.0, Vec3::Y * 1.0);
    let bottom = rectangle(Vec3::Y * -1.0, Vec3::Z * 2.0, Vec3::X * 2.0);
    let light = rectangle(Vec3::new(0.1, -0.9, -0.2), Vec3::Z * 0.7, Vec3::X * 0.8);
    let parts = [
        surface(-1.0, 1.3),
        surface(1.0, 2.0),
        part(wall, Diffuse::new(0.7)),
        part(bottom, Diffuse::new(0.7)),
        part(light, Diffuse::new(0.0)).glowing(Rgb::new(6.0, 5.0, 4.0)),
    ];
    Stage {
        name: "tank",
        scene: scene(parts, |_| {}),
        sensor: camera(
            Vec3::new(0.0, 1.2, 2.2),
            Vec3::new(0.0, 0.4, -0.5),
            45.0,
            SIDE,
        ),
    }
}

/// Lit by an environment and the sun.
fn open_air() -> Stage {
    // Bodies do not touch: close to a contact rounding decides directions.
    let aside = sphere(Vec3::new(0.9, 0.5, -0.3), 0.4);
    let parts = [
        floor(Diffuse::new(0.7)),
        ball(glass(1.5)),
        part(aside, Conductor::new(None, 0.9)),
    ];
    Stage {
        name: "open air",
        scene: scene(parts, |builder| {
            builder.add_emitter(Constant::new(Rgb::new(0.5, 0.6, 0.8)));
            let sun = Directional::new(Vec3::new(-1.0, -2.0, -0.5), Rgb::grey(1.5));
            builder.add_emitter(sun.expect("the sun shines somewhere"));
        }),
        sensor: view(),
    }
}

/// Lights that no ray can meet.
fn point_and_spot() -> Stage {
    let wall = rectangle(Vec3::new(0.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Y * 1.0);
    let parts = [
        floor(Diffuse::new(0.7)),
        part(wall, Diffuse::new(0.6)),
        ball(glass(1.5)),
    ];
    Stage {
        name: "point and spot",
        scene: scene(parts, |builder| {
            builder.add_emitter(Point::new(Vec3::new(0.6, 1.2, 0.8), Rgb::grey(1.0)));
            let place = Mat4::from_translation(Vec3::new(-0.8, 1.5, 0.5));
            let aim = place * Mat4::from_rotation_x(1.9);
            let spot = Spot::new(aim, Rgb::new(3.0, 2.0, 1.0), Beam::new(1.0), None);
            builder.add_emitter(spot.expect("the lamp is one"));
        }),
        sensor: view(),
    }
}

/// A floor before a mirror, close to the eye; the lamp is a ball.
fn mirror_hall() -> Stage {
    let mirror = rectangle(Vec3::new(0.0, 1.0, -1.0), Vec3::X * 2.0, Vec3::Y * 1.0);
    let ceiling = rectangle(Vec3::Y * 2.0, Vec3::X * 2.0, Vec3::Z * 2.0);
    let lamp = sphere(Vec3::new(0.1, 0.6, -0.3), 0.3);
    let parts = [
        floor(Diffuse::new(0.7)),
        part(ceiling, Diffuse::new(0.6)),
        part(mirror, Conductor::new(None, Rgb::new(0.9, 0.8, 0.7))),
        part(lamp, Diffuse::new(0.0)).glowing(Rgb::new(4.0, 5.0, 6.0)),
    ];
    Stage {
        name: "mirror hall",
        scene: scene(parts, |_| {}),
        sensor: camera(
            Vec3::new(0.9, 0.6, 1.0),
            Vec3::new(0.0, 0.1, -0.4),
            90.0,
            SIDE,
        ),
    }
}

/// Seen through a wide lens.
fn through_a_lens() -> Stage {
    let view = (Vec3::new(-0.3, 1.6, 2.2), Vec3::new(0.0, 0.2, 0.0));
    let parts = [floor(Diffuse::new(0.7)), ball(glass(1.5)), lamp()];
    Stage {
        name: "thin lens",
        scene: scene(parts, |_| {}),
        sensor: lens_camera(view, 50.0, 0.3, 2.0),
    }
}

/// Seen along parallel rays.
fn along_parallels() -> Stage {
    let (from, to) = (Vec3::new(-0.3, 1.6, 2.2), Vec3::new(0.0, 0.5, 0.0));
    let to_world = Transform::look_at(from.as_dvec3(), to.as_dvec3(), Some(Vec3::Y.as_dvec3()));
    let to_world = to_world.expect("the camera looks somewhere").matrix();
    let camera = Orthographic::new(to_world, (0.0, f32::MAX), (SIDE, SIDE));
    Stage {
        sensor: camera.expect("the camera is one").into(),
        ..stage(
            "orthographic",
            [floor(Diffuse::new(0.7)), ball(glass(1.5)), lamp()],
        )
    }
}

/// Seen by a camera that looks into all directions.
fn all_around() -> Stage {
    let to_world = Mat4::from_translation(Vec3::new(-0.9, 0.9, 0.6)) * Mat4::from_rotation_x(0.4);
    let camera = Spherical::new(to_world, (SIDE, SIDE));
    Stage {
        sensor: camera.expect("the camera is one").into(),
        ..stage(
            "spherical",
            [floor(Diffuse::new(0.7)), ball(glass(1.5)), lamp()],
        )
    }
}

/// A camera with a lens.
pub(crate) fn lens_camera(
    (from, to): (Vec3, Vec3),
    degrees: f32,
    radius: f32,
    focus: f32,
) -> Sensor {
    let up = Some(Vec3::Y.as_dvec3());
    let to_world = Transform::look_at(from.as_dvec3(), to.as_dvec3(), up);
    let settings = PerspectiveSettings {
        to_world: to_world.expect("the camera looks somewhere").matrix(),
        field_of_view: degrees,
        axis: FieldOfViewAxis::X,
        near: 0.0,
        far: f32::MAX,
        principal_point_offset: Vec2::ZERO,
        film_size: (SIDE, SIDE),
    };
    let lens = ThinLens::new(settings, radius, focus);
    lens.expect("the lens is one").into()
}
