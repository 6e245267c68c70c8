//! Chains of numbers.

use super::ChainPlan;
use crate::math::Vec2;
use crate::mutation::{PrimarySpace, SmallSteps};

/// The numbers of a sample, on both sides; path tracing takes those of the eye's only.
pub(in crate::integrator) struct PrimaryNumbers {
    pub(in crate::integrator) eye: PrimarySpace,
    light: PrimarySpace,
}

/// Tells streams of chains from those of bootstrap samples, of which there are fewer.
const CHAINS: u32 = 1 << 31;

impl PrimaryNumbers {
    /// Makes a place for samples; all of its memory is allocated here.
    pub(in crate::integrator) fn new(steps: SmallSteps, plan: &ChainPlan<'_>) -> Self {
        let new = || PrimarySpace::new(steps, plan.bootstrap_numbers(0));
        Self {
            eye: new(),
            light: new(),
        }
    }

    /// Begins a sample of the bootstrap set.
    pub(in crate::integrator) fn begin(&mut self, plan: &ChainPlan<'_>, sample: u32) {
        let whole = (Vec2::ZERO, Vec2::ONE);
        let cell = plan.cells.cell(sample);
        self.eye.begin(plan.bootstrap_numbers(sample), cell);
        self.light.begin(plan.light_numbers(sample), whole);
    }

    /// Makes the sample begun the first of a chain.
    pub(in crate::integrator) fn start_chain(&mut self, plan: &ChainPlan<'_>, chain: u32) {
        self.eye.start_chain(plan.chain_numbers(chain));
        self.light.start_chain(plan.light_numbers(chain | CHAINS));
    }

    /// Begins a proposal: the numbers asked for from now on are its.
    #[inline]
    pub(in crate::integrator) fn propose(&mut self, is_large: bool) {
        self.eye.propose(is_large);
        self.light.propose(is_large);
    }

    /// Makes the proposal the current state, or forgets it.
    #[inline]
    pub(in crate::integrator) fn settle(&mut self, acceptance: f64, is_accepted: bool) {
        self.eye.settle(acceptance, is_accepted);
        self.light.settle(acceptance, is_accepted);
    }

    /// A number for a decision.
    #[inline]
    pub(in crate::integrator) fn uniform(&mut self) -> f64 {
        f64::from(self.eye.random().next_f32())
    }

    /// The numbers of the eye's and of the light's side.
    #[inline]
    pub(in crate::integrator) fn sides(&mut self) -> [&mut PrimarySpace; 2] {
        [&mut self.eye, &mut self.light]
    }
}
