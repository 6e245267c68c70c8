//! Rays leave surfaces neither through what is behind nor into what they leave, at any size and any
//! place of the scene.

use lumiflow::accel::{CurveBasis, Ray};
use lumiflow::bsdf::Diffuse;
use lumiflow::emitter::{Constant, Point};
use lumiflow::math::{Mat4, Rgb, Vec2, Vec3, warp};
use lumiflow::random::{Purpose, Stream};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::sensor::Sensor;
use lumiflow::shape::{Curves, Cylinder, Disk, Shape, Sphere, primitives};

use crate::support::render::{mean, picture, settings};
use crate::support::scenes::{camera, cornell, cornell_camera, moved, part, scene};

/// Sizes of a scene, in m.
const SIZES: [f32; 5] = [1e-3, 0.1, 1.0, 300.0, 1e5];
/// Distances of a scene from the origin, in sizes of it.
const DISTANCES: [f32; 3] = [0.0, 10.0, 100.0];

/// Places a scene of size one, turned so that no coordinate is exact.
fn place(size: f32, distance: f32) -> Mat4 {
    let away = Vec3::new(0.6, -0.48, 0.64) * (distance * size);
    Mat4::from_translation(away) * Mat4::from_scale(Vec3::splat(size)) * turn()
}

fn turn() -> Mat4 {
    Mat4::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 0.9)
}

fn places() -> impl Iterator<Item = (f32, f32, Mat4)> {
    SIZES.into_iter().flat_map(|size| {
        DISTANCES
            .into_iter()
            .map(move |distance| (size, distance, place(size, distance)))
    })
}

#[test]
fn the_picture_does_not_depend_on_size_and_place() {
    const SIDE: u32 = 32;
    let render = |to_world: Mat4| {
        let (scene, sensor) = (cornell(to_world), cornell_camera(to_world, SIDE));
        picture(&scene, &sensor, "path", settings(5, SIDE), 16)
    };
    let expected = render(turn());
    for (size, distance, to_world) in places() {
        let found = render(to_world);
        // The same random numbers make the same paths, except where rounding moves an edge.
        let (a, b) = (mean(&found), mean(&expected));
        let what = format!("size {size}, distance {distance}");
        assert!((a / b - 1.0).abs() < 2e-3, "{what}: mean {a}, not {b}");
        let differ = |(a, b): &(&Rgb, &Rgb)| {
            let (a, b) = (a.luminance(), b.luminance());
            (a - b).abs() > 0.01 * b.max(0.01)
        };
        let count = found.iter().zip(&expected).filter(differ).count();
        let most = if distance > 10.0 { 0.12 } else { 0.03 };
        let share = count as f64 / expected.len() as f64;
        assert!(
            share < most,
            "{what}: {:.1} % of the pixels differ",
            100.0 * share
        );
    }
}

/// A box in blinding light, with an opening in one side or none.
///
/// It is one mesh: walls of their own would leave gaps where each rounds its corners for itself.
fn dark_room(to_world: Mat4, open: bool) -> Scene {
    let mut cube = primitives::cube();
    cube.flip_normals();
    if open {
        cube.indices.truncate(11);
    }
    let outside = to_world.transform_point3(Vec3::new(3.0, 2.5, 2.0));
    let shell = part(moved(cube, to_world), Diffuse::new(0.9));
    scene([shell], |builder: &mut SceneBuilder| {
        builder.add_emitter(Constant::new(Rgb::grey(1e6)));
        builder.add_emitter(Point::new(outside, Rgb::grey(1e30)));
    })
}

/// Cameras in the box that look at faces at a grazing angle, into edges and into corners.
fn lookouts(to_world: Mat4) -> Vec<Sensor> {
    let eye = Vec3::new(0.3, 0.99, -0.2);
    [
        (Vec3::new(-1.0, 0.999, 0.1), 20.0),
        (Vec3::new(1.0, -1.0, 0.4), 5.0),
        (Vec3::new(1.0, -1.0, 1.0), 1.0),
        (Vec3::new(-1.0, 1.0, 0.0), 0.5),
        (Vec3::new(0.0, -1.0, 0.0), 150.0),
    ]
    .into_iter()
    .map(|(target, degrees)| {
        let at = |point| to_world.transform_point3(point);
        camera(at(eye), at(target), degrees, 24)
    })
    .collect()
}

fn light_in(to_world: Mat4, open: bool) -> f64 {
    let room = dark_room(to_world, open);
    let look = |sensor| {
        mean(&picture(
            &room,
            &sensor,
            "path max_depth=8",
            settings(6, 24),
            8,
        ))
    };
    lookouts(to_world).into_iter().map(look).sum()
}

#[test]
fn light_subpaths_do_not_depend_on_size_and_place() {
    const SIDE: u32 = 16;
    for text in ["bdpt max_depth=5", "ptracer max_depth=5"] {
        let render = |to_world: Mat4| {
            let (scene, sensor) = (cornell(to_world), cornell_camera(to_world, SIDE));
            mean(&picture(&scene, &sensor, text, settings(5, SIDE), 16))
        };
        let expected = render(turn());
        for (size, distance, to_world) in places() {
            let found = render(to_world);
            let what = format!("{text}, size {size}, distance {distance}");
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{what}: {found}, {expected}"
            );
        }
    }
}

#[test]
fn closed_rooms_are_dark() {
    for (size, distance, to_world) in places() {
        let light = light_in(to_world, false);
        assert_eq!(light, 0.0, "size {size}, distance {distance}");
    }
    assert!(light_in(place(1.0, 0.0), true) > 0.0);
}

/// A shape, and whether its surface closes around an inside.
fn bodies(to_world: Mat4) -> Vec<(&'static str, Shape, bool)> {
    let slab = to_world * Mat4::from_scale(Vec3::new(1.0, 1.0, 2e-3));
    vec![
        (
            "sphere",
            Sphere::new(Vec3::ZERO, 1.0, to_world)
                .expect("a sphere")
                .into(),
            true,
        ),
        ("cube", moved(primitives::cube(), to_world).into(), true),
        ("slab", moved(primitives::cube(), slab).into(), true),
        ("disk", Disk::new(to_world).expect("a disk").into(), false),
        (
            "rectangle",
            moved(primitives::rectangle(), to_world).into(),
            false,
        ),
        (
            "cylinder",
            Cylinder::new(Vec3::NEG_Z, Vec3::Z, 1.0, to_world)
                .expect("a cylinder")
                .into(),
            false,
        ),
        ("capsule", hair(CurveBasis::Linear, to_world), true),
        ("hair", hair(CurveBasis::BSpline, to_world), false),
    ]
}

/// A straight curve; a linear one has round ends.
fn hair(basis: CurveBasis, to_world: Mat4) -> Shape {
    let radius = 0.6 * to_world.x_axis.truncate().length();
    let points = [-1.5, -0.5, 0.5, 1.5].map(|z| [0.1 * z, 0.2 * z, 0.6 * z, radius]);
    let curves = [points.to_vec()];
    let made = Curves::new(basis, &curves, to_world);
    made.expect("four control points").into()
}

fn pair(stream: &mut Stream) -> Vec2 {
    Vec2::new(stream.next_f32(), stream.next_f32())
}

/// Sends rays at a body, then from where they met it to infinity. Counts the rays that met the body
/// and goes wrong: outwards into it, or inwards out of it.
///
/// - `least_cos`: how far from the surface's plane rays leave at least.
fn wrong_ways(scene: &Scene, closed: bool, to_world: Mat4, least_cos: f32) -> (usize, usize) {
    let mut stream = Stream::new(9, Purpose::Check, 0, 0);
    let (mut met, mut wrong) = (0, 0);
    for _ in 0..4000 {
        let to_point = |p: Vec3| to_world.transform_point3(p);
        let from = to_point(warp::uniform_sphere(pair(&mut stream)) * 4.0);
        let toward = to_point(warp::uniform_sphere(pair(&mut stream)) * stream.next_f32());
        let Some(hit) = scene.intersect(&Ray::new(from, (toward - from).normalize())) else {
            continue;
        };
        let outwards = hit.point.geometric_normal;
        let leave = warp::uniform_sphere(pair(&mut stream));
        // Half of the directions graze the surface.
        let grazing = (leave - outwards * (0.99 * leave.dot(outwards))).normalize();
        let leave = if stream.next_f32() < 0.5 {
            leave
        } else {
            grazing
        };
        let cos = leave.dot(outwards);
        if cos.abs() < least_cos {
            continue;
        }
        met += 1;
        let free = scene.is_visible_to_infinity(&hit.point, leave);
        // From the inner side of an open cylinder, some ways out meet its other wall.
        let expected = match (closed, cos > 0.0) {
            (true, outwards) => outwards,
            (false, true) => true,
            (false, false) => continue,
        };
        wrong += usize::from(free != expected);
    }
    (met, wrong)
}

#[test]
fn rays_leave_bodies_on_the_right_side() {
    for (size, distance, to_world) in places() {
        for (name, shape, closed) in bodies(to_world) {
            let scene = scene([part(shape, Diffuse::new(0.5))], |_| {});
            let (met, wrong) = wrong_ways(&scene, closed, to_world, 1e-3);
            let what = format!("{name} of size {size} at {distance}");
            assert!(met > 500, "{what}: {met} rays met it");
            assert_eq!(wrong, 0, "{what}: {met} rays");
        }
    }
}

/// A scene of one instance of a body.
fn instance_of(shape: Shape, to_world: Mat4) -> Scene {
    scene([], |builder: &mut SceneBuilder| {
        let bsdf = builder.add_bsdf(Diffuse::new(0.5));
        let group = builder.add_group([(shape, bsdf)]);
        builder
            .add_instance(group, to_world)
            .expect("the map has an inverse");
    })
}

#[test]
fn rays_leave_instances_on_the_right_side() {
    let squeeze = Mat4::from_scale(Vec3::new(1.0, -0.2, 2.0));
    for (size, distance, to_world) in places() {
        for stretch in [Mat4::IDENTITY, squeeze, squeeze * turn()] {
            // Shapes of another size and place than the whole: their own space counts, too.
            let inner = place(50.0, 3.0);
            let to_world = to_world * stretch;
            for (name, shape, closed) in bodies(inner) {
                // Squeezed and far away, it is thinner than coordinates can tell.
                if name == "slab" && distance > 10.0 {
                    continue;
                }
                let scene = instance_of(shape, to_world * inner.inverse());
                let (met, wrong) = wrong_ways(&scene, closed, to_world, 1e-3);
                let what = format!("{name} of size {size} at {distance}, {stretch}");
                assert!(met > 300, "{what}: {met} rays met it");
                assert_eq!(wrong, 0, "{what}: {met} rays");
            }
        }
    }
}

#[test]
fn a_wide_plane_in_grazing_light_has_no_spots() {
    const SIDE: u32 = 24;
    for (size, distance, to_world) in places() {
        let at = |p: Vec3| to_world.transform_point3(p);
        let wide = to_world * Mat4::from_scale(Vec3::splat(300.0));
        let plane = part(moved(primitives::rectangle(), wide), Diffuse::new(1.0));
        // Far away and low: its light is nearly parallel, one degree above the plane.
        let lamp = at(Vec3::new(100.0, 0.0, 100.0 * 1.0_f32.to_radians().tan()));
        let intensity = Rgb::grey((size * 100.0).powi(2));
        let scene = scene([plane], |builder| {
            builder.add_emitter(Point::new(lamp, intensity));
        });
        let sensor = camera(at(Vec3::new(0.0, -3.0, 0.7)), at(Vec3::ZERO), 20.0, SIDE);
        let image = picture(&scene, &sensor, "direct", settings(3, SIDE), 2);
        let brightest = image.iter().map(|c| c.luminance()).fold(0.0, f32::max);
        let darkest = image.iter().map(|c| c.luminance()).fold(f32::MAX, f32::min);
        // Distance to the lamp varies by a tenth over the picture; irradiance by its cube.
        assert!(
            darkest > 0.5 * brightest,
            "size {size}, distance {distance}: {darkest} to {brightest}"
        );
    }
}
