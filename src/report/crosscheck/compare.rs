//! What two tracers say of a ray: whether it is the same, and what it is if not.

use super::address::RayAddress;
use glam::DVec3;

use super::judge::Seen;
use super::referee::Referee;
use super::subject::Id;
use crate::accel::{Hit, Ray};

/// What a tracer is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// The closest hit.
    Closest,
    /// Whether anything is hit.
    Any,
}

/// What kind of disagreement it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Two primitives at the same distance, within tolerance.
    Tie,
    /// The ray passes an edge, a border, a grazed surface or an end of its interval within tolerance.
    Silhouette,
    /// One of the answers is not right for any ray nearby, but single precision cannot tell: the ray meets
    /// an edge or a corner within tolerance, or lies in the plane of a triangle.
    Limit,
    /// One of the answers cannot be right.
    Real,
}

/// Who is right, by the referee.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Right {
    /// Embree alone.
    Embree,
    /// The tree of obvhs alone.
    Obvhs,
    /// Both: what differs is which of equal answers is given.
    Both,
    /// None.
    Neither,
}

/// A real disagreement, with all that is needed to see it again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// Which ray of the check.
    pub address: RayAddress,
    /// The ray.
    pub ray: Ray,
    /// What was asked.
    pub query: Query,
    /// Who is right.
    pub right: Right,
}

/// All answers to one ray, Embree's before those of obvhs.
#[derive(Clone, Debug)]
pub struct Answers {
    /// The closest hits.
    pub closest: [Option<Hit>; 2],
    /// Whether anything is hit.
    pub occluded: [bool; 2],
    /// Distance and, by instance, geometry and primitive, what the referee hits first, where it was
    /// asked.
    pub(super) referee: Option<(f64, Id)>,
}

impl Class {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tie => "tie",
            Self::Silhouette => "silhouette",
            Self::Limit => "limit",
            Self::Real => "real",
        }
    }
}

impl Query {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest hit",
            Self::Any => "any hit",
        }
    }
}

impl Right {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Embree => "embree",
            Self::Obvhs => "obvhs",
            Self::Both => "both",
            Self::Neither => "neither",
        }
    }

    fn of([embree, obvhs]: [bool; 2]) -> Self {
        match (embree, obvhs) {
            (true, true) => Self::Both,
            (true, false) => Self::Embree,
            (false, true) => Self::Obvhs,
            (false, false) => Self::Neither,
        }
    }
}

impl Answers {
    /// What the referee hits first: distance, instance, geometry and primitive.
    pub fn refereed(&self) -> Option<(f64, Option<u32>, u32, u32)> {
        let (distance, id) = self.referee?;
        Some((distance, id.instance, id.geometry, id.primitive))
    }
}

/// Distances this near, as a part of them, are one distance: the last bits of a float.
const SAME: f64 = 1e-6;

/// Compares answers with the referee at hand.
pub(super) struct Comparison<'r> {
    pub(super) referee: &'r Referee<'r>,
}

impl Comparison<'_> {
    /// All disagreements about a ray.
    pub(super) fn compare(&self, ray: &Ray, answers: &Answers) -> Vec<(Query, Class, Right)> {
        let closest = self.closest(ray, &answers.closest);
        let any = self.any(ray, answers);
        let name = |query| move |(class, right)| (query, class, right);
        let closest = closest.map(name(Query::Closest));
        closest
            .into_iter()
            .chain(any.map(name(Query::Any)))
            .collect()
    }

    fn closest(&self, ray: &Ray, hits: &[Option<Hit>; 2]) -> Option<(Class, Right)> {
        let ids = hits.map(|hit| hit.map(|hit| self.referee.subject.id(&hit)));
        let same_primitive = ids[0] == ids[1];
        let apart = match hits {
            [None, None] => return None,
            [Some(a), Some(b)] => Some(self.is_apart(ray, a, b)),
            _ => None,
        };
        if let ([Some(a), Some(b)], true, Some(false)) = (hits, same_primitive, apart) {
            let seen = self.referee.seen(ray, self.referee.subject.id(a));
            if same_surface(&seen, ray, a, b) {
                return None;
            }
            let right = [a, b].map(|hit| is_own_surface(&seen, ray, hit));
            // Each may be off by the tolerance, to either side of what is right.
            if right == [true, true] {
                return None;
            }
            return Some((Class::Real, Right::of(right)));
        }
        let aside = self.aside(ray, hits);
        let possible = hits.map(|hit| self.is_possible(ray, hit.as_ref(), aside));
        if possible != [true, true] {
            let excused = hits.map(|hit| self.is_excused(ray, hit.as_ref()));
            return Some(impossible(possible, excused));
        }
        let class = if apart == Some(false) {
            Class::Tie
        } else {
            Class::Silhouette
        };
        Some((class, self.sides_with(ray, hits)))
    }

    fn any(&self, ray: &Ray, answers: &Answers) -> Option<(Class, Right)> {
        let [a, b] = answers.occluded;
        if a == b {
            return None;
        }
        let aside = self.aside(ray, &answers.closest);
        let own = answers.closest.into_iter().flatten();
        let may_meet = self.referee.may_meet(ray, aside)
            || own.into_iter().any(|hit| self.referee.may_hit(ray, &hit));
        let may_be_free = self.referee.may_be_free(ray, f64::INFINITY, aside);
        let possible = [a, b].map(|occluded| if occluded { may_meet } else { may_be_free });
        if possible != [true, true] {
            let excused = [a, b].map(|occluded| {
                if occluded {
                    let own = answers.closest.iter().flatten();
                    own.into_iter().any(|hit| self.referee.is_edge_on(ray, hit))
                } else {
                    self.referee.may_leak(ray, f64::INFINITY)
                }
            });
            return Some(impossible(possible, excused));
        }
        let is_met = self.referee.closest(ray).is_some();
        let right = [a, b].map(|occluded| occluded == is_met);
        Some((Class::Silhouette, Right::of(right)))
    }

    /// How far a ray may be off, in the world: the largest tolerance of what it hits and crosses.
    fn aside(&self, ray: &Ray, hits: &[Option<Hit>; 2]) -> f64 {
        let of_hits = hits.iter().flatten().map(|hit| {
            let seen = self.referee.seen(ray, self.referee.subject.id(hit));
            seen.tolerance(ray, f64::from(hit.distance)).world
        });
        of_hits.fold(self.referee.aside(ray), f64::max)
    }

    fn is_possible(&self, ray: &Ray, hit: Option<&Hit>, aside: f64) -> bool {
        let limit = hit.map_or(f64::INFINITY, |hit| f64::from(hit.distance));
        hit.is_none_or(|hit| self.referee.may_hit(ray, hit))
            && self.referee.may_be_free(ray, limit, aside)
    }

    /// Whether single precision cannot tell that an answer is not possible.
    fn is_excused(&self, ray: &Ray, hit: Option<&Hit>) -> bool {
        let limit = hit.map_or(f64::INFINITY, |hit| f64::from(hit.distance));
        let is_met = |hit| self.referee.may_hit(ray, hit) || self.referee.is_edge_on(ray, hit);
        hit.is_none_or(is_met) && self.referee.may_leak(ray, limit)
    }

    /// Whether two hits are farther apart than tolerance.
    fn is_apart(&self, ray: &Ray, a: &Hit, b: &Hit) -> bool {
        let slack: f64 = [a, b]
            .map(|hit| {
                let seen = self.referee.seen(ray, self.referee.subject.id(hit));
                seen.tolerance(ray, f64::from(hit.distance)).distance
            })
            .iter()
            .sum();
        let [a, b] = [a, b].map(|hit| f64::from(hit.distance));
        // Within the plane of a triangle no distance is far from another; equal ones are still equal.
        let slack = if slack.is_finite() {
            slack
        } else {
            SAME * a.abs().max(b.abs())
        };
        (a - b).abs() > slack
    }

    /// Whose answer is that of the referee.
    fn sides_with(&self, ray: &Ray, hits: &[Option<Hit>; 2]) -> Right {
        let found = self.referee.closest(ray);
        Right::of(hits.map(|hit| match (hit, found) {
            (None, None) => true,
            (Some(hit), Some((distance, id))) => {
                let apart = (f64::from(hit.distance) - distance).abs();
                self.referee.subject.id(&hit) == id || apart <= SAME * distance
            }
            _ => false,
        }))
    }
}

/// The class of two answers of which one is not possible.
fn impossible(possible: [bool; 2], excused: [bool; 2]) -> (Class, Right) {
    let is_limit = possible
        .iter()
        .zip(excused)
        .all(|(possible, excused)| *possible || excused);
    let class = if is_limit { Class::Limit } else { Class::Real };
    (class, Right::of(possible))
}

/// Whether two hits on one primitive name the same point of it with the same normal.
fn same_surface(seen: &Seen, ray: &Ray, a: &Hit, b: &Hit) -> bool {
    let tolerance = seen.tolerance(ray, f64::from(a.distance));
    let coordinates = |hit: &Hit| [hit.u, hit.v].map(f64::from);
    let [first, second] = [a, b].map(coordinates);
    let points = [first, second].map(|uv| seen.exact.named(uv));
    let same_point = match points {
        [Some(p), Some(q)] => p.distance(q) <= 2.0 * allowed(seen, &tolerance),
        _ => seen.exact.axis().is_none_or(|axis| {
            let [p, q] = [first[0], second[0]].map(|u| axis.at(u).0);
            p.distance(q) <= 4.0 * allowed(seen, &tolerance)
        }),
    };
    same_point && same_normal(normal_of(a), normal_of(b), doubt(seen, &tolerance))
}

fn normal_of(hit: &Hit) -> DVec3 {
    DVec3::from_array(hit.normal.map(f64::from)).normalize_or_zero()
}

/// Whether two unit normals are one within a sine; from 1 on any are.
fn same_normal(a: DVec3, b: DVec3, sine: f64) -> bool {
    sine >= 1.0 || (a.cross(b).length() <= sine && a.dot(b) > 0.0)
}

/// Whether a hit's coordinates and normal are those of the surface where it says that it is.
fn is_own_surface(seen: &Seen, ray: &Ray, hit: &Hit) -> bool {
    let distance = f64::from(hit.distance);
    let tolerance = seen.tolerance(ray, distance);
    let point = seen.line.at(distance);
    let uv = [hit.u, hit.v].map(f64::from);
    let named = seen.exact.named(uv);
    let own = seen.exact.normal(point);
    named.is_none_or(|named| named.distance(point) <= 2.0 * allowed(seen, &tolerance))
        && same_normal(normal_of(hit), own, doubt(seen, &tolerance))
}

/// How far apart along the surface two points may be; coordinates are floats, too.
fn allowed(seen: &Seen, tolerance: &super::judge::Tolerance) -> f64 {
    let [low, high] = seen.exact.bounds();
    (tolerance.along + tolerance.own) * seen.exact.stretch() + 1e-6 * (high - low).length()
}

/// The sine of the angle that normals may differ by.
fn doubt(seen: &Seen, tolerance: &super::judge::Tolerance) -> f64 {
    let is_flat = seen.exact.axis().is_none();
    let moved = if is_flat {
        tolerance.own
    } else {
        tolerance.along
    };
    1e-5 + 8.0 * moved / seen.exact.width()
}
