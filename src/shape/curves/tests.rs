//! Curves against Mitsuba, differences, and other ways to find hits.

use super::*;

fn made(basis: CurveBasis) -> Curves {
    let first = [
        [-2.0, 0.0, 0.0, 0.3],
        [-1.0, 1.0, 0.0, 0.3],
        [0.0, -1.0, 0.5, 0.2],
        [1.0, 1.0, 0.0, 0.1],
        [2.0, 0.0, 0.0, 0.3],
    ];
    let second = [
        [-2.0, -1.0, 0.0, 0.1],
        [-1.0, -1.5, 0.0, 0.1],
        [0.0, -1.0, 0.0, 0.2],
        [2.0, -1.5, 0.0, 0.2],
    ];
    let curves = [first.to_vec(), second.to_vec()];
    Curves::new(basis, &curves, Mat4::from_scale(Vec3::splat(2.0))).unwrap()
}

/// What Mitsuba 3.9.1 says of the same curves.
#[test]
fn points_are_those_of_mitsuba() {
    for (basis, primitive, along, position, normal, uv) in [
        (
            CurveBasis::BSpline,
            0,
            0.294_302,
            [-1.5, 0.5, 0.593_766],
            [-0.318_051, -0.038_030_7, 0.947_31],
            [0.291_741, 0.098_100_7],
        ),
        (
            CurveBasis::BSpline,
            2,
            0.883_18,
            [0.0, -2.4, 0.168_344],
            [0.000_865_5, -0.307_333, 0.951_602],
            [0.299_6, 0.961_06],
        ),
        (
            CurveBasis::Linear,
            1,
            0.355_62,
            [-1.5, 0.5, 0.494_529],
            [-0.798_851, -0.293_103, 0.525_289],
            [0.410_437, 0.193_66],
        ),
        (
            CurveBasis::Linear,
            0,
            0.25,
            [-3.5, 0.5, 0.3],
            [0.0, 0.0, 1.0],
            [0.25, 0.035_714_3],
        ),
    ] {
        let position = Vec3::from_array(position);
        let found = made(basis).surface_at(&ShapeHit {
            primitive,
            barycentrics: Vec2::new(along, 0.0),
            position,
        });
        let what = format!("{basis:?} {primitive}: {found:?}");
        assert!(found.position.distance(position) < 1e-5, "{what}");
        let normal = Vec3::from_array(normal);
        assert!(found.geometric_normal.distance(normal) < 1e-4, "{what}");
        assert!(found.uv.distance(Vec2::from_array(uv)) < 1e-4, "{what}");
    }
}

/// Neighbouring points of the surface: coordinates say how they move, normals stand across.
#[test]
fn derivatives_and_normals_are_those_of_differences() {
    let curves = made(CurveBasis::BSpline);
    let point = |along: f32, turn: f64| {
        let axis = curves.axis(curves.segment(1), f64::from(along));
        let frame = Frame::around(axis.along.normalize().as_vec3());
        let (sin, cos) = turn.sin_cos();
        let out = frame.tangent.as_dvec3() * cos + frame.bitangent.as_dvec3() * sin;
        curves.surface_at(&ShapeHit {
            primitive: 1,
            barycentrics: Vec2::new(along, 0.0),
            position: (axis.centre + out * axis.radius).as_vec3(),
        })
    };
    for (along, turn) in [(0.2, 0.3), (0.5, 2.0), (0.8, 5.0)] {
        let here = point(along, turn);
        for there in [point(along + 5e-4, turn), point(along, turn + 2e-3)] {
            let step = there.position - here.position;
            let lean = step.normalize().dot(here.geometric_normal);
            assert!(lean.abs() < 5e-3, "{lean}");
            // A coordinate's gradient, times the step, is how it changes.
            let frame = here.shading_frame();
            let across = Vec2::new(step.dot(frame.tangent), step.dot(frame.bitangent));
            for by_uv in [Vec2::X, Vec2::Y] {
                let change = by_uv.dot(there.uv - here.uv);
                let expected = here.gradient(by_uv).unwrap().dot(across);
                assert!((change - expected).abs() < 2e-5, "{change}, not {expected}");
            }
        }
    }
}

/// Rays from outside against the tracer's rivals in `brute_force`.
#[test]
fn hits_lie_on_the_surface() {
    use crate::accel::{Accel, Engine, Ray};
    use crate::shape::Shape;
    use crate::shape::brute_force::crossings;
    for basis in [CurveBasis::Linear, CurveBasis::BSpline] {
        // Away from the open ends of B-splines, and of even radius: there both rivals agree.
        let points: Vec<_> = (0..6)
            .map(|i| [i as f32 * 0.5 - 1.2, 0.0, 0.3, 0.2])
            .collect();
        let curves = Curves::new(basis, &[points], Mat4::from_rotation_z(0.4)).unwrap();
        let none: [Vec<Geometry>; 0] = [];
        let accel = Accel::build(Engine::Embree, [curves.geometry()], none, []).unwrap();
        for x in [-0.3_f32, -0.1, 0.15, 0.3] {
            let from = Vec3::new(x, 0.1, 3.0);
            let direction = Vec3::new(0.02, -0.03 - 0.1 * x, -1.0).normalize();
            let hit = accel.intersect(&Ray::new(from, direction)).unwrap();
            let found = curves.surface_at(&ShapeHit {
                primitive: hit.primitive,
                barycentrics: Vec2::new(hit.u, hit.v),
                position: from + direction * hit.distance,
            });
            let shape = Shape::from(curves.clone());
            let all = crossings(&shape, from, direction);
            let nearest = all.iter().map(|at| (at.position - from).length());
            let nearest = nearest.fold(f32::INFINITY, f32::min);
            let distance = (found.position - from).length();
            assert!(
                (distance - nearest).abs() < 1e-4,
                "{basis:?}: {distance}, {nearest}"
            );
            assert!(found.geometric_normal.dot(direction) < 0.0);
        }
    }
}

#[test]
fn curves_without_a_segment_and_negative_radii_are_refused() {
    let point = [0.0, 0.0, 0.0, 1.0];
    let new = |basis, points: Vec<[f32; 4]>| Curves::new(basis, &[points], Mat4::IDENTITY).err();
    let short = |found, least| Some(ShapeError::ShortCurve { found, least });
    assert_eq!(new(CurveBasis::Linear, vec![point]), short(1, 2));
    assert_eq!(new(CurveBasis::BSpline, vec![point; 3]), short(3, 4));
    let negative = vec![point, [0.0, 0.0, 0.0, -1.0]];
    assert_eq!(
        new(CurveBasis::Linear, negative),
        Some(ShapeError::BadRadius)
    );
    let infinite = vec![point, [f32::INFINITY, 0.0, 0.0, 1.0]];
    assert_eq!(
        new(CurveBasis::Linear, infinite),
        Some(ShapeError::NotFinite)
    );
}
