//! Phong's highlight on a diffuse surface.

use std::f32::consts::{FRAC_1_PI, TAU};

use super::{BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport};
use crate::math::{Frame, Local, Rgb, SolidAngleDensity, Vec2, Vec3, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A diffuse surface with a highlight around the mirrored direction, on the front side; black from
/// behind.
///
/// The highlight is `(n + 2)/2π · cosⁿ α`, with α the angle to the mirrored direction: light that
/// arrives along the normal is reflected in full, slanted light less.
///
/// Source: Lafortune & Willems 1994.
#[derive(Clone, Debug)]
pub struct Phong {
    colours: Highlight,
    exponent: Texture,
}

/// The two colours of a surface with a highlight, which together reflect no more than there is.
#[derive(Clone, Debug)]
pub(super) struct Highlight {
    specular: Texture,
    diffuse: Texture,
    /// Probability of sampling the highlight.
    pub(super) choice: f32,
}

impl Highlight {
    pub(super) fn new(specular: Texture, diffuse: Texture) -> Self {
        let share = specular.mean().luminance();
        let sum = share + diffuse.mean().luminance();
        Self {
            choice: if sum > 0.0 { share / sum } else { 0.5 },
            specular,
            diffuse,
        }
    }

    /// Highlight and base at one point; where a channel of their sum is more than one, both are
    /// scaled down together.
    #[inline]
    pub(super) fn at(&self, uv: Vec2) -> (Rgb, Rgb) {
        let (specular, diffuse) = (self.specular.colour(uv), self.diffuse.colour(uv));
        let excess = (specular + diffuse).max_channel().max(1.0);
        (specular / excess, diffuse / excess)
    }
}

/// `cosⁿ α / 2π`.
#[inline]
fn peak(cos: f32, exponent: f32) -> f32 {
    if cos > 0.0 {
        cos.min(1.0).powf(exponent) / TAU
    } else {
        0.0
    }
}

impl Phong {
    /// Makes the material.
    ///
    /// - `exponent`: of the cosine, 0 or more; the larger, the smaller the highlight.
    /// - `specular_reflectance`, `diffuse_reflectance`: of highlight and base, in `[0, 1]`.
    pub fn new(
        exponent: impl Into<Texture>,
        specular_reflectance: impl Into<Texture>,
        diffuse_reflectance: impl Into<Texture>,
    ) -> Self {
        Self {
            colours: Highlight::new(specular_reflectance.into(), diffuse_reflectance.into()),
            exponent: exponent.into(),
        }
    }

    #[inline]
    fn exponent(&self, at: &SurfacePoint) -> f32 {
        self.exponent.value(at.uv).max(0.0)
    }
}

impl BsdfModel for Phong {
    fn examples() -> Vec<Self> {
        let red = Rgb::new(0.9, 0.2, 0.1);
        vec![
            Self::new(30.0, 0.2, 0.5),
            Self::new(12.0, 1.0, 0.0),
            Self::new(500.0, 0.9, red),
            Self::new(4.0, red, 0.1),
        ]
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
        let (wo, lobe) = if u_lobe < self.colours.choice {
            let cos = (1.0 - u.y).powf(1.0 / (self.exponent(at) + 1.0));
            let (sin_azimuth, cos_azimuth) = (TAU * u.x).sin_cos();
            let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
            let around = Local(Vec3::new(sin * cos_azimuth, sin * sin_azimuth, cos));
            let wo = Local(Frame::around(wi.mirrored().0).to_world(around));
            (wo, Lobe::Glossy)
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
        let exponent = self.exponent(at);
        let peak = peak(wi.mirrored().0.dot(wo.0), exponent);
        let (specular, diffuse) = self.colours.at(at.uv);
        let value = specular * ((exponent + 2.0) * peak) + diffuse * FRAC_1_PI;
        let choice = self.colours.choice;
        let density = choice * (exponent + 1.0) * peak
            + (1.0 - choice) * warp::cosine_hemisphere_density(wo.cos());
        (value * wo.cos(), SolidAngleDensity(density))
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
        let exponent = self.exponent(at);
        let around = Frame::around(wi.mirrored().0).to_local(wo.0);
        let choice = self.colours.choice;
        let densities = [
            choice * (exponent + 1.0) * peak(around.cos(), exponent),
            (1.0 - choice) * warp::cosine_hemisphere_density(wo.cos()),
        ];
        let (lobe, spare) = spare.choose(densities)?;
        if lobe == 0 {
            let height = 1.0 - around.cos().min(1.0).powf(exponent + 1.0);
            let u = Vec2::new(warp::turn(around.0.truncate()), height);
            return Some(spare.numbers.with_direction(u).within(0.0, choice));
        }
        let u = warp::cosine_hemisphere_inverse(wo.0);
        let numbers = spare.numbers.with_direction(u);
        Some(numbers.within(choice, 1.0 - choice))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let (specular, diffuse) = self.colours.at(at.uv);
        specular + diffuse
    }
}
