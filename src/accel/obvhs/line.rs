//! Rays in double precision, and what they cross.

use embree4_sys::VertexBuffer;
use glam::DVec3;

use crate::accel::Ray;

/// A ray in double precision, with what all boxes and triangles ask of it.
pub(super) struct Line {
    pub(super) origin: DVec3,
    /// Any length; distances count in multiples of it.
    pub(super) direction: DVec3,
    /// One over the direction, by axis.
    pub(super) inverse: DVec3,
    /// The axis of the largest component of the direction, and the other two.
    pub(super) axes: [usize; 3],
    near: f32,
    far: f32,
}

/// Where a line meets a surface.
pub(super) struct Crossing {
    /// In multiples of the line's direction.
    pub(super) distance: f64,
    /// Surface coordinates, as Embree's hits have them.
    pub(super) u: f64,
    pub(super) v: f64,
    /// Independent of the line's side; twice the area long on triangles, unit elsewhere.
    pub(super) normal: DVec3,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box3 {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Box3 {
    /// Around nothing.
    pub(super) const EMPTY: Self = Self {
        low: DVec3::ZERO,
        high: DVec3::ZERO,
    };

    /// Around points.
    pub(super) fn around<const N: usize>(points: [DVec3; N]) -> Self {
        Self {
            low: points.into_iter().fold(DVec3::INFINITY, DVec3::min),
            high: points.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max),
        }
    }
}

impl Line {
    /// A ray; `None` for one that can meet nothing: with not-a-number in it, without a direction, too
    /// far out, or with an interval that is empty or begins behind the origin.
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        let (origin, direction) = (ray.origin(), ray.direction());
        // Written so that not-a-number fails.
        let largest = VertexBuffer::LARGEST;
        let within = |c: f32| c.abs() <= largest;
        let is_usable = origin.to_array().into_iter().all(within)
            && direction.to_array().into_iter().all(within)
            && ray.near() >= 0.0
            && ray.near() <= ray.far();
        let direction = direction.as_dvec3();
        (is_usable && direction != DVec3::ZERO).then(|| {
            let whole = Self {
                origin: DVec3::ZERO,
                direction,
                inverse: DVec3::ONE,
                axes: [0; 3],
                near: ray.near(),
                far: ray.far(),
            };
            whole.mapped(origin.as_dvec3(), direction)
        })
    }

    /// The same interval of another line.
    pub(super) fn mapped(&self, origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let largest = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        Self {
            origin,
            direction,
            inverse: direction.recip(),
            axes: [largest, (largest + 1) % 3, (largest + 2) % 3],
            near: self.near,
            far: self.far,
        }
    }

    /// The point at a distance.
    pub(super) fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// Whether a distance, as a hit stores it, lies in the interval. Not-a-number never does.
    pub(super) fn accepts(&self, distance: f64) -> bool {
        let stored = distance as f32;
        stored >= self.near && stored <= self.far && stored <= f32::MAX
    }

    /// The nearer of two distances that lies in the interval and passes a test.
    pub(super) fn first(
        &self,
        distances: [f64; 2],
        mut test: impl FnMut(f64) -> bool,
    ) -> Option<f64> {
        distances
            .into_iter()
            .find(|&distance| self.accepts(distance) && test(distance))
    }

    /// The distance at which the line enters a box, if it does so before `limit`.
    ///
    /// Rounding never makes it miss a box: both ends are let out, by more than edges of triangles are.
    pub(super) fn enters(&self, low: DVec3, high: DVec3, limit: f64) -> Option<f64> {
        const LET_OUT: f64 = 64.0 * f64::EPSILON;
        let (a, b) = (
            (low - self.origin) * self.inverse,
            (high - self.origin) * self.inverse,
        );
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
            // Zero times infinity: the line runs along a face of the box, which belongs to it.
            if !(a.is_nan() || b.is_nan()) {
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        let enter = enter - LET_OUT * enter.abs();
        let leave = leave + LET_OUT * leave.abs();
        let (near, far) = (f64::from(self.near), f64::from(self.far));
        // Hits are compared with the interval as floats, which may round into it.
        let is_met = enter <= leave
            && leave >= near - 1e-6 * near
            && enter <= far + 1e-6 * far
            && enter <= limit;
        is_met.then_some(enter)
    }
}
