//! Moving the point of the lens that a path goes through.

use super::{Perturbation, Rejection};
use crate::math::{Vec3, warp};
use crate::path::PathSpace;
use crate::random::Stream;
use crate::sensor::SensorModel;

/// Moves a point of the lens by a uniform offset in a disk, where the sensor has a lens.
///
/// - `point`: in world space, as what returns.
///
/// # Errors
/// Moves beyond the lens are rejected, so that a move and its way back are equally likely.
///
/// Source: van Antwerpen 2011, Sec. 6.3.
#[inline]
pub(super) fn perturb(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    point: Vec3,
    random: &mut Stream,
) -> Result<Vec3, Rejection> {
    if !space.sensor.has_lens() {
        return Ok(point);
    }
    let offset = warp::uniform_disk(random.next_vec2()) * settings.lens;
    let coordinates = space.sensor.lens_coordinates(point) + offset;
    if coordinates.length_squared() > 1.0 {
        return Err(Rejection::OffImage);
    }
    Ok(space.sensor.lens_point(coordinates))
}
