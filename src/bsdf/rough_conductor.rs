//! Rough metal.

use super::conductor::{EXAMPLE_METAL, conductor_reflectance};
use super::fresnel::ComplexIor;
use super::microfacet::{MicrofacetKind, Roughness, halfway, mirrored_at};
use super::{BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// Metal of many small mirrors, on the front side; black from behind.
///
/// Light that is reflected by more than one mirror is lost.
///
/// Source: Walter 2007 for the model, Heitz 2014 for two roughnesses and for sampling.
#[derive(Clone, Debug)]
pub struct RoughConductor {
    roughness: Roughness,
    ior: Option<ComplexIor>,
    specular_reflectance: Texture,
}

impl RoughConductor {
    /// Makes the material.
    ///
    /// - `ior`: index of the metal over that of the outside; `None` for mirrors that reflect all.
    /// - `specular_reflectance`: factor on the reflectance; 1 is physical.
    pub fn new(
        roughness: Roughness,
        ior: Option<ComplexIor>,
        specular_reflectance: impl Into<Texture>,
    ) -> Self {
        Self {
            roughness,
            ior,
            specular_reflectance: specular_reflectance.into(),
        }
    }
}

impl BsdfModel for RoughConductor {
    fn examples() -> Vec<Self> {
        let make = |kind, alpha_u: f32, alpha_v: f32, ior| {
            Self::new(Roughness::new(kind, alpha_u, alpha_v), ior, 1.0)
        };
        [MicrofacetKind::Beckmann, MicrofacetKind::Ggx]
            .into_iter()
            .flat_map(|kind| {
                [
                    make(kind, 0.02, 0.02, None),
                    make(kind, 0.3, 0.3, Some(EXAMPLE_METAL)),
                    make(kind, 0.8, 0.8, None),
                    make(kind, 0.05, 0.4, Some(EXAMPLE_METAL)),
                ]
            })
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            single: true,
            ..LobeSet::default()
        }
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        _u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if wi.cos() <= 0.0 {
            return None;
        }
        let m = self.roughness.at(at.uv).sample_visible(wi, u);
        let wo = mirrored_at(wi, m);
        let (value, density) = self.eval_with_density(wi, wo, at, transport);
        BsdfSample::finite(wo, value, density, Lobe::Glossy)
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
        _transport: Transport,
    ) -> SolidAngleDensity {
        if wi.cos() <= 0.0 || wo.cos() <= 0.0 {
            return SolidAngleDensity::ZERO;
        }
        let facets = self.roughness.at(at.uv);
        SolidAngleDensity(facets.reflected_density(wi, halfway(wi, wo).0))
    }

    /// The value is `F·D·G / (4 cos θ_i)`, the density the same without `F` and `G₁(wo)`.
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
        let (m, cos) = halfway(wi, wo);
        let facets = self.roughness.at(at.uv);
        let density = facets.reflected_density(wi, m);
        let reflectance =
            conductor_reflectance(self.ior.as_ref(), cos) * self.specular_reflectance.colour(at.uv);
        (
            reflectance * (density * facets.masking(wo)),
            SolidAngleDensity(density),
        )
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        _transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        match sampled {
            Sampled::Finite(wo) if wi.cos() > 0.0 && wo.cos() > 0.0 => {
                let facets = self.roughness.at(at.uv);
                let u = facets.invert_visible(wi, halfway(wi, wo).0);
                Some(spare.numbers.with_direction(u))
            }
            _ => None,
        }
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        conductor_reflectance(self.ior.as_ref(), 1.0) * self.specular_reflectance.colour(at.uv)
    }
}
