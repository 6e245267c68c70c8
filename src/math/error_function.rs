//! The error function and its inverse in single precision.

/// `erf(x)` to 5e-7 and `exp(−x²)`, for `x ≥ 0`.
///
/// Source: Abramowitz & Stegun 1964, Sec. 7.1.
#[inline]
pub fn erf_and_gauss(x: f32) -> (f32, f32) {
    const COEFFICIENTS: [f32; 5] = [
        1.061_405_4,
        -1.453_152,
        1.421_413_7,
        -0.284_496_74,
        0.254_829_6,
    ];
    let gauss = (-x * x).exp();
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let polynomial = COEFFICIENTS.iter().fold(0.0, |sum, c| sum * t + c) * t;
    (1.0 - polynomial * gauss, gauss)
}

/// The `x` with `erf(x) = y`, finite: for `|y|` near one that of the last `f32` before.
///
/// Source: Giles 2012 (single precision).
#[inline]
pub fn erf_inverse(y: f32) -> f32 {
    const CENTRE: [f32; 9] = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        2.185_808_7e-4,
        -1.253_725_1e-3,
        -4.177_681_6e-3,
        0.246_640_73,
        1.501_409_4,
    ];
    const TAIL: [f32; 9] = [
        -2.002_142_6e-4,
        1.009_505_6e-4,
        1.349_343_2e-3,
        -3.673_428_4e-3,
        5.739_507_7e-3,
        -7.622_461_3e-3,
        9.438_870_5e-3,
        1.001_674,
        2.832_976_8,
    ];
    let distance = ((1.0 - y) * (1.0 + y)).max(f32::EPSILON);
    let w = -distance.ln();
    let (coefficients, w) = if w < 5.0 {
        (CENTRE, w - 2.5)
    } else {
        (TAIL, w.sqrt() - 3.0)
    };
    y * coefficients.iter().fold(0.0, |sum, c| sum * w + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_function_and_its_inverse() {
        for i in 0..=4000 {
            let x = i as f32 / 1000.0;
            let (erf, gauss) = erf_and_gauss(x);
            let exact = statrs::function::erf::erf(f64::from(x));
            assert!((f64::from(erf) - exact).abs() < 5e-7);
            assert!((gauss - (-x * x).exp()).abs() < 1e-7);
        }
        for i in -999..1000 {
            let y = i as f32 / 1000.0;
            let back = statrs::function::erf::erf(f64::from(erf_inverse(y)));
            assert!((back - f64::from(y)).abs() < 1e-6, "{y}");
        }
        assert!(erf_inverse(1.0).is_finite() && erf_inverse(-1.0) < -3.5);
        assert_eq!(erf_and_gauss(f32::INFINITY), (1.0, 0.0));
    }
}
