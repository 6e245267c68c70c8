//! One Markov chain of paths.

use glam::DVec3;

use super::{
    BidirectionalMutation, Choose, Fault, Move, MoveStatistics, Mutate, Mutation, Perturbation,
    fault,
};
use crate::math::Vec2;
use crate::path::{Path, PathSpace};
use crate::random::Stream;

/// A proposal that may become the current path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposed {
    /// What made it.
    pub made_by: Move,
    /// The probability with which it is to be accepted.
    pub acceptance: f64,
    /// Its [`Path::value`].
    pub value: DVec3,
    /// Its target in the coordinates of the perturbation that made it.
    target: Option<f64>,
}

/// A chain of paths: the current one, a proposal, and what is known about them.
///
/// All memory is here: nothing is allocated while the chain runs. Between two mutations the proposal
/// equals the current path, so that a mutation rewrites only what it changes.
#[derive(Clone, Debug, Default)]
pub struct Chain {
    current: Path,
    proposal: Path,
    /// Targets of the current path in the coordinates of each mutation, as far as they are known.
    targets: [Option<f64>; Mutation::COUNT],
    /// [`Mutate::last_changed`] of each mutation, as far as it is known: the same for all paths that
    /// perturbations make of one.
    last_changed: [Option<Option<usize>>; Mutation::COUNT],
    /// Where the last mutation tried to go on the image.
    tried: Option<Vec2>,
    /// What became of the mutations so far.
    pub statistics: MoveStatistics,
}

impl Chain {
    /// Starts at a path.
    pub fn start(&mut self, seed: &Path) {
        self.current.copy_from(seed);
        self.proposal.copy_from(seed);
        self.forget();
    }

    /// Forgets what is known about the current path.
    #[inline]
    fn forget(&mut self) {
        self.targets = [None; Mutation::COUNT];
        self.last_changed = [None; Mutation::COUNT];
    }

    /// The current path.
    #[inline]
    pub fn current(&self) -> &Path {
        &self.current
    }

    /// The last proposal.
    #[inline]
    pub fn proposal(&self) -> &Path {
        &self.proposal
    }

    /// Raster position that the last mutation tried to go to, whether it got there or not; `None` where it
    /// ended before it had one, or left the image.
    #[inline]
    pub fn tried(&self) -> Option<Vec2> {
        self.tried
    }

    /// Makes a proposal; `None` when there is none, or it would never be accepted. Every proposal must be
    /// settled by [`Chain::settle`].
    ///
    /// The acceptance is `min(1, target(y) P(mutation | y) / (target(x) P(mutation | x)))` with the
    /// probabilities of choosing the mutation.
    ///
    /// Source: Cline et al. 2005, Eq. 7; van Antwerpen 2011, Eq. 6.7.
    #[inline]
    pub fn propose(
        &mut self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        choice: &impl Choose,
        random: &mut Stream,
    ) -> Option<Proposed> {
        self.tried = None;
        // From beyond, there would be no way back.
        if !settings.domain.contains(self.current.raster()) {
            return None;
        }
        let mutation = choice.choose(&self.current, random.next_f32())?;
        let statistics = &mut self.statistics[mutation as usize];
        let here = *self.targets[mutation as usize]
            .get_or_insert_with(|| mutation.target(space, settings, &self.current));
        let proposed = mutation.propose(space, settings, &mut self.proposal, random);
        let raster = self.proposal.raster();
        let has_moved = proposed.is_ok() || raster != self.current.raster();
        self.tried = (has_moved && settings.domain.contains(raster)).then_some(raster);
        let factor = match proposed {
            Ok(factor) => factor,
            Err(reason) => {
                statistics.reject(reason);
                self.restore(Move::Perturbation(mutation));
                return None;
            }
        };
        let again = || mutation.factor(space, settings, &self.proposal);
        debug_assert_eq!(factor.to_bits(), again().to_bits());
        let value = self.proposal.value();
        let target = fault::path_luminance(space, settings, &self.proposal, value) * factor;
        let choices = choice.ratio(space, &self.current, &self.proposal, mutation);
        let choices = settings.fault.keep(Fault::Choice, choices);
        let excess = if settings.fault.is(Fault::Ratio) {
            1.01
        } else {
            1.0
        };
        let ratio = target / here * choices * excess;
        // Not a number, infinite or zero: nothing that a chain could go to.
        let acceptance = if ratio.is_finite() && ratio > 0.0 && here > 0.0 {
            // Unlike `clamp`, no branch: which side of one it lies on cannot be foreseen.
            ratio.min(1.0)
        } else {
            0.0
        };
        self.statistics[mutation as usize].propose(acceptance);
        if acceptance == 0.0 {
            self.restore(Move::Perturbation(mutation));
            return None;
        }
        Some(Proposed {
            made_by: Move::Perturbation(mutation),
            acceptance,
            value,
            target: Some(target),
        })
    }

    /// Makes a proposal that may have another length; as [`Chain::propose`].
    ///
    /// - `chance`: probability with which the mutation is chosen at a path.
    pub fn propose_bidirectional(
        &mut self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        (mutation, chance): (&mut BidirectionalMutation, impl Fn(&Path) -> f64),
        random: &mut Stream,
    ) -> Option<Proposed> {
        self.tried = None;
        if !settings.domain.contains(self.current.raster()) {
            return None;
        }
        let paths = (&self.current, &mut self.proposal);
        let made = mutation.propose(space, settings, paths, random);
        let statistics = &mut self.statistics[Move::Bidirectional.index()];
        let ratio = match made {
            Ok(ratio) => ratio * chance(&self.proposal) / chance(&self.current),
            Err(reason) => {
                statistics.reject(reason);
                self.restore(Move::Bidirectional);
                return None;
            }
        };
        self.tried = Some(self.proposal.raster());
        // Not a number, infinite or zero: nothing that a chain could go to.
        let acceptance = if ratio.is_finite() {
            ratio.clamp(0.0, 1.0)
        } else {
            0.0
        };
        statistics.propose(acceptance);
        if acceptance == 0.0 {
            self.restore(Move::Bidirectional);
            return None;
        }
        Some(Proposed {
            made_by: Move::Bidirectional,
            acceptance,
            value: self.proposal.value(),
            target: None,
        })
    }

    /// Makes a proposal the current path, or forgets it.
    #[inline]
    pub fn settle(&mut self, proposed: Proposed, is_accepted: bool) {
        if !is_accepted {
            return self.restore(proposed.made_by);
        }
        let index = proposed.made_by.index();
        self.statistics[index].accepted += 1;
        match proposed.made_by {
            Move::Perturbation(mutation) => {
                if let Some(last) = self.last_changed(mutation) {
                    self.current.copy_prefix(&self.proposal, last);
                }
                self.targets = [None; Mutation::COUNT];
                self.targets[index] = proposed.target;
            }
            _ => {
                self.current.copy_from(&self.proposal);
                self.forget();
            }
        }
    }

    /// Makes the proposal equal to the current path again.
    #[inline]
    fn restore(&mut self, made_by: Move) {
        match made_by {
            Move::Perturbation(mutation) => {
                if let Some(last) = self.last_changed(mutation) {
                    self.proposal.copy_prefix(&self.current, last);
                }
            }
            _ => self.proposal.copy_from(&self.current),
        }
    }

    /// [`Mutate::last_changed`] at the current path.
    #[inline]
    fn last_changed(&mut self, mutation: Mutation) -> Option<usize> {
        let current = &self.current;
        *self.last_changed[mutation as usize].get_or_insert_with(|| mutation.last_changed(current))
    }
}
