//! Tests of hypotheses: does a sampler follow its density, do two means agree.
//!
//! The distributions come from `statrs`; here stand the tests that rendering needs of them.

use statrs::function::{erf::erfc, gamma::gamma_ur};

/// Chance that a value at least as far out as `z` comes from a standard normal distribution, on
/// either side.
pub fn two_sided_p(z: f64) -> f64 {
    erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Level of each of `count` independent tests, so that the family errs with probability `level`.
///
/// Source: Šidák 1967.
pub fn sidak(level: f64, count: usize) -> f64 {
    -((-level).ln_1p() / count as f64).exp_m1()
}

/// Chance that counts at least as far from their expectation come from it (Pearson's χ²).
///
/// Cells that expect less than five are pooled, smallest first. Counts in cells that expect nothing
/// make the chance zero: the sampler does what its density says is impossible.
///
/// - `observed`: count of each cell.
/// - `expected`: expected count of each cell; needs not sum to the number of samples, where some of
///   them end outside of all cells: give that outside as a cell of its own.
///
/// `None` when fewer than two cells are left after pooling.
pub fn chi_square_p(observed: &[f64], expected: &[f64]) -> Option<f64> {
    const POOL_BELOW: f64 = 5.0;
    assert_eq!(
        observed.len(),
        expected.len(),
        "every cell has a count and an expectation"
    );
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    let (mut pooled_observed, mut pooled_expected) = (0.0, 0.0);
    let (mut chi_square, mut cells) = (0.0, 0);
    for index in order {
        if expected[index] == 0.0 {
            if observed[index] > 0.0 {
                return Some(0.0);
            }
            continue;
        }
        pooled_observed += observed[index];
        pooled_expected += expected[index];
        if pooled_expected >= POOL_BELOW {
            chi_square += (pooled_observed - pooled_expected).powi(2) / pooled_expected;
            cells += 1;
            (pooled_observed, pooled_expected) = (0.0, 0.0);
        }
    }
    (cells >= 2).then(|| gamma_ur((f64::from(cells) - 1.0) / 2.0, chi_square / 2.0))
}

/// Chance (Pearson's χ²) that two histograms come from one distribution, of what is in cells of twenty or
/// more in both together.
///
/// `None` when fewer than two cells are so full.
pub fn two_samples_p(first: &[f64], second: &[f64]) -> Option<f64> {
    let sums = [first, second].map(|counts| counts.iter().sum::<f64>());
    let total = sums[0] + sums[1];
    let kept: Vec<(f64, f64)> = first
        .iter()
        .zip(second)
        .filter(|(a, b)| **a + **b >= 20.0)
        .map(|(a, b)| (*a, *b))
        .collect();
    if kept.len() < 2 {
        return None;
    }
    let of = |(a, b): &(f64, f64)| {
        let [ea, eb] = sums.map(|sum| (a + b) * sum / total);
        (a - ea).powi(2) / ea + (b - eb).powi(2) / eb
    };
    let statistic: f64 = kept.iter().map(of).sum();
    Some(gamma_ur((kept.len() as f64 - 1.0) / 2.0, statistic / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    #[test]
    fn quantiles_are_those_of_the_tables() {
        assert!((two_sided_p(1.959_964) - 0.05).abs() < 1e-6);
        assert!((sidak(0.01, 1000) - 1.005e-5).abs() < 1e-8);
        assert!((sidak(0.05, 1) - 0.05).abs() < 1e-12);
        // χ² = 3.841 with one degree of freedom is the 5 % point.
        let d = (3.841_459_f64 * 25.0).sqrt();
        let p = chi_square_p(&[50.0 + d, 50.0 - d], &[50.0, 50.0]);
        assert!((p.unwrap() - 0.05).abs() < 1e-6, "{p:?}");
    }

    #[test]
    fn right_counts_pass_and_wrong_ones_fail() {
        let mut stream = Stream::new(5, Purpose::Check, 0, 0);
        let mut observed = [0.0; 10];
        for _ in 0..100_000 {
            observed[(stream.next_f32() * 10.0) as usize] += 1.0;
        }
        assert!(chi_square_p(&observed, &[10_000.0; 10]).unwrap() > 0.001);
        let mut tilted = [10_000.0; 10];
        tilted[0] *= 1.05;
        tilted[1] *= 0.95;
        assert!(chi_square_p(&observed, &tilted).unwrap() < 1e-6);
        assert_eq!(chi_square_p(&[3.0, 7.0], &[0.0, 10.0]), Some(0.0));
        assert_eq!(chi_square_p(&[7.0], &[10.0]), None);
        let p = two_samples_p(&observed, &[5_000.0; 10]);
        assert!(p.unwrap() > 0.001);
        assert!(two_samples_p(&observed, &tilted).unwrap() < 1e-3);
        assert_eq!(two_samples_p(&[7.0, 3.0], &[20.0, 3.0]), None);
    }
}
