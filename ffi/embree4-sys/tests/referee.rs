//! Random triangles against a brute-force referee in double precision.

use embree4_sys::{
    BuildOptions, CommittedScene, Device, Error, IndexBuffer, Ray, SceneBuilder, VertexBuffer,
};

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

/// Nearer than this, a ray to an edge or an interval to its end, rounding decides.
const MARGIN: f64 = 1e-4;

/// What brute force says about a ray, given its crossings with all triangles.
///
/// Returns the distance of the nearest hit, if there is one; `None` where rounding decides.
fn judged(ray: &Ray, crossings: &[Crossing]) -> Option<Option<f64>> {
    let range = f64::from(ray.near)..=f64::from(ray.far);
    let is_unclear = |crossing: &Crossing| {
        let near_end = (crossing.distance - range.start()).abs() < MARGIN
            || (crossing.distance - range.end()).abs() < MARGIN;
        (crossing.inside.abs() < MARGIN && range.contains(&crossing.distance))
            || (near_end && crossing.inside > -MARGIN)
    };
    if crossings.iter().any(is_unclear) {
        return None;
    }
    let distances = crossings
        .iter()
        .filter(|crossing| crossing.inside > 0.0 && range.contains(&crossing.distance))
        .map(|crossing| crossing.distance);
    Some(distances.min_by(f64::total_cmp))
}

fn random_triangles(numbers: &mut Numbers) -> Vec<[[f32; 3]; 3]> {
    let triangle = |_| {
        let middle = numbers.point();
        [(); 3].map(|()| {
            let offset = numbers.point();
            [0, 1, 2].map(|axis| middle[axis] + 0.3 * offset[axis])
        })
    };
    (0..300).map(triangle).collect()
}

fn random_ray(numbers: &mut Numbers) -> Ray {
    let far = 1.0 + numbers.signed();
    let direction = numbers.point();
    Ray {
        origin: numbers.point(),
        direction,
        near: 1e-3,
        far,
    }
}

fn built(triangles: &[[[f32; 3]; 3]], robust: bool) -> Result<CommittedScene, Error> {
    let indices = (0..triangles.len() as u32)
        .map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner))
        .collect();
    let vertices = VertexBuffer::new(triangles.as_flattened().to_vec());
    let options = BuildOptions {
        robust,
        ..BuildOptions::default()
    };
    let mut builder = SceneBuilder::with_options(&Device::new("")?, options)?;
    builder.add_triangles(&vertices, &IndexBuffer::new(indices))?;
    builder.commit()
}

#[test]
fn hits_agree_with_brute_force() -> Result<(), Error> {
    for robust in [true, false] {
        let mut numbers = Numbers(20);
        let triangles = random_triangles(&mut numbers);
        let scene = built(&triangles, robust)?;
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..4000 {
            let ray = random_ray(&mut numbers);
            let crossings: Vec<Crossing> = triangles
                .iter()
                .map(|&corners| cross_triangle(&ray, corners))
                .collect();
            let Some(expected) = judged(&ray, &crossings) else {
                continue;
            };
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
                    assert!((named - distance).abs() < MARGIN, "{ray:?}: wrong triangle");
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
