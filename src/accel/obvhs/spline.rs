//! Lines against segments of B-spline curves: circles across an axis, open at both ends.
//!
//! A segment is cut into short pieces. Along the part of the line near a piece, the distance from the
//! surface falls and rises again; its lowest place is found, then the roots before and behind it. It is
//! slow, and it has nothing in common with Embree's own iteration.

use embree4_sys::CurveBuffer;
use glam::DVec3;

use super::line::{Box3, Crossing, Line};

/// Pieces of a segment.
const PIECES: u32 = 8;

/// A cubic segment, and its radius along it.
struct Spline {
    points: [DVec3; 4],
    radii: [f64; 4],
}

/// A point of the axis with its derivatives.
struct Axis {
    centre: DVec3,
    along: DVec3,
    bend: DVec3,
    radius: f64,
    widening: f64,
}

impl Spline {
    fn of(curves: &CurveBuffer, segment: usize) -> Self {
        let first = curves.segments()[segment] as usize;
        let points = [0, 1, 2, 3].map(|i| curves.points()[first + i].map(f64::from));
        Self {
            points: points.map(|[x, y, z, _]| DVec3::new(x, y, z)),
            radii: points.map(|point| point[3]),
        }
    }

    fn axis(&self, u: f64) -> Axis {
        let rest = 1.0 - u;
        let values = [
            rest * rest * rest / 6.0,
            (4.0 - 6.0 * u * u + 3.0 * u * u * u) / 6.0,
            (4.0 - 6.0 * rest * rest + 3.0 * rest * rest * rest) / 6.0,
            u * u * u / 6.0,
        ];
        let slopes = [
            -0.5 * rest * rest,
            -2.0 * u + 1.5 * u * u,
            2.0 * rest - 1.5 * rest * rest,
            0.5 * u * u,
        ];
        let bends = [rest, 3.0 * u - 2.0, 1.0 - 3.0 * u, u];
        let place = |weights: [f64; 4]| -> DVec3 {
            let terms = self.points.iter().zip(weights);
            terms.map(|(point, weight)| *point * weight).sum()
        };
        let radius = |weights: [f64; 4]| -> f64 {
            let terms = self.radii.iter().zip(weights);
            terms.map(|(radius, weight)| radius * weight).sum()
        };
        Axis {
            centre: place(values),
            along: place(slopes),
            bend: place(bends),
            radius: radius(values),
            widening: radius(slopes),
        }
    }

    /// The place near `u` whose plane across the axis holds a point.
    fn foot(&self, point: DVec3, mut u: f64) -> f64 {
        for _ in 0..8 {
            let axis = self.axis(u);
            let offset = point - axis.centre;
            let slope = axis.along.length_squared() - offset.dot(axis.bend);
            let step = offset.dot(axis.along) / slope;
            if !step.is_finite() {
                break;
            }
            u = (u + step).clamp(-0.25, 1.25);
            if step.abs() < 1e-15 {
                break;
            }
        }
        u
    }

    /// Distances at which a line goes through the surface of a piece, with the places along it.
    fn piece(&self, line: &Line, piece: u32) -> Vec<(f64, f64)> {
        let [from, to] = [piece, piece + 1].map(|i| f64::from(i) / f64::from(PIECES));
        let middle = 0.5 * (from + to);
        let ends = [from, to].map(|u| self.axis(u).centre);
        let chord = 0.5 * ends[0].distance(ends[1]);
        let [a, b, c, d] = self.points;
        let bend = (a - 2.0 * b + c).length().max((b - 2.0 * c + d).length());
        let width = to - from;
        let widest = self.radii.iter().fold(0.0, |a: f64, b| a.max(*b));
        // A ball around the piece and its surface, and a little of its neighbours.
        let reach = 1.1 * (chord + widest + bend * width * width);
        let to_middle = 0.5 * (ends[0] + ends[1]) - line.origin;
        let speed = line.direction.length();
        let unit = line.direction / speed;
        let apart = to_middle.cross(unit).length();
        if apart.is_nan() || apart > reach {
            return Vec::new();
        }
        let half = (reach * reach - apart * apart).sqrt();
        let nearest = to_middle.dot(unit);
        let outside = |way: f64| {
            let point = line.origin + way * unit;
            let u = self.foot(point, middle);
            let axis = self.axis(u);
            (point.distance(axis.centre) - axis.radius, u)
        };
        let (low, high) = (nearest - half, nearest + half);
        let bottom = lowest(low, high, |way| outside(way).0);
        if outside(bottom).0 >= 0.0 {
            return Vec::new();
        }
        let roots = [low, high].into_iter().filter(|end| outside(*end).0 > 0.0);
        let roots = roots.map(|end| root(end, bottom, |way| outside(way).0));
        let roots = roots.map(|way| (way / speed, outside(way).1));
        roots.filter(|(_, u)| (from..=to).contains(u)).collect()
    }
}

/// Where a function that falls and rises again is lowest.
fn lowest(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..90 {
        let third = (high - low) / 3.0;
        if value(low + third) < value(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    0.5 * (low + high)
}

/// Where a function is zero between an argument with a positive and one with a negative value.
fn root(mut positive: f64, mut negative: f64, value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..70 {
        let middle = 0.5 * (positive + negative);
        if value(middle) > 0.0 {
            positive = middle;
        } else {
            negative = middle;
        }
    }
    0.5 * (positive + negative)
}

/// Where a line crosses the surface of a segment.
pub(super) fn cross(curves: &CurveBuffer, segment: usize, line: &Line) -> Option<Crossing> {
    let spline = Spline::of(curves, segment);
    let found = (0..PIECES).flat_map(|piece| spline.piece(line, piece));
    let accepted = found.filter(|(distance, _)| line.accepts(*distance));
    let (distance, u) = accepted.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let axis = spline.axis(u);
    let offset = line.at(distance) - axis.centre;
    // The gradient of the distance from the surface: the circle that a point belongs to moves with it.
    let slope = axis.along.length_squared() - offset.dot(axis.bend);
    let normal = offset.normalize() - axis.along * (axis.widening / slope);
    Some(Crossing {
        distance,
        u,
        v: 0.0,
        normal: normal.normalize(),
    })
}

/// The box around a segment: it stays within the hull of its control points.
pub(super) fn bounds(curves: &CurveBuffer, segment: usize) -> Box3 {
    let spline = Spline::of(curves, segment);
    let widest = spline.radii.iter().fold(0.0, |a: f64, b| a.max(*b));
    let hull = Box3::around(spline.points);
    Box3 {
        low: hull.low - widest,
        high: hull.high + widest,
    }
}
