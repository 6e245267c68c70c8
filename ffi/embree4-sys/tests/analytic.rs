//! Spheres, disks and cylinders: exact from near, far, inside, and at any size.

use embree4_sys::{CommittedScene, Error, Hit, Ray};

use crate::{IDENTITY, Numbers, build, ray};

fn sphere(center: [f32; 3], radius: f32) -> Result<CommittedScene, Error> {
    build(|builder| builder.add_sphere(center, radius).map(drop))
}

fn disk(to_world: [[f32; 4]; 3]) -> Result<CommittedScene, Error> {
    build(|builder| builder.add_disk(to_world).map(drop))
}

fn cylinder(to_world: [[f32; 4]; 3]) -> Result<CommittedScene, Error> {
    build(|builder| builder.add_cylinder(to_world).map(drop))
}

/// The hit, after checking that `occluded` says the same.
fn trace(scene: &CommittedScene, ray: &Ray) -> Option<Hit> {
    let hit = scene.intersect(ray);
    assert_eq!(scene.occluded(ray), hit.is_some(), "{ray:?}");
    hit
}

#[track_caller]
fn assert_distance(hit: Option<Hit>, expected: f32) {
    let distance = hit.map(|hit| hit.distance);
    assert!(
        distance.is_some_and(|distance| (distance - expected).abs() <= 1e-6 * expected),
        "{distance:?} instead of {expected}"
    );
}

#[test]
fn a_sphere_is_hit_from_outside_and_inside() -> Result<(), Error> {
    let scene = sphere([1.0, 2.0, 3.0], 0.5)?;
    let outside = trace(&scene, &ray([1.0, 2.0, 0.0], [0.0, 0.0, 2.0]));
    assert_eq!(
        outside.map(|hit| (hit.distance, hit.normal)),
        Some((1.25, [0.0, 0.0, -1.0]))
    );
    let inside = trace(&scene, &ray([1.0, 2.0, 3.25], [0.0, 0.0, -1.0]));
    assert_eq!(
        inside.map(|hit| (hit.distance, hit.normal)),
        Some((0.75, [0.0, 0.0, -1.0]))
    );
    assert_eq!(trace(&scene, &ray([1.0, 2.0, 4.0], [0.0, 0.0, 1.0])), None);
    assert_eq!(trace(&scene, &ray([1.6, 2.0, 0.0], [0.0, 0.0, 1.0])), None);
    assert_eq!(trace(&scene, &ray([1.0, 2.0, 0.0], [0.0; 3])), None);
    Ok(())
}

#[test]
fn the_interval_selects_the_side_of_a_sphere() -> Result<(), Error> {
    let scene = sphere([0.0, 0.0, 4.0], 1.0)?;
    for (near, far, expected) in [
        (0.0, 9.0, Some(3.0)),
        (0.0, 3.0, Some(3.0)),
        (3.0, 9.0, Some(3.0)),
        (3.001, 9.0, Some(5.0)),
        (3.001, 4.9, None),
        (5.0, 9.0, Some(5.0)),
        (5.001, 9.0, None),
        (0.0, 2.9, None),
    ] {
        let piece = Ray {
            near,
            far,
            ..ray([0.0; 3], [0.0, 0.0, 1.0])
        };
        assert_eq!(
            trace(&scene, &piece).map(|hit| hit.distance),
            expected,
            "{near} {far}"
        );
    }
    Ok(())
}

#[test]
fn a_sphere_is_exact_at_any_size_and_distance() -> Result<(), Error> {
    for radius in [1e-15_f32, 1e-6, 1.0, 1e6, 1e12] {
        let scene = sphere([0.0; 3], radius)?;
        let mut numbers = Numbers(3);
        for scale in [0.0, 0.3, 0.999_999, 1.000_001, 3.0, 1e3, 1e6] {
            for _ in 0..300 {
                let toward = numbers.point().map(f64::from);
                let length = toward.iter().map(|x| x * x).sum::<f64>().sqrt();
                let distance = f64::from(radius) * scale;
                let origin = toward.map(|x| (x / length * distance) as f32);
                let aim = numbers.point().map(|x| 0.5 * x * radius);
                let direction = [0, 1, 2].map(|axis| aim[axis] - origin[axis]);
                let ray = ray(origin, direction);
                let Some(hit) = trace(&scene, &ray) else {
                    panic!("{radius} {scale} {ray:?}")
                };
                let expected = sphere_distance(&ray, f64::from(radius));
                let error = (f64::from(hit.distance) - expected).abs();
                assert!(
                    error <= 1e-7 * expected,
                    "{radius} {scale} {expected} {hit:?}"
                );
            }
        }
    }
    Ok(())
}

/// The first positive distance to the sphere around the origin, by the textbook formula.
fn sphere_distance(ray: &Ray, radius: f64) -> f64 {
    let origin = ray.origin.map(f64::from);
    let direction = ray.direction.map(f64::from);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(direction, direction).sqrt();
    let unit = direction.map(|x| x / length);
    let half = dot(origin, unit);
    let away = dot(origin, origin).sqrt();
    let constant = (away - radius) * (away + radius);
    let root = (half * half - constant).sqrt();
    // The form without cancellation for each sign.
    let (first, second) = if half < 0.0 {
        (constant / (root - half), root - half)
    } else {
        (-half - root, -constant / (half + root))
    };
    (if first > 0.0 { first } else { second }) / length
}

#[test]
fn a_disk_is_hit_from_both_sides() -> Result<(), Error> {
    // An ellipse with half axes 2 and 3 around (0, 0, 5).
    let scene = disk([
        [2.0, 0.0, 0.0, 0.0],
        [0.0, 3.0, 0.0, 0.0],
        [0.0, 0.0, 4.0, 5.0],
    ])?;
    let expected = Hit {
        distance: 5.0,
        u: 0.5,
        v: 0.25,
        normal: [0.0, 0.0, 1.0],
        primitive: 0,
        geometry: 0,
        instance: None,
    };
    assert_eq!(
        trace(&scene, &ray([0.0, 1.5, 0.0], [0.0, 0.0, 1.0])),
        Some(expected)
    );
    assert_eq!(
        trace(&scene, &ray([0.0, 1.5, 10.0], [0.0, 0.0, -1.0])),
        Some(expected)
    );
    for (x, y, hit) in [(1.999, 0.0, true), (2.001, 0.0, false), (0.0, -2.999, true)] {
        let down = ray([x, y, 1e4], [0.0, 0.0, -1.0]);
        assert_eq!(trace(&scene, &down).is_some(), hit, "{x} {y}");
    }
    assert_eq!(trace(&scene, &ray([0.0, 0.0, 5.0], [1.0, 0.0, 0.0])), None);
    let below_x = trace(&scene, &ray([1.0, -1e-30, 0.0], [0.0, 0.0, 1.0]));
    assert!(
        below_x.is_some_and(|hit| (0.0..1.0).contains(&hit.v)),
        "{below_x:?}"
    );
    Ok(())
}

#[test]
fn a_mirrored_and_sheared_disk_keeps_its_plus_z_side() -> Result<(), Error> {
    let mirrored = disk([[-1.0, 0.0, 0.0, 0.0], IDENTITY[1], IDENTITY[2]])?;
    let down = ray([0.1, 0.0, 3.0], [0.0, 0.0, -1.0]);
    assert_eq!(
        trace(&mirrored, &down).map(|hit| hit.normal),
        Some([0.0, 0.0, 1.0])
    );
    // The object's z axis leans towards x: the plane, and so the normal, stay.
    let sheared = disk([[1.0, 0.0, 5.0, 0.0], IDENTITY[1], IDENTITY[2]])?;
    assert_eq!(
        trace(&sheared, &down).map(|hit| hit.normal),
        Some([0.0, 0.0, 1.0])
    );
    // The disk in the plane x = 0 with its +z side towards +x.
    let turned = disk([
        [0.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
    ])?;
    let left = trace(&turned, &ray([2.0, 0.5, 0.0], [-1.0, 0.0, 0.0]));
    let expected = (2.0, [1.0, 0.0, 0.0], 0.5, 0.0);
    assert_eq!(
        left.map(|hit| (hit.distance, hit.normal, hit.u, hit.v)),
        Some(expected)
    );
    Ok(())
}

#[test]
fn a_cylinder_is_open_and_hit_from_both_sides() -> Result<(), Error> {
    // Radius 2 along x, 6 along y, from z = 1 to z = 11.
    let scene = cylinder([
        [2.0, 0.0, 0.0, 0.0],
        [0.0, 6.0, 0.0, 0.0],
        [0.0, 0.0, 10.0, 1.0],
    ])?;
    let outside = trace(&scene, &ray([-5.0, 0.0, 6.0], [1.0, 0.0, 0.0]));
    let Some(hit) = outside else {
        panic!("the cylinder is there")
    };
    assert_eq!(
        (hit.distance, hit.normal, hit.u, hit.v),
        (3.0, [-1.0, 0.0, 0.0], 0.5, 0.5)
    );
    let inside = trace(&scene, &ray([0.0, 0.0, 6.0], [0.0, -1.0, 0.0]));
    let Some(hit) = inside else {
        panic!("the cylinder is there")
    };
    assert_eq!(
        (hit.distance, hit.normal, hit.u, hit.v),
        (6.0, [0.0, -1.0, 0.0], 0.75, 0.5)
    );
    // Through the open ends: along the axis, and in at the top and against the far wall.
    assert_eq!(trace(&scene, &ray([0.0, 0.0, -3.0], [0.0, 0.0, 1.0])), None);
    assert_eq!(
        trace(&scene, &ray([0.0, 0.0, 12.0], [1.0, 0.0, -1.0])).map(|hit| hit.v),
        Some(0.9)
    );
    assert_distance(
        trace(&scene, &ray([-3.0, 0.0, 12.0], [1.0, 0.0, -0.5])),
        5.0,
    );
    assert_eq!(
        trace(&scene, &ray([-5.0, 0.0, 0.999], [1.0, 0.0, 0.0])),
        None
    );
    assert_eq!(
        trace(&scene, &ray([-5.0, 0.0, 11.001], [1.0, 0.0, 0.0])),
        None
    );
    let second = Ray {
        near: 3.001,
        ..ray([-5.0, 0.0, 6.0], [1.0, 0.0, 0.0])
    };
    assert_distance(trace(&scene, &second), 7.0);
    let between = Ray { far: 6.9, ..second };
    assert_eq!(trace(&scene, &between), None);
    Ok(())
}

#[test]
fn disks_and_cylinders_are_exact_at_any_size_and_distance() -> Result<(), Error> {
    for scale in [1e-12_f32, 1e-3, 1.0, 1e5, 1e11] {
        for away in [0.0, 2.0, 1e3, 1e6] {
            let distance = away * scale;
            let matrix = IDENTITY.map(|row| row.map(|entry| entry * scale));
            let pipe = cylinder(matrix)?;
            let origin = [distance, 0.0, 0.5 * scale];
            let expected = if away < 1.0 { 1.0 } else { away - 1.0 };
            let hit = trace(&pipe, &ray(origin, [-scale, 0.0, 0.0]));
            assert_distance(hit, expected);
            let plate = disk(matrix)?;
            let above = ray(
                [0.25 * scale, 0.5 * scale, distance + scale],
                [0.0, 0.0, -scale],
            );
            assert_distance(trace(&plate, &above), away + 1.0);
        }
    }
    Ok(())
}

/// A point of the unit disk or cylinder from the surface coordinates of a hit on it.
fn object_point(flat: bool, u: f32, v: f32) -> [f32; 3] {
    let (sine, cosine) = (std::f32::consts::TAU * if flat { v } else { u }).sin_cos();
    if flat {
        [u * cosine, u * sine, 0.0]
    } else {
        [cosine, sine, v]
    }
}

/// The linear part of a matrix times a vector.
fn rotate(matrix: &[[f32; 4]; 3], vector: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

#[test]
fn rays_aimed_at_a_shape_hit_it_and_satisfy_its_equation() -> Result<(), Error> {
    let matrix = [
        [1.5, -0.4, 0.3, 2.0],
        [0.2, 0.7, -0.6, -1.0],
        [-0.5, 0.1, 2.5, 0.5],
    ];
    let offset = matrix.map(|row| row[3]);
    let shapes = [cylinder(matrix)?, disk(matrix)?];
    let mut numbers = Numbers(5);
    for (scene, flat) in shapes.iter().zip([false, true]) {
        for _ in 0..2000 {
            let [u, v] = [
                0.5 + 0.499 * numbers.signed(),
                0.5 + 0.499 * numbers.signed(),
            ];
            let target = rotate(&matrix, object_point(flat, u, v));
            let origin = numbers.point().map(|x| 6.0 * x);
            let direction = [0, 1, 2].map(|axis| target[axis] + offset[axis] - origin[axis]);
            let Some(hit) = trace(scene, &ray(origin, direction)) else {
                panic!("{origin:?} {direction:?} misses")
            };
            // The near wall of a cylinder may stand before the target.
            assert!(hit.distance <= 1.00001, "{hit:?}");
            let object = object_point(flat, hit.u, hit.v);
            let of_surface = rotate(&matrix, object);
            for axis in [0, 1, 2] {
                let of_ray = origin[axis] + hit.distance * direction[axis];
                assert!(
                    (of_surface[axis] + offset[axis] - of_ray).abs() < 2e-5,
                    "{hit:?}"
                );
            }
            let tangents = if flat {
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
            } else {
                [[0.0, 0.0, 1.0], [-object[1], object[0], 0.0]]
            };
            for tangent in tangents.map(|tangent| rotate(&matrix, tangent)) {
                let product: f32 = (0..3).map(|axis| hit.normal[axis] * tangent[axis]).sum();
                assert!(product.abs() < 2e-5, "{hit:?}");
            }
        }
    }
    Ok(())
}

#[test]
fn shapes_that_describe_nothing_are_refused() {
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let refused = sphere([0.0; 3], radius).map(drop);
        assert!(
            matches!(
                refused,
                Err(Error::BadShape {
                    parameter: "radius",
                    ..
                })
            ),
            "{radius}"
        );
    }
    let refused = sphere([0.0, f32::NAN, 0.0], 1.0).map(drop);
    assert!(matches!(
        refused,
        Err(Error::BadShape {
            parameter: "centre",
            ..
        })
    ));
    let flat = [
        [1.0, 2.0, 3.0, 0.0],
        [2.0, 4.0, 6.0, 0.0],
        [0.0, 1.0, 0.1, 0.0],
    ];
    let mut infinite = IDENTITY;
    infinite[1][3] = f32::INFINITY;
    for matrix in [flat, infinite, [[0.0; 4]; 3]] {
        for refused in [disk(matrix).map(drop), cylinder(matrix).map(drop)] {
            let found = matches!(
                refused,
                Err(Error::BadShape {
                    parameter: "matrix",
                    ..
                })
            );
            assert!(found, "{matrix:?}");
        }
    }
}
