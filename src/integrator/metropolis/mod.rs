//! Metropolis sampling, whatever its chains walk over: seeds, their energy, and passes.
//!
//! A pass makes a bootstrap set of samples all over the image. Their mean is the energy that the pass
//! hands out, and its seeds are drawn from them in proportion to their luminance, so that a chain is in
//! equilibrium from its first step on and no energy is known from elsewhere. In expectation, every
//! sample's energy then flows along chains of one length, as in energy redistribution; the mean of
//! passes has no bias, however short they are.

mod bootstrap;
mod importance;
mod numbers;
mod options;
mod render;

pub(super) use bootstrap::Seed;
pub(super) use importance::Importance;
pub(super) use numbers::PrimaryNumbers;
pub(super) use options::{MetropolisOptions, PrimaryOptions};
pub(super) use render::{ChainPlan, Metropolis, Sampling, counted};
