//! Ideal diffuse reflection.

use std::f32::consts::FRAC_1_PI;

use super::{
    BsdfModel, BsdfSample, Component, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// Reflects equally into all directions of the front side; black from behind.
#[derive(Clone, Debug)]
pub struct Diffuse {
    reflectance: Texture,
}

impl Diffuse {
    /// Makes the material.
    ///
    /// - `reflectance`: share of light reflected, in `[0, 1]`.
    pub fn new(reflectance: impl Into<Texture>) -> Self {
        Self {
            reflectance: reflectance.into(),
        }
    }

    /// The reflectance at surface coordinates.
    pub fn reflectance(&self, uv: Vec2) -> Rgb {
        self.reflectance.colour(uv)
    }

    /// The reflectance, where it is the same everywhere.
    pub fn sole_reflectance(&self) -> Option<Rgb> {
        self.reflectance.sole_colour()
    }
}

/// What a diffuse surface scatters, times the cosine.
///
/// - `reflectance`: share of light reflected.
/// - `cos_in`, `cos_out`: signed cosines of the angles between directions and normal.
#[inline(always)]
pub(super) fn lambert(reflectance: impl FnOnce() -> Rgb, cos_in: f32, cos_out: f32) -> Rgb {
    if cos_in <= 0.0 || cos_out <= 0.0 {
        return Rgb::BLACK;
    }
    reflectance() * (FRAC_1_PI * cos_out)
}

impl BsdfModel for Diffuse {
    fn examples() -> Vec<Self> {
        vec![Self::new(0.5), Self::new(Rgb::new(0.9, 0.5, 0.0))]
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            single: true,
            ..LobeSet::default()
        }
    }

    #[inline(always)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        _transport: Transport,
        _u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if wi.cos() <= 0.0 {
            return None;
        }
        let direction = Local(warp::cosine_hemisphere(u));
        let density = warp::cosine_hemisphere_density(direction.cos());
        let weight = self.reflectance.colour(at.uv);
        Some(BsdfSample {
            direction,
            weight,
            value: weight * density,
            density,
            lobe: Lobe::Diffuse,
            component: Component(0),
            eta: 1.0,
        })
    }

    #[inline]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, _transport: Transport) -> Rgb {
        lambert(|| self.reflectance.colour(at.uv), wi.cos(), wo.cos())
    }

    #[inline]
    fn density(
        &self,
        wi: Local,
        wo: Local,
        _at: &SurfacePoint,
        _transport: Transport,
    ) -> SolidAngleDensity {
        if wi.cos() <= 0.0 {
            return SolidAngleDensity::ZERO;
        }
        SolidAngleDensity(warp::cosine_hemisphere_density(wo.cos()))
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        _at: &SurfacePoint,
        _transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        match sampled {
            Sampled::Finite(wo) if wi.cos() > 0.0 && wo.cos() > 0.0 => {
                let u = warp::cosine_hemisphere_inverse(wo.0);
                Some(spare.numbers.with_direction(u))
            }
            _ => None,
        }
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.reflectance.colour(at.uv)
    }
}
