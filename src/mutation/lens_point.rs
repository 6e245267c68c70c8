//! Moving the point of the lens that a path goes through.

use super::{Perturbation, Rejection};
use crate::math::warp;
use crate::path::{Path, PathSpace};
use crate::random::Stream;
use crate::sensor::SensorModel;

/// Moves the first vertex of a path by a uniform offset in a disk, where the sensor has a lens.
///
/// Moves beyond the lens are rejected, so that a move and its way back are equally likely.
///
/// Source: van Antwerpen 2011, Sec. 6.3.
#[inline]
pub(super) fn perturb(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    path: &mut Path,
    random: &mut Stream,
) -> Result<(), Rejection> {
    if !space.sensor.has_lens() {
        return Ok(());
    }
    let lens = &mut path.vertices_mut()[0];
    let offset = warp::uniform_disk(random.next_vec2()) * settings.lens;
    let coordinates = space.sensor.lens_coordinates(lens.position()) + offset;
    if coordinates.length_squared() > 1.0 {
        return Err(Rejection::OffImage);
    }
    lens.point.position = space.sensor.lens_point(coordinates);
    Ok(())
}
