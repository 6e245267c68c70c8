//! One Markov chain of paths.

use std::mem;

use glam::DVec3;

use super::{
    BidirectionalMutation, Choose, Fault, Move, MoveStatistics, Mutate, Mutation, Perturbation,
    Site, fault,
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
/// All memory is here: nothing is allocated while the chain runs. A mutation rewrites only what it changes,
/// so that a proposal needs to be a copy of the current path no further than there; accepting one exchanges
/// the two.
#[derive(Clone, Debug, Default)]
pub struct Chain {
    current: Box<Path>,
    proposal: Box<Path>,
    /// What the proposal and the current path differ in.
    difference: Difference,
    /// Targets of the current path in the coordinates of each mutation, as far as they are known.
    targets: [Option<f64>; Mutation::COUNT],
    /// [`Mutate::site`] of each mutation, as far as it is known: the same for all paths that perturbations
    /// make of one.
    sites: [Option<Option<Site>>; Mutation::COUNT],
    /// Where the last mutation tried to go on the image.
    tried: Option<Vec2>,
    /// What became of the mutations so far.
    pub statistics: MoveStatistics,
}

/// What a proposal and the current path differ in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Difference {
    /// All that there is.
    #[default]
    All,
    /// What a mutation changes.
    Of(Mutation),
}

impl Chain {
    /// Starts at a path.
    pub fn start(&mut self, seed: &Path) {
        self.current.copy_from(seed);
        self.difference = Difference::All;
        self.forget();
    }

    /// Forgets what is known about the current path.
    #[inline]
    fn forget(&mut self) {
        self.targets = [None; Mutation::COUNT];
        self.sites = [None; Mutation::COUNT];
    }

    /// The current path.
    #[inline]
    pub fn current(&self) -> &Path {
        &self.current
    }

    /// The last proposal, until it is settled; in disorder where there was none.
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
        let site = self.site(mutation)?;
        let here = *self.targets[mutation as usize]
            .get_or_insert_with(|| mutation.target(space, settings, &self.current, site));
        self.prepare(mutation);
        let paths = (&*self.current, &mut *self.proposal);
        let proposed = mutation.propose(space, settings, site, paths, random);
        let raster = self.proposal.raster();
        let has_moved = proposed.is_ok() || raster != self.current.raster();
        self.tried = (has_moved && settings.domain.contains(raster)).then_some(raster);
        let factor = match proposed {
            Ok(factor) => factor,
            Err(reason) => {
                self.statistics[mutation as usize].reject(reason);
                return None;
            }
        };
        let again = || mutation.factor(space, settings, &self.proposal, site);
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
        (acceptance > 0.0).then_some(Proposed {
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
        let paths = (&*self.current, &mut *self.proposal);
        self.difference = Difference::All;
        let made = mutation.propose(space, settings, paths, random);
        let statistics = &mut self.statistics[Move::Bidirectional.index()];
        let ratio = match made {
            Ok(ratio) => ratio * chance(&self.proposal) / chance(&self.current),
            Err(reason) => {
                statistics.reject(reason);
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
        (acceptance > 0.0).then(|| Proposed {
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
            return;
        }
        let index = proposed.made_by.index();
        self.statistics[index].accepted += 1;
        mem::swap(&mut self.current, &mut self.proposal);
        match proposed.made_by {
            Move::Perturbation(_) => {
                self.targets = [None; Mutation::COUNT];
                self.targets[index] = proposed.target;
            }
            _ => self.forget(),
        }
    }

    /// Makes the proposal a copy of the current path, apart from what a mutation changes anyway.
    #[inline]
    fn prepare(&mut self, mutation: Mutation) {
        match self.difference {
            Difference::Of(other) if other == mutation => {}
            Difference::Of(other) => {
                if let Some(site) = self.site(other) {
                    self.proposal.copy_prefix(&self.current, site.last_changed);
                }
            }
            Difference::All => self.proposal.copy_from(&self.current),
        }
        self.proposal.set_raster(self.current.raster());
        self.difference = Difference::Of(mutation);
    }

    /// [`Mutate::site`] at the current path.
    #[inline]
    fn site(&mut self, mutation: Mutation) -> Option<Site> {
        let current = &self.current;
        *self.sites[mutation as usize].get_or_insert_with(|| mutation.site(current))
    }
}
