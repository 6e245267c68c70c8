//! Random triangles against a brute-force referee in double precision.

use embree4_sys::{BuildOptions, Device, Error, IndexBuffer, Ray, SceneBuilder, VertexBuffer};

use crate::Numbers;

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A crossing of the ray with the plane of a triangle.
struct Crossing {
    distance: f64,
    /// The smallest barycentric coordinate: how far inside the triangle, negative outside.
    inside: f64,
}

/// Source: Möller, Trumbore 1997.
fn cross_triangle(ray: &Ray, corners: [[f32; 3]; 3]) -> Crossing {
    let [first, second, third] = corners.map(|corner| corner.map(f64::from));
    let origin = ray.origin.map(f64::from);
    let direction = ray.direction.map(f64::from);
    let (edge, other_edge) = (minus(second, first), minus(third, first));
    let across = cross(direction, other_edge);
    let determinant = dot(edge, across);
    let from_first = minus(origin, first);
    let u = dot(from_first, across) / determinant;
    let along = cross(from_first, edge);
    let v = dot(direction, along) / determinant;
    let distance = dot(other_edge, along) / determinant;
    Crossing {
        distance,
        inside: u.min(v).min(1.0 - u - v),
    }
}

#[test]
fn hits_agree_with_brute_force() -> Result<(), Error> {
    for robust in [true, false] {
        let mut numbers = Numbers(20);
        let triangles: Vec<[[f32; 3]; 3]> = (0..300)
            .map(|_| {
                let middle = numbers.point();
                [(); 3].map(|()| {
                    let offset = numbers.point();
                    [0, 1, 2].map(|axis| middle[axis] + 0.3 * offset[axis])
                })
            })
            .collect();
        let indices = (0..300)
            .map(|first| [3 * first, 3 * first + 1, 3 * first + 2])
            .collect();
        let vertices = VertexBuffer::new(triangles.as_flattened().to_vec());
        let options = BuildOptions {
            robust,
            ..BuildOptions::default()
        };
        let mut builder = SceneBuilder::with_options(&Device::new("")?, options)?;
        builder.add_triangles(&vertices, &IndexBuffer::new(indices))?;
        let scene = builder.commit()?;
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..4000 {
            let far = 1.0 + numbers.signed();
            let direction = numbers.point();
            let ray = Ray {
                origin: numbers.point(),
                direction,
                near: 1e-3,
                far,
            };
            let crossings: Vec<Crossing> = triangles
                .iter()
                .map(|&corners| cross_triangle(&ray, corners))
                .collect();
            let margin = 1e-4;
            let range = f64::from(ray.near)..=f64::from(ray.far);
            // Rays within rounding of an edge or an end of the interval decide nothing.
            let unclear = crossings.iter().any(|crossing| {
                let near_end = (crossing.distance - range.start()).abs() < margin
                    || (crossing.distance - range.end()).abs() < margin;
                (crossing.inside.abs() < margin && range.contains(&crossing.distance))
                    || (near_end && crossing.inside > -margin)
            });
            if unclear {
                continue;
            }
            let expected = crossings
                .iter()
                .map(|crossing| (crossing.inside > 0.0, crossing.distance))
                .filter(|(inside, distance)| *inside && range.contains(distance))
                .map(|(_, distance)| distance)
                .min_by(f64::total_cmp);
            let found = scene
                .intersect(&ray)
                .map(|hit| (hit.primitive as usize, hit.distance));
            assert_eq!(scene.occluded(&ray), expected.is_some(), "{ray:?}");
            match (expected, found) {
                (None, None) => misses += 1,
                (Some(distance), Some((primitive, found))) => {
                    hits += 1;
                    let error = (f64::from(found) - distance).abs();
                    assert!(
                        error < 1e-4 * distance.max(0.1),
                        "{ray:?} {distance} {found}"
                    );
                    let named = crossings[primitive].distance;
                    assert!((named - distance).abs() < margin, "{ray:?}: wrong triangle");
                }
                other => panic!("{ray:?}: expected and found {other:?}"),
            }
        }
        assert!(
            hits > 500 && misses > 500,
            "{hits} hits and {misses} misses prove little"
        );
    }
    Ok(())
}
