//! What the C callbacks need to know about a sphere, disk or cylinder, computed once.
//!
//! Spheres are user geometries too, not Embree's sphere points, which lose on both counts. In a box
//! with two spheres they trace 8.4 million diffuse bounces a second on one core (4.4.0; 8.1 with
//! 3.13.5) against 9.6 (9.2) here, and they compute in single precision: on a unit sphere the worst
//! point that the normal stands for is off by 4e-7 from just inside, 2e-6 from a distance of 3 and
//! 6e-5 from 100, against 5e-8, the rounding of the normal itself, from everywhere here; from 10⁶
//! away they miss some rays that hit.

use crate::bindings::{self, ShimShape};
use crate::buffers::VertexBuffer;
use crate::error::Error;

/// Which callbacks a shape uses.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Sphere,
    Disk,
    Cylinder,
}

impl Kind {
    pub(crate) fn to_shim(self) -> bindings::ShimKind {
        match self {
            Self::Sphere => bindings::SHIM_SPHERE,
            Self::Disk => bindings::SHIM_DISK,
            Self::Cylinder => bindings::SHIM_CYLINDER,
        }
    }
}

/// Finds what makes a sphere unusable.
///
/// # Errors
/// As [`crate::SceneBuilder::add_sphere`].
pub fn check_sphere(center: [f32; 3], radius: f32) -> Result<(), Error> {
    let bad = |parameter, value| {
        Err(Error::BadShape {
            what: "a sphere",
            parameter,
            value,
        })
    };
    if !(radius > 0.0 && radius <= VertexBuffer::LARGEST) {
        return bad(
            "radius",
            format!("{radius}; it must be positive and finite"),
        );
    }
    if !center
        .iter()
        .all(|coordinate| coordinate.abs() <= VertexBuffer::LARGEST)
    {
        return bad("centre", format!("{center:?}; it must be finite"));
    }
    Ok(())
}

/// Finds what makes an affine map unusable.
///
/// - `what`: what it places, as in "a disk".
/// - `to_world`: by rows; the last column is the translation.
///
/// # Errors
/// As [`crate::SceneBuilder::add_instance`].
pub fn check_map(what: &'static str, to_world: &[[f32; 4]; 3]) -> Result<(), Error> {
    check_invertible(what, to_world).map(drop)
}

/// The sphere around `center` with `radius`, both in scene units.
pub(crate) fn sphere(center: [f32; 3], radius: f32) -> Result<ShimShape, Error> {
    check_sphere(center, radius)?;
    let origin = center.map(f64::from);
    let radius = f64::from(radius);
    let (lower, upper) = outward_box(origin.map(|middle| (middle - radius, middle + radius)));
    Ok(ShimShape {
        lower,
        upper,
        origin,
        radius,
        to_object: [[0.0; 3]; 3],
    })
}

/// The disk or cylinder that `to_world` makes of the unit one.
///
/// - `to_world`: object to world, by rows; the last column is the translation.
pub(crate) fn transformed(kind: Kind, to_world: &[[f32; 4]; 3]) -> Result<ShimShape, Error> {
    let what = match kind {
        Kind::Sphere => "a sphere",
        Kind::Disk => "a disk",
        Kind::Cylinder => "a cylinder",
    };
    let to_object = check_invertible(what, to_world)?;
    let rows = to_world.map(|row| row.map(f64::from));
    let height = match kind {
        Kind::Cylinder => 1.0,
        Kind::Sphere | Kind::Disk => 0.0,
    };
    let (lower, upper) = outward_box(rows.map(|[x, y, z, offset]| {
        let reach = x.hypot(y);
        let end = z * height;
        (offset + end.min(0.0) - reach, offset + end.max(0.0) + reach)
    }));
    let origin = rows.map(|[_, _, _, offset]| offset);
    Ok(ShimShape {
        lower,
        upper,
        origin,
        radius: 1.0,
        to_object,
    })
}

/// The inverse of a matrix's linear part, by rows; an error if it has none, or if an entry is not
/// finite or beyond what Embree can bound.
pub(crate) fn check_invertible(
    what: &'static str,
    to_world: &[[f32; 4]; 3],
) -> Result<[[f64; 3]; 3], Error> {
    let bad = |reason: &str| Error::BadShape {
        what,
        parameter: "matrix",
        value: format!("{to_world:?}; {reason}"),
    };
    if !to_world
        .iter()
        .flatten()
        .all(|entry| entry.abs() <= VertexBuffer::LARGEST)
    {
        return Err(bad("its entries must be finite"));
    }
    inverse(&to_world.map(|row| row.map(f64::from)))
        .ok_or_else(|| bad("it flattens space and has no inverse"))
}

/// Inverse of the linear part, by rows; `None` if it maps space onto a plane or less.
fn inverse(rows: &[[f64; 4]; 3]) -> Option<[[f64; 3]; 3]> {
    let columns = [0, 1, 2].map(|column| rows.map(|row| row[column]));
    let lengths = columns.map(|column| dot(column, column).sqrt());
    let cofactors = [
        cross(columns[1], columns[2]),
        cross(columns[2], columns[0]),
        cross(columns[0], columns[1]),
    ];
    let determinant = dot(columns[0], cofactors[0]);
    // Relative, so that a shape may be of any size; single-precision entries leave about 1e-7 of
    // noise per column, so flatter than this nothing real is.
    let flat = 1e-12 * lengths[0] * lengths[1] * lengths[2];
    let inverse = cofactors.map(|row| row.map(|entry| entry / determinant));
    let usable =
        determinant.abs() > flat && inverse.iter().flatten().all(|entry| entry.is_finite());
    usable.then_some(inverse)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A single-precision box around intervals per axis, a little larger than needed.
///
/// Embree finds user geometry by plain single-precision slab tests, whatever the scene's options
/// say. The margin covers their rounding for rays that start within a few times the box's distance
/// from the origin, so that the rim is not cut off.
fn outward_box(intervals: [(f64, f64); 3]) -> ([f32; 3], [f32; 3]) {
    let reach = intervals
        .iter()
        .fold(0.0, |reach: f64, &(low, high)| reach.max(-low).max(high));
    let margin = 4.0 * f64::from(f32::EPSILON) * reach;
    let lower = intervals.map(|(low, _)| nearest(low - margin));
    let upper = intervals.map(|(_, high)| nearest(high + margin));
    (lower, upper)
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "rounding to the nearest float is wanted"
)]
fn nearest(value: f64) -> f32 {
    value as f32
}
