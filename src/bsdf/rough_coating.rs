//! A rough clear coat over any material that reflects.

use super::coating::example_nested;
use super::fresnel::RelativeIor;
use super::microfacet::MicrofacetKind;
use super::rough_coat::{CoatPoint, RoughCoat};
use super::varnish::Varnish;
use super::{
    Bsdf, BsdfError, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers,
    Sampled, Spare, Transport,
};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A material under a rough dielectric coat, on the front side; black from behind.
///
/// The coat reflects as rough plastic's does, and lets through what its table says. It bends what it
/// lets through as a smooth one would: a mirror below stays sharp.
///
/// Components: those of the material.
///
/// Source: Weidlich & Wilkie 2007; Walter 2007 for the coat.
#[derive(Clone, Debug)]
pub struct RoughCoating {
    coat: RoughCoat,
    varnish: Varnish,
    specular_reflectance: Texture,
    /// Mean of `specular_reflectance`.
    tint: f32,
}

impl RoughCoating {
    /// Makes the material; this takes some milliseconds, or half a second where `alpha` varies.
    ///
    /// - `alpha`: roughness, the same for all directions.
    /// - the others: as for [`super::Coating::new`].
    ///
    /// # Errors
    /// [`BsdfError::NestedTransmission`] when `nested` lets light through.
    pub fn new(
        (kind, alpha): (MicrofacetKind, impl Into<Texture>),
        ior: RelativeIor,
        thickness: f32,
        absorption: impl Into<Texture>,
        specular_reflectance: impl Into<Texture>,
        nested: impl Into<Bsdf>,
    ) -> Result<Self, BsdfError> {
        let specular_reflectance = specular_reflectance.into();
        Ok(Self {
            varnish: Varnish::new(ior, thickness, absorption.into(), nested.into())?,
            coat: RoughCoat::new(kind, alpha.into(), ior),
            tint: specular_reflectance.mean().mean(),
            specular_reflectance,
        })
    }

    /// Probability of sampling the coat's reflection.
    #[inline]
    fn choice(&self, coat: &CoatPoint<'_>, wi: Local) -> f32 {
        let reflectance = 1.0 - coat.transmittance(wi.cos());
        self.varnish.coat_choice(reflectance, self.tint)
    }
}

impl BsdfModel for RoughCoating {
    fn examples() -> Vec<Self> {
        use MicrofacetKind::{Beckmann, Ggx};
        let amber = Rgb::new(0.1, 0.4, 1.5);
        let make = |(number, nested)| {
            let roughness = [(Ggx, 0.1), (Beckmann, 0.3)][number % 2];
            let ior = RelativeIor::new(1.5, 1.0)?;
            Self::new(roughness, ior, number as f32 * 0.3, amber, 1.0, nested)
        };
        let nested = example_nested().into_iter().enumerate();
        nested.map(make).filter_map(Result::ok).collect()
    }

    fn lobes(&self) -> LobeSet {
        let coat = LobeSet {
            finite: true,
            ..LobeSet::default()
        };
        self.varnish.nested.lobes().union(coat)
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
        if wi.cos() <= 0.0 {
            return None;
        }
        let coat = self.coat.at(at.uv);
        let choice = self.choice(&coat, wi);
        let (wo, lobe) = if u_lobe < choice {
            (coat.sample(wi, u), Lobe::Glossy)
        } else {
            let u_nested = ((u_lobe - choice) / (1.0 - choice)).min(ONE_MINUS_EPSILON);
            let (wo, lobe, component) = self.varnish.sample(wi, at, transport, u_nested, u)?;
            if lobe.is_dirac() {
                let event = self.follow(wi, at, transport, component)?;
                return event.sampled(component);
            }
            (wo, lobe)
        };
        let (value, density) = self.eval_with_density(wi, wo, at, transport);
        BsdfSample::finite(wo, value, density, lobe)
    }

    #[inline]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        self.eval_with_density(wi, wo, at, transport).0
    }

    #[inline]
    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        self.eval_with_density(wi, wo, at, transport).1
    }

    #[inline(never)]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        if wi.cos() <= 0.0 || wo.cos() <= 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let coat = self.coat.at(at.uv);
        let (reflection, reflected) = coat.reflection(wi, wo);
        let (below, density) = self.varnish.eval_with_density(wi, wo, at, transport);
        let passed = coat.transmittance(wi.cos()) * coat.transmittance(wo.cos());
        let choice = self.choice(&coat, wi);
        (
            self.specular_reflectance.colour(at.uv) * reflection + below * passed,
            SolidAngleDensity(choice * reflected + (1.0 - choice) * density.0),
        )
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        if wi.cos() <= 0.0 {
            return None;
        }
        let coat = self.coat.at(at.uv);
        let event = self.varnish.follow(wi, at, transport, component)?;
        let passed = coat.transmittance(wi.cos()) * coat.transmittance(event.direction.cos());
        Some(DiracEvent {
            coefficient: event.coefficient * passed,
            probability: event.probability * (1.0 - self.choice(&coat, wi)),
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        self.varnish.nested.component_count()
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        if wi.cos() <= 0.0 {
            return None;
        }
        let coat = self.coat.at(at.uv);
        let choice = self.choice(&coat, wi);
        let mut spare = spare;
        if let Sampled::Finite(wo) = sampled {
            if wo.cos() <= 0.0 {
                return None;
            }
            let below = self.varnish.eval_with_density(wi, wo, at, transport);
            let densities = [choice * coat.density(wi, wo), (1.0 - choice) * below.1.0];
            let (lobe, rest) = spare.choose(densities)?;
            if lobe == 0 {
                let numbers = rest.numbers.with_direction(coat.invert(wi, wo));
                return Some(numbers.within(0.0, choice));
            }
            spare = rest;
        }
        let numbers = self.varnish.invert(wi, sampled, at, transport, spare)?;
        (choice < 1.0).then(|| numbers.within(choice, 1.0 - choice))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let passed = self.coat.at(at.uv).transmittance(1.0);
        let reflected = self.specular_reflectance.colour(at.uv) * (1.0 - passed);
        reflected + self.varnish.albedo(at) * (passed * passed)
    }
}
