//! Which mutation comes next.

use super::Mlt;
use crate::integrator::chains::Kernel;
use crate::integrator::metropolis::Importance;
use crate::mutation::{
    BidirectionalMutation, Chain, Choice, ChoiceAt, Choose, Mutation, Perturbation, Proposed,
};
use crate::path::{Path, PathSpace};
use crate::random::Stream;

/// A mixture of the mutations that apply to a path and of the one that always does.
pub(super) struct MltKernel<'a> {
    choice: &'a Choice,
    perturbation: &'a Perturbation,
    /// Weight of the bidirectional mutation.
    weight: f64,
    bidirectional: BidirectionalMutation,
    importance: &'a Importance,
}

/// A choice, and the importance of places: as part of the density of a move away, it becomes part of the
/// target.
struct Weighed<'a>(ChoiceAt, &'a Importance);

impl Choose for Weighed<'_> {
    #[inline]
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        self.0.choose(path, u)
    }

    #[inline]
    fn density(&self, space: &PathSpace<'_>, from: &Path, to: &Path, mutation: Mutation) -> f64 {
        self.0.density(space, from, to, mutation) * self.1.at(from.raster())
    }
}

impl<'a> MltKernel<'a> {
    /// Makes the kernel; all of its memory is allocated here.
    pub(super) fn new(
        mlt: &'a Mlt,
        perturbation: &'a Perturbation,
        importance: &'a Importance,
    ) -> Self {
        Self {
            choice: &mlt.mutations.choice,
            perturbation,
            weight: mlt.bidirectional,
            bidirectional: mlt.bidirectional_mutation(),
            importance,
        }
    }
}

/// Probability of the bidirectional mutation at a path.
fn chance(choice: &Choice, weight: f64, path: &Path) -> f64 {
    weight / (weight + choice.at(path).total())
}

impl Kernel for MltKernel<'_> {
    fn prepare(&mut self, seed: &Path) -> bool {
        (self.weight > 0.0 && self.bidirectional.applies(seed)) || !self.choice.at(seed).is_empty()
    }

    #[inline]
    fn propose(
        &mut self,
        chain: &mut Chain,
        space: &PathSpace<'_>,
        random: &mut Stream,
    ) -> Option<Proposed> {
        let (choice, weight, importance) = (self.choice, self.weight, self.importance);
        if weight > 0.0 {
            let own = chance(choice, weight, chain.current());
            if f64::from(random.next_f32()) < own {
                let mutation = (&mut self.bidirectional, |path: &Path| {
                    chance(choice, weight, path) * importance.at(path.raster())
                });
                return chain.propose_bidirectional(space, self.perturbation, mutation, random);
            }
        }
        let at = Weighed(choice.at(chain.current()), importance);
        chain.propose(space, self.perturbation, &at, random)
    }
}
