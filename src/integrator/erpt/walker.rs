//! A chain of paths as something that energy flows over.

use glam::DVec3;

use super::render::Work;
use crate::energy::Walker;
use crate::film::Filter;
use crate::math::{Rgb, Vec2};
use crate::mutation::{Chain, ChoiceAt, Proposed};
use crate::path::{self, Path};
use crate::random::Stream;

/// Walks over paths, and lets their energy land on layers.
pub(super) struct PathWalker<'a> {
    work: &'a Work<'a>,
    random: Stream,
    /// The chain with its statistics.
    pub(super) chain: Chain,
    seed: Path,
    /// The mutations that apply to the seed and to all that becomes of it.
    choice: ChoiceAt,
    levels: Vec<Path>,
    proposed: Option<Proposed>,
    here: State,
    there: State,
}

/// What a state shows, and the energy that waits there.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    raster: Vec2,
    /// Of luminance one.
    colour: Rgb,
    energy: f64,
    /// The part of the energy that the limit on consecutive samples lets through.
    limited: f64,
    /// Number of steps in a row that have ended on the state's pixel.
    stay: u32,
}

impl State {
    /// The state of a path; `None` for a path without light.
    fn of(path: &Path) -> Option<Self> {
        Self::new(path.raster(), path.value())
    }

    /// The state of a path by its raster position and value.
    #[inline]
    fn new(raster: Vec2, value: DVec3) -> Option<Self> {
        Some(Self {
            raster,
            colour: path::colour(value)?,
            ..Self::default()
        })
    }

    fn pixel(&self) -> Vec2 {
        self.raster.floor()
    }
}

impl<'a> PathWalker<'a> {
    /// Makes a walker; all of its memory is allocated here.
    ///
    /// - `levels`: states to keep room for.
    pub(super) fn new(work: &'a Work<'a>, levels: usize) -> Self {
        Self {
            work,
            random: Stream::new(0, crate::random::Purpose::Chain, 0, 0),
            chain: Chain::default(),
            seed: Path::default(),
            choice: ChoiceAt::default(),
            levels: vec![Path::default(); levels],
            proposed: None,
            here: State::default(),
            there: State::default(),
        }
    }

    /// Sets the random numbers of the chains to come.
    pub(super) fn draw_from(&mut self, random: Stream) {
        self.random = random;
    }

    /// Puts the walker on a seed; false where nothing can move it, or it has no light.
    pub(super) fn start(&mut self, seed: &Path) -> bool {
        self.flush();
        self.choice = self.work.mutations.choice.at(seed);
        if self.choice.is_empty() || seed.colour().is_none() {
            return false;
        }
        self.seed.copy_from(seed);
        true
    }

    /// Lets all energy that waits land.
    pub(super) fn flush(&mut self) {
        let state = self.here;
        self.work
            .land(state.raster, state.colour, (state.energy, state.limited));
        self.here.energy = 0.0;
        self.here.limited = 0.0;
    }

    /// How much of an energy the limit on consecutive samples lets through at a raster position.
    fn limited(&self, raster: Vec2, energy: f64) -> f64 {
        match self.work.consecutive_limit {
            Some(limit) if self.here.stay >= limit && raster.floor() == self.here.pixel() => 0.0,
            _ => energy,
        }
    }

    fn count_proposal(&self, acceptance: f64) {
        let Some(raster) = self.chain.tried() else {
            return;
        };
        let pixel = Filter::pixel_box();
        if let Some(proposals) = self.work.proposals {
            proposals.add(&pixel, raster, [1.0]);
        }
        if let Some(layer) = self.work.acceptance {
            layer.add(&pixel, raster, [acceptance as f32]);
        }
    }
}

impl Walker for PathWalker<'_> {
    fn restart(&mut self) {
        self.flush();
        self.chain.start(&self.seed);
        self.here = State::of(&self.seed).unwrap_or_default();
    }

    #[inline]
    fn propose(&mut self) -> f64 {
        let work = self.work;
        self.proposed = self.chain.propose(
            &work.space,
            &work.perturbation,
            &self.choice,
            &mut self.random,
        );
        let mut acceptance = 0.0;
        if let Some(proposed) = self.proposed {
            match State::new(self.chain.proposal().raster(), proposed.value) {
                Some(state) => {
                    self.there = state;
                    acceptance = proposed.acceptance;
                }
                None => {
                    self.chain.settle(proposed, false);
                    self.proposed = None;
                }
            }
        }
        if work.proposals.is_some() || work.acceptance.is_some() {
            self.count_proposal(acceptance);
        }
        acceptance
    }

    #[inline]
    fn settle(&mut self, is_accepted: bool) {
        if let Some(proposed) = self.proposed.take() {
            self.chain.settle(proposed, is_accepted);
        }
        if is_accepted {
            let stays = self.there.pixel() == self.here.pixel();
            let stay = self.here.stay;
            self.flush();
            self.here = State {
                stay: if stays { stay } else { 0 },
                ..self.there
            };
        }
        self.here.stay = self.here.stay.saturating_add(1);
    }

    #[inline]
    fn deposit_here(&mut self, energy: f64) {
        self.here.limited += self.limited(self.here.raster, energy);
        self.here.energy += energy;
    }

    #[inline]
    fn deposit_there(&mut self, energy: f64) {
        let there = self.there;
        let limited = self.limited(there.raster, energy);
        self.work
            .land(there.raster, there.colour, (energy, limited));
    }

    #[inline]
    fn uniform(&mut self) -> f64 {
        // Halfway between the steps of the grid, so that rounding favours neither side.
        (f64::from(self.random.next_u32()) + 0.5) / 4_294_967_296.0
    }

    fn save(&mut self, level: usize) {
        self.levels[level].copy_from(self.chain.current());
    }

    fn save_proposal(&mut self, level: usize) {
        self.levels[level].copy_from(self.chain.proposal());
    }

    fn load(&mut self, level: usize) {
        self.flush();
        self.chain.start(&self.levels[level]);
        self.here = State::of(&self.levels[level]).unwrap_or_default();
    }
}
