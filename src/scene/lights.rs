//! The table of emitters, and the choice among them.

use super::EmitterId;
use crate::emitter::{
    EmissionDensity, EmittedRay, Emitter, EmitterClass, EmitterModel, EmitterSample, MeshLight,
};
use crate::math::distribution::{Choice, Discrete};
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3, warp};
use crate::shape::SurfacePoint;

/// All emitters of a scene, and how one of them is chosen.
///
/// Few emitters are chosen by their [`EmitterModel::influence`] at the point that asks, many by
/// their power. In both cases a tenth of the choices is uniform: influence and power know nothing of
/// walls and of what faces where, and an emitter must not be all but forgotten where it is the only
/// one that counts.
#[derive(Clone, Debug)]
pub struct Lights {
    emitters: Vec<Emitter>,
    by_power: Option<Discrete>,
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

/// A ray of a chosen emitter.
#[derive(Clone, Copy, Debug)]
pub struct ChosenRay {
    /// The ray; its density does *not* include the probability of the choice.
    pub ray: EmittedRay,
    /// The chosen emitter.
    pub emitter: EmitterId,
    /// Probability of the choice.
    pub probability: f32,
}

/// Up to so many emitters are weighed at each point; the time of a choice grows with them.
const WEIGHED: usize = 16;

/// Share of choices that are uniform.
const UNIFORM: f32 = 0.1;

impl Lights {
    /// Makes the table.
    pub(super) fn new(emitters: Vec<Emitter>) -> Self {
        let powers: Vec<f64> = emitters.iter().map(EmitterModel::power).collect();
        let total: f64 = powers.iter().sum();
        let uniform = 1.0 / emitters.len().max(1) as f64;
        let share = |power: f64| if total > 0.0 { power / total } else { uniform };
        let mixed: Vec<f64> = powers
            .iter()
            .map(|power| (1.0 - f64::from(UNIFORM)) * share(*power) + f64::from(UNIFORM) * uniform)
            .collect();
        let is_environment = |e: &Emitter| e.class() == EmitterClass::Environment;
        let environment = emitters.iter().position(is_environment);
        Self {
            by_power: Discrete::new(&mixed),
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

    /// Whether there is light that only what is traced from the emitters on shows: beams without width.
    pub fn has_beams(&self) -> bool {
        self.emitters.iter().any(|e| !e.class().is_connectable())
    }

    /// The only emitter, where that is a mesh of one radiance.
    #[inline]
    pub fn sole_mesh_light(&self) -> Option<MeshLight<'_>> {
        match self.emitters.as_slice() {
            [Emitter::Area(area)] => area.as_mesh(),
            _ => None,
        }
    }

    /// An emitter.
    #[inline]
    pub fn get(&self, id: EmitterId) -> &Emitter {
        &self.emitters[id.0 as usize]
    }

    /// Probability with which an emitter is chosen at a point.
    #[inline]
    pub fn probability(&self, id: EmitterId, from: Vec3) -> f32 {
        match self.emitters.len() {
            1 => 1.0,
            2..=WEIGHED => self.weighed(from).probability(id.0 as usize),
            _ => self
                .by_power
                .as_ref()
                .map_or(0.0, |choice| choice.probability(id.0 as usize)),
        }
    }

    /// Chooses an emitter at a point.
    ///
    /// - `u`: uniform in `[0, 1)`.
    #[inline(always)]
    fn choose(&self, from: Vec3, u: f32) -> Option<Choice> {
        match self.emitters.len() {
            0 => None,
            1 => Some(Choice {
                index: 0,
                probability: 1.0,
                remainder: u,
            }),
            _ => self.choose_among(from, u),
        }
    }

    /// [`Lights::choose`] where there are several; out of line, since most scenes have one.
    #[inline(never)]
    fn choose_among(&self, from: Vec3, u: f32) -> Option<Choice> {
        if self.emitters.len() <= WEIGHED {
            Some(self.weighed(from).choose(u))
        } else {
            self.by_power.as_ref().map(|choice| choice.sample(u))
        }
    }

    /// The influences of few emitters at a point.
    fn weighed(&self, from: Vec3) -> Weighed {
        let mut weights = [0.0; WEIGHED];
        for (weight, emitter) in weights.iter_mut().zip(&self.emitters) {
            *weight = emitter.influence(from);
        }
        let total = weights.iter().sum();
        Weighed {
            weights,
            total,
            count: self.emitters.len(),
        }
    }

    /// Chooses an emitter and samples a direction to it.
    ///
    /// - `u`: uniform in the unit square; the choice takes its share of `u.x`.
    #[inline(always)]
    pub fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<ChosenSample> {
        self.sample_toward_then(from, u, |chosen| chosen)
    }

    /// [`Lights::sample_toward`], with what becomes of the sample: see
    /// [`Emitter::sample_toward_then`].
    #[inline(always)]
    pub fn sample_toward_then<R>(
        &self,
        from: Vec3,
        u: Vec2,
        then: impl FnOnce(ChosenSample) -> R,
    ) -> Option<R> {
        let choice = self.choose(from, u.x)?;
        let emitter = EmitterId(choice.index as u32);
        let u = Vec2::new(choice.remainder, u.y);
        self.get(emitter).sample_toward_then(from, u, |mut sample| {
            sample.density.0 *= choice.probability;
            then(ChosenSample { sample, emitter })
        })
    }

    /// Probability with which [`Lights::sample_emission`] chooses an emitter.
    #[inline]
    pub fn emission_probability(&self, id: EmitterId) -> f32 {
        self.by_power
            .as_ref()
            .map_or(0.0, |choice| choice.probability(id.0 as usize))
    }

    /// Chooses an emitter in proportion to its power, a tenth of the choices uniformly, and samples one of
    /// its rays.
    ///
    /// - `u_choice`: uniform in `[0, 1)`.
    /// - `u_point`, `u_direction`: uniform in the unit square.
    #[inline]
    pub fn sample_emission(
        &self,
        u_choice: f32,
        u_point: Vec2,
        u_direction: Vec2,
    ) -> Option<ChosenRay> {
        let choice = self.by_power.as_ref()?.sample(u_choice);
        let emitter = EmitterId(choice.index as u32);
        let ray = self.get(emitter).sample_emission(u_point, u_direction)?;
        Some(ChosenRay {
            ray,
            emitter,
            probability: choice.probability,
        })
    }

    /// The start of a ray as a sample of its light from a point; `None` where it shows its back.
    pub fn as_sample(&self, chosen: &ChosenRay, from: Vec3) -> Option<ChosenSample> {
        let mut sample = chosen.ray.seen_from(self.get(chosen.emitter), from)?;
        sample.density.0 *= chosen.probability;
        Some(ChosenSample {
            sample,
            emitter: chosen.emitter,
        })
    }

    /// Density with which [`Lights::sample_emission`] makes a ray of an emitter, once that is chosen; see
    /// [`EmitterModel::emission_density`].
    #[inline]
    pub fn emission_density(
        &self,
        id: EmitterId,
        at: Option<&SurfacePoint>,
        direction: Vec3,
    ) -> EmissionDensity {
        self.get(id).emission_density(at, direction)
    }

    /// Density with which [`Lights::sample_toward`] makes the direction to a point of an area light.
    #[inline]
    pub fn density_toward(
        &self,
        id: EmitterId,
        from: Vec3,
        at: &SurfacePoint,
    ) -> SolidAngleDensity {
        SolidAngleDensity(self.probability(id, from) * self.get(id).density_toward(from, at).0)
    }

    /// Goes back from a direction to the numbers that [`Lights::sample_toward`] makes it of; see
    /// [`EmitterModel::invert_toward`].
    ///
    /// - `id`: the emitter that is chosen.
    pub fn invert_toward(
        &self,
        id: EmitterId,
        (from, toward): (Vec3, Vec3),
        at: Option<&SurfacePoint>,
        spare: Vec2,
    ) -> Option<Vec2> {
        let u = self.get(id).invert_toward(from, toward, at, spare)?;
        let index = id.0 as usize;
        let x = match self.emitters.len() {
            1 => Some(u.x),
            2..=WEIGHED => Some(self.weighed(from).invert(index, u.x)),
            _ => self.by_power.as_ref()?.invert(index, u.x),
        };
        Some(Vec2::new(x?, u.y))
    }

    /// Goes back from an emitter to a number with which [`Lights::sample_emission`] chooses it.
    ///
    /// - `spare`: uniform in `[0, 1)`, like the result if the emitter is chosen so.
    pub fn invert_emission_choice(&self, id: EmitterId, spare: f32) -> Option<f32> {
        self.by_power.as_ref()?.invert(id.0 as usize, spare)
    }

    /// Radiance that arrives from the unit direction `toward` infinity.
    #[inline]
    pub fn environment_radiance(&self, toward: Vec3) -> Rgb {
        self.environment
            .map_or(Rgb::BLACK, |id| self.get(id).environment_radiance(toward))
    }

    /// Density with which [`Lights::sample_toward`] makes the unit direction `toward` infinity.
    #[inline]
    pub fn environment_density(&self, from: Vec3, toward: Vec3) -> SolidAngleDensity {
        self.environment.map_or(SolidAngleDensity::ZERO, |id| {
            let density = self.get(id).environment_density(toward).0;
            SolidAngleDensity(self.probability(id, from) * density)
        })
    }
}

/// The influences of few emitters at one point.
struct Weighed {
    weights: [f32; WEIGHED],
    total: f32,
    count: usize,
}

impl Weighed {
    fn probability(&self, index: usize) -> f32 {
        let uniform = 1.0 / self.count as f32;
        // Far out, or right at a point light, the sum may leave the range of numbers.
        if !(self.total > 0.0 && self.total.is_finite()) {
            return uniform;
        }
        (1.0 - UNIFORM) * self.weights[index] / self.total + UNIFORM * uniform
    }

    /// Undoes [`Weighed::choose`].
    fn invert(&self, index: usize, remainder: f32) -> f32 {
        let below = (0..index).fold(0.0, |sum, i| sum + self.probability(i));
        let end = if index + 1 == self.count {
            1.0
        } else {
            below + self.probability(index)
        };
        warp::within(remainder, below, end)
    }

    fn choose(&self, u: f32) -> Choice {
        let mut below = 0.0;
        for index in 0..self.count {
            let probability = self.probability(index);
            // The last one takes what rounding has left.
            if u < below + probability || index + 1 == self.count {
                let remainder = ((u - below) / probability).clamp(0.0, warp::ONE_MINUS_EPSILON);
                return Choice {
                    index,
                    probability,
                    remainder,
                };
            }
            below += probability;
        }
        unreachable!("there is at least one emitter")
    }
}

#[cfg(test)]
mod tests;
