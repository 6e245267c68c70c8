//! The second highlight of Disney's material.

use std::f32::consts::{PI, TAU};

use super::disney::schlick_weight;
use super::microfacet::{MicrofacetKind, Microfacets, mirrored_at};
use crate::math::warp::turn;
use crate::math::{Local, Vec2, Vec3};

/// A thin white highlight over everything else; light that passes it is not reduced.
#[derive(Clone, Copy)]
pub(super) struct Clearcoat {
    pub(super) strength: f32,
    alpha_squared: f32,
}

impl Clearcoat {
    /// Makes the highlight.
    ///
    /// - `strength`, `gloss`: in `[0, 1]`.
    pub(super) fn new(strength: f32, gloss: f32) -> Self {
        let alpha = 0.1 + (0.001 - 0.1) * gloss;
        Self {
            strength,
            alpha_squared: alpha * alpha,
        }
    }

    /// Area of mirrors with a normal of cosine `cos`: a distribution with long tails.
    ///
    /// Source: Burley 2012 (GTR with γ = 1).
    #[inline]
    fn normal_density(self, cos: f32) -> f32 {
        let a = self.alpha_squared;
        (a - 1.0) / (PI * a.ln() * (1.0 + (a - 1.0) * cos * cos))
    }

    /// Samples a direction that the highlight reflects `wi` into; `None` where it is below.
    ///
    /// Source: Burley 2012.
    #[inline]
    pub(super) fn sample(self, wi: Local, u: Vec2) -> Option<Local> {
        let a = self.alpha_squared;
        let cos2 = ((1.0 - a.powf(1.0 - u.y)) / (1.0 - a)).clamp(0.0, 1.0);
        let sin = (1.0 - cos2).sqrt();
        let (y, x) = (TAU * u.x).sin_cos();
        let m = Local(Vec3::new(sin * x, sin * y, cos2.sqrt()));
        let wo = mirrored_at(wi, m);
        (wi.0.dot(m.0) > 0.0 && wo.cos() > 0.0).then_some(wo)
    }

    /// The numbers of [`Clearcoat::sample`], from the normal halfway between the directions.
    #[inline]
    pub(super) fn invert(self, m: Local) -> Vec2 {
        let a = self.alpha_squared;
        let power = (1.0 - (1.0 - a) * m.cos() * m.cos()).ln() / a.ln();
        Vec2::new(turn(m.0.truncate()), 1.0 - power)
    }

    /// Value times the cosine of `wo`; the index is 1.5, the masking that of a roughness of 0.25.
    ///
    /// Source: Burley 2012.
    #[inline]
    pub(super) fn value(self, wi: Local, wo: Local, m: Local, cos: f32) -> f32 {
        let fresnel = 0.04 + 0.96 * schlick_weight(cos);
        let masks = Microfacets::new(MicrofacetKind::Ggx, Vec2::splat(0.25));
        let masking = masks.masking(wi) * masks.masking(wo);
        0.25 * self.strength * fresnel * self.normal_density(m.cos()) * masking * wo.cos()
    }

    /// Density of [`Clearcoat::sample`], in 1/sr.
    ///
    /// - `m`, `cos`: the normal halfway between the directions, and its cosine to them.
    #[inline]
    pub(super) fn density(self, m: Local, cos: f32) -> f32 {
        self.normal_density(m.cos()) * m.cos() / (4.0 * cos)
    }
}
