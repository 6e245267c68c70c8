//! Which mutation comes next.

use super::{CausticPerturbation, Mutate, Mutation};
use crate::path::Path;

/// Chooses a mutation for a path.
pub trait Choose {
    /// Chooses a mutation that applies; `None` where none does.
    ///
    /// - `u`: uniform in `[0, 1)`.
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation>;

    /// Probability of choosing a mutation at a path: the ratio of two of them is part of the
    /// acceptance.
    fn probability(&self, path: &Path, mutation: Mutation) -> f64;
}

/// The choice by a path's signature.
///
/// All paths that mutations lead to share one signature, so that the probabilities cancel in every
/// acceptance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Weight of each mutation; zero switches it off.
    pub weights: [f32; Mutation::COUNT],
    /// Whether one mutation is chosen by rule: the caustic perturbation for `E D S⁺ (D|L) …`, else the
    /// lens perturbation, else a mixture of those that pass further Dirac events. If not, all that
    /// apply are mixed.
    ///
    /// Source: Cline et al. 2005, Sec. 4.3.
    pub by_rule: bool,
}

impl Choice {
    /// Weights of the mutations that may be chosen at a path.
    #[inline]
    fn applicable(&self, path: &Path) -> [f32; Mutation::COUNT] {
        let mut weights = self.weights;
        for (weight, mutation) in weights.iter_mut().zip(Mutation::ALL) {
            if *weight > 0.0 && mutation.last_changed(path).is_none() {
                *weight = 0.0;
            }
        }
        if !self.by_rule {
            return weights;
        }
        let only = |chosen: Mutation| {
            let mut one = [0.0; Mutation::COUNT];
            one[chosen as usize] = 1.0;
            one
        };
        let offered = |mutation: Mutation| weights[mutation as usize] > 0.0;
        if offered(Mutation::Caustic) && CausticPerturbation::is_caustic(path) {
            only(Mutation::Caustic)
        } else if offered(Mutation::Lens) {
            only(Mutation::Lens)
        } else if offered(Mutation::MultiChain) || offered(Mutation::LaiLens) {
            weights[Mutation::Caustic as usize] = 0.0;
            weights
        } else {
            weights
        }
    }
}

impl Choose for Choice {
    #[inline]
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        let weights = self.applicable(path);
        let total: f32 = weights.iter().sum();
        let mut left = u * total;
        let mut last = None;
        for (weight, mutation) in weights.into_iter().zip(Mutation::ALL) {
            if weight > 0.0 {
                if left < weight {
                    return Some(*mutation);
                }
                left -= weight;
                last = Some(*mutation);
            }
        }
        // Rounding can leave a rest after the last one.
        last
    }

    #[inline]
    fn probability(&self, path: &Path, mutation: Mutation) -> f64 {
        let weights = self.applicable(path);
        let total: f32 = weights.iter().sum();
        f64::from(weights[mutation as usize]) / f64::from(total)
    }
}
