//! Adapting a mixture of kernels to how well each of them does.

/// How often proposals of one kernel were made, and how likely they were accepted.
///
/// Integers: their sums do not depend on the order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AcceptanceTally {
    /// Mutations tried.
    pub count: u64,
    /// Sum of their acceptance probabilities, in steps of [`AcceptanceTally::STEP`].
    pub steps: u64,
}

impl AcceptanceTally {
    /// Resolution of acceptance probabilities.
    pub const STEP: f64 = 1.0 / 1_048_576.0;

    /// An acceptance probability in steps.
    #[inline]
    pub fn in_steps(acceptance: f64) -> u64 {
        (acceptance / Self::STEP + 0.5) as u64
    }

    /// Counts a mutation.
    #[inline]
    pub fn add(&mut self, acceptance: f64) {
        self.count += 1;
        self.steps += Self::in_steps(acceptance);
    }

    /// Mean acceptance, as if `prior.0` further mutations had had the mean `prior.1`; zero when there is
    /// nothing to go by.
    pub fn mean(&self, prior: (f64, f64)) -> f64 {
        let count = self.count as f64 + prior.0;
        let sum = self.steps as f64 * Self::STEP + prior.0 * prior.1;
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// Probabilities of choosing each kernel of a mixture: in proportion to merit, but never none; all the
/// same while no kernel has any merit.
///
/// - `merits`: not negative; the mean acceptances, for one.
/// - `epsilon`: how much goes to each kernel whatever its merit, in `[0, 1]`.
///
/// Differs: normalised, and of means. As printed the probabilities sum to more than one, and sums of acceptances
/// feed back on themselves: what is chosen more often is accepted more often in all.
///
/// Source: Lai et al. 2007, Sec. 4.3.
///
/// ```
/// use lumiflow::energy::kernel_weights;
/// assert_eq!(kernel_weights(&[0.6, 0.2], 0.0), [0.75, 0.25]);
/// assert_eq!(kernel_weights(&[0.0, 0.0], 0.0), [0.5, 0.5]);
/// assert_eq!(kernel_weights(&[0.5, 0.0], 0.5), [0.6666667, 0.33333334]);
/// ```
pub fn kernel_weights(merits: &[f64], epsilon: f64) -> Vec<f32> {
    let count = merits.len() as f64;
    let sum: f64 = merits.iter().sum();
    let weight = |merit: f64| {
        let share = if sum > 0.0 { merit / sum } else { 1.0 / count };
        (epsilon + (1.0 - epsilon) * share) / (1.0 + (count - 1.0) * epsilon)
    };
    merits.iter().map(|merit| weight(*merit) as f32).collect()
}

/// Chooses a kernel by its probability.
///
/// - `weights`: of the kernels, summing to one; not empty.
/// - `u`: uniform in `[0, 1)`.
#[inline]
pub fn choose_kernel(weights: &[f32], u: f32) -> usize {
    let mut left = u;
    for (kernel, weight) in weights.iter().enumerate() {
        if left < *weight {
            return kernel;
        }
        left -= weight;
    }
    // Rounding can leave a rest after the last one.
    weights.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tallies_have_means_with_priors() {
        let mut tally = AcceptanceTally::default();
        assert_eq!(tally.mean((0.0, 0.7)), 0.0);
        assert_eq!(tally.mean((4.0, 0.75)), 0.75);
        tally.add(0.25);
        tally.add(0.75);
        assert!((tally.mean((0.0, 0.0)) - 0.5).abs() < 1e-6);
        assert!((tally.mean((2.0, 1.0)) - 0.75).abs() < 1e-6);
    }

    #[test]
    fn weights_sum_to_one_and_leave_no_kernel_out() {
        for epsilon in [0.0, 0.01, 1.0] {
            let weights = kernel_weights(&[0.9, 0.3, 0.0], epsilon);
            let sum: f32 = weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-6, "{weights:?}");
            assert!(epsilon == 0.0 || weights.iter().all(|weight| *weight > 0.0));
        }
    }

    #[test]
    fn kernels_are_chosen_by_their_weights() {
        let weights = [0.25, 0.5, 0.25];
        let chosen = [0.0, 0.24, 0.25, 0.74, 0.75, 0.999_999].map(|u| choose_kernel(&weights, u));
        assert_eq!(chosen, [0, 0, 1, 1, 2, 2]);
    }
}
