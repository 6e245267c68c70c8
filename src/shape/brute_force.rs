//! Rays against single shapes without a tracer, for tests.

use super::{Curves, Shape, ShapeHit, ShapeModel, Sphere, SurfacePoint, TriangleMesh};
use crate::math::{Mat3, Mat4, Vec2, Vec3};

/// All points where a line from `from` along `direction` meets a shape, ahead of `from`.
pub(crate) fn crossings(shape: &Shape, from: Vec3, direction: Vec3) -> Vec<SurfacePoint> {
    let at = |t: f32, primitive: u32, barycentrics: Vec2| {
        shape.surface_at(&ShapeHit {
            primitive,
            barycentrics,
            position: from + direction * t,
        })
    };
    let ahead = |ts: Vec<f32>| -> Vec<SurfacePoint> {
        let ts = ts.into_iter().filter(|t| *t > 0.0);
        ts.map(|t| at(t, 0, Vec2::ZERO)).collect()
    };
    let to_object = |rows: [[f32; 4]; 3]| {
        let column = |i: usize| Vec3::new(rows[0][i], rows[1][i], rows[2][i]);
        let map = Mat4::from_cols(
            column(0).extend(0.0),
            column(1).extend(0.0),
            column(2).extend(0.0),
            column(3).extend(1.0),
        );
        let inverse = map.inverse();
        (
            inverse.transform_point3(from),
            inverse.transform_vector3(direction),
        )
    };
    match shape {
        Shape::Sphere(s) => ahead(sphere_crossings(s, from, direction)),
        Shape::Curves(curves) => curve_crossings(curves, from, direction)
            .into_iter()
            .map(|(t, primitive, along)| at(t, primitive, Vec2::new(along, 0.0)))
            .collect(),
        Shape::Disk(d) => {
            let (o, d) = to_object(d.to_world());
            let t = -o.z / d.z;
            let inside = (o + d * t).truncate().length() <= 1.0;
            ahead(if inside { vec![t] } else { vec![] })
        }
        Shape::Cylinder(c) => {
            let (o, d) = to_object(c.to_world());
            let (o2, d2) = (o.truncate().as_dvec2(), d.truncate().as_dvec2());
            let ts = roots(d2.length_squared(), o2.dot(d2), o2.length_squared() - 1.0);
            let on_wall = |t: &f32| (0.0..=1.0).contains(&(o.z + d.z * t));
            ahead(ts.into_iter().filter(on_wall).collect())
        }
        Shape::TriangleMesh(mesh) => (0..mesh.triangles().as_slice().len() as u32)
            .filter_map(|primitive| {
                let (t, barycentrics) = triangle_crossing(mesh, primitive, from, direction)?;
                Some(at(t, primitive, barycentrics))
            })
            .collect(),
    }
}

/// In f64: seen from afar, a sphere is lost in the rounding of f32.
fn sphere_crossings(sphere: &Sphere, from: Vec3, direction: Vec3) -> Vec<f32> {
    let (o, d) = ((from - sphere.centre()).as_dvec3(), direction.as_dvec3());
    let radius = f64::from(sphere.radius());
    let c = o.length_squared() - radius * radius;
    roots(d.length_squared(), o.dot(d), c)
}

/// Distances along a ray of unit length where it enters or leaves a curve: found by looking at many
/// points of it, each against many points of every segment's axis.
///
/// Returns distance, segment and place along the segment.
fn curve_crossings(curves: &Curves, from: Vec3, direction: Vec3) -> Vec<(f32, u32, f32)> {
    const STEPS: u32 = 4000;
    const REACH: f64 = 8.0;
    let mut found = Vec::new();
    for segment in 0..curves.segment_count() as u32 {
        let depth = |t: f64| {
            let point = from.as_dvec3() + direction.as_dvec3() * t;
            let distances = (0..=400_u32).map(|i| {
                let along = f64::from(i) / 400.0;
                let (centre, radius) = curves.axis_point(segment, along);
                (centre.distance(point) - radius, along)
            });
            let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
            nearest.unwrap_or((f64::INFINITY, 0.0))
        };
        let ts = (0..=STEPS).map(|i| REACH * f64::from(i) / f64::from(STEPS));
        let ts: Vec<f64> = ts.collect();
        for pair in ts.windows(2) {
            let (mut near, mut far) = (pair[0], pair[1]);
            if (depth(near).0 > 0.0) == (depth(far).0 > 0.0) {
                continue;
            }
            for _ in 0..40 {
                let middle = 0.5 * (near + far);
                if (depth(middle).0 > 0.0) == (depth(near).0 > 0.0) {
                    near = middle;
                } else {
                    far = middle;
                }
            }
            found.push((near as f32, segment, depth(near).1 as f32));
        }
    }
    found
}

/// Roots of a·t² + 2·b·t + c.
fn roots(a: f64, b: f64, c: f64) -> Vec<f32> {
    let discriminant = b * b - a * c;
    if discriminant <= 0.0 {
        return vec![];
    }
    let root = discriminant.sqrt();
    [(-b - root) / a, (-b + root) / a]
        .map(|t| t as f32)
        .to_vec()
}

fn triangle_crossing(
    mesh: &TriangleMesh,
    primitive: u32,
    from: Vec3,
    direction: Vec3,
) -> Option<(f32, Vec2)> {
    let corners = mesh.triangles().as_slice()[primitive as usize];
    let [a, b, c] = corners.map(|i| Vec3::from_array(mesh.vertices().as_slice()[i as usize]));
    let columns = Mat3::from_cols(b - a, c - a, -direction);
    let solution = columns.inverse() * (from - a);
    let inside = solution.x >= 0.0 && solution.y >= 0.0 && solution.x + solution.y <= 1.0;
    (inside && solution.z > 0.0).then_some((solution.z, solution.truncate()))
}
