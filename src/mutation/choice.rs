//! Which mutation comes next.

use super::{CausticPerturbation, Mutate, Mutation};
use crate::path::{Path, PathSpace};

/// Chooses a mutation for a path.
pub trait Choose {
    /// Chooses a mutation that applies; `None` where none does.
    ///
    /// - `u`: uniform in `[0, 1)`.
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation>;

    /// What the choice makes of the density of a move: the ratio of its values for the way back and the
    /// way there is part of the acceptance.
    ///
    /// The probability of choosing the mutation at the path left; or, where any of several mutations may have
    /// made the move, the density of all of them over that of the one.
    ///
    /// - `from`, `to`: the path left and the path proposed.
    fn density(&self, space: &PathSpace<'_>, from: &Path, to: &Path, mutation: Mutation) -> f64;

    /// [`Choose::density`] of the way back over that of the way there: a factor of the acceptance.
    #[inline]
    fn ratio(&self, space: &PathSpace<'_>, from: &Path, to: &Path, mutation: Mutation) -> f64 {
        self.density(space, to, from, mutation) / self.density(space, from, to, mutation)
    }
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
            if *weight > 0.0 && mutation.site(path).is_none() {
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

/// A [`Choice`] among the mutations that apply to the paths of one signature: worked out once a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChoiceAt {
    weights: [f32; Mutation::COUNT],
    total: f32,
}

impl Choice {
    /// The choice at a path, and at all that mutations make of it.
    #[inline]
    pub fn at(&self, path: &Path) -> ChoiceAt {
        let weights = self.applicable(path);
        ChoiceAt {
            weights,
            total: weights.iter().sum(),
        }
    }
}

impl ChoiceAt {
    /// True when no mutation applies.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.total <= 0.0
    }

    /// Sum of the weights of the mutations that may be chosen.
    #[inline]
    pub fn total(&self) -> f64 {
        f64::from(self.total)
    }

    /// Probability of choosing a mutation.
    #[inline]
    pub fn probability(&self, mutation: Mutation) -> f64 {
        f64::from(self.weights[mutation as usize]) / f64::from(self.total)
    }
}

impl Choose for ChoiceAt {
    #[inline]
    fn choose(&self, _path: &Path, u: f32) -> Option<Mutation> {
        let mut left = u * self.total;
        let mut last = None;
        for (weight, mutation) in self.weights.into_iter().zip(Mutation::ALL) {
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
    fn density(&self, _: &PathSpace<'_>, _from: &Path, _to: &Path, mutation: Mutation) -> f64 {
        self.probability(mutation)
    }

    /// One: both ends have one signature.
    #[inline]
    fn ratio(&self, _: &PathSpace<'_>, _from: &Path, _to: &Path, _mutation: Mutation) -> f64 {
        1.0
    }
}

impl Choose for Choice {
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        self.at(path).choose(path, u)
    }

    fn density(&self, _: &PathSpace<'_>, from: &Path, _to: &Path, mutation: Mutation) -> f64 {
        self.at(from).probability(mutation)
    }
}
