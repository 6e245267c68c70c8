//! A clear coat over any material that reflects.

use super::fresnel::RelativeIor;
use super::varnish::Varnish;
use super::{
    Bsdf, BsdfError, BsdfModel, BsdfSample, BumpMap, Component, Conductor, Diffuse, DiracEvent,
    Lobe, LobeSet, Plastic, RoughConductor, SampleNumbers, Sampled, Spare, Transport,
};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// The component that the coat reflects.
const COAT: Component = Component(0);

/// A material under a smooth dielectric coat, on the front side; black from behind.
///
/// Components: 0 is the coat's mirror reflection; then those of the material, each number one higher.
///
/// Source: Weidlich & Wilkie 2007.
#[derive(Clone, Debug)]
pub struct Coating {
    varnish: Varnish,
    specular_reflectance: Texture,
    /// Mean of `specular_reflectance`.
    tint: f32,
}

impl Coating {
    /// Makes the material.
    ///
    /// - `ior`: of the coat over that of the outside.
    /// - `thickness`: of the coat in m; `absorption`: of what it is made of, in 1/m.
    /// - `specular_reflectance`: factor on the coat's reflection; 1 is physical.
    /// - `nested`: the material below.
    ///
    /// # Errors
    /// [`BsdfError::NestedTransmission`] when `nested` lets light through.
    pub fn new(
        ior: RelativeIor,
        thickness: f32,
        absorption: impl Into<Texture>,
        specular_reflectance: impl Into<Texture>,
        nested: impl Into<Bsdf>,
    ) -> Result<Self, BsdfError> {
        let specular_reflectance = specular_reflectance.into();
        Ok(Self {
            varnish: Varnish::new(ior, thickness, absorption.into(), nested.into())?,
            tint: specular_reflectance.mean().mean(),
            specular_reflectance,
        })
    }

    /// Share of light that the coat reflects.
    #[inline]
    fn reflectance(&self, direction: Local) -> f32 {
        self.varnish.ior.refract(direction.cos()).reflectance
    }

    /// Probability of sampling the coat's reflection.
    #[inline]
    fn choice(&self, wi: Local) -> f32 {
        self.varnish.coat_choice(self.reflectance(wi), self.tint)
    }

    /// Share of light that the coat's boundary lets through on the way in and on the way out.
    #[inline]
    fn passed(&self, wi: Local, wo: Local) -> f32 {
        (1.0 - self.reflectance(wi)) * (1.0 - self.reflectance(wo))
    }
}

/// A few materials to be coated, smooth and rough ones.
pub(super) fn example_nested() -> Vec<Bsdf> {
    let rough = RoughConductor::examples().into_iter().skip(1).take(1);
    let plastic = Plastic::examples().into_iter().take(1);
    // Mirroring bumps.
    let bumps = BumpMap::examples().into_iter().skip(2).take(1);
    let plain = [
        Bsdf::from(Diffuse::new(Rgb::new(0.9, 0.5, 0.2))),
        Conductor::new(None, 0.9).into(),
    ];
    let plain = plain.into_iter().chain(rough.map(Bsdf::from));
    let layered = plastic.map(Bsdf::from).chain(bumps.map(Bsdf::from));
    plain.chain(layered).collect()
}

impl BsdfModel for Coating {
    fn examples() -> Vec<Self> {
        let amber = Rgb::new(0.1, 0.4, 1.5);
        let make = |(number, nested)| {
            let interior = if number % 2 == 0 { 1.5 } else { 1.8 };
            let ior = RelativeIor::new(interior, 1.0)?;
            let tint = if number == 3 { 0.5 } else { 1.0 };
            Self::new(ior, number as f32 * 0.3, amber, tint, nested)
        };
        let thinner = RelativeIor::new(1.0, 1.33)
            .and_then(|ior| Self::new(ior, 0.0, 0.0, 1.0, Diffuse::new(0.8)));
        let nested = example_nested().into_iter().enumerate().map(make);
        nested.chain([thinner]).flatten().collect()
    }

    fn lobes(&self) -> LobeSet {
        let coat = LobeSet {
            dirac: true,
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
        let choice = self.choice(wi);
        if u_lobe < choice {
            return self.follow(wi, at, transport, COAT)?.sampled(COAT);
        }
        let u_nested = ((u_lobe - choice) / (1.0 - choice)).min(ONE_MINUS_EPSILON);
        let (wo, lobe, nested) = self.varnish.sample(wi, at, transport, u_nested, u)?;
        if lobe.is_dirac() {
            let component = Component(nested.0 + 1);
            let event = self.follow(wi, at, transport, component)?;
            return event.sampled(component);
        }
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
        let (value, density) = self.varnish.eval_with_density(wi, wo, at, transport);
        (
            value * self.passed(wi, wo),
            SolidAngleDensity(density.0 * (1.0 - self.choice(wi))),
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
        let choice = self.choice(wi);
        let Some(nested) = component.0.checked_sub(1) else {
            return Some(DiracEvent {
                direction: wi.mirrored(),
                coefficient: self.specular_reflectance.colour(at.uv) * self.reflectance(wi),
                probability: choice,
                lobe: Lobe::Specular,
                eta: 1.0,
                cosine_ratio: 1.0,
            });
        };
        let event = self.varnish.follow(wi, at, transport, Component(nested))?;
        Some(DiracEvent {
            coefficient: event.coefficient * self.passed(wi, event.direction),
            probability: event.probability * (1.0 - choice),
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        self.varnish.nested.component_count() + 1
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
        let choice = self.choice(wi);
        if sampled == Sampled::Dirac(COAT) {
            return (choice > 0.0).then(|| spare.numbers.within(0.0, choice));
        }
        let nested = match sampled {
            Sampled::Dirac(component) => Sampled::Dirac(Component(component.0 - 1)),
            finite => finite,
        };
        let numbers = self.varnish.invert(wi, nested, at, transport, spare)?;
        (choice < 1.0).then(|| numbers.within(choice, 1.0 - choice))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let reflectance = self.reflectance(Local::NORMAL);
        let passed = self.passed(Local::NORMAL, Local::NORMAL);
        self.specular_reflectance.colour(at.uv) * reflectance + self.varnish.albedo(at) * passed
    }
}
