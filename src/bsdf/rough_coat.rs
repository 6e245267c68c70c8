//! The coat of rough plastic and of rough coatings: a rough boundary, and tables of what it lets
//! through.

use super::fresnel::RelativeIor;
use super::microfacet::{MicrofacetKind, Microfacets, Roughness, halfway, mirrored_at};
use super::quadrature::gauss_legendre;
use crate::math::{Local, Vec2};
use crate::texture::{Texture, TextureModel};

/// A rough dielectric boundary above something else.
///
/// It is the microfacet model of rough glass; what it lets through is known by a table over the
/// cosine, for light that meets one small mirror only. Where the roughness varies there are tables
/// for some roughnesses, and the others lie between them.
///
/// Source: Walter 2007.
#[derive(Clone, Debug)]
pub(super) struct RoughCoat {
    pub(super) ior: RelativeIor,
    roughness: Roughness,
    rows: Box<[Row]>,
}

/// What a coat of one roughness lets through and reflects.
#[derive(Clone, Debug)]
struct Row {
    transmittance: CosineTable,
    inner_reflectance: f32,
}

/// A coat at one point.
#[derive(Clone, Copy)]
pub(super) struct CoatPoint<'a> {
    pub(super) facets: Microfacets,
    ior: RelativeIor,
    low: &'a Row,
    high: &'a Row,
    /// Place between the two rows.
    between: f32,
}

impl RoughCoat {
    /// Roughnesses with tables of their own, where it varies. The root of the roughness is spread
    /// evenly over 0 to 1; above one the last table stands.
    const ROWS: usize = 17;

    /// Makes the coat; this takes some milliseconds, or half a second where `alpha` varies.
    ///
    /// - `alpha`: roughness, the same for all directions.
    pub(super) fn new(kind: MicrofacetKind, alpha: Texture, ior: RelativeIor) -> Self {
        let row = |alpha: f32| {
            let facets = Microfacets::new(kind, Vec2::splat(alpha));
            Row {
                transmittance: CosineTable::new(|cos| transmittance(&facets, ior, cos)),
                inner_reflectance: diffuse_reflectance_within(&facets, ior.seen_from(-1.0)),
            }
        };
        let rows = if alpha.is_constant() {
            Box::new([row(alpha.value(Vec2::ZERO))]) as Box<[Row]>
        } else {
            let root = |i| i as f32 / (Self::ROWS - 1) as f32;
            (0..Self::ROWS).map(|i| row(root(i) * root(i))).collect()
        };
        Self {
            ior,
            roughness: Roughness::isotropic(kind, alpha),
            rows,
        }
    }

    #[inline]
    pub(super) fn at(&self, uv: Vec2) -> CoatPoint<'_> {
        let facets = self.roughness.at(uv);
        let last = self.rows.len() - 1;
        let place = facets.alpha().x.min(1.0).sqrt() * last as f32;
        let index = (place as usize).min(last.saturating_sub(1));
        CoatPoint {
            facets,
            ior: self.ior,
            low: &self.rows[index],
            high: &self.rows[(index + 1).min(last)],
            between: place - index as f32,
        }
    }
}

impl CoatPoint<'_> {
    /// Between what the rows of the two nearest roughnesses say.
    #[inline]
    fn between(&self, of: impl Fn(&Row) -> f32) -> f32 {
        let low = of(self.low);
        low + self.between * (of(self.high) - low)
    }

    /// Share of light that the coat lets through from its outside.
    #[inline]
    pub(super) fn transmittance(&self, cos: f32) -> f32 {
        self.between(|row| row.transmittance.at(cos))
    }

    /// Share of diffuse light from below that the coat reflects.
    #[inline]
    pub(super) fn inner_reflectance(&self) -> f32 {
        self.between(|row| row.inner_reflectance)
    }

    /// What the coat reflects from `wi` to `wo`, times `|cos θ_o|`, and the density of sampling it.
    ///
    /// The value is `F·D·G / (4 cos θ_i)`; the density the same without `F` and `G₁(wo)`.
    #[inline]
    pub(super) fn reflection(&self, wi: Local, wo: Local) -> (f32, f32) {
        let (m, cos) = halfway(wi, wo);
        let density = self.facets.reflected_density(wi, m);
        let fresnel = self.ior.refract(cos).reflectance;
        (fresnel * density * self.facets.masking(wo), density)
    }

    /// Density of [`CoatPoint::sample`], in 1/sr.
    #[inline]
    pub(super) fn density(&self, wi: Local, wo: Local) -> f32 {
        self.facets.reflected_density(wi, halfway(wi, wo).0)
    }

    /// The numbers of [`CoatPoint::sample`].
    #[inline]
    pub(super) fn invert(&self, wi: Local, wo: Local) -> Vec2 {
        self.facets.invert_visible(wi, halfway(wi, wo).0)
    }

    /// Samples a direction that the coat reflects `wi` into.
    #[inline]
    pub(super) fn sample(&self, wi: Local, u: Vec2) -> Local {
        mirrored_at(wi, self.facets.sample_visible(wi, u))
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

    #[test]
    fn rows_between_are_near_enough() {
        use std::sync::Arc;

        use crate::image::{self, Texels};
        use crate::math::Mat3;
        use crate::texture::{Bitmap, Filter, Wrap};

        let ior = RelativeIor::new(1.5, 1.0).unwrap();
        for alpha in [0.004, 0.05, 0.12, 0.37, 0.8] {
            let one_texel = image::Bitmap::new(1, 1, 1, Texels::Float(vec![alpha])).unwrap();
            let (filter, wrap) = (Filter::Nearest, Wrap::Repeat);
            let varying = Bitmap::new(Arc::new(one_texel), filter, wrap, Mat3::IDENTITY);
            let make = |alpha: Texture| RoughCoat::new(MicrofacetKind::Beckmann, alpha, ior);
            let (exact, varying) = (make(alpha.into()), make(varying.into()));
            let (exact, varying) = (exact.at(Vec2::ZERO), varying.at(Vec2::ZERO));
            let inner = exact.inner_reflectance() - varying.inner_reflectance();
            assert!(inner.abs() < 2e-3, "{alpha}: {inner}");
            for cos in [1.0, 0.6, 0.3, 0.1] {
                let apart = exact.transmittance(cos) - varying.transmittance(cos);
                assert!(apart.abs() < 4e-3, "{alpha} {cos}: {apart}");
            }
        }
    }
}
