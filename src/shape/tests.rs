//! Every shape against brute-force intersections, and against figures of Mitsuba 3.9.1.

mod sampling;

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use super::brute_force::crossings;
use super::*;
use crate::math::Mat4;
use crate::math::statistics::chi_square_p;
use crate::random::{Purpose, Stream};

/// Level of each χ² test: the family of about forty then errs with 2 %, once and for all seeds.
const LEVEL: f64 = 5e-4;

fn sphere() -> Sphere {
    let to_world = Mat4::from_translation(Vec3::new(0.3, -0.2, 1.5))
        * Mat4::from_rotation_x(0.7)
        * Mat4::from_scale(Vec3::splat(2.0));
    Sphere::new(Vec3::new(0.1, 0.0, -0.3), 0.4, to_world).unwrap()
}

fn sheared_disk() -> Disk {
    let to_world = Mat4::from_cols_array(&[
        0.9, 0.1, 0.2, 0.0, 0.3, 0.6, -0.1, 0.0, 0.0, 0.2, 1.0, 0.0, 0.2, 0.1, 2.0, 1.0,
    ]);
    Disk::new(to_world).unwrap()
}

fn slanted_cylinder() -> Cylinder {
    let to_world = Mat4::from_translation(Vec3::new(0.0, 0.1, 1.8)) * Mat4::from_rotation_y(0.3);
    Cylinder::new(
        Vec3::new(0.0, -0.5, 0.0),
        Vec3::new(0.25, 0.5, 0.25),
        0.4,
        to_world,
    )
    .unwrap()
}

fn rectangle() -> TriangleMesh {
    let mut data = primitives::rectangle();
    data.transform(
        Mat4::from_translation(Vec3::new(0.2, 0.0, 1.7))
            * Mat4::from_rotation_y(2.6)
            * Mat4::from_scale(Vec3::new(0.8, 0.5, 1.0)),
    );
    let mut mesh = TriangleMesh::from(data);
    assert!(mesh.prepare_sampling());
    mesh
}

fn examples() -> Vec<Shape> {
    let mut inside_out = sphere();
    inside_out.flip_normals();
    vec![
        sphere().into(),
        inside_out.into(),
        sheared_disk().into(),
        slanted_cylinder().into(),
        rectangle().into(),
    ]
}

fn stream(index: u32) -> Stream {
    Stream::new(11, Purpose::Check, index, 0)
}

fn pair(stream: &mut Stream) -> Vec2 {
    let x = stream.next_f32();
    Vec2::new(x, stream.next_f32())
}

/// Surface coordinates in which equal areas are equal.
fn equal_area_coordinates(shape: &Shape, at: &SurfacePoint) -> Vec2 {
    let uv = at.uv;
    match shape {
        Shape::Sphere(_) => Vec2::new(uv.x, (1.0 - (uv.y * TAU / 2.0).cos()) / 2.0),
        Shape::Disk(_) => Vec2::new(uv.x * uv.x, uv.y),
        _ => uv,
    }
}

#[test]
fn points_are_uniform_by_area() {
    const COUNT: u32 = 20_000;
    for shape in examples() {
        let mut stream = stream(2);
        let mut observed = [0.0; 100];
        for _ in 0..COUNT {
            let (point, density) = shape.sample_area(pair(&mut stream));
            assert_eq!(density.0, (1.0 / shape.area()) as f32);
            let at = (equal_area_coordinates(&shape, &point) * 10.0).min(Vec2::splat(9.0));
            observed[at.x as usize * 10 + at.y as usize] += 1.0;
        }
        let p = chi_square_p(&observed, &[f64::from(COUNT) / 100.0; 100]).unwrap();
        assert!(p > LEVEL, "p = {p} for {shape:?}");
    }
}

#[test]
fn a_hit_near_the_surface_finds_the_sampled_point_again() {
    for shape in examples() {
        if matches!(shape, Shape::TriangleMesh(_)) {
            continue;
        }
        let mut stream = stream(3);
        for _ in 0..500 {
            let (point, _) = shape.sample_area(pair(&mut stream));
            let hit = ShapeHit {
                primitive: 0,
                barycentrics: Vec2::ZERO,
                position: point.position + point.geometric_normal * 1e-5,
            };
            let found = shape.surface_at(&hit);
            assert!(
                (found.position - point.position).length() < 1e-6,
                "{shape:?}"
            );
            assert!((found.geometric_normal - point.geometric_normal).length() < 1e-5);
            assert!(found.shading_normal == found.geometric_normal);
            assert!((found.geometric_normal.length() - 1.0).abs() < 1e-6);
            let turn = (found.uv - point.uv).abs();
            assert!(turn.min(1.0 - turn).max_element() < 1e-4, "{shape:?}");
            assert!(found.error > 1e-6 && found.error < 1e-4);
        }
    }
}

#[test]
fn spheres_that_ignore_their_coordinates_have_the_same_points() {
    let (follows, mut ignores) = (sphere(), sphere());
    ignores.ignore_coordinates();
    let mut stream = stream(9);
    for _ in 0..100 {
        let u = pair(&mut stream);
        let (full, bare) = (follows.sample_area(u).0, ignores.sample_area(u).0);
        assert_ne!(full.derivatives, Derivatives::NONE);
        assert_eq!(bare.derivatives, Derivatives::NONE);
        let full = SurfacePoint {
            derivatives: Derivatives::NONE,
            ..full
        };
        assert_eq!(format!("{full:?}"), format!("{bare:?}"));
    }
}

#[test]
fn surface_points_are_small() {
    assert!(size_of::<SurfacePoint>() <= 64);
}

#[test]
fn gradients_say_how_coordinates_change() {
    const STEP: f32 = 1e-3;
    for mut shape in examples() {
        if let Shape::TriangleMesh(mesh) = &mut shape {
            mesh.follow_coordinates();
        }
        let mut stream = stream(4);
        for _ in 0..300 {
            let u = pair(&mut stream);
            let (at, _) = shape.sample_area(u);
            // Where the coordinates bend too much for differences.
            let near_pole = at.uv.x < 0.1 || (at.uv.y - 0.5).abs() > 0.4;
            if near_pole {
                continue;
            }
            let gradients = [Vec2::X, Vec2::Y].map(|by_uv| at.gradient(by_uv).unwrap());
            for step in [Vec2::X, Vec2::Y] {
                let (beside, _) = shape.sample_area(u + step * STEP);
                let way = at.shading_frame().to_local(beside.position - at.position);
                let [by_u, by_v] = gradients.map(|gradient| gradient.dot(way.0.truncate()));
                let (expected, found) = (Vec2::new(by_u, by_v), beside.uv - at.uv);
                let error = (found - expected).length();
                assert!(
                    error < 0.02 * found.length() + 1e-5,
                    "{found} is not {expected}: {shape:?}"
                );
            }
        }
    }
    // Without coordinates there is nothing to follow.
    let (at, _) = Shape::from(rectangle()).sample_area(Vec2::splat(0.3));
    assert_eq!(at.gradient(Vec2::ONE), None);
}

#[test]
fn areas_are_those_of_the_formulas() {
    let close = |shape: Shape, area: f64| {
        let found = shape.area();
        assert!((found - area).abs() < 1e-5 * area, "{found} for {area}");
    };
    let pi = std::f64::consts::PI;
    close(sphere().into(), 4.0 * pi * 0.64);
    let cross = Vec3::new(0.9, 0.1, 0.2).cross(Vec3::new(0.3, 0.6, -0.1));
    close(sheared_disk().into(), pi * f64::from(cross.length()));
    close(slanted_cylinder().into(), 2.0 * pi * 0.4 * 1.125_f64.sqrt());
    close(rectangle().into(), 1.6);
    close(TriangleMesh::from(primitives::cube()).into(), 24.0);
}

/// Where a ray meets a shape first.
fn first(shape: &Shape, from: [f32; 3], direction: [f32; 3]) -> SurfacePoint {
    let from = Vec3::from_array(from);
    let direction = Vec3::from_array(direction).normalize();
    let distance = |p: &SurfacePoint| (p.position - from).length();
    crossings(shape, from, direction)
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .expect("the ray of the test meets the shape")
}

fn check(at: SurfacePoint, normal: [f32; 3], uv: [f32; 2], tangent: [f32; 3]) {
    let near = |a: Vec3, b: [f32; 3]| (a - Vec3::from_array(b)).length() < 2e-4;
    assert!(near(at.geometric_normal, normal), "{at:?}");
    assert!((at.uv - Vec2::from_array(uv)).length() < 1e-4, "{at:?}");
    assert!(near(at.shading_frame().tangent, tangent), "{at:?}");
}

/// Normal, uv and tangent as Mitsuba 3.9.1 prints them for the same rays.
#[test]
fn parametrisations_are_those_of_mitsuba() {
    let turned = Mat4::from_translation(Vec3::new(0.1, 0.0, 0.0))
        * Mat4::from_rotation_x(FRAC_PI_2)
        * Mat4::from_scale(Vec3::splat(0.5));
    let sphere = |to_world| Shape::from(Sphere::new(Vec3::ZERO, 1.0, to_world).unwrap());
    check(
        first(&sphere(Mat4::IDENTITY), [3., 1., 0.5], [-1., -0.2, 0.]),
        [0.6802, 0.536, 0.5],
        [0.1062, 0.3333],
        [-0.619, 0.785_45, 0.],
    );
    check(
        first(&sphere(turned), [-2., 0.3, 4.], [0.5, 0., -1.]),
        [-0.5087, 0.6, 0.6174],
        [0.3597, 0.7048],
        [-0.7718, 0., -0.6359],
    );
    let stretched = Mat4::from_scale(Vec3::new(2.0, 1.0, 1.0));
    let disk = Shape::from(Disk::new(stretched).unwrap());
    check(
        first(&disk, [-0.3, -0.5, -4.], [0., 0., 1.]),
        [0., 0., 1.],
        [0.522, 0.7036],
        [-0.5145, -0.8575, 0.],
    );
    let cylinder = |end: [f32; 3]| {
        let start = Vec3::new(0.0, -1.0, 0.0);
        Shape::from(Cylinder::new(start, end.into(), 0.5, Mat4::IDENTITY).unwrap())
    };
    check(
        first(&cylinder([0., 1., 0.]), [4., 0.3, 0.2], [-1., 0., 0.]),
        [0.9165, 0., 0.4],
        [0.9345, 0.65],
        [0.4, 0., -0.9165],
    );
    check(
        first(&cylinder([0.5, 1., 0.5]), [-4., 0.3, 0.2], [1., 0., 0.]),
        [-0.9428, 0.2807, -0.1798],
        [0.4314, 0.5798],
        [-0.2357, -0.1798, 0.955],
    );
}

#[test]
fn flat_primitives_are_those_of_mitsuba() {
    let mesh = |data: mesh::MeshData| {
        assert_eq!(data.validate(), Ok(()));
        let mut mesh = TriangleMesh::from(data);
        mesh.follow_coordinates();
        Shape::from(mesh)
    };
    let rectangle = mesh(primitives::rectangle());
    check(
        first(&rectangle, [-0.3, -0.5, -4.], [0., 0., 1.]),
        [0., 0., 1.],
        [0.35, 0.25],
        [1., 0., 0.],
    );
    let cube = mesh(primitives::cube());
    let faces = [
        ([0.3, 0.2, 4.], [0., 0., 1.], [0.6, 0.65], [0., 1., 0.]),
        ([0.3, 0.2, -4.], [0., 0., -1.], [0.4, 0.65], [0., -1., 0.]),
        ([4., 0.3, 0.2], [1., 0., 0.], [0.65, 0.4], [0., 1., 0.]),
        ([-4., 0.3, 0.2], [-1., 0., 0.], [0.65, 0.6], [0., 1., 0.]),
        ([0.3, 4., 0.2], [0., 1., 0.], [0.35, 0.4], [-1., 0., 0.]),
        ([0.3, -4., 0.2], [0., -1., 0.], [0.6, 0.65], [0., 0., 1.]),
    ];
    for (from, normal, uv, tangent) in faces {
        check(
            first(&cube, from, normal.map(|c: f32| -c)),
            normal,
            uv,
            tangent,
        );
    }
    let mut inside_out = primitives::cube();
    inside_out.flip_normals();
    let point = first(&mesh(inside_out), [0.3, 0.2, 4.], [0., 0., -1.]);
    assert_eq!(point.geometric_normal, -Vec3::Z);
}

#[test]
fn mirrors_keep_round_shapes_outside_out_and_flips_turn_them() {
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let sphere = Sphere::new(Vec3::ZERO, 1.0, mirror).unwrap();
    let cylinder = Cylinder::new(Vec3::ZERO, Vec3::Z, 1.0, mirror).unwrap();
    let from = [3.0, 0.3, 0.5];
    let mut shapes = [Shape::from(sphere), Shape::from(cylinder)];
    for shape in &mut shapes {
        let at = first(shape, from, [-1., 0., 0.]);
        assert!(at.geometric_normal.x > 0.8);
        // The object's x axis points to the world's −x.
        assert!((at.uv.x - 0.5).abs() < 0.1 && at.uv.x < 0.5, "{at:?}");
        match shape {
            Shape::Sphere(s) => s.flip_normals(),
            Shape::Cylinder(c) => c.flip_normals(),
            _ => unreachable!("the list holds these two"),
        }
        let flipped = first(shape, from, [-1., 0., 0.]);
        assert_eq!(flipped.geometric_normal, -at.geometric_normal);
        assert_eq!(flipped.uv, at.uv);
        let (turned, tangent) = (flipped.shading_frame().tangent, at.shading_frame().tangent);
        assert!((turned - tangent).length() < 1e-6);
    }
    let below = Disk::new(Mat4::from_scale(Vec3::new(1.0, 1.0, -1.0))).unwrap();
    assert_eq!(below.sample_area(Vec2::ZERO).0.geometric_normal, -Vec3::Z);
    let pressed = Disk::new(Mat4::from_scale(Vec3::new(1.0, -1.0, 0.0))).unwrap();
    assert_eq!(pressed.sample_area(Vec2::ZERO).0.geometric_normal, -Vec3::Z);
}

#[test]
fn what_is_not_round_is_refused() {
    let stretch = |x, y, z| Mat4::from_scale(Vec3::new(x, y, z));
    let sphere = |radius, to_world| Sphere::new(Vec3::ZERO, radius, to_world).err();
    assert_eq!(
        sphere(1.0, stretch(1.0, 1.2, 1.0)),
        Some(ShapeError::Stretched)
    );
    assert_eq!(sphere(0.0, Mat4::IDENTITY), Some(ShapeError::BadRadius));
    assert_eq!(sphere(1.0, stretch(0.0, 0.0, 0.0)), Some(ShapeError::Flat));
    assert_eq!(
        sphere(f32::NAN, Mat4::IDENTITY),
        Some(ShapeError::NotFinite)
    );
    assert_eq!(
        sphere(1e30, stretch(1e30, 1e30, 1e30)),
        Some(ShapeError::NotFinite)
    );
    assert_eq!(sphere(1.0, Mat4::from_rotation_y(FRAC_PI_4)), None);
    let cylinder = |end, to_world| Cylinder::new(Vec3::ZERO, end, 1.0, to_world).err();
    assert_eq!(cylinder(Vec3::Z, stretch(2.0, 2.0, 0.5)), None);
    assert_eq!(
        cylinder(Vec3::Z, stretch(2.0, 1.0, 1.0)),
        Some(ShapeError::Stretched)
    );
    assert_eq!(cylinder(Vec3::ZERO, Mat4::IDENTITY), Some(ShapeError::Flat));
    let mut slanted = Mat4::IDENTITY;
    slanted.z_axis.x = 0.5;
    assert_eq!(cylinder(Vec3::Z, slanted), Some(ShapeError::Stretched));
    assert_eq!(
        Disk::new(stretch(1.0, 0.0, 1.0)).err(),
        Some(ShapeError::Flat)
    );
    assert_eq!(Disk::new(Mat4::NAN).err(), Some(ShapeError::NotFinite));
}

#[test]
fn right_above_a_sphere_half_of_all_directions_see_it() {
    let sphere = sphere();
    let above = sphere.centre() + Vec3::X * (sphere.radius() * (1.0 + 3e-7));
    let (point, density) = sphere.sample_toward(above, Vec2::new(0.2, 0.5)).unwrap();
    assert!((density.0 * TAU - 1.0).abs() < 2e-3, "{density:?}");
    assert!((point.position - above).length() < 1e-3);
    let far = sphere.centre() + Vec3::X * 1e9;
    let (point, density) = sphere.sample_toward(far, Vec2::new(0.2, 0.5)).unwrap();
    let disk = TAU / 2.0 * (sphere.radius() / 1e9).powi(2);
    assert!((density.0 * disk - 1.0).abs() < 1e-4, "{density:?}");
    assert!((point.geometric_normal.x - 0.5_f32.sqrt()).abs() < 1e-4);
}
