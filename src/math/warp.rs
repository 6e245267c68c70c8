//! Maps from the unit square to the domains that rendering samples, each with its density.
//!
//! Every warp is one-to-one up to a null set, and its `_inverse` undoes it: primary-sample-space
//! and path-space kernels need both directions to work on one chain.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::ops::{Add, Mul, Sub};

use super::{Vec2, Vec3, angle_of};

/// The largest `f32` below one: keeps uniform numbers inside `[0, 1)` after arithmetic.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// A point of the unit square, stretched over a rectangle.
///
/// Never reaches the upper corner, which is the next pixel's: without care the last places of a pixel are
/// rounded there, one in ten thousand at column 4095.
///
/// - `low`, `high`: the rectangle's corners.
#[inline]
pub fn stretch(u: Vec2, low: Vec2, high: Vec2) -> Vec2 {
    (low + (high - low) * u).min(Vec2::new(below(high.x), below(high.y)))
}

/// The largest number below another; zero has none that is not flushed to it, and keeps its place.
#[inline]
fn below(limit: f32) -> f32 {
    let bits = limit.to_bits();
    f32::from_bits(if limit > 0.0 {
        bits - 1
    } else if limit < 0.0 {
        bits + 1
    } else {
        bits
    })
}

/// Numbers that rounding may have led out of `[0, 1)`, moved in.
#[inline]
pub fn into_unit_square(u: Vec2) -> Vec2 {
    u.clamp(Vec2::ZERO, Vec2::splat(ONE_MINUS_EPSILON))
}

/// The number at a place inside of a part of `[0, 1)`; rounding does not lead to the next part.
///
/// - `low`, `high`: where the part begins and where the next one does, not the same.
/// - `place`: in `[0, 1]`.
#[inline]
pub fn within(place: f32, low: f32, high: f32) -> f32 {
    (low + place * (high - low)).min(below(high))
}

/// Uniform on the unit disk, with little distortion of neighbouring strata.
///
/// Source: Shirley & Chiu 1997.
#[inline]
pub fn uniform_disk(u: Vec2) -> Vec2 {
    let a = 2.0 * u.x - 1.0;
    let b = 2.0 * u.y - 1.0;
    let is_high = a * a <= b * b;
    let (radius, across) = swapped_if(is_high, a, b);
    if radius == 0.0 {
        return Vec2::ZERO;
    }
    let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * (across / radius));
    swapped_if(is_high, radius * cos, radius * sin).into()
}

/// Two numbers, in the other order where asked.
#[inline]
fn swapped_if(swap: bool, a: f32, b: f32) -> (f32, f32) {
    (select(swap, b, a), select(swap, a, b))
}

/// One of two numbers.
///
/// By their bits: the compiler makes a branch of anything else, and which one it will be often cannot be foreseen.
#[inline]
pub(super) fn select(first: bool, then: f32, otherwise: f32) -> f32 {
    let mask = u32::from(first).wrapping_neg();
    f32::from_bits(then.to_bits() & mask | otherwise.to_bits() & !mask)
}

/// Sine and cosine of an angle of at most an eighth of a turn either way, to 1e-7: of one, or of one in each
/// lane.
///
/// Source: Moshier 1992, `sinf` and `cosf`.
#[inline(always)]
pub(super) fn sin_cos_of_eighth<T>(angle: T) -> (T, T)
where
    T: Copy + Mul<Output = T> + Add<Output = T> + Sub<Output = T>,
    T: Mul<f32, Output = T> + Add<f32, Output = T> + Sub<f32, Output = T>,
{
    let z = angle * angle;
    let sin = ((z * -1.951_529_6e-4 + 8.332_161e-3) * z - 1.666_665_5e-1) * z * angle + angle;
    let cos = ((z * 2.443_315_7e-5 - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - z * 0.5 + 1.0;
    (sin, cos)
}

/// Undoes [`uniform_disk`].
pub fn uniform_disk_inverse(point: Vec2) -> Vec2 {
    let radius = point.length();
    let angle = point.y.atan2(point.x);
    // The four wedges of the square, each around one half axis.
    let (a, b) = if (-FRAC_PI_4..FRAC_PI_4).contains(&angle) {
        (radius, radius * angle / FRAC_PI_4)
    } else if (FRAC_PI_4..3.0 * FRAC_PI_4).contains(&angle) {
        (-radius * (angle - FRAC_PI_2) / FRAC_PI_4, radius)
    } else if (-3.0 * FRAC_PI_4..-FRAC_PI_4).contains(&angle) {
        (radius * (angle + FRAC_PI_2) / FRAC_PI_4, -radius)
    } else {
        let behind = if angle > 0.0 { angle - PI } else { angle + PI };
        (-radius, -radius * behind / FRAC_PI_4)
    };
    Vec2::new((a + 1.0) / 2.0, (b + 1.0) / 2.0)
}

/// Density of [`uniform_disk`], in 1/m² on the unit disk.
pub const UNIFORM_DISK_DENSITY: f32 = FRAC_1_PI;

/// Cosine-weighted on the hemisphere around +z.
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let p = uniform_disk(u);
    // Kept off the horizon, where the density is zero.
    let z = (1.0 - p.length_squared()).max(1e-12).sqrt();
    Vec3::new(p.x, p.y, z)
}

/// Undoes [`cosine_hemisphere`].
pub fn cosine_hemisphere_inverse(direction: Vec3) -> Vec2 {
    uniform_disk_inverse(direction.truncate())
}

/// Density of [`cosine_hemisphere`], in 1/sr; zero below the horizon.
#[inline]
pub fn cosine_hemisphere_density(cos: f32) -> f32 {
    cos.max(0.0) * FRAC_1_PI
}

/// Uniform on the unit sphere.
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.y;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}

/// Undoes [`uniform_sphere`].
pub fn uniform_sphere_inverse(direction: Vec3) -> Vec2 {
    Vec2::new(turn(direction.truncate()), (1.0 - direction.z) / 2.0)
}

/// Density of [`uniform_sphere`], in 1/sr.
pub const UNIFORM_SPHERE_DENSITY: f32 = FRAC_1_PI / 4.0;

/// Uniform in the cone around +z whose half angle has the cosine `1 − one_minus_cos`.
///
/// The opening is given as `1 − cos` because a narrow cone's cosine rounds to one.
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let drop = u.y * one_minus_cos;
    let r = (drop * (2.0 - drop)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    Vec3::new(r * cos, r * sin, 1.0 - drop)
}

/// Undoes [`uniform_cone`].
pub fn uniform_cone_inverse(direction: Vec3, one_minus_cos: f32) -> Vec2 {
    // 1 − cos from the sine: exact for narrow cones, too.
    let sin_squared = direction.truncate().length_squared();
    let drop = if direction.z > 0.0 {
        sin_squared / (1.0 + direction.z)
    } else {
        1.0 - direction.z
    };
    Vec2::new(turn(direction.truncate()), drop / one_minus_cos)
}

/// Density of [`uniform_cone`], in 1/sr.
#[inline]
pub fn uniform_cone_density(one_minus_cos: f32) -> f32 {
    1.0 / (TAU * one_minus_cos)
}

/// Uniform barycentric coordinates `(b1, b2)` of a triangle; `b0 = 1 − b1 − b2`.
#[inline]
pub fn uniform_triangle(u: Vec2) -> Vec2 {
    let root = (1.0 - u.x).max(0.0).sqrt();
    Vec2::new(1.0 - root, root * u.y)
}

/// Undoes [`uniform_triangle`].
pub fn uniform_triangle_inverse(barycentrics: Vec2) -> Vec2 {
    let root = 1.0 - barycentrics.x;
    Vec2::new(
        1.0 - root * root,
        if root > 0.0 {
            barycentrics.y / root
        } else {
            0.0
        },
    )
}

/// A number of `[0, 1]` whose density grows linearly from `at_0` to `at_1`, up to a factor.
///
/// - `at_0`, `at_1`: not negative, not both zero.
#[inline]
pub fn linear(u: f32, at_0: f32, at_1: f32) -> f32 {
    let root = (at_0 * at_0 * (1.0 - u) + at_1 * at_1 * u).sqrt();
    (u * (at_0 + at_1) / (at_0 + root)).min(1.0)
}

/// Undoes [`linear`].
#[inline]
pub fn linear_inverse(x: f32, at_0: f32, at_1: f32) -> f32 {
    x * (2.0 * at_0 + x * (at_1 - at_0)) / (at_0 + at_1)
}

/// A point of the unit square whose density is bilinear, up to a factor.
///
/// - `corners`: the density at (0, 0), (1, 0), (0, 1) and (1, 1); not negative, not all zero.
#[inline]
pub fn bilinear(u: Vec2, corners: [f32; 4]) -> Vec2 {
    let [a, b, c, d] = corners;
    let y = linear(u.y, a + b, c + d);
    let x = linear(u.x, a + (c - a) * y, b + (d - b) * y);
    Vec2::new(x, y)
}

/// Undoes [`bilinear`].
pub fn bilinear_inverse(point: Vec2, corners: [f32; 4]) -> Vec2 {
    let [a, b, c, d] = corners;
    let Vec2 { x, y } = point;
    Vec2::new(
        linear_inverse(x, a + (c - a) * y, b + (d - b) * y),
        linear_inverse(y, a + b, c + d),
    )
}

/// Density of [`bilinear`].
#[inline]
pub fn bilinear_density(point: Vec2, corners: [f32; 4]) -> f32 {
    let [a, b, c, d] = corners;
    let (top, bottom) = (a + (b - a) * point.x, c + (d - c) * point.x);
    4.0 * (top + (bottom - top) * point.y) / (a + b + c + d)
}

/// Angle of a vector as a part of a full turn, in `[0, 1)`, from the x axis towards y.
#[inline]
pub fn turn(v: Vec2) -> f32 {
    let part = angle_of(v.x, v.y) / TAU;
    (if part < 0.0 { part + 1.0 } else { part }).min(ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> impl Iterator<Item = Vec2> {
        (0..40).flat_map(|i| {
            (0..40).map(move |j| Vec2::new((i as f32 + 0.37) / 40.0, (j as f32 + 0.61) / 40.0))
        })
    }

    #[test]
    fn stretching_never_reaches_the_upper_corner() {
        let last = Vec2::splat(ONE_MINUS_EPSILON);
        for corner in [
            -2000.0,
            -16.0,
            -3.0,
            -1.0,
            0.0,
            15.0,
            4095.0,
            16_383.0,
            65_535.0_f32,
        ] {
            let (low, high) = (Vec2::splat(corner), Vec2::splat(corner + 1.0));
            let found = stretch(last, low, high);
            assert!(low.cmple(found).all() && found.cmplt(high).all(), "{found}");
            assert_eq!(stretch(Vec2::ZERO, low, high), low);
            assert_eq!(stretch(Vec2::splat(0.5), low, high), low + 0.5);
        }
        assert_eq!(stretch(last, Vec2::ZERO, Vec2::ONE), last);
    }

    fn check(warp: impl Fn(Vec2) -> Vec2) {
        for u in grid() {
            let back = warp(u);
            assert!(
                (back - u).abs().max_element() < 2e-4,
                "{u} came back as {back}"
            );
        }
    }

    #[test]
    fn short_series_are_exact_enough() {
        for i in -1000..=1000 {
            let angle = FRAC_PI_4 * i as f32 / 1000.0;
            let (sin, cos) = sin_cos_of_eighth(angle);
            let (true_sin, true_cos) = f64::from(angle).sin_cos();
            assert!((f64::from(sin) - true_sin).abs() < 1e-7, "sin {angle}");
            assert!((f64::from(cos) - true_cos).abs() < 1e-7, "cos {angle}");
        }
    }

    #[test]
    fn inverses_undo_the_warps() {
        check(|u| uniform_disk_inverse(uniform_disk(u)));
        check(|u| cosine_hemisphere_inverse(cosine_hemisphere(u)));
        check(|u| uniform_sphere_inverse(uniform_sphere(u)));
        check(|u| uniform_triangle_inverse(uniform_triangle(u)));
        for corners in [
            [1.0, 2.0, 3.0, 5.0],
            [4.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 2.0],
        ] {
            check(|u| bilinear_inverse(bilinear(u, corners), corners));
        }
        for one_minus_cos in [1e-6, 0.1, 1.0, 1.9] {
            check(|u| uniform_cone_inverse(uniform_cone(u, one_minus_cos), one_minus_cos));
        }
    }
}
