//! Paths under way.

use super::pixel::Estimate;
use crate::math::lanes::Vec4;
use crate::math::{Rgb, Vec3};
use crate::random::Sampler;

/// How the last direction was made, for weighing the emitter that it meets.
#[derive(Clone, Copy)]
pub(super) struct Departure {
    /// Where the ray left from.
    pub(super) position: Vec3,
    /// Density of its direction in 1/sr; `None` for the camera and Dirac lobes, whose directions no
    /// other technique makes.
    pub(super) density: Option<f32>,
}

/// A path under way: what it has collected, and what it carries along.
pub(super) struct Walk<'r> {
    /// What it has collected.
    pub(super) estimate: Estimate,
    pub(super) throughput: Rgb,
    /// Product of [`BsdfSample::eta`](crate::bsdf::BsdfSample::eta) over the events so far: refraction has
    /// made radiance grow by its square.
    pub(super) eta: f32,
    pub(super) departure: Departure,
    /// Its random numbers.
    pub(super) sampler: &'r mut Sampler,
}

impl Walk<'_> {
    /// The throughput, and [`Walk::eta`] last.
    #[inline(always)]
    pub(super) fn state(&self) -> Vec4 {
        self.throughput.0.extend(self.eta)
    }

    /// Undoes [`Walk::state`].
    #[inline(always)]
    pub(super) fn set_state(&mut self, state: Vec4) {
        self.throughput = Rgb(state.truncate());
        self.eta = state.w;
    }

    /// Takes a scattering event along.
    ///
    /// - `weight`, `eta`: as [`BsdfSample`](crate::bsdf::BsdfSample) has them.
    #[inline(always)]
    pub(super) fn scatter(&mut self, departure: Departure, weight: Rgb, eta: f32) {
        self.throughput *= weight;
        self.eta *= eta;
        self.departure = departure;
    }
}
