//! The table of emitters, and the choice among them.

use super::EmitterId;
use crate::emitter::{Emitter, EmitterModel, EmitterSample};
use crate::math::distribution::Discrete;
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::SurfacePoint;

/// All emitters of a scene; one is chosen in proportion to its power.
#[derive(Clone, Debug)]
pub struct Lights {
    emitters: Vec<Emitter>,
    choice: Option<Discrete>,
    environment: Option<EmitterId>,
}

/// A direction to a chosen emitter.
#[derive(Clone, Copy, Debug)]
pub struct ChosenSample {
    /// The direction; its density includes the probability of the choice.
    pub sample: EmitterSample,
    /// The chosen emitter.
    pub emitter: EmitterId,
}

impl Lights {
    /// Makes the table.
    ///
    /// An emitter without power is never chosen; if none has any, all are equally likely.
    pub(super) fn new(emitters: Vec<Emitter>) -> Self {
        let powers: Vec<f64> = emitters.iter().map(EmitterModel::power).collect();
        let choice = Discrete::new(&powers).or_else(|| Discrete::new(&vec![1.0; emitters.len()]));
        let is_environment = |e: &Emitter| e.class() == crate::emitter::EmitterClass::Environment;
        let environment = emitters.iter().position(is_environment);
        Self {
            choice,
            environment: environment.map(|i| EmitterId(i as u32)),
            emitters,
        }
    }

    /// All emitters, in the order of their ids.
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// The emitter that surrounds the scene.
    pub fn environment(&self) -> Option<EmitterId> {
        self.environment
    }

    /// An emitter.
    #[inline]
    pub fn get(&self, id: EmitterId) -> &Emitter {
        &self.emitters[id.0 as usize]
    }

    /// Probability with which an emitter is chosen.
    #[inline]
    pub fn probability(&self, id: EmitterId) -> f32 {
        self.choice
            .as_ref()
            .map_or(0.0, |choice| choice.probability(id.0 as usize))
    }

    /// Chooses an emitter and samples a direction to it.
    ///
    /// - `u`: uniform in the unit square; the choice takes its share of `u.x`.
    #[inline]
    pub fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<ChosenSample> {
        let choice = self.choice.as_ref()?.sample(u.x);
        let emitter = EmitterId(choice.index as u32);
        let mut sample = self
            .get(emitter)
            .sample_toward(from, Vec2::new(choice.remainder, u.y))?;
        sample.density.0 *= choice.probability;
        Some(ChosenSample { sample, emitter })
    }

    /// Density with which [`Lights::sample_toward`] makes the direction to a point of an area light.
    #[inline]
    pub fn density_toward(
        &self,
        id: EmitterId,
        from: Vec3,
        at: &SurfacePoint,
    ) -> SolidAngleDensity {
        SolidAngleDensity(self.probability(id) * self.get(id).density_toward(from, at).0)
    }

    /// Radiance that arrives from the unit direction `toward` infinity.
    #[inline]
    pub fn environment_radiance(&self, toward: Vec3) -> Rgb {
        self.environment
            .map_or(Rgb::BLACK, |id| self.get(id).environment_radiance(toward))
    }

    /// Density with which [`Lights::sample_toward`] makes the unit direction `toward` infinity.
    #[inline]
    pub fn environment_density(&self, toward: Vec3) -> SolidAngleDensity {
        self.environment.map_or(SolidAngleDensity::ZERO, |id| {
            SolidAngleDensity(self.probability(id) * self.get(id).environment_density(toward).0)
        })
    }
}
