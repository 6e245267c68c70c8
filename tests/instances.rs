//! Instances of groups look as if their shapes stood there by themselves.

use lumiflow::bsdf::{
    Bsdf, Dielectric, Diffuse, MicrofacetKind, RelativeIor, RoughConductor, Roughness,
};
use lumiflow::film::Window;
use lumiflow::integrator::PixelSettings;
use lumiflow::math::{Mat4, Rgb, Vec3};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::shape::{Shape, Sphere, primitives};

use crate::support::render::{image, integrator, mean, picture, run, settings};
use crate::support::scenes::{Part, camera, faceted_sphere, moved, part, rectangle, scene};

const SIDE: u32 = 32;

fn place(middle: Vec3, turn: f32, stretch: Vec3) -> Mat4 {
    let axis = Vec3::new(0.36, 0.48, 0.8);
    Mat4::from_translation(middle)
        * Mat4::from_axis_angle(axis, turn)
        * Mat4::from_scale(stretch)
        * Mat4::from_rotation_x(0.4)
}

/// Where a group stands that may be stretched and mirrored.
fn anywhere() -> [Mat4; 3] {
    [
        place(Vec3::new(-0.9, 0.9, 0.0), 0.3, Vec3::splat(0.4)),
        place(Vec3::new(0.9, 0.8, -0.3), 1.0, Vec3::new(0.5, 0.2, 0.35)),
        place(Vec3::new(0.0, 0.7, 1.0), 2.0, Vec3::new(-0.3, 0.3, 0.4)),
    ]
}

/// Where a group stands that must stay round.
fn evenly() -> [Mat4; 2] {
    [
        place(Vec3::new(-0.6, 1.9, 0.0), 0.3, Vec3::splat(0.3)),
        place(Vec3::new(0.6, 1.8, 0.2), 2.0, Vec3::new(-0.35, 0.35, 0.35)),
    ]
}

/// A round body with brushed metal, and a box on top of it, which a map moves.
fn meshes(to_world: Mat4) -> [(Shape, Bsdf); 2] {
    let brushed = Roughness::new(MicrofacetKind::Ggx, 0.5, 0.2);
    let mut ball = faceted_sphere(24, to_world);
    ball.follow_coordinates();
    let on_top = Mat4::from_translation(Vec3::Y * 1.2) * Mat4::from_scale(Vec3::splat(0.4));
    let block = moved(primitives::cube(), to_world * on_top);
    [
        (ball.into(), RoughConductor::new(brushed, None, 0.9).into()),
        (block.into(), Diffuse::new(Rgb::new(0.2, 0.5, 0.7)).into()),
    ]
}

/// A glass ball beside a matt one, which a map moves.
fn balls(to_world: Mat4) -> [(Shape, Bsdf); 2] {
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    let ball = |middle: Vec3, radius: f32| {
        let ball = Sphere::new(middle, radius, to_world);
        Shape::from(ball.expect("an even map leaves it round"))
    };
    [
        (ball(Vec3::ZERO, 1.0), Dielectric::new(ior, 1.0, 1.0).into()),
        (ball(Vec3::X * 1.3, 0.3), Diffuse::new(0.7).into()),
    ]
}

/// A floor and a lamp, and what `bodies` adds.
fn stage(bodies: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 4.0, Vec3::X * 4.0);
    let lamp = rectangle(Vec3::new(-1.0, 4.0, 1.0), Vec3::X, Vec3::Z);
    let parts: [Part; 2] = [
        part(floor, Diffuse::new(0.6)),
        part(lamp, Diffuse::new(0.0)).glowing(Rgb::new(9.0, 8.0, 7.0)),
    ];
    scene(parts, bodies)
}

/// The bodies as instances, each moved by `shift` from where it belongs.
pub(crate) fn placed(shift: Vec3) -> Scene {
    let shift = Mat4::from_translation(shift);
    stage(|builder| {
        let mut add = |members: [(Shape, Bsdf); 2], maps: &[Mat4]| {
            let members = members.map(|(shape, bsdf)| (shape, builder.add_bsdf(bsdf)));
            let group = builder.add_group(members);
            for map in maps {
                builder
                    .add_instance(group, shift * *map)
                    .expect("the map has an inverse");
            }
        };
        add(meshes(Mat4::IDENTITY), &anywhere());
        add(balls(Mat4::IDENTITY), &evenly());
    })
}

/// The bodies by themselves.
fn flat() -> Scene {
    let bodies = anywhere().into_iter().map(meshes);
    let bodies = bodies.chain(evenly().into_iter().map(balls)).flatten();
    stage(|builder| {
        for (shape, bsdf) in bodies {
            let bsdf = builder.add_bsdf(bsdf);
            builder
                .add_shape(shape, bsdf, None)
                .expect("it does not emit");
        }
    })
}

fn look(scene: &Scene) -> Vec<Rgb> {
    let eye = Vec3::new(0.5, 2.5, 5.0);
    let sensor = camera(eye, Vec3::new(0.0, 1.0, 0.0), 40.0, SIDE);
    picture(scene, &sensor, "path max_depth=8", settings(7, SIDE), 16)
}

/// Share of the pixels that differ by more than two per cent, and by how much the means do.
fn difference(a: &[Rgb], b: &[Rgb]) -> (f64, f64) {
    let differ = |(a, b): &(&Rgb, &Rgb)| {
        let (a, b) = (a.luminance(), b.luminance());
        (a - b).abs() > 0.02 * b.max(0.01)
    };
    let count = a.iter().zip(b).filter(differ).count();
    (count as f64 / a.len() as f64, mean(a) / mean(b) - 1.0)
}

#[test]
fn instances_look_like_what_they_stand_for() {
    // The same random numbers make the same paths, except where rounding moves an edge.
    let expected = look(&flat());
    let (share, mean) = difference(&look(&placed(Vec3::ZERO)), &expected);
    assert!(share < 0.05, "{:.1} % of the pixels differ", 100.0 * share);
    assert!(mean.abs() < 2e-3, "the mean differs by {mean}");
    let (share, _) = difference(&look(&placed(Vec3::X * 0.02)), &expected);
    assert!(share > 0.2, "a shift by 2 cm changes {share} of the pixels");
}

#[test]
fn instances_look_the_same_to_any_number_of_threads() {
    let scene = placed(Vec3::ZERO);
    let eye = Vec3::new(0.5, 2.5, 5.0);
    let sensor = camera(eye, Vec3::new(0.0, 1.0, 0.0), 40.0, SIDE);
    let algorithm = integrator("erpt max_depth=6");
    let render = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let work = || image(&run(&scene, &sensor, &*algorithm, settings(3, SIDE), 2));
        pool.expect("threads can be started").install(work)
    };
    let one = render(1);
    assert!(mean(&one) > 0.0);
    assert_eq!(one, render(3));
}

#[test]
fn a_window_on_instances_shows_what_the_whole_film_shows_there() {
    let scene = placed(Vec3::ZERO);
    let sensor = camera(Vec3::new(0.5, 2.5, 5.0), Vec3::Y, 40.0, SIDE);
    let look = |window| {
        let settings = PixelSettings {
            window,
            ..settings(5, SIDE)
        };
        picture(&scene, &sensor, "path max_depth=6", settings, 2)
    };
    let whole = look(Window::full(SIDE, SIDE));
    let window = Window {
        x: 5,
        y: 9,
        width: 17,
        height: 11,
    };
    let rows = (window.y..window.y + window.height).map(|y| (y * SIDE + window.x) as usize);
    let expected: Vec<Rgb> = rows
        .flat_map(|start| whole[start..start + window.width as usize].iter().copied())
        .collect();
    assert!(mean(&expected) > 0.0);
    assert_eq!(look(window), expected);
}

#[test]
fn objects_of_groups_are_counted_once_and_placed_often() {
    let scene = placed(Vec3::ZERO);
    assert_eq!(scene.objects().len(), 2 + 4);
    assert_eq!(scene.instances().len(), 5);
    let placed = scene.instances().iter();
    let placed: usize = placed.map(|i| scene.objects_of(i).len()).sum();
    assert_eq!(placed, 10);
}
