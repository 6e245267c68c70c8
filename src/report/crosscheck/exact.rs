//! Primitives in double precision, as the referee sees them: by textbook formulas, each written apart
//! from those of both tracers.

use glam::{DMat3, DVec3};

use super::round::{Axis, Round};
use crate::accel::{Geometry, Ray};

/// A straight line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub(super) origin: DVec3,
    /// Any length; distances count in multiples of it.
    pub(super) direction: DVec3,
}

/// A primitive.
pub(super) enum Exact {
    Triangle([DVec3; 3]),
    Round(Round),
    /// The image of the unit disk.
    Disk {
        linear: DMat3,
        origin: DVec3,
    },
    /// The image of the open cylinder.
    Cylinder {
        linear: DMat3,
        origin: DVec3,
    },
}

/// By how much edges are let out, as a part of the primitive's size: no line slips through between two
/// primitives by the rounding of doubles.
const LET_OUT: f64 = 1e-15;

impl Line {
    pub(super) fn of(ray: &Ray) -> Self {
        Self {
            origin: ray.origin().as_dvec3(),
            direction: ray.direction().as_dvec3(),
        }
    }

    pub(super) fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// Whether a box is crossed, by a little more than rounding.
    pub(super) fn crosses_box(&self, [low, high]: [DVec3; 2]) -> bool {
        let (a, b) = (
            (low - self.origin) / self.direction,
            (high - self.origin) / self.direction,
        );
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
            // Not-a-number: along a face.
            if !(a.is_nan() || b.is_nan()) {
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        enter - 1e-9 * enter.abs() <= leave + 1e-9 * leave.abs()
    }
}

impl Exact {
    /// A primitive of a geometry.
    pub(super) fn of(geometry: &Geometry, primitive: u32) -> Self {
        match geometry {
            Geometry::Triangles(vertices, triangles) => {
                let corners = triangles.as_slice()[primitive as usize];
                Self::Triangle(corners.map(|index| {
                    DVec3::from_array(vertices.as_slice()[index as usize].map(f64::from))
                }))
            }
            Geometry::Curves(basis, curves) => {
                Self::Round(Round::curve(*basis, curves, primitive as usize))
            }
            Geometry::Sphere { centre, radius } => {
                Self::Round(Round::sphere(centre.as_dvec3(), f64::from(*radius)))
            }
            Geometry::Disk(rows) => {
                let (linear, origin) = affine(rows);
                Self::Disk { linear, origin }
            }
            Geometry::Cylinder(rows) => {
                let (linear, origin) = affine(rows);
                Self::Cylinder { linear, origin }
            }
        }
    }

    /// How many primitives a geometry has.
    pub(super) fn count(geometry: &Geometry) -> u32 {
        match geometry {
            Geometry::Triangles(_, triangles) => triangles.as_slice().len() as u32,
            Geometry::Curves(_, curves) => curves.segments().len() as u32,
            _ => 1,
        }
    }

    /// The corners of the box around it.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Triangle([a, b, c]) => [a.min(*b).min(*c), a.max(*b).max(*c)],
            Self::Round(round) => round.bounds(),
            Self::Disk { linear, origin } => {
                let reach = linear.x_axis.abs() + linear.y_axis.abs();
                [*origin - reach, *origin + reach]
            }
            Self::Cylinder { linear, origin } => {
                let reach = linear.x_axis.abs() + linear.y_axis.abs();
                let end = *origin + linear.z_axis;
                [origin.min(end) - reach, origin.max(end) + reach]
            }
        }
    }

    /// Tells all distances at which a line crosses it.
    pub(super) fn crossings(&self, line: &Line, mut tell: impl FnMut(f64)) {
        match self {
            Self::Triangle(corners) => {
                let Some((distance, [u, v])) = cross_plane(corners, line) else {
                    return;
                };
                if u.min(v).min(1.0 - u - v) >= -LET_OUT {
                    tell(distance);
                }
            }
            Self::Round(round) => round.crossings(line, tell),
            Self::Disk { linear, origin } => {
                let local = local(linear, *origin, line);
                let distance = -local.origin.z / local.direction.z;
                if local.at(distance).truncate().length() <= 1.0 + LET_OUT {
                    tell(distance);
                }
            }
            Self::Cylinder { linear, origin } => {
                let local = local(linear, *origin, line);
                let (o, d) = (local.origin.truncate(), local.direction.truncate());
                for distance in roots(d.length_squared(), o.dot(d), o.length_squared() - 1.0) {
                    if (-LET_OUT..=1.0 + LET_OUT).contains(&local.at(distance).z) {
                        tell(distance);
                    }
                }
            }
        }
    }

    /// How far a line is from the surface, at a distance or as far before and behind it as `slack` says.
    pub(super) fn gap(&self, line: &Line, distance: f64, slack: f64) -> f64 {
        match self {
            Self::Triangle(corners) => {
                let all = 4.0 * self.reach(line.origin) / line.direction.length() + distance.abs();
                let slack = slack.min(all);
                let ends = [distance - slack, distance + slack].map(|end| line.at(end));
                if let Some((crossing, [u, v])) = cross_plane(corners, line) {
                    let is_within = (crossing - distance).abs() <= slack;
                    if is_within && u.min(v).min(1.0 - u - v) >= 0.0 {
                        return 0.0;
                    }
                }
                let edges =
                    [0, 1, 2].map(|i| segments_apart(ends, [corners[i], corners[(i + 1) % 3]]));
                let points = ends.map(|end| point_apart(end, corners));
                edges
                    .into_iter()
                    .chain(points)
                    .fold(f64::INFINITY, f64::min)
            }
            Self::Round(round) => round.depth(line.at(distance)).abs(),
            Self::Disk { linear, origin } => {
                let place = linear.inverse() * (line.at(distance) - *origin);
                let radius = place.truncate().length();
                let inside = place.truncate() / radius.max(1.0);
                (*linear * (place - inside.extend(0.0))).length()
            }
            Self::Cylinder { linear, origin } => {
                let place = linear.inverse() * (line.at(distance) - *origin);
                let wall = place.truncate().normalize_or_zero();
                let nearest = wall.extend(place.z.clamp(0.0, 1.0));
                (*linear * (place - nearest)).length()
            }
        }
    }

    /// How far a line is from the border of a triangle, around a distance; without an end elsewhere.
    pub(super) fn border(&self, line: &Line, distance: f64, slack: f64) -> f64 {
        let Self::Triangle(corners) = self else {
            return f64::INFINITY;
        };
        let ends = [distance - slack, distance + slack].map(|end| line.at(end));
        let edges = [0, 1, 2].map(|i| segments_apart(ends, [corners[i], corners[(i + 1) % 3]]));
        edges.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// By how much a part of a triangle's area moves its point more than it moves its edges: the
    /// longest side by the least height; 1 elsewhere.
    pub(super) fn stretch(&self) -> f64 {
        match self {
            Self::Triangle(_) => self.longest() / self.width(),
            _ => 1.0,
        }
    }

    /// The longest side of a triangle; zero elsewhere.
    pub(super) fn longest(&self) -> f64 {
        match self {
            Self::Triangle(corners) => {
                let sides = [0, 1, 2].map(|i| corners[i].distance(corners[(i + 1) % 3]));
                sides.into_iter().fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }

    /// Unit normal at a point of the surface; zero where a triangle has none.
    pub(super) fn normal(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Triangle([a, b, c]) => (*b - *a).cross(*c - *a).normalize_or_zero(),
            Self::Round(round) => round.normal(point),
            Self::Disk { linear, .. } => {
                let normal = linear.x_axis.cross(linear.y_axis);
                normal.normalize() * normal.dot(linear.z_axis).signum()
            }
            Self::Cylinder { linear, origin } => {
                let inverse = linear.inverse();
                let place = inverse * (point - *origin);
                (inverse.transpose() * place.truncate().extend(0.0)).normalize_or_zero()
            }
        }
    }

    /// The point of the surface that a hit's coordinates name, where they name one.
    pub(super) fn named(&self, [u, v]: [f64; 2]) -> Option<DVec3> {
        let turned = |radius: f64, turn: f64| {
            let angle = turn * std::f64::consts::TAU;
            [radius * angle.cos(), radius * angle.sin()]
        };
        match self {
            Self::Triangle([a, b, c]) => Some(*a + u * (*b - *a) + v * (*c - *a)),
            Self::Round(_) => None,
            Self::Disk { linear, origin } => {
                let [x, y] = turned(u, v);
                Some(*origin + *linear * DVec3::new(x, y, 0.0))
            }
            Self::Cylinder { linear, origin } => {
                let [x, y] = turned(1.0, u);
                Some(*origin + *linear * DVec3::new(x, y, v))
            }
        }
    }

    /// The smallest length that its normal depends on: a triangle's least height, a radius.
    pub(super) fn width(&self) -> f64 {
        match self {
            Self::Triangle([a, b, c]) => {
                let sides = [*b - *a, *c - *b, *a - *c];
                let longest = sides.iter().map(|side| side.length()).fold(0.0, f64::max);
                sides[0].cross(sides[2]).length() / longest
            }
            Self::Round(round) => round.width(),
            Self::Disk { linear, .. } => linear.x_axis.length().min(linear.y_axis.length()),
            Self::Cylinder { linear, .. } => {
                let axes = [linear.x_axis, linear.y_axis, linear.z_axis];
                axes.iter()
                    .map(|axis| axis.length())
                    .fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// How long a line may run along it, no farther from it than a distance: without an end within the
    /// plane of a triangle, whose crossing is then a quotient of nothing but rounding.
    pub(super) fn longest_graze(&self, distance: f64) -> f64 {
        match self {
            // The chord of a sphere that is as deep as it may be off, on either side.
            Self::Round(round) if round.is_sphere() => 4.0 * (distance * round.width()).sqrt(),
            Self::Triangle(_) => f64::INFINITY,
            _ => {
                let [low, high] = self.bounds();
                (high - low).length()
            }
        }
    }

    /// How far the farthest corner of the box around it is from a point.
    pub(super) fn reach(&self, from: DVec3) -> f64 {
        let [low, high] = self.bounds();
        (low - from).abs().max((high - from).abs()).length()
    }

    /// The axis of a curve's segment.
    pub(super) fn axis(&self) -> Option<&Axis> {
        match self {
            Self::Round(round) => Some(&round.axis),
            _ => None,
        }
    }
}

/// Where a line meets the plane of a triangle, with the weights of the second and third corner.
///
/// Source: Möller, Trumbore 1997.
fn cross_plane([a, b, c]: &[DVec3; 3], line: &Line) -> Option<(f64, [f64; 2])> {
    let (first, second) = (*b - *a, *c - *a);
    let across = line.direction.cross(second);
    let determinant = first.dot(across);
    if determinant == 0.0 {
        return None;
    }
    let from_corner = line.origin - *a;
    let along = from_corner.cross(first);
    let weights = [from_corner.dot(across), line.direction.dot(along)];
    let distance = second.dot(along) / determinant;
    Some((distance, weights.map(|weight| weight / determinant)))
}

fn local(linear: &DMat3, origin: DVec3, line: &Line) -> Line {
    let inverse = linear.inverse();
    Line {
        origin: inverse * (line.origin - origin),
        direction: inverse * line.direction,
    }
}

/// Roots of a·t² + 2·b·t + c.
fn roots(a: f64, b: f64, c: f64) -> impl Iterator<Item = f64> {
    let root = (b * b - a * c).sqrt();
    let both = [(-b - root) / a, (-b + root) / a];
    both.into_iter().filter(|root| root.is_finite())
}

/// The least distance between two pieces of lines.
fn segments_apart([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    let (first, second, between) = (b - a, d - c, a - c);
    let (aa, bb, ab) = (
        first.length_squared(),
        second.length_squared(),
        first.dot(second),
    );
    let (fa, fb) = (first.dot(between), second.dot(between));
    let determinant = aa * bb - ab * ab;
    let mut s = if determinant > 0.0 {
        ((ab * fb - bb * fa) / determinant).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut t = if bb > 0.0 {
        ((ab * s + fb) / bb).clamp(0.0, 1.0)
    } else {
        0.0
    };
    // Once more each way: the clamped one moves the other.
    for _ in 0..2 {
        s = if aa > 0.0 {
            ((ab * t - fa) / aa).clamp(0.0, 1.0)
        } else {
            0.0
        };
        t = if bb > 0.0 {
            ((ab * s + fb) / bb).clamp(0.0, 1.0)
        } else {
            0.0
        };
    }
    (between + s * first - t * second).length()
}

/// The distance of a point from a triangle, where its foot is inside; else that from its plane's far
/// side, infinity: the edges tell that.
fn point_apart(point: DVec3, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (*b - *a).cross(*c - *a);
    let across = Line {
        origin: point,
        direction: normal,
    };
    match cross_plane(corners, &across) {
        Some((distance, [u, v])) if u.min(v).min(1.0 - u - v) >= 0.0 => {
            distance.abs() * normal.length()
        }
        _ => f64::INFINITY,
    }
}

/// Linear part and translation of an affine map by rows.
fn affine(rows: &[[f32; 4]; 3]) -> (DMat3, DVec3) {
    let column = |i: usize| DVec3::from_array(rows.map(|row| f64::from(row[i])));
    (DMat3::from_cols(column(0), column(1), column(2)), column(3))
}
