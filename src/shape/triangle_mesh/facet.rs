//! What all points of a triangle share.

use glam::{Vec3A, Vec4};

use crate::math::Vec3;
use crate::shape::SurfacePoint;

/// What all points of a triangle share, in one line of the cache.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Facet {
    /// The first corner; and the bound on the error of a position, in metres.
    pub(super) corner_and_error: Vec4,
    /// The edge from that corner to the second one; and a limit: points with a smaller barycentric
    /// are too near to an edge, rounding can have put them beyond it, and so behind the wall that
    /// stands there.
    pub(super) to_b_and_least: Vec4,
    /// The edge from the first corner to the third one; the fourth number is zero.
    pub(super) to_c: Vec4,
    /// Unit normal; the fourth number is zero.
    pub(super) normal: Vec4,
}

const _: () = assert!(
    size_of::<Facet>() == 64,
    "hits on large meshes wait for memory"
);

impl Facet {
    pub(super) fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3A::from);
        let (to_b, to_c) = (b - a, c - a);
        let extent = a.abs().max(b.abs()).max(c.abs()).max_element();
        let error = SurfacePoint::error_bound(extent);
        let across = to_b.cross(to_c);
        // Distances from edges are barycentrics times heights, and heights are at least the cross
        // product's length over the longest edge.
        let needed = 2.0 * error * to_b.abs().max(to_c.abs()).element_sum();
        let length = across.length();
        let least = if needed > 0.0 { needed / length } else { 0.0 };
        Self {
            corner_and_error: a.extend(error),
            to_b_and_least: to_b.extend(least),
            to_c: to_c.extend(0.0),
            // Without negative zeros: frames turn around where `z` changes its sign, and the two halves of a
            // wall would have different ones.
            normal: unit_or(across.into(), Vec3::Z).extend(0.0) + Vec4::ZERO,
        }
    }

    #[inline(always)]
    pub(super) fn error(&self) -> f32 {
        self.corner_and_error.w
    }

    /// The edges from the first corner to the others.
    #[inline(always)]
    pub(super) fn edges(&self) -> [Vec3A; 2] {
        [self.to_b_and_least, self.to_c].map(Vec3A::from_vec4)
    }

    /// The point at the barycentrics of the second and third corner, kept off the edges.
    #[inline(always)]
    pub(super) fn position(&self, b1: f32, b2: f32) -> Vec3 {
        let corner = Vec3A::from_vec4(self.corner_and_error);
        let [to_b, to_c] = self.edges();
        let mut position = corner + to_b * b1 + to_c * b2;
        let least = self.to_b_and_least.w;
        if b1.min(b2).min(1.0 - b1 - b2) < least {
            // All of the middle's barycentrics are a third.
            let middle = corner + (to_b + to_c) * (1.0 / 3.0);
            position += (middle - position) * (3.0 * least).min(1.0);
        }
        position.into()
    }
}

/// A vector scaled to unit length; `fallback` where it has none.
#[inline]
pub(super) fn unit_or(vector: Vec3, fallback: Vec3) -> Vec3 {
    let length_squared = vector.length_squared();
    if length_squared > 0.0 {
        vector * (1.0 / length_squared.sqrt())
    } else {
        fallback
    }
}
