//! What became of mutations.

use std::ops::AddAssign;

use super::Rejection;

/// What became of the mutations of one kind. Integers: their sums do not depend on the order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MutationStatistics {
    /// Mutations tried.
    pub proposed: u64,
    /// Mutations accepted.
    pub accepted: u64,
    /// Sum of the acceptance probabilities, in steps of 2⁻²⁰.
    acceptance: u64,
    /// Mutations that made no proposal, by reason.
    rejected: [u64; Rejection::COUNT],
}

const STEPS: f64 = (1_u64 << 20) as f64;

impl MutationStatistics {
    /// Counts a mutation that made no proposal.
    #[inline]
    pub fn reject(&mut self, reason: Rejection) {
        self.proposed += 1;
        self.rejected[reason as usize] += 1;
    }

    /// Counts a proposal.
    #[inline]
    pub fn propose(&mut self, acceptance: f64) {
        self.proposed += 1;
        self.acceptance += (acceptance * STEPS + 0.5) as u64;
    }

    /// Mean acceptance probability of all mutations tried; zero when there were none.
    pub fn mean_acceptance(&self) -> f64 {
        self.acceptance as f64 / STEPS / self.proposed.max(1) as f64
    }

    /// Number of mutations that came to nothing for a reason.
    pub fn rejections(&self, reason: Rejection) -> u64 {
        self.rejected[reason as usize]
    }
}

impl AddAssign for MutationStatistics {
    fn add_assign(&mut self, other: Self) {
        self.proposed += other.proposed;
        self.accepted += other.accepted;
        self.acceptance += other.acceptance;
        for (sum, count) in self.rejected.iter_mut().zip(other.rejected) {
            *sum += count;
        }
    }
}
