//! Spheres and segments of curves in double precision: surfaces at a radius from an axis.
//!
//! Crossings are where the depth changes its sign, found by looking at many points of the line: slow,
//! and good for any axis.

use glam::DVec3;

use super::exact::Line;
use crate::accel::{CurveBasis, CurveBuffer};

/// Places along the axis that are looked at before the nearest one is refined.
const PLACES: u32 = 32;
/// Points of a line that are looked at.
const POINTS: u32 = 256;

/// What a surface is around: control points of one segment, or one point.
#[derive(Clone)]
pub(super) struct Axis {
    /// x, y, z and radius.
    points: Vec<[f64; 4]>,
}

/// A round surface.
pub(super) struct Round {
    pub(super) axis: Axis,
    /// Segments that share the surface's ends: what lies inside of them is no surface.
    neighbours: Vec<Axis>,
    /// Whether the sphere at the end is that of the next segment.
    shares_end: bool,
}

impl Axis {
    /// Middle and radius at a place from 0 to 1.
    pub(super) fn at(&self, u: f64) -> (DVec3, f64) {
        let rest = 1.0 - u;
        let weights = match self.points.len() {
            1 => vec![1.0],
            2 => vec![rest, u],
            _ => vec![
                rest.powi(3) / 6.0,
                2.0 / 3.0 - u.powi(2) + 0.5 * u.powi(3),
                2.0 / 3.0 - rest.powi(2) + 0.5 * rest.powi(3),
                u.powi(3) / 6.0,
            ],
        };
        let mut sum = [0.0; 4];
        for (point, weight) in self.points.iter().zip(weights) {
            for (sum, coordinate) in sum.iter_mut().zip(point) {
                *sum += weight * coordinate;
            }
        }
        (DVec3::new(sum[0], sum[1], sum[2]), sum[3])
    }

    /// The place whose sphere a point is nearest to.
    pub(super) fn nearest(&self, point: DVec3) -> f64 {
        if self.points.len() == 1 {
            return 0.0;
        }
        let depth = |u: f64| {
            let (centre, radius) = self.at(u);
            point.distance(centre) - radius
        };
        let step = 1.0 / f64::from(PLACES);
        let places = (0..=PLACES).map(|i| f64::from(i) * step);
        let best = places.min_by(|a, b| depth(*a).total_cmp(&depth(*b)));
        let best = best.unwrap_or(0.0);
        let (mut low, mut high) = ((best - step).max(0.0), (best + step).min(1.0));
        for _ in 0..60 {
            let third = (high - low) / 3.0;
            if depth(low + third) < depth(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        0.5 * (low + high)
    }

    fn depth(&self, point: DVec3) -> f64 {
        let (centre, radius) = self.at(self.nearest(point));
        point.distance(centre) - radius
    }
}

impl Round {
    pub(super) fn sphere(centre: DVec3, radius: f64) -> Self {
        let [x, y, z] = centre.to_array();
        Self {
            axis: Axis {
                points: vec![[x, y, z, radius]],
            },
            neighbours: Vec::new(),
            shares_end: false,
        }
    }

    pub(super) fn curve(basis: CurveBasis, curves: &CurveBuffer, segment: usize) -> Self {
        let axis = |segment: usize| {
            let first = curves.segments()[segment] as usize;
            let points = &curves.points()[first..first + basis.points_per_segment()];
            let points = points.iter().map(|point| point.map(f64::from));
            Axis {
                points: points.collect(),
            }
        };
        let segments = curves.segments();
        let follows = |a: usize, b: usize| segments.get(b) == Some(&(segments[a] + 1));
        let (mut neighbours, mut shares_end) = (Vec::new(), false);
        if basis == CurveBasis::Linear {
            if segment > 0 && follows(segment - 1, segment) {
                neighbours.push(axis(segment - 1));
            }
            if follows(segment, segment + 1) {
                neighbours.push(axis(segment + 1));
                shares_end = true;
            }
        }
        Self {
            axis: axis(segment),
            neighbours,
            shares_end,
        }
    }

    pub(super) fn is_sphere(&self) -> bool {
        self.axis.points.len() == 1
    }

    /// Whether it is a B-spline, which is open at both ends.
    pub(super) fn is_spline(&self) -> bool {
        self.axis.points.len() == 4
    }

    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let points = self.axis.points.iter();
        points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| {
            let [x, y, z, _] = *p;
            let (point, reach) = (DVec3::new(x, y, z), self.widest());
            [low.min(point - reach), high.max(point + reach)]
        })
    }

    fn widest(&self) -> f64 {
        let radii = self.axis.points.iter().map(|point| point[3]);
        radii.fold(0.0, f64::max)
    }

    pub(super) fn width(&self) -> f64 {
        let radii = self.axis.points.iter().map(|point| point[3]);
        radii.fold(f64::INFINITY, f64::min)
    }

    /// How far outside a point is, negative inside.
    pub(super) fn depth(&self, point: DVec3) -> f64 {
        self.axis.depth(point)
    }

    pub(super) fn normal(&self, point: DVec3) -> DVec3 {
        let (centre, _) = self.axis.at(self.axis.nearest(point));
        (point - centre).normalize_or_zero()
    }

    /// Tells the distances at which a line goes in or out.
    pub(super) fn crossings(&self, line: &Line, mut tell: impl FnMut(f64)) {
        let [low, high] = self.bounds();
        let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low).length());
        let speed = line.direction.length();
        let unit = line.direction / speed;
        let nearest = (middle - line.origin).dot(unit);
        // From the nearest point on, nothing is lost in far origins.
        let start = line.origin + nearest * unit;
        let apart = start.distance(middle);
        if apart.is_nan() || apart > reach {
            return;
        }
        let half = (reach * reach - apart * apart).sqrt();
        let mut cross = |from: f64, to: f64| {
            let way = self.root(|way| self.depth(start + way * unit), from, to);
            let point = start + way * unit;
            let is_covered = self
                .neighbours
                .iter()
                .any(|other| other.depth(point) < -1e-6 * self.width());
            let place = self.axis.nearest(point);
            let is_open = self.is_spline() && !(1e-9..=1.0 - 1e-9).contains(&place);
            let is_next = self.shares_end && place > 1.0 - 1e-9;
            if !is_covered && !is_open && !is_next {
                tell((nearest + way) / speed);
            }
        };
        if let [[x, y, z, radius]] = self.axis.points[..] {
            // One sphere: in before the nearest point to its centre, out behind it.
            let foot = (DVec3::new(x, y, z) - start).dot(unit);
            if self.depth(start + foot * unit) <= 0.0 {
                cross(foot - 2.0 * radius, foot);
                cross(foot + 2.0 * radius, foot);
            }
            return;
        }
        let ways = (0..=POINTS).map(|i| half * (2.0 * f64::from(i) / f64::from(POINTS) - 1.0));
        let depths = ways.map(|way| (way, self.depth(start + way * unit)));
        let depths: Vec<(f64, f64)> = depths.collect();
        for pair in depths.windows(2) {
            match (pair[0].1 > 0.0, pair[1].1 > 0.0) {
                (true, false) => cross(pair[0].0, pair[1].0),
                (false, true) => cross(pair[1].0, pair[0].0),
                _ => {}
            }
        }
    }

    /// The root between an argument outside and one inside.
    fn root(&self, depth: impl Fn(f64) -> f64, mut outside: f64, mut inside: f64) -> f64 {
        for _ in 0..70 {
            let middle = 0.5 * (outside + inside);
            if depth(middle) > 0.0 {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        0.5 * (outside + inside)
    }
}
