//! Lines against triangles, without gaps between neighbours.

use glam::DVec3;

use super::line::{Crossing, Line};

/// By how much edges are let out, as a part of the area: meshes that touch without sharing corners, as
/// walls do that were turned by different matrices, have cracks of as much.
const LET_OUT: f64 = 4e-15;

/// Where a line crosses a triangle; its edges belong to it.
///
/// Neighbours compute the same number for the edge that they share, so that no line slips through
/// between them.
///
/// Source: Woop, Benthin & Wald 2013.
/// Differs: all is in double precision, so that a number is zero for lines through the edge alone, and
/// no second attempt is needed.
pub(super) fn cross(corners: [DVec3; 3], line: &Line) -> Option<Crossing> {
    let [along, across, up] = line.axes;
    let direction = line.direction;
    let shear = [across, up].map(|axis| direction[axis] / direction[along]);
    let from_origin = corners.map(|corner| corner - line.origin);
    let [a, b, c] = from_origin.map(|corner| {
        [
            corner[across] - shear[0] * corner[along],
            corner[up] - shear[1] * corner[along],
        ]
    });
    // Twice the area of the triangle that the line's point makes with an edge.
    let area = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let weights = [area(b, c), area(c, a), area(a, b)];
    let sum = weights[0] + weights[1] + weights[2];
    let slack = LET_OUT * sum.abs();
    if weights.iter().any(|w| *w < -slack) && weights.iter().any(|w| *w > slack) {
        return None;
    }
    // In the plane of the triangle, or with not-a-number.
    if sum.is_nan() || sum == 0.0 {
        return None;
    }
    let depth: f64 = weights
        .iter()
        .zip(from_origin)
        .map(|(weight, corner)| weight * corner[along])
        .sum();
    let distance = depth / (sum * direction[along]);
    if !line.accepts(distance) {
        return None;
    }
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    // Corners on one line leave a sum of nothing but rounding.
    (normal != DVec3::ZERO).then(|| Crossing {
        distance,
        u: weights[1] / sum,
        v: weights[2] / sum,
        normal,
    })
}
