//! Diffuse transmission: paper, leaves, lamp shades.

use std::f32::consts::FRAC_1_PI;

use super::{BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// Sends light equally into all directions of the other side, from either side.
#[derive(Clone, Debug)]
pub struct DiffuseTransmitter {
    transmittance: Texture,
}

impl DiffuseTransmitter {
    /// Makes the material.
    ///
    /// - `transmittance`: share of light that goes through, in `[0, 1]`.
    pub fn new(transmittance: impl Into<Texture>) -> Self {
        Self {
            transmittance: transmittance.into(),
        }
    }
}

impl BsdfModel for DiffuseTransmitter {
    fn examples() -> Vec<Self> {
        vec![Self::new(Rgb::new(0.9, 0.5, 0.0))]
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            dirac: false,
            transmission: true,
            single: true,
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
        let above = Local(warp::cosine_hemisphere(u));
        let wo = if wi.cos() > 0.0 {
            above.flipped()
        } else {
            above
        };
        let value = self.eval(wi, wo, at, transport);
        BsdfSample::finite(
            wo,
            value,
            self.density(wi, wo, at, transport),
            Lobe::Diffuse,
        )
    }

    #[inline]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, _transport: Transport) -> Rgb {
        if wi.cos() * wo.cos() >= 0.0 {
            return Rgb::BLACK;
        }
        self.transmittance.colour(at.uv) * (FRAC_1_PI * wo.abs_cos())
    }

    #[inline]
    fn density(
        &self,
        wi: Local,
        wo: Local,
        _at: &SurfacePoint,
        _transport: Transport,
    ) -> SolidAngleDensity {
        if wi.cos() * wo.cos() >= 0.0 {
            return SolidAngleDensity::ZERO;
        }
        SolidAngleDensity(warp::cosine_hemisphere_density(wo.abs_cos()))
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
            Sampled::Finite(wo) if wi.cos() * wo.cos() < 0.0 => {
                let u = warp::cosine_hemisphere_inverse(wo.0);
                Some(spare.numbers.with_direction(u))
            }
            _ => None,
        }
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.transmittance.colour(at.uv)
    }
}
