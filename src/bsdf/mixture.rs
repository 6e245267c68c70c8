//! Materials side by side, in parts too small to see.

use super::{
    Bsdf, BsdfError, BsdfModel, BsdfSample, Component, Conductor, Dielectric, Diffuse, DiracEvent,
    LobeSet, Null, Plastic, RoughConductor, RoughDielectric, SampleNumbers, Sampled, Spare,
    Transport,
};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// Sums of weights above one by less than this are one.
const ROUNDING: f32 = 1e-4;

/// A weighted sum of materials.
///
/// Components: those of the parts, one part after the other.
#[derive(Clone, Debug)]
pub struct Mixture {
    parts: Box<[Bsdf]>,
    weights: Weights,
}

/// How much of each part there is.
#[derive(Clone, Debug)]
enum Weights {
    /// The same everywhere, one for each part.
    Fixed(Box<[f32]>),
    /// Of the second of two parts; the first has the rest.
    OfSecond(Box<Texture>),
}

impl Mixture {
    /// Makes a material of two, with shares that may vary over the surface.
    ///
    /// - `weight`: share of `second`; values outside of `[0, 1]` count as the nearer end.
    pub fn blend(
        weight: impl Into<Texture>,
        first: impl Into<Bsdf>,
        second: impl Into<Bsdf>,
    ) -> Self {
        Self {
            parts: Box::new([first.into(), second.into()]),
            weights: Weights::OfSecond(Box::new(weight.into())),
        }
    }

    /// Makes a material of any number of others, with shares that are the same everywhere.
    ///
    /// - `parts`: weights and materials. What the weights leave of one is lost.
    ///
    /// # Errors
    /// [`BsdfError::Weights`] where a weight is negative or not a number, or their sum is zero or
    /// more than one.
    pub fn new(parts: impl IntoIterator<Item = (f32, Bsdf)>) -> Result<Self, BsdfError> {
        let (weights, parts): (Vec<f32>, Vec<Bsdf>) = parts.into_iter().unzip();
        let sum: f32 = weights.iter().sum();
        let is_share = weights.iter().all(|weight| *weight >= 0.0);
        if !(is_share && sum > 0.0 && sum <= 1.0 + ROUNDING) {
            return Err(BsdfError::Weights(sum));
        }
        let excess = sum.max(1.0);
        Ok(Self {
            parts: parts.into(),
            weights: Weights::Fixed(weights.into_iter().map(|weight| weight / excess).collect()),
        })
    }

    /// The parts with their weights at one point.
    #[inline]
    fn weighted(&self, at: &SurfacePoint) -> impl Iterator<Item = (f32, &Bsdf)> {
        let blend = match &self.weights {
            Weights::Fixed(_) => 0.0,
            Weights::OfSecond(texture) => texture.value(at.uv).clamp(0.0, 1.0),
        };
        let parts = self.parts.iter().enumerate();
        parts.map(move |(number, part)| match &self.weights {
            Weights::Fixed(weights) => (weights[number], part),
            Weights::OfSecond(_) => (if number == 0 { 1.0 - blend } else { blend }, part),
        })
    }

    /// The factor that turns weights into the probabilities of choosing parts.
    #[inline]
    fn choice(&self) -> f32 {
        match &self.weights {
            Weights::Fixed(weights) => 1.0 / weights.iter().sum::<f32>(),
            Weights::OfSecond(_) => 1.0,
        }
    }
}

impl BsdfModel for Mixture {
    fn examples() -> Vec<Self> {
        let last = |glass: Option<Bsdf>| glass.unwrap_or_else(|| Null.into());
        let smooth_glass = || last(Dielectric::examples().pop().map(Bsdf::from));
        let rough_glass = last(RoughDielectric::examples().pop().map(Bsdf::from));
        let plastic = last(Plastic::examples().pop().map(Bsdf::from));
        let metal = last(RoughConductor::examples().pop().map(Bsdf::from));
        let mirror = || Conductor::new(None, 0.9);
        let thirds = [
            (0.2, Diffuse::new(0.9).into()),
            (0.3, plastic),
            (0.4, smooth_glass()),
        ];
        let blends = [
            Self::blend(0.3, Diffuse::new(0.7), metal.clone()),
            Self::blend(0.6, mirror(), smooth_glass()),
            Self::blend(0.5, rough_glass, metal),
            Self::blend(1.0, Diffuse::new(0.7), mirror()),
        ];
        let fixed = Self::new(thirds).into_iter();
        fixed.chain(blends).collect()
    }

    fn lobes(&self) -> LobeSet {
        let none = LobeSet::default();
        self.parts
            .iter()
            .fold(none, |all, part| all.union(part.lobes()))
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let choice = self.choice();
        let mut rest = u_lobe;
        let mut first_component = 0;
        for (weight, part) in self.weighted(at) {
            let probability = weight * choice;
            if rest >= probability {
                rest -= probability;
                first_component += part.component_count();
                continue;
            }
            let u_nested = (rest / probability).min(ONE_MINUS_EPSILON);
            let sample = part.sample(wi, at, transport, u_nested, u)?;
            if sample.lobe.is_dirac() {
                return Some(BsdfSample {
                    value: sample.value * weight,
                    density: sample.density * probability,
                    weight: sample.weight / choice,
                    component: Component(sample.component.0 + first_component),
                    ..sample
                });
            }
            let wo = sample.direction;
            let (value, density) = self.eval_with_density(wi, wo, at, transport);
            return BsdfSample::finite(wo, value, density, sample.lobe).map(|whole| BsdfSample {
                eta: sample.eta,
                ..whole
            });
        }
        // Only rounding leads here.
        None
    }

    #[inline]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        let parts = self.weighted(at).filter(|(weight, _)| *weight > 0.0);
        parts
            .map(|(weight, part)| part.eval(wi, wo, at, transport) * weight)
            .sum()
    }

    #[inline]
    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        let parts = self.weighted(at).filter(|(weight, _)| *weight > 0.0);
        let sum: f32 = parts
            .map(|(weight, part)| part.density(wi, wo, at, transport).0 * weight)
            .sum();
        SolidAngleDensity(sum * self.choice())
    }

    #[inline(never)]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        let (mut value, mut density) = (Rgb::BLACK, 0.0);
        for (weight, part) in self.weighted(at).filter(|(weight, _)| *weight > 0.0) {
            let (part_value, part_density) = part.eval_with_density(wi, wo, at, transport);
            value += part_value * weight;
            density += part_density.0 * weight;
        }
        (value, SolidAngleDensity(density * self.choice()))
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let mut number = component.0;
        for (weight, part) in self.weighted(at) {
            let Some(beyond) = number.checked_sub(part.component_count()) else {
                let event = part.follow(wi, at, transport, Component(number))?;
                return (weight > 0.0).then(|| DiracEvent {
                    coefficient: event.coefficient * weight,
                    probability: event.probability * (weight * self.choice()),
                    ..event
                });
            };
            number = beyond;
        }
        None
    }

    fn component_count(&self) -> u8 {
        self.parts.iter().map(BsdfModel::component_count).sum()
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let choice = self.choice();
        // What each part has to do with it: its density, or whether the component is its own.
        let share = |(weight, part): (f32, &Bsdf), first_component: u8| match sampled {
            _ if weight <= 0.0 => 0.0,
            Sampled::Finite(wo) => weight * part.density(wi, wo, at, transport).0,
            Sampled::Dirac(Component(number)) => {
                let own = first_component..first_component + part.component_count();
                f32::from(u8::from(own.contains(&number)))
            }
        };
        let parts = || {
            self.weighted(at).scan((0.0, 0), move |sum, part| {
                let (low, first_component) = *sum;
                *sum = (
                    low + part.0 * choice,
                    first_component + part.1.component_count(),
                );
                Some((part, low, first_component))
            })
        };
        let total: f32 = parts().map(|(part, _, first)| share(part, first)).sum();
        let mut rest = spare.lobe * total;
        for (part, low, first_component) in parts() {
            let own = share(part, first_component);
            if own <= 0.0 || rest >= own {
                rest -= own;
                continue;
            }
            let nested = match sampled {
                Sampled::Dirac(component) => {
                    Sampled::Dirac(Component(component.0 - first_component))
                }
                finite => finite,
            };
            let lobe = (rest / own).clamp(0.0, ONE_MINUS_EPSILON);
            let numbers = part
                .1
                .invert(wi, nested, at, transport, Spare { lobe, ..spare })?;
            return Some(numbers.within(low, part.0 * choice));
        }
        None
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.weighted(at)
            .map(|(weight, part)| part.albedo(at) * weight)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_that_are_no_shares_are_refused() {
        let make = |weights: &[f32]| {
            let grey = || Bsdf::from(Diffuse::new(0.5));
            Mixture::new(weights.iter().map(|weight| (*weight, grey())))
        };
        for weights in [[0.5, 0.6], [0.0, 0.0], [-0.5, 0.6], [f32::NAN, 0.5]] {
            assert!(make(&weights).is_err(), "{weights:?}");
        }
        assert!(make(&[]).is_err());
        assert!(make(&[0.3, 0.4]).is_ok() && make(&[0.500_01, 0.5]).is_ok());
    }
}
