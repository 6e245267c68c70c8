//! Paths that go on together make the bits that they make alone, whatever they meet.

use lumiflow::bsdf::{Diffuse, TwoSided};
use lumiflow::emitter::{Constant, Directional, Emitter, EmitterModel, Point};
use lumiflow::integrator::{Counters, Estimate};
use lumiflow::math::{Mat3, Mat4, Rgb, Vec2, Vec3};
use lumiflow::random::{PixelAddress, Purpose, Sampler, SamplerKind};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::sensor::{CameraRay, Sensor, SensorModel};
use lumiflow::shape::TriangleMesh;
use lumiflow::texture::{Checkerboard, Texture};

use crate::support::hard_scenes;
use crate::support::render::pixel_integrator;
use crate::support::scenes::{
    Part, cornell, cornell_camera, cuboid, faceted_sphere, part, rectangle, scene, sphere, studio,
    studio_camera, walls,
};

/// Width and height of the film; its pixels are no multiple of what goes together.
const SIDE: u32 = 37;

/// Camera rays all over the film, with the numbers for what follows.
fn camera_samples(sensor: &Sensor, kind: SamplerKind) -> (Vec<CameraRay>, Vec<Sampler>) {
    let sample = |pixel| {
        let address = PixelAddress {
            seed: 5,
            purpose: Purpose::Check,
            pixel,
            sample: 0,
        };
        let mut sampler = Sampler::new(kind, address);
        let corner = Vec2::new((pixel % SIDE) as f32, (pixel / SIDE) as f32);
        let raster = corner + sampler.next_2d();
        (sensor.sample_ray(raster, sampler.next_2d()), sampler)
    };
    (0..SIDE * SIDE).map(sample).collect()
}

/// Traces the same paths together and alone.
fn assert_same(views: &[(Scene, Sensor)], options: &[&str], kind: SamplerKind) {
    let bits = |estimate: &Estimate| {
        // One broken number is as broken as another.
        let whole = |x: f32| if x.is_nan() { f32::NAN } else { x };
        let [r, g, b] = estimate.radiance.to_array().map(|x| whole(x).to_bits());
        [r, g, b, estimate.alpha.to_bits()]
    };
    for (options, (scene, sensor)) in options
        .iter()
        .flat_map(|o| views.iter().map(move |v| (o, v)))
    {
        let integrator = pixel_integrator(options);
        let (rays, mut samplers) = camera_samples(sensor, kind);
        let (mut of_all, mut of_each) = (Counters::default(), Counters::default());
        let mut advanced = samplers.clone();
        let together = integrator.estimate_all(scene, (&rays, &mut advanced), &mut of_all);
        assert_eq!(together.len(), rays.len());
        for ((estimate, ray), sampler) in together.iter().zip(&rays).zip(&mut samplers) {
            let alone = integrator.estimate(scene, ray, sampler, &mut of_each);
            assert_eq!(bits(estimate), bits(&alone), "{options}, {ray:?}");
        }
        for (together, alone) in advanced.iter_mut().zip(&mut samplers) {
            assert_eq!(together.next_1d(), alone.next_1d(), "{options}");
        }
        assert_eq!(of_all, of_each, "{options}");
        assert_eq!(of_all.rays == 0, options.ends_with("max_depth=0"));
    }
}

#[test]
fn paths_together_are_the_paths_alone_to_the_bit() {
    let glass = hard_scenes::glass_caustic(SIDE, 1.0);
    let lights = hard_scenes::many_lights(SIDE);
    let bumps = hard_scenes::bumpy_mirror(SIDE);
    let views = [
        (
            cornell(Mat4::IDENTITY),
            cornell_camera(Mat4::IDENTITY, SIDE),
        ),
        (studio(1.0, |_| ()), studio_camera(SIDE)),
        (glass.scene, glass.sensor),
        (lights.scene, lights.sensor),
        (bumps.scene, bumps.sensor),
    ];
    let options = [
        "path",
        "path max_depth=0",
        "path max_depth=1",
        "path max_depth=4 rr_depth=2 mis=balance",
        "path hide_emitters=true strict_normals=true",
    ];
    assert_same(&views, &options, SamplerKind::Stratified);
}

/// A room of all kinds of diffuse surfaces: of one and of two sides, seen from both; with a texture;
/// black; with smooth normals; with more triangles than are prepared; and a sphere.
fn diffuse_room(
    more: impl IntoIterator<Item = Part>,
    lights: impl FnOnce(&mut SceneBuilder),
) -> Scene {
    let two_sided = |colour: Rgb| TwoSided::new(Diffuse::new(colour), None).expect("it is opaque");
    let [left, right, floor, ceiling, back, _front] = walls(Mat4::IDENTITY);
    let squares = Checkerboard::new(
        [Rgb::new(0.8, 0.3, 0.1), Rgb::new(0.1, 0.2, 0.7)],
        Mat3::from_scale(Vec2::splat(5.0)),
    );
    let place = |x: f32, size: f32| {
        Mat4::from_translation(Vec3::new(x, -0.6, 0.2)) * Mat4::from_scale(Vec3::splat(size))
    };
    let parts = [
        part(left, two_sided(Rgb::new(0.6, 0.1, 0.1))),
        part(right, Diffuse::new(Rgb::new(0.1, 0.5, 0.1))),
        part(floor, Diffuse::new(squares)),
        part(ceiling, Diffuse::new(Rgb::BLACK)),
        part(back, Diffuse::new(0.7)),
        part(
            rectangle(Vec3::new(-0.5, 0.1, 0.4), Vec3::Y * 0.2, Vec3::X * 0.2),
            two_sided(Rgb::grey(0.5)),
        ),
        part(
            rectangle(Vec3::new(0.5, 0.1, 0.4), Vec3::Y * 0.2, Vec3::X * 0.2),
            Diffuse::new(0.5),
        ),
        part(faceted_sphere(8, place(-0.6, 0.3)), Diffuse::new(0.6)),
        part(faceted_sphere(140, place(0.0, 0.25)), Diffuse::new(0.6)),
        part(sphere(Vec3::new(0.6, -0.7, 0.2), 0.3), Diffuse::new(0.6)),
    ];
    scene(parts.into_iter().chain(more), lights)
}

/// A small square in the room.
fn patch(x: f32) -> TriangleMesh {
    rectangle(Vec3::new(x, -0.2, 0.0), Vec3::X * 0.2, Vec3::Y * 0.2)
}

/// A surface that reflects more than there is.
fn endless_surface() -> Part {
    part(patch(0.0), Diffuse::new(Rgb::grey(f32::INFINITY)))
}

/// Surfaces that are diffuse and yet are shaded one by one: one that knows how its coordinates run, one with
/// another material behind.
fn neighbours() -> [Part; 2] {
    let mut following = patch(-0.4);
    following.follow_coordinates();
    let back = Diffuse::new(0.9).into();
    let of_two = TwoSided::new(Diffuse::new(0.1), Some(back)).expect("both are opaque");
    [part(following, Diffuse::new(0.8)), part(patch(0.4), of_two)]
}

/// Lights that are surfaces, alone and with others, and lights that are none.
fn diffuse_rooms() -> Vec<Scene> {
    let panel = || rectangle(Vec3::new(0.0, 0.9, 0.0), Vec3::X * 0.3, Vec3::Z * 0.3);
    let lamp = || part(panel(), Diffuse::new(0.2)).glowing(Rgb::new(12.0, 10.0, 6.0));
    let block = || {
        let block = cuboid(Vec3::new(0.3, 0.6, -0.2), Vec3::splat(0.1));
        part(block, Diffuse::new(0.0)).glowing(Rgb::grey(3.0))
    };
    let ball =
        || part(sphere(Vec3::new(-0.3, 0.5, 0.0), 0.1), Diffuse::new(0.2)).glowing(Rgb::grey(9.0));
    let sky = |builder: &mut SceneBuilder| _ = builder.add_emitter(Constant::new(Rgb::grey(0.7)));
    let bulb = |builder: &mut SceneBuilder| {
        _ = builder.add_emitter(Point::new(Vec3::new(0.1, 0.3, 0.9), Rgb::grey(0.7)));
    };
    let sun = |builder: &mut SceneBuilder| {
        let sun = Directional::new(Vec3::new(0.2, -0.6, -1.0), Rgb::grey(2.0));
        _ = builder.add_emitter(sun.expect("it has a direction"));
    };
    let in_squares = |builder: &mut SceneBuilder| {
        let bsdf = builder.add_bsdf(Diffuse::new(0.0));
        let squares = Checkerboard::new([Rgb::grey(9.0), Rgb::BLACK], Mat3::IDENTITY);
        let added = builder.add_shape(panel(), bsdf, Some(Texture::from(squares)));
        added.expect("the panel has an area");
    };
    vec![
        diffuse_room([], |_| ()),
        diffuse_room([lamp()], |_| ()),
        diffuse_room([block()], |_| ()),
        diffuse_room([ball()], |_| ()),
        diffuse_room([], sky),
        diffuse_room([], bulb),
        diffuse_room([], sun),
        diffuse_room([], in_squares),
        diffuse_room([lamp(), block(), ball()], |builder| {
            sky(builder);
            bulb(builder);
            sun(builder);
        }),
        // Light that knows no bounds, where there is any, and where there is none.
        diffuse_room([endless_surface(), lamp()], |_| ()),
        diffuse_room([endless_surface()], |_| ()),
        diffuse_room(neighbours().into_iter().chain([lamp()]), |_| ()),
        // On an instance, too.
        diffuse_room([lamp()], |builder| {
            let bsdf = builder.add_bsdf(Diffuse::new(0.4));
            let block = cuboid(Vec3::ZERO, Vec3::splat(0.1)).into();
            let group = builder.add_group([(block, bsdf)]);
            let place = Mat4::from_translation(Vec3::new(0.2, -0.2, 0.5));
            let added = builder.add_instance(group, place);
            added.expect("the place is one");
        }),
    ]
}

#[test]
fn diffuse_vertices_see_every_kind_of_light_as_they_do_alone() {
    let lights = Emitter::examples();
    assert!(lights.len() > 8);
    let views: Vec<_> = lights
        .into_iter()
        .map(|light| {
            let room = diffuse_room([], |builder| _ = builder.add_emitter(light));
            (room, cornell_camera(Mat4::IDENTITY, SIDE))
        })
        .collect();
    assert_same(&views, &["path max_depth=4"], SamplerKind::Stratified);
}

#[test]
fn diffuse_vertices_together_are_those_alone_to_the_bit() {
    let views: Vec<_> = diffuse_rooms()
        .into_iter()
        .map(|room| (room, cornell_camera(Mat4::IDENTITY, SIDE)))
        .collect();
    let options = [
        "path",
        "path max_depth=2",
        "path rr_depth=1 mis=maximum",
        "path max_depth=4 mis=balance hide_emitters=true",
        "path strict_normals=true",
    ];
    assert_same(&views, &options, SamplerKind::Independent);
    assert_same(&views, &options[..1], SamplerKind::Sobol);
}
