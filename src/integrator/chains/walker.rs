//! A chain of paths as something that energy flows over.

use std::mem;

use glam::DVec3;

use super::Landing;
use crate::energy::Walker;
use crate::film::pixel_of;
use crate::math::{Rgb, Vec2};
use crate::mutation::{Chain, Proposed};
use crate::path::{self, Path, PathSpace};
use crate::random::{Purpose, Stream};

/// What makes proposals: which mutation comes next, and how large it is.
pub(in crate::integrator) trait Kernel {
    /// Prepares for a seed and all that becomes of it; false where nothing can move it.
    fn prepare(&mut self, seed: &Path) -> bool;

    /// Makes a proposal, see [`Chain::propose`].
    fn propose(
        &mut self,
        chain: &mut Chain,
        space: &PathSpace<'_>,
        random: &mut Stream,
    ) -> Option<Proposed>;
}

/// Walks over paths, and lets their energy land on layers.
pub(in crate::integrator) struct PathWalker<'a, K> {
    landing: Landing<'a>,
    /// The paths walked over.
    pub(in crate::integrator) space: &'a PathSpace<'a>,
    /// What makes proposals.
    pub(in crate::integrator) kernel: K,
    random: Stream,
    /// The chain with its statistics.
    pub(in crate::integrator) chain: Chain,
    seed: Path,
    levels: Vec<Path>,
    proposed: Option<Proposed>,
    here: State,
    there: State,
}

/// A chain that waits: what a walker needs to go on with it.
#[derive(Clone, Debug)]
pub(in crate::integrator) struct Pause {
    /// Where the chain is.
    pub(in crate::integrator) path: Path,
    /// Its random numbers.
    pub(in crate::integrator) random: Stream,
    /// Number of steps in a row that have ended on the path's pixel.
    stay: u32,
}

impl Pause {
    /// A chain that has not begun.
    pub(in crate::integrator) fn new(path: &Path, random: Stream) -> Self {
        Self {
            path: path.clone(),
            random,
            stay: 0,
        }
    }
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

    fn pixel(&self) -> (i32, i32) {
        pixel_of(self.raster)
    }

    /// Takes the energy that waits, and the part of it that is let through.
    #[inline]
    fn take(&mut self) -> (f64, f64) {
        (mem::take(&mut self.energy), mem::take(&mut self.limited))
    }

    /// Lets the energy that waits land.
    #[inline]
    fn land(&mut self, landing: &Landing<'_>) {
        let energy = self.take();
        if energy.0 > 0.0 {
            landing.land(self.raster, self.colour, energy);
        }
    }
}

impl<'a, K: Kernel> PathWalker<'a, K> {
    /// Makes a walker; all of its memory is allocated here.
    ///
    /// - `levels`: states to keep room for.
    pub(in crate::integrator) fn new(
        landing: Landing<'a>,
        space: &'a PathSpace<'a>,
        kernel: K,
        levels: usize,
    ) -> Self {
        Self {
            landing,
            space,
            kernel,
            random: Stream::new(0, Purpose::Chain, 0, 0),
            chain: Chain::default(),
            seed: Path::default(),
            levels: vec![Path::default(); levels],
            proposed: None,
            here: State::default(),
            there: State::default(),
        }
    }

    /// Sets the random numbers of the chains to come.
    pub(in crate::integrator) fn draw_from(&mut self, random: Stream) {
        self.random = random;
    }

    /// Puts the walker on a seed; false where nothing can move it, or it has no light.
    pub(in crate::integrator) fn start(&mut self, seed: &Path) -> bool {
        self.flush();
        if !self.kernel.prepare(seed) || seed.colour().is_none() {
            return false;
        }
        self.seed.copy_from(seed);
        true
    }

    /// Goes on with a chain.
    pub(in crate::integrator) fn resume(&mut self, pause: &Pause) {
        self.flush();
        self.chain.start(&pause.path);
        self.random.clone_from(&pause.random);
        self.here = State {
            stay: pause.stay,
            ..State::of(&pause.path).unwrap_or_default()
        };
    }

    /// A stream of random numbers for a chain that begins at this one.
    pub(in crate::integrator) fn fork(&mut self) -> Stream {
        let seed = (u64::from(self.random.next_u32()) << 32) | u64::from(self.random.next_u32());
        Stream::new(seed, Purpose::Chain, 0, 0)
    }

    /// Leaves a chain for now.
    pub(in crate::integrator) fn pause(&mut self, pause: &mut Pause) {
        self.flush();
        pause.path.copy_from(self.chain.current());
        pause.random.clone_from(&self.random);
        pause.stay = self.here.stay;
    }

    /// Lets all energy that waits land.
    pub(in crate::integrator) fn flush(&mut self) {
        self.here.land(&self.landing);
    }

    /// How much of an energy the limit on consecutive samples lets through at a raster position.
    fn limited(&self, raster: Vec2, energy: f64) -> f64 {
        match self.landing.consecutive_limit {
            Some(limit) if self.here.stay >= limit && pixel_of(raster) == self.here.pixel() => 0.0,
            _ => energy,
        }
    }
}

impl<K: Kernel> Walker for PathWalker<'_, K> {
    fn restart(&mut self) {
        self.flush();
        self.chain.start(&self.seed);
        self.here = State::of(&self.seed).unwrap_or_default();
    }

    #[inline]
    fn propose(&mut self) -> f64 {
        self.proposed = self
            .kernel
            .propose(&mut self.chain, self.space, &mut self.random);
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
        if let Some(tried) = self
            .chain
            .tried()
            .filter(|_| self.landing.counts_proposals())
        {
            self.landing.count_proposal(tried, acceptance);
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
            // With the energy that has come there: it waits for what the next steps bring.
            self.here = State {
                stay: if stays { stay } else { 0 },
                ..self.there
            };
            self.there.take();
        } else {
            self.there.land(&self.landing);
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
        self.there.limited += self.limited(self.there.raster, energy);
        self.there.energy += energy;
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
