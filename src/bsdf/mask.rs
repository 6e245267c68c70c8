//! A material with holes.

use super::{
    Bsdf, BsdfModel, BsdfSample, BumpMap, Component, Dielectric, Diffuse, DiracEvent, Lobe,
    LobeSet, Plastic, SampleNumbers, Sampled, Spare, Transport,
};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// The component that goes straight through.
const HOLE: Component = Component(0);

/// A material of which only a share is there; the rest lets light straight through.
///
/// Components: 0 goes through the holes and is [`Lobe::Null`]; then those of the material, each
/// number one higher. A coloured opacity acts on each channel, as in Mitsuba 0.6.
#[derive(Clone, Debug)]
pub struct Mask {
    opacity: Texture,
    nested: Box<Bsdf>,
}

/// The opacity at one point.
#[derive(Clone, Copy)]
struct Opacity {
    colour: Rgb,
    /// Probability of choosing the material, not the hole.
    choice: f32,
}

impl Mask {
    /// Makes the material.
    ///
    /// - `opacity`: share that is there; values outside of `[0, 1]` count as the nearer end.
    /// - `nested`: the material between the holes.
    pub fn new(opacity: impl Into<Texture>, nested: impl Into<Bsdf>) -> Self {
        Self {
            opacity: opacity.into(),
            nested: Box::new(nested.into()),
        }
    }

    #[inline]
    fn opacity(&self, at: &SurfacePoint) -> Opacity {
        let colour = self.opacity.colour(at.uv).clamp(0.0, 1.0);
        // Unlike the luminance, the mean of three ones is exactly one.
        let choice = colour.mean();
        Opacity { colour, choice }
    }
}

impl Opacity {
    /// The event of passing through a hole; `None` where there is none.
    #[inline]
    fn hole(self, wi: Local) -> Option<DiracEvent> {
        (self.choice < 1.0).then(|| DiracEvent {
            direction: wi.straight_on(),
            coefficient: Rgb::WHITE - self.colour,
            probability: 1.0 - self.choice,
            lobe: Lobe::Null,
            eta: 1.0,
            cosine_ratio: 1.0,
        })
    }
}

impl BsdfModel for Mask {
    fn examples() -> Vec<Self> {
        let glass = Dielectric::examples().into_iter().take(1);
        let coat = Plastic::examples().into_iter().take(1);
        // The third: mirroring bumps.
        let bumps = BumpMap::examples().into_iter().skip(2).take(1);
        [0.0, 0.3, 1.0]
            .into_iter()
            .map(|opacity| Self::new(opacity, Diffuse::new(0.7)))
            .chain(coat.map(|coat| Self::new(Rgb::new(0.9, 0.5, 0.2), coat)))
            .chain(glass.map(|glass| Self::new(0.6, glass)))
            .chain(bumps.map(|bumps| Self::new(0.6, bumps)))
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        let hole = LobeSet {
            finite: false,
            dirac: true,
            transmission: true,
            single: false,
        };
        self.nested.lobes().union(hole)
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
        let opacity = self.opacity(at);
        if u_lobe >= opacity.choice {
            return opacity.hole(wi)?.sampled(HOLE);
        }
        let u_nested = (u_lobe / opacity.choice).min(ONE_MINUS_EPSILON);
        let mut sample = self.nested.sample(wi, at, transport, u_nested, u)?;
        sample.value *= opacity.colour;
        sample.density *= opacity.choice;
        sample.weight *= opacity.colour / opacity.choice;
        if sample.lobe.is_dirac() {
            sample.component.0 += 1;
        }
        Some(sample)
    }

    #[inline]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        self.nested.eval(wi, wo, at, transport) * self.opacity(at).colour
    }

    #[inline]
    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        SolidAngleDensity(self.nested.density(wi, wo, at, transport).0 * self.opacity(at).choice)
    }

    #[inline(never)]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        let opacity = self.opacity(at);
        let (value, density) = self.nested.eval_with_density(wi, wo, at, transport);
        (
            value * opacity.colour,
            SolidAngleDensity(density.0 * opacity.choice),
        )
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let opacity = self.opacity(at);
        if component == HOLE {
            return opacity.hole(wi);
        }
        let nested = Component(component.0 - 1);
        let event = self.nested.follow(wi, at, transport, nested)?;
        (opacity.choice > 0.0).then(|| DiracEvent {
            coefficient: event.coefficient * opacity.colour,
            probability: event.probability * opacity.choice,
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        self.nested.component_count() + 1
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let choice = self.opacity(at).choice;
        let nested = match sampled {
            Sampled::Dirac(HOLE) => {
                let hole = spare.numbers.within(choice, 1.0 - choice);
                return (choice < 1.0).then_some(hole);
            }
            Sampled::Dirac(component) => Sampled::Dirac(Component(component.0 - 1)),
            finite => finite,
        };
        let numbers = self.nested.invert(wi, nested, at, transport, spare)?;
        (choice > 0.0).then(|| numbers.within(0.0, choice))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let opacity = self.opacity(at).colour;
        self.nested.albedo(at) * opacity + (Rgb::WHITE - opacity)
    }
}
