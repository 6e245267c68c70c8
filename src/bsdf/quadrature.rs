//! Gauss-Legendre quadrature, for constants and tables that are computed once per material.

use std::f64::consts::PI;

/// Nodes and weights of the Gauss-Legendre rule with `count` points on `[0, 1]`.
///
/// Exact for polynomials of degree `2·count − 1`; the weights sum to one.
///
/// Source: Press et al. 2007, Sec. 4.6 (nodes by Newton's method on the Legendre polynomial).
pub(super) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    (0..count)
        .map(|i| {
            let mut x = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
            let mut slope = 1.0;
            // Newton's method converges quadratically from this start; six steps reach rounding.
            for _ in 0..6 {
                let (value, derivative) = legendre(count, x);
                slope = derivative;
                x -= value / derivative;
            }
            ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// Legendre polynomial of degree `n >= 1` at `|x| < 1`, and its derivative.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (previous, value) = (
            value,
            ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k,
        );
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [1, 2, 5, 32, 64] {
            let rule = gauss_legendre(count);
            for degree in 0..2 * count as i32 {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree)).sum();
                assert!(
                    (sum - 1.0 / f64::from(degree + 1)).abs() < 1e-13,
                    "{count}, {degree}: {sum}"
                );
            }
        }
    }
}
