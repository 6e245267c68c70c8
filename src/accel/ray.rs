//! Rays.

use crate::math::Vec3;
use crate::math::lanes::{LANES, LaneMask, Lanes, Vec3Lanes, each};

/// A half line, or a piece of a line.
///
/// Its numbers lie in memory as those of the tracer's rays do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    origin: Vec3,
    near: f32,
    direction: Vec3,
    far: f32,
}

impl Ray {
    /// The half line from `origin` along `direction`.
    #[inline]
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            near: 0.0,
            far: f32::INFINITY,
        }
    }

    /// The piece of a line between two points; distances along it run from 0 to 1.
    #[inline]
    pub fn segment(from: Vec3, to: Vec3) -> Self {
        Self {
            origin: from,
            direction: to - from,
            near: 0.0,
            far: 1.0,
        }
    }

    /// The same ray, limited to distances between `near` and `far`.
    #[inline]
    pub const fn between(self, near: f32, far: f32) -> Self {
        Self { near, far, ..self }
    }

    /// Where distances are counted from, in world space.
    #[inline]
    pub const fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Direction; distances count in multiples of its length.
    #[inline]
    pub const fn direction(&self) -> Vec3 {
        self.direction
    }

    /// Hits nearer than this do not count.
    #[inline]
    pub const fn near(&self) -> f32 {
        self.near
    }

    /// Hits farther than this do not count.
    #[inline]
    pub const fn far(&self) -> f32 {
        self.far
    }

    /// The point at a distance.
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }
}

/// A ray in each lane, which counts hits from its origin on.
#[derive(Clone, Copy, Debug)]
pub struct RayLanes {
    /// Where distances are counted from, in world space.
    pub origin: Vec3Lanes,
    /// Directions; distances count in multiples of their lengths.
    pub direction: Vec3Lanes,
    /// Hits farther than this do not count.
    pub far: Lanes,
}

impl RayLanes {
    /// Those of one where the mask is set, else those of the other.
    #[inline(always)]
    pub fn select(mask: LaneMask, then: Self, otherwise: Self) -> Self {
        Self {
            origin: Vec3Lanes::select(mask, then.origin, otherwise.origin),
            direction: Vec3Lanes::select(mask, then.direction, otherwise.direction),
            far: Lanes::select(mask, then.far, otherwise.far),
        }
    }

    /// The rays of all lanes.
    #[inline(always)]
    pub fn rays(self) -> [Ray; LANES] {
        let starts = self.origin.rows(Lanes::ZERO);
        let ways = self.direction.rows(self.far);
        each(|lane| {
            let (start, way) = (starts[lane], ways[lane]);
            Ray::new(start.truncate(), way.truncate()).between(start.w, way.w)
        })
    }
}
