//! Smooth plastic: a diffuse base under a smooth coat.

use std::f32::consts::FRAC_1_PI;

use super::coat::CoatedBase;
use super::fresnel::RelativeIor;
use super::{
    BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled, Spare,
    Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A diffuse base under a smooth dielectric coat, on the front side; black from behind.
///
/// Component 0 is the coat's mirror reflection; the base is a finite lobe.
#[derive(Clone, Debug)]
pub struct Plastic {
    coated: CoatedBase,
    inner_reflectance: f32,
}

impl Plastic {
    /// Makes the material.
    ///
    /// - `ior`: of the coat over that of the outside.
    /// - `specular_reflectance`: factor on the coat's reflection; 1 is physical.
    /// - `diffuse_reflectance`: of the base, in `[0, 1]`.
    /// - `nonlinear`: whether light that goes back and forth between base and coat takes on more
    ///   of the base's colour each time.
    pub fn new(
        ior: RelativeIor,
        specular_reflectance: impl Into<Texture>,
        diffuse_reflectance: impl Into<Texture>,
        nonlinear: bool,
    ) -> Self {
        Self {
            coated: CoatedBase::new(
                ior,
                specular_reflectance.into(),
                diffuse_reflectance.into(),
                nonlinear,
            ),
            inner_reflectance: ior.seen_from(-1.0).diffuse_reflectance(),
        }
    }

    /// Share of light that the coat reflects.
    #[inline]
    fn reflectance(&self, cos: f32) -> f32 {
        self.coated.ior.refract(cos).reflectance
    }

    /// The coat's mirror reflection.
    #[inline]
    fn event(&self, wi: Local, reflectance: f32, choice: f32, at: &SurfacePoint) -> DiracEvent {
        DiracEvent {
            direction: wi.mirrored(),
            coefficient: self.coated.specular_reflectance.colour(at.uv) * reflectance,
            probability: choice,
            lobe: Lobe::Specular,
            eta: 1.0,
            cosine_ratio: 1.0,
        }
    }

    /// The base's value and its density, given what the coat does to `wi`.
    #[inline]
    fn base(
        &self,
        wo: Local,
        reflectance: f32,
        choice: f32,
        at: &SurfacePoint,
    ) -> (Rgb, SolidAngleDensity) {
        let passed = (1.0 - reflectance) * (1.0 - self.reflectance(wo.cos()));
        (
            self.coated.base(at.uv, self.inner_reflectance) * (passed * FRAC_1_PI * wo.cos()),
            SolidAngleDensity((1.0 - choice) * warp::cosine_hemisphere_density(wo.cos())),
        )
    }
}

impl BsdfModel for Plastic {
    fn examples() -> Vec<Self> {
        let red = Rgb::new(0.9, 0.2, 0.1);
        RelativeIor::new(1.5, 1.0)
            .map(|ior| [false, true].map(|nonlinear| Self::new(ior, 1.0, red, nonlinear)))
            .into_iter()
            .flatten()
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            dirac: true,
            transmission: false,
            single: false,
        }
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        _transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if wi.cos() <= 0.0 {
            return None;
        }
        let reflectance = self.reflectance(wi.cos());
        let choice = self.coated.specular_choice(reflectance);
        if u_lobe < choice {
            return self
                .event(wi, reflectance, choice, at)
                .sampled(Component(0));
        }
        let wo = Local(warp::cosine_hemisphere(u));
        let (value, density) = self.base(wo, reflectance, choice, at);
        BsdfSample::finite(wo, value, density, Lobe::Diffuse)
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
        _transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        if wi.cos() <= 0.0 || wo.cos() <= 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let reflectance = self.reflectance(wi.cos());
        let choice = self.coated.specular_choice(reflectance);
        self.base(wo, reflectance, choice, at)
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        _transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        if wi.cos() <= 0.0 || component.0 != 0 {
            return None;
        }
        let reflectance = self.reflectance(wi.cos());
        let choice = self.coated.specular_choice(reflectance);
        Some(self.event(wi, reflectance, choice, at))
    }

    fn component_count(&self) -> u8 {
        1
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        _at: &SurfacePoint,
        _transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        if wi.cos() <= 0.0 {
            return None;
        }
        let choice = self.coated.specular_choice(self.reflectance(wi.cos()));
        match sampled {
            Sampled::Dirac(_) => (choice > 0.0).then(|| spare.numbers.within(0.0, choice)),
            Sampled::Finite(wo) if wo.cos() > 0.0 && choice < 1.0 => {
                let u = warp::cosine_hemisphere_inverse(wo.0);
                let numbers = spare.numbers.with_direction(u);
                Some(numbers.within(choice, 1.0 - choice))
            }
            Sampled::Finite(_) => None,
        }
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.coated.albedo(at.uv, self.inner_reflectance)
    }
}
