//! A point on a surface, with all that materials and lights ask of it.

use crate::accel::Ray;
use crate::math::{Frame, Vec2, Vec3};

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// World-space position.
    pub position: Vec3,
    /// Unit normal of the true geometry.
    pub geometric_normal: Vec3,
    /// Unit normal of the shaded surface: the interpolated one where the shape has such.
    pub shading_normal: Vec3,
    /// How the position changes with `uv`.
    pub derivatives: Derivatives,
    /// Surface coordinates of textures; where nobody asks for them and the shape leaves them out, what helps it
    /// to find them again, see [`ShapeModel::coordinates`](super::ShapeModel::coordinates).
    pub uv: Vec2,
    /// Bound on the error of `position`, in metres: how far a ray's origin must leave the surface.
    pub error: f32,
}

/// How a position changes with the surface coordinates `u` and `v`, seen in the plane across the
/// shading normal.
///
/// Two numbers for each coordinate instead of three: a surface point stays within 64 bytes, and what
/// is left out, the part along the normal, no material asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// ∂p/∂u in m, along tangent and bitangent of [`Frame::around`] the shading normal.
    by_u: Vec2,
    /// ∂p/∂v, likewise.
    by_v: Vec2,
}

impl Derivatives {
    /// Of surfaces without coordinates, or where nobody asks for them.
    pub const NONE: Self = Self {
        by_u: Vec2::ZERO,
        by_v: Vec2::ZERO,
    };

    /// Takes what lies across the normal of derivatives in world space.
    ///
    /// - `by_u`, `by_v`: ∂p/∂u and ∂p/∂v in m; numbers that are not finite give
    ///   [`Derivatives::NONE`].
    #[inline]
    pub fn new(shading_normal: Vec3, by_u: Vec3, by_v: Vec3) -> Self {
        let frame = Frame::around(shading_normal);
        let across = |v: Vec3| Vec2::new(v.dot(frame.tangent), v.dot(frame.bitangent));
        let (by_u, by_v) = (across(by_u), across(by_v));
        if by_u.is_finite() && by_v.is_finite() {
            Self { by_u, by_v }
        } else {
            Self::NONE
        }
    }

    /// ∂p/∂u and ∂p/∂v of a point in m, with the part along the shading normal: what keeps them in
    /// the plane of the surface. `None` where there are none.
    #[inline]
    pub(super) fn in_surface(&self, point: &SurfacePoint) -> Option<[Vec3; 2]> {
        if *self == Self::NONE {
            return None;
        }
        let frame = Frame::around(point.shading_normal);
        let cos = point.shading_normal.dot(point.geometric_normal);
        Some([self.by_u, self.by_v].map(|across| {
            let across = frame.tangent * across.x + frame.bitangent * across.y;
            across - frame.normal * (across.dot(point.geometric_normal) / cos)
        }))
    }
}

impl SurfacePoint {
    /// A point without a surface.
    pub const fn bare(position: Vec3) -> Self {
        Self {
            position,
            geometric_normal: Vec3::ZERO,
            shading_normal: Vec3::ZERO,
            derivatives: Derivatives::NONE,
            uv: Vec2::ZERO,
            error: 0.0,
        }
    }

    /// The frame that materials write their directions in: its tangent goes where `u` grows.
    #[inline(always)]
    pub fn shading_frame(&self) -> Frame {
        let frame = Frame::around(self.shading_normal);
        // Most points: what is not asked for is not there.
        if self.derivatives.by_u == Vec2::ZERO {
            return frame;
        }
        let Some(along) = self.derivatives.by_u.try_normalize() else {
            return frame;
        };
        Frame {
            tangent: frame.tangent * along.x + frame.bitangent * along.y,
            bitangent: frame.bitangent * along.x - frame.tangent * along.y,
            normal: frame.normal,
        }
    }

    /// Gradient over the surface of what changes with its coordinates, along tangent and bitangent
    /// of the shading frame, for each m.
    ///
    /// - `by_uv`: derivatives by `u` and `v`.
    ///
    /// `None` where the coordinates do not span the surface.
    ///
    /// With the tangent along ∂p/∂u, a gradient (x, y) must give `x·|∂p/∂u|` for `u`, and its dot
    /// product with ∂p/∂v for `v`.
    #[inline]
    pub fn gradient(&self, by_uv: Vec2) -> Option<Vec2> {
        let Derivatives { by_u, by_v } = self.derivatives;
        let length = by_u.length();
        let x = by_uv.x / length;
        let across = by_u.perp_dot(by_v) / length;
        let y = (by_uv.y - x * by_u.dot(by_v) / length) / across;
        let gradient = Vec2::new(x, y);
        gradient.is_finite().then_some(gradient)
    }

    /// The origin of a ray that leaves in `direction`: off the surface by [`SurfacePoint::error`],
    /// to the side that the ray leaves to, so that the ray neither meets its own surface nor skips
    /// a neighbouring one.
    #[inline]
    pub fn ray_origin(&self, direction: Vec3) -> Vec3 {
        let side = self.error.copysign(self.geometric_normal.dot(direction));
        self.position + self.geometric_normal * side
    }

    /// The half line that leaves in a unit direction, off the surface.
    #[inline]
    pub fn ray_toward(&self, direction: Vec3) -> Ray {
        Ray::new(self.ray_origin(direction), direction)
    }

    /// The piece of a line to another point, off the surface.
    ///
    /// - `target`: already off its own surface.
    #[inline]
    pub fn ray_to(&self, target: Vec3) -> Ray {
        Ray::segment(self.ray_origin(target - self.position), target)
    }

    /// Error of a position that was computed from coordinates of size `extent`, in metres.
    ///
    /// Interpolating three vertices in `f32` errs by a few units in the last place of the largest
    /// coordinate, and so does the tracer's own distance to the plane; 2⁻¹⁹ is 16 units.
    #[inline]
    pub fn error_bound(extent: f32) -> f32 {
        const UNITS_16: f32 = 1.0 / 524_288.0;
        // The floor keeps the offset from vanishing in denormals around the world's origin.
        (extent * UNITS_16).max(1e-30)
    }
}
