//! Rough plastic: a diffuse base under a rough coat.

use std::f32::consts::FRAC_1_PI;

use super::coat::CoatedBase;
use super::fresnel::RelativeIor;
use super::microfacet::{MicrofacetKind, Microfacets, halfway, mirrored_at};
use super::quadrature::gauss_legendre;
use super::{BsdfModel, BsdfSample, Lobe, LobeSet, Transport};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A diffuse base under a rough dielectric coat, on the front side; black from behind.
///
/// The coat is the microfacet model of rough glass; what it lets through is known by a table over
/// the cosine, for light that meets one small mirror only.
///
/// What the coat reflects of the base's own light is found by the coarse rule of Mitsuba: with the
/// exact one, pictures differ from its own by 2 %, and the model is no more right for it.
///
/// Source: Walter 2007 for the coat.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    facets: Microfacets,
    coated: CoatedBase,
    transmittance: CosineTable,
}

impl RoughPlastic {
    /// Makes the material; this takes some milliseconds.
    ///
    /// - `alpha`: roughness, the same for all directions and everywhere.
    /// - the others: as for [`super::Plastic::new`].
    pub fn new(
        kind: MicrofacetKind,
        alpha: f32,
        ior: RelativeIor,
        specular_reflectance: impl Into<Texture>,
        diffuse_reflectance: impl Into<Texture>,
        nonlinear: bool,
    ) -> Self {
        let facets = Microfacets::new(kind, Vec2::splat(alpha));
        Self {
            facets,
            coated: CoatedBase::new(
                ior,
                specular_reflectance.into(),
                diffuse_reflectance.into(),
                nonlinear,
                diffuse_reflectance_within(&facets, ior.seen_from(-1.0)),
            ),
            transmittance: CosineTable::new(|cos| transmittance(&facets, ior, cos)),
        }
    }

    /// Probability of sampling the coat's reflection.
    #[inline]
    fn specular_choice(&self, transmittance: f32) -> f32 {
        self.coated.specular_choice(1.0 - transmittance)
    }
}

/// A function of the cosine, by linear interpolation.
#[derive(Clone, Debug)]
struct CosineTable {
    values: Box<[f32]>,
}

impl CosineTable {
    const INTERVALS: usize = 128;
    /// Stands for the horizon, where nothing is seen.
    const LEAST_COSINE: f32 = 1e-6;

    /// Makes the table of a function on `(0, 1]`.
    fn new(f: impl Fn(f32) -> f32) -> Self {
        let value = |i| f((i as f32 / Self::INTERVALS as f32).max(Self::LEAST_COSINE));
        Self {
            values: (0..=Self::INTERVALS).map(value).collect(),
        }
    }

    #[inline]
    fn at(&self, cos: f32) -> f32 {
        let place = cos.clamp(0.0, 1.0) * Self::INTERVALS as f32;
        let index = (place as usize).min(Self::INTERVALS - 1);
        let (low, high) = (self.values[index], self.values[index + 1]);
        low + (place - index as f32) * (high - low)
    }
}

/// Mean of a function of the small mirrors' normals, over those that are seen from `wi`.
///
/// The first number of the sampler turns around the normal: there the midpoint rule converges
/// as fast as Gauss's does for the second.
fn visible_mean(facets: &Microfacets, wi: Local, f: impl Fn(Local) -> f32) -> f32 {
    const COUNT: usize = 32;
    let mut sum = 0.0;
    for (y, weight) in gauss_legendre(COUNT) {
        for i in 0..COUNT {
            let x = (i as f32 + 0.5) / COUNT as f32;
            let m = facets.sample_visible(wi, Vec2::new(x, y as f32));
            sum += weight * f64::from(f(m));
        }
    }
    (sum / COUNT as f64) as f32
}

/// A direction with the given cosine.
fn above(cos: f32) -> Local {
    Local::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// Share of light that the coat lets through from its outside.
fn transmittance(facets: &Microfacets, ior: RelativeIor, cos: f32) -> f32 {
    let wi = above(cos);
    visible_mean(facets, wi, |m| {
        let cos_i = wi.0.dot(m.0).clamp(0.0, 1.0);
        let refraction = ior.refract(cos_i);
        let wo = ior.bend(wi, m, cos_i, refraction.cos_refracted);
        (1.0 - refraction.reflectance) * facets.masking(wo.flipped())
    })
}

/// Share of light that the coat reflects.
fn reflectance(facets: &Microfacets, ior: RelativeIor, cos: f32) -> f32 {
    let wi = above(cos);
    visible_mean(facets, wi, |m| {
        let cos_i = wi.0.dot(m.0).clamp(0.0, 1.0);
        ior.refract(cos_i).reflectance * facets.masking(mirrored_at(wi, m))
    })
}

/// Share of diffuse light that the coat reflects, by Mitsuba's rule; `ior` is seen from the light's
/// side.
///
/// The mean of `2μ R(μ)` over 64 cosines from zero to one, ends included, which for glass is 1 % low.
fn diffuse_reflectance_within(facets: &Microfacets, ior: RelativeIor) -> f32 {
    const COUNT: usize = 64;
    let share = |i| {
        let cos = (i as f32 / (COUNT - 1) as f32).max(CosineTable::LEAST_COSINE);
        2.0 * cos * reflectance(facets, ior, cos)
    };
    (0..COUNT).map(share).sum::<f32>() / COUNT as f32
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
        let choice = self.specular_choice(self.transmittance.at(wi.cos()));
        let (wo, lobe) = if u_lobe < choice {
            let m = self.facets.sample_visible(wi, u);
            (mirrored_at(wi, m), Lobe::Glossy)
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
    fn density(&self, wi: Local, wo: Local, at: &SurfacePoint) -> SolidAngleDensity {
        self.eval_with_density(wi, wo, at, Transport::Importance).1
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
        let (m, cos) = halfway(wi, wo);
        let reflected = self.facets.reflected_density(wi, m);
        let fresnel = self.coated.ior.refract(cos).reflectance;
        let specular = self.coated.specular_reflectance.colour(at.uv)
            * (fresnel * reflected * self.facets.masking(wo));

        let passed_in = self.transmittance.at(wi.cos());
        let passed = passed_in * self.transmittance.at(wo.cos());
        let diffuse = self.coated.base(at.uv) * (passed * FRAC_1_PI * wo.cos());

        let choice = self.specular_choice(passed_in);
        let density =
            choice * reflected + (1.0 - choice) * warp::cosine_hemisphere_density(wo.cos());
        (specular + diffuse, SolidAngleDensity(density))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.coated.albedo(at.uv)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nearly_smooth_coat_is_a_smooth_one() {
        let ior = RelativeIor::new(1.5, 1.0).unwrap();
        for kind in [MicrofacetKind::Beckmann, MicrofacetKind::Ggx] {
            let facets = Microfacets::new(kind, Vec2::splat(1e-3));
            for cos in [1.0, 0.7, 0.3, 0.1] {
                let passed = transmittance(&facets, ior, cos);
                let exact = 1.0 - ior.refract(cos).reflectance;
                assert!(
                    (passed - exact).abs() < 1e-3,
                    "{kind:?} {cos}: {passed} {exact}"
                );
            }
            let inner = ior.seen_from(-1.0);
            let found = diffuse_reflectance_within(&facets, inner);
            let exact = inner.diffuse_reflectance();
            assert!((found - exact).abs() < 1e-2, "{kind:?}: {found} {exact}");
        }
    }

    #[test]
    fn the_coat_makes_no_light() {
        let ior = RelativeIor::new(1.5, 1.0).unwrap();
        for alpha in [0.05, 0.3, 0.9] {
            let facets = Microfacets::new(MicrofacetKind::Ggx, Vec2::splat(alpha));
            for ior in [ior, ior.seen_from(-1.0)] {
                for cos in [1.0, 0.5, 0.05] {
                    let sum = transmittance(&facets, ior, cos) + reflectance(&facets, ior, cos);
                    assert!(sum <= 1.0 + 1e-5, "{alpha} {cos}: {sum}");
                }
            }
        }
    }
}
