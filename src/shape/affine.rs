//! What transforms may do to shapes that must stay round.

use glam::DVec3;

use super::ShapeError;
use crate::math::{Mat4, Vec3};

/// By what part of their lengths axes may differ, or lean towards each other, and still count as
/// equal or perpendicular: files write matrices with few digits.
const ROUND: f64 = 1e-3;

/// The images of the three axes and of the origin.
///
/// # Errors
/// [`ShapeError::NotFinite`].
pub(super) fn axes_and_origin(to_world: Mat4) -> Result<([DVec3; 3], DVec3), ShapeError> {
    if !to_world.is_finite() {
        return Err(ShapeError::NotFinite);
    }
    let column = |axis: glam::Vec4| axis.truncate().as_dvec3();
    let axes = [to_world.x_axis, to_world.y_axis, to_world.z_axis].map(column);
    Ok((axes, column(to_world.w_axis)))
}

/// Checks that two axes are of one length and perpendicular.
///
/// # Errors
/// [`ShapeError::Flat`] and [`ShapeError::Stretched`].
pub(super) fn check_circular(x: DVec3, y: DVec3) -> Result<(), ShapeError> {
    let (a, b) = (x.length(), y.length());
    if a == 0.0 || b == 0.0 {
        return Err(ShapeError::Flat);
    }
    if (a - b).abs() > ROUND * a.max(b) {
        return Err(ShapeError::Stretched);
    }
    check_perpendicular(x, y)
}

/// Checks that two axes are perpendicular.
///
/// # Errors
/// [`ShapeError::Stretched`].
pub(super) fn check_perpendicular(x: DVec3, y: DVec3) -> Result<(), ShapeError> {
    if x.dot(y).abs() > ROUND * x.length() * y.length() {
        return Err(ShapeError::Stretched);
    }
    Ok(())
}

/// An affine map by rows, as the tracer takes it.
pub(super) fn rows(axes: [Vec3; 3], origin: Vec3) -> [[f32; 4]; 3] {
    let [x, y, z] = axes;
    [0, 1, 2].map(|row| [x[row], y[row], z[row], origin[row]])
}
