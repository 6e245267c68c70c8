//! A point on a surface, with all that materials and lights ask of it.

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
    /// Direction in which `u` grows, of any length; zero where nobody asks for it.
    pub tangent: Vec3,
    /// Surface coordinates of textures.
    pub uv: Vec2,
    /// Bound on the error of `position`, in metres: how far a ray's origin must leave the surface.
    pub error: f32,
}

impl SurfacePoint {
    /// The frame that materials write their directions in.
    #[inline(always)]
    pub fn shading_frame(&self) -> Frame {
        if self.tangent == Vec3::ZERO {
            Frame::around(self.shading_normal)
        } else {
            Frame::with_tangent(self.shading_normal, self.tangent)
        }
    }

    /// The origin of a ray that leaves in `direction`: off the surface by [`SurfacePoint::error`],
    /// to the side that the ray leaves to, so that the ray neither meets its own surface nor skips
    /// a neighbouring one.
    #[inline]
    pub fn ray_origin(&self, direction: Vec3) -> Vec3 {
        let side = self.error.copysign(self.geometric_normal.dot(direction));
        self.position + self.geometric_normal * side
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
