//! Lines against segments of linear curves: the hulls of two spheres.
//!
//! Embree's callback solves quadratics for the two spheres and the cone between them. Here the
//! distance at which a line enters the sphere at each place along the segment is minimised over all
//! places: points and places of a hull are a convex set, so that there is one minimum. It is slow, and
//! it has nothing in common with the other.

use embree4_sys::CurveBuffer;
use glam::DVec3;

use super::line::{Box3, Crossing, Line};

/// Steps of a search by thirds: enough for the last bit of a double.
const STEPS: u32 = 90;

/// A segment.
#[derive(Clone, Copy)]
struct Cone {
    start: DVec3,
    along: DVec3,
    start_radius: f64,
    widening: f64,
}

impl Cone {
    fn of(curves: &CurveBuffer, segment: usize) -> Self {
        let first = curves.segments()[segment] as usize;
        let [start, end] = [first, first + 1].map(|index| curves.points()[index].map(f64::from));
        let place = |[x, y, z, _]: [f64; 4]| DVec3::new(x, y, z);
        Self {
            start: place(start),
            along: place(end) - place(start),
            start_radius: start[3],
            widening: end[3] - start[3],
        }
    }

    fn centre(&self, place: f64) -> DVec3 {
        self.start + place * self.along
    }

    fn radius(&self, place: f64) -> f64 {
        self.start_radius + place * self.widening
    }

    /// How far a point lies outside of the hull, negative inside, and the place of the sphere that it
    /// is nearest to.
    fn depth(&self, point: DVec3) -> (f64, f64) {
        let depth = |place: f64| point.distance(self.centre(place)) - self.radius(place);
        let place = lowest([0.0, 1.0], depth);
        (depth(place), place)
    }

    /// The part of the segment whose spheres a line meets, forwards or backwards.
    fn places(&self, line: &Line) -> Option<[f64; 2]> {
        let along = line.direction.normalize();
        let across = |v: DVec3| v - along * v.dot(along);
        let (offset, slope) = (across(self.start - line.origin), across(self.along));
        let outside = |place: f64| (offset + place * slope).length() - self.radius(place);
        let inner = lowest([0.0, 1.0], outside);
        if outside(inner) > 0.0 {
            return None;
        }
        Some([0.0, 1.0].map(|end| {
            let (mut outer, mut inner) = (end, inner);
            if outside(outer) <= 0.0 {
                return outer;
            }
            for _ in 0..STEPS {
                let middle = 0.5 * (outer + inner);
                if outside(middle) > 0.0 {
                    outer = middle;
                } else {
                    inner = middle;
                }
            }
            inner
        }))
    }

    /// Where a line enters the hull, or leaves it, each with the place along the segment.
    fn ends(&self, line: &Line) -> Option<[(f64, f64); 2]> {
        let places = self.places(line)?;
        let length = line.direction.length();
        let along = line.direction / length;
        let ends = [-1.0, 1.0].map(|side| {
            let distance = |place: f64| {
                let to_centre = self.centre(place) - line.origin;
                let apart = to_centre.cross(along).length();
                let radius = self.radius(place);
                let half_chord = ((radius - apart) * (radius + apart)).max(0.0).sqrt();
                to_centre.dot(along) + side * half_chord
            };
            let place = lowest(places, |place| -side * distance(place));
            (distance(place) / length, place)
        });
        Some(ends)
    }
}

/// Where a convex function is lowest between two places.
fn lowest([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let ends = [low, high];
    for _ in 0..STEPS {
        let third = (high - low) / 3.0;
        if value(low + third) < value(high - third) {
            high -= third;
        } else {
            low += third;
        }
    }
    let middle = 0.5 * (low + high);
    let best = ends.into_iter().find(|end| value(*end) <= value(middle));
    best.unwrap_or(middle)
}

/// The end of a segment, less what searches leave.
const END: f64 = 1.0 - 1e-9;

/// Whether what lies on the sphere at a place of a segment is no surface: inside of a neighbour, or on
/// the sphere that is shared with the next one, to which it belongs.
fn is_covered(curves: &CurveBuffer, segment: usize, place: f64, point: DVec3) -> bool {
    let segments = curves.segments();
    let is_inside = |neighbour: usize| {
        let cone = Cone::of(curves, neighbour);
        let (depth, at) = cone.depth(point);
        depth < -1e-7 * cone.radius(at)
    };
    let follows = |first: usize, second: usize| {
        second < segments.len() && segments[first] + 1 == segments[second]
    };
    (segment > 0 && follows(segment - 1, segment) && is_inside(segment - 1))
        || (follows(segment, segment + 1) && (place >= END || is_inside(segment + 1)))
}

/// Where a line crosses the hull of a segment.
pub(super) fn cross(curves: &CurveBuffer, segment: usize, line: &Line) -> Option<Crossing> {
    let cone = Cone::of(curves, segment);
    let ends = cone.ends(line)?;
    let (distance, place) = ends.into_iter().find(|&(distance, place)| {
        line.accepts(distance) && !is_covered(curves, segment, place, line.at(distance))
    })?;
    Some(Crossing {
        distance,
        u: place,
        v: 0.0,
        normal: (line.at(distance) - cone.centre(place)).normalize(),
    })
}

/// The box around a segment.
pub(super) fn bounds(curves: &CurveBuffer, segment: usize) -> Box3 {
    let cone = Cone::of(curves, segment);
    let ends = [0.0, 1.0].map(|place| {
        let reach = DVec3::splat(cone.radius(place));
        Box3 {
            low: cone.centre(place) - reach,
            high: cone.centre(place) + reach,
        }
    });
    Box3 {
        low: ends[0].low.min(ends[1].low),
        high: ends[0].high.max(ends[1].high),
    }
}
