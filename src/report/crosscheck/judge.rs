//! Which answers can be right for a ray that is off by no more than the rounding of floats.

use glam::DVec3;

use super::exact::{Exact, Line};
use super::referee::{Crossing, Referee};
use super::subject::{Id, Place};
use crate::accel::{Hit, Ray};

/// Rounding errors of half a unit in the last place that a tracer in single precision may add up: its
/// corners as seen from the origin, edges, products of both, and their sums.
const ROUNDINGS: f64 = 16.0;
/// What a rounding is, as a part of a number.
const ROUNDING: f64 = 1.0 / 16_777_216.0;
/// Of B-splines Embree finds the root by an iteration of its own in single precision.
const SPLINE: f64 = 16.0;
/// Directions in which rays are moved aside.
const DIRECTIONS: u32 = 8;
/// How far they are moved, in tolerances.
const SHIFTS: [f64; 3] = [1.0, 0.5, 0.1];
/// What single precision leaves uncertain of a primitive on a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    /// Across the ray, in the primitive's space.
    pub(super) own: f64,
    /// How far a corner moves when each edge moves by as much, seen along the ray.
    pub(super) corner: f64,
    /// The same in the world.
    pub(super) world: f64,
    /// Along the surface, in the primitive's space.
    pub(super) along: f64,
    /// Of distances, in multiples of the ray's direction.
    pub(super) distance: f64,
}

/// A primitive as a ray sees it.
pub(super) struct Seen {
    pub(super) exact: Exact,
    pub(super) line: Line,
    place: Option<Place>,
}

impl Referee<'_> {
    /// A primitive as a ray sees it.
    pub(super) fn seen(&self, ray: &Ray, id: Id) -> Seen {
        let place = id.instance.map(|instance| self.subject.place(instance));
        let line = Line::of(ray);
        Seen {
            exact: self.subject.exact(id),
            line: place.as_ref().map_or(line, |place| place.line(&line)),
            place,
        }
    }

    /// Whether a ray that is off by the tolerance may hit what a tracer says it does.
    pub(super) fn may_hit(&self, ray: &Ray, hit: &Hit) -> bool {
        let in_interval = ray.near() <= hit.distance && hit.distance <= ray.far();
        let seen = self.seen(ray, self.subject.id(hit));
        let distance = f64::from(hit.distance);
        let tolerance = seen.tolerance(ray, distance);
        in_interval && seen.exact.gap(&seen.line, distance, tolerance.distance) <= tolerance.corner
    }

    /// Whether a ray that is off by the tolerance may be free up to a distance.
    ///
    /// - `aside`: the tolerance in the world.
    pub(super) fn may_be_free(&self, ray: &Ray, limit: f64, aside: f64) -> bool {
        let limit = limit.min(f64::from(ray.far()));
        let near = f64::from(ray.near());
        beside(ray, aside).any(|line| {
            !self.crossings(&line, &mut |crossing| {
                let slack = tolerance(ray, crossing).distance;
                crossing.distance - slack > near && crossing.distance + slack < limit
            })
        })
    }

    /// Whether all that blocks a ray before a distance is such that single precision cannot tell: met
    /// within tolerance of an edge, where the sides of all edges around a corner are rounded each by
    /// itself, or in whose plane the ray lies.
    pub(super) fn may_leak(&self, ray: &Ray, limit: f64) -> bool {
        let limit = limit.min(f64::from(ray.far()));
        let near = f64::from(ray.near());
        !self.crossings(&Line::of(ray), &mut |crossing| {
            let Tolerance { own, distance, .. } = tolerance(ray, crossing);
            let is_before =
                crossing.distance - distance > near && crossing.distance + distance < limit;
            let place = crossing.distance;
            is_before && crossing.exact.border(crossing.line, place, distance) > own
        })
    }

    /// Whether a ray lies in the plane of what a tracer says that it hits, as far as single precision can
    /// tell: there all edges have the ray on them, and any distance is as good as another.
    pub(super) fn is_edge_on(&self, ray: &Ray, hit: &Hit) -> bool {
        let seen = self.seen(ray, self.subject.id(hit));
        let tolerance = seen.tolerance(ray, f64::from(hit.distance));
        tolerance.distance.is_infinite()
    }

    /// Whether a ray that is off by the tolerance may meet anything.
    pub(super) fn may_meet(&self, ray: &Ray, aside: f64) -> bool {
        let (near, far) = (f64::from(ray.near()), f64::from(ray.far()));
        beside(ray, aside).any(|line| {
            self.crossings(&line, &mut |crossing| {
                let slack = tolerance(ray, crossing).distance;
                near <= far && crossing.distance + slack >= near && crossing.distance - slack <= far
            })
        })
    }

    /// The largest tolerance in the world of what a ray crosses within its interval; where that is
    /// nothing, the tolerance of all that there is.
    pub(super) fn aside(&self, ray: &Ray) -> f64 {
        let (near, far) = (f64::from(ray.near()), f64::from(ray.far()));
        let mut aside = 0.0_f64;
        self.crossings(&Line::of(ray), &mut |crossing| {
            let tolerance = tolerance(ray, crossing);
            let is_near = crossing.distance + tolerance.distance >= near
                && crossing.distance - tolerance.distance <= far;
            if is_near {
                aside = aside.max(tolerance.world);
            }
            false
        });
        if aside > 0.0 {
            return aside;
        }
        let [low, high] = self.bounds();
        let origin = ray.origin().as_dvec3();
        let reach = (low - origin).abs().max((high - origin).abs()).length();
        ROUNDINGS * ROUNDING * reach
    }
}

impl Seen {
    pub(super) fn tolerance(&self, ray: &Ray, distance: f64) -> Tolerance {
        tolerance_of(ray, distance, &self.exact, &self.line, self.place.as_ref())
    }
}

fn tolerance(ray: &Ray, crossing: &Crossing<'_>) -> Tolerance {
    tolerance_of(
        ray,
        crossing.distance,
        crossing.exact,
        crossing.line,
        crossing.place,
    )
}

fn tolerance_of(
    ray: &Ray,
    distance: f64,
    exact: &Exact,
    line: &Line,
    place: Option<&Place>,
) -> Tolerance {
    let travelled = line.direction.length() * distance.abs();
    let products = place.map_or(0.0, |place| place.products(ray, distance.abs()));
    let size = exact.reach(line.origin).max(travelled) + products;
    let is_spline = matches!(exact, Exact::Round(round) if round.is_spline());
    let factor = if is_spline { SPLINE } else { 1.0 };
    let own = factor * ROUNDINGS * ROUNDING * size;
    let speed = line.direction.length();
    let normal = exact.normal(line.at(distance));
    // What is uncertain of the normal of a sliver is uncertain of the cosine.
    let doubt = (4.0 * own / exact.width()).min(1.0);
    let cosine = (normal.dot(line.direction) / speed).abs() - doubt;
    // The normal is the cross product of two edges, whose rounding tilts the plane along the longest.
    let tilt = ROUNDINGS * ROUNDING * exact.longest() * exact.stretch();
    // A ray that runs within a surface has no distance to speak of: it may be met anywhere on it.
    let longest = exact.longest_graze(own);
    let along = if cosine > 0.0 {
        ((own + tilt) / cosine).min(longest)
    } else {
        longest
    };
    // Edges that meet at a small angle, as the ray sees it, have their corner moved by more.
    let corner = match exact {
        Exact::Triangle(_) if cosine > 0.0 => own * exact.stretch() / cosine,
        _ => own,
    };
    Tolerance {
        own,
        corner,
        world: own * place.map_or(1.0, Place::stretch),
        along,
        distance: along / speed,
    }
}

/// The ray, and rays that are moved aside by up to a distance.
fn beside(ray: &Ray, aside: f64) -> impl Iterator<Item = Line> {
    let line = Line::of(ray);
    let along = line.direction.normalize_or_zero();
    // Turned by no round angle, so that none stays on an edge along an axis.
    let across = along.any_orthonormal_vector();
    let other = along.cross(across);
    let moved = SHIFTS.into_iter().flat_map(move |shift| {
        (0..DIRECTIONS).map(move |i| {
            let angle = 0.3 + std::f64::consts::TAU * f64::from(i) / f64::from(DIRECTIONS);
            let offset: DVec3 = across * angle.cos() + other * angle.sin();
            Line {
                origin: line.origin + shift * aside * offset,
                ..line
            }
        })
    });
    std::iter::once(line).chain(moved)
}
