//! Rough plastic: a diffuse base under a rough coat.

use std::f32::consts::FRAC_1_PI;

use super::coat::CoatedBase;
use super::fresnel::RelativeIor;
use super::microfacet::MicrofacetKind;
use super::rough_coat::{CoatPoint, RoughCoat};
use super::{BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A diffuse base under a rough dielectric coat, on the front side; black from behind.
///
/// What the coat reflects of the base's own light is found by the coarse rule of Mitsuba: with the
/// exact one, pictures differ from its own by 2 %, and the model is no more right for it.
///
/// Source: Walter 2007 for the coat.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    coat: RoughCoat,
    coated: CoatedBase,
}

impl RoughPlastic {
    /// Makes the material; this takes some milliseconds, or half a second where `alpha` varies.
    ///
    /// - `alpha`: roughness, the same for all directions.
    /// - the others: as for [`super::Plastic::new`].
    pub fn new(
        kind: MicrofacetKind,
        alpha: impl Into<Texture>,
        ior: RelativeIor,
        specular_reflectance: impl Into<Texture>,
        diffuse_reflectance: impl Into<Texture>,
        nonlinear: bool,
    ) -> Self {
        Self {
            coat: RoughCoat::new(kind, alpha.into(), ior),
            coated: CoatedBase::new(
                ior,
                specular_reflectance.into(),
                diffuse_reflectance.into(),
                nonlinear,
            ),
        }
    }

    /// Probability of sampling the coat's reflection.
    #[inline]
    fn specular_choice(&self, coat: &CoatPoint<'_>, wi: Local) -> f32 {
        self.coated
            .specular_choice(1.0 - coat.transmittance(wi.cos()))
    }
}

impl BsdfModel for RoughPlastic {
    fn examples() -> Vec<Self> {
        use MicrofacetKind::{Beckmann, Ggx};
        let red = Rgb::new(0.9, 0.2, 0.1);
        let make = |ior| {
            [
                Self::new(Beckmann, 0.02, ior, 1.0, red, false),
                Self::new(Beckmann, 0.3, ior, 1.0, red, true),
                Self::new(Ggx, 0.1, ior, 1.0, 0.5, true),
                Self::new(Ggx, 0.7, ior, 0.5, red, false),
            ]
        };
        RelativeIor::new(1.5, 1.0)
            .map(make)
            .into_iter()
            .flatten()
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            ..LobeSet::default()
        }
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
        let (wo, lobe) = if u_lobe < self.specular_choice(&coat, wi) {
            (coat.sample(wi, u), Lobe::Glossy)
        } else {
            (Local(warp::cosine_hemisphere(u)), Lobe::Diffuse)
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

    /// The value is the coat's `F·D·G / (4 cos θ_i)` and the base's
    /// `ρ η⁻² / (1 − R) · T(wi) T(wo) cos θ_o / π`, where `R` is the coat's inner reflectance.
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
        let coat = self.coat.at(at.uv);
        let (reflection, reflected) = coat.reflection(wi, wo);
        let specular = self.coated.specular_reflectance.colour(at.uv) * reflection;

        let passed = coat.transmittance(wi.cos()) * coat.transmittance(wo.cos());
        let base = self.coated.base(at.uv, coat.inner_reflectance());
        let diffuse = base * (passed * FRAC_1_PI * wo.cos());

        let choice = self.specular_choice(&coat, wi);
        let density =
            choice * reflected + (1.0 - choice) * warp::cosine_hemisphere_density(wo.cos());
        (specular + diffuse, SolidAngleDensity(density))
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        _transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let Sampled::Finite(wo) = sampled else {
            return None;
        };
        if wi.cos() <= 0.0 || wo.cos() <= 0.0 {
            return None;
        }
        let coat = self.coat.at(at.uv);
        let choice = self.specular_choice(&coat, wi);
        let by_cosine = warp::cosine_hemisphere_density(wo.cos());
        let densities = [choice * coat.density(wi, wo), (1.0 - choice) * by_cosine];
        let (lobe, spare) = spare.choose(densities)?;
        if lobe == 0 {
            let numbers = spare.numbers.with_direction(coat.invert(wi, wo));
            return Some(numbers.within(0.0, choice));
        }
        let u = warp::cosine_hemisphere_inverse(wo.0);
        let numbers = spare.numbers.with_direction(u);
        Some(numbers.within(choice, 1.0 - choice))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.coated
            .albedo(at.uv, self.coat.at(at.uv).inner_reflectance())
    }
}
