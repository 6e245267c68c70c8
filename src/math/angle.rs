//! Angles of directions in a plane.

use std::f32::consts::{FRAC_PI_2, PI};

use super::warp::select;

/// The angle from the x axis to `(x, y)` in radians, in `[−π, π]`; as [`f32::atan2`] to 3e-7, without a call and
/// without a branch. Zero for the origin.
///
/// Source: Abramowitz & Stegun 1964, 4.4.49, for an eighth of a turn; the rest is symmetry.
#[inline]
pub fn angle_of(x: f32, y: f32) -> f32 {
    const ODD: [f32; 8] = [
        0.002_866_225_7,
        -0.016_165_737,
        0.042_909_615,
        -0.075_289_64,
        0.106_562_64,
        -0.142_089,
        0.199_935_51,
        -0.333_331_47,
    ];
    let (along, across) = (x.abs(), y.abs());
    // No more than one; the divisor is no zero.
    let slope = along.min(across) / along.max(across).max(f32::MIN_POSITIVE);
    let squared = slope * slope;
    let mut sum = 0.0;
    for coefficient in ODD {
        sum = (sum + coefficient) * squared;
    }
    let eighth = slope + slope * sum;
    let quarter = select(across > along, FRAC_PI_2 - eighth, eighth);
    select(x < 0.0, PI - quarter, quarter).copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_library() {
        let mut largest = 0.0_f64;
        for step in 0..40_000 {
            let angle = f64::from(step) / 40_000.0 * std::f64::consts::TAU;
            for radius in [1e-30, 1.0, 3e20] {
                let (x, y) = ((radius * angle.cos()) as f32, (radius * angle.sin()) as f32);
                let exact = f64::from(y).atan2(f64::from(x));
                let error = (f64::from(angle_of(x, y)) - exact).abs();
                largest = largest.max(error);
            }
        }
        assert!(largest < 3e-7, "{largest}");
    }

    #[test]
    fn axes_have_their_angles() {
        for (x, y, angle) in [
            (0.0, 0.0, 0.0),
            (2.0, 0.0, 0.0),
            (2.0, 2.0, FRAC_PI_2 / 2.0),
            (0.0, 2.0, FRAC_PI_2),
            (-2.0, 0.0, PI),
            (-2.0, -0.0, -PI),
            (0.0, -2.0, -FRAC_PI_2),
        ] {
            let found = angle_of(x, y);
            assert!((found - angle).abs() < 2e-7, "{x} {y}: {found}");
        }
    }
}
