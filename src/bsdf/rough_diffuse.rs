//! Rough matt surfaces: plaster, clay, sand.

use std::f32::consts::{FRAC_1_PI, FRAC_2_PI};

use super::matt::{invert_matt, matt_density, sample_matt};
use super::{BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// Grooves whose flanks are ideal diffuse, on the front side; black from behind.
///
/// A fit to such a surface, no exact account of it: with a reflectance of one it sends out up to 5 %
/// more than it gets where light grazes it. Where the fit is negative it counts as zero.
///
/// Source: Oren & Nayar 1994.
#[derive(Clone, Debug)]
pub struct RoughDiffuse {
    reflectance: Texture,
    alpha: Texture,
    qualitative: bool,
}

/// Angles of the two directions, as the model asks for them.
struct Angles {
    /// Cosine of the angle between the azimuths.
    cos_azimuth: f32,
    /// The larger and the smaller angle to the normal, in radians.
    larger: f32,
    smaller: f32,
    /// Sine of the larger angle; tangent of the smaller one, and of half of their sum.
    sin_larger: f32,
    tan_smaller: f32,
    tan_half_sum: f32,
}

impl Angles {
    fn new(wi: Local, wo: Local) -> Self {
        let (cos_i, cos_o) = (wi.cos(), wo.cos());
        let (sin_i, sin_o) = (wi.sin_squared().sqrt(), wo.sin_squared().sqrt());
        let across = wi.0.truncate().dot(wo.0.truncate());
        let cos_azimuth = if sin_i * sin_o > 0.0 {
            (across / (sin_i * sin_o)).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        Self {
            cos_azimuth,
            larger: cos_i.min(cos_o).min(1.0).acos(),
            smaller: cos_i.max(cos_o).min(1.0).acos(),
            sin_larger: sin_i.max(sin_o),
            tan_smaller: sin_i.min(sin_o) / cos_i.max(cos_o),
            tan_half_sum: (sin_i + sin_o) / (cos_i + cos_o),
        }
    }
}

impl RoughDiffuse {
    /// Makes the material.
    ///
    /// - `reflectance`: of the grooves' flanks, in `[0, 1]`.
    /// - `alpha`: root mean square of the slopes. The paper's σ, their deviation along one axis of the
    ///   surface, is `alpha / √2`.
    /// - `qualitative`: the paper's shorter form, without light that goes from flank to flank.
    pub fn new(
        reflectance: impl Into<Texture>,
        alpha: impl Into<Texture>,
        qualitative: bool,
    ) -> Self {
        Self {
            reflectance: reflectance.into(),
            alpha: alpha.into(),
            qualitative,
        }
    }

    /// π times the value for unit irradiance, for directions above the surface.
    ///
    /// Source: Oren & Nayar 1994, the functional model with its term for light that is reflected
    /// twice, or the qualitative model.
    fn groove(&self, angles: &Angles, at: &SurfacePoint) -> Rgb {
        let reflectance = self.reflectance.colour(at.uv);
        let alpha = self.alpha.value(at.uv);
        let variance = 0.5 * alpha * alpha;
        let steep = variance / (variance + 0.09);
        let cos = angles.cos_azimuth;
        let base = 1.0 - 0.5 * variance / (variance + 0.33);
        if self.qualitative {
            let leaning = 0.45 * steep * cos.max(0.0) * angles.sin_larger * angles.tan_smaller;
            return reflectance * (base + leaning);
        }
        let smaller = angles.smaller * FRAC_2_PI;
        let behind = if cos < 0.0 { smaller.powi(3) } else { 0.0 };
        let both = smaller * angles.larger * FRAC_2_PI;
        let once = base
            + 0.45 * steep * cos * (angles.sin_larger - behind) * angles.tan_smaller
            + 0.125 * steep * both * both * (1.0 - cos.abs()) * angles.tan_half_sum;
        let twice = 0.17 * variance / (variance + 0.13) * (1.0 - cos * smaller * smaller);
        let sum = reflectance * once + reflectance * reflectance * twice;
        sum.map(|channel| channel.max(0.0))
    }
}

impl BsdfModel for RoughDiffuse {
    fn examples() -> Vec<Self> {
        let clay = Rgb::new(0.9, 0.5, 0.2);
        vec![
            Self::new(0.5, 0.0, false),
            Self::new(clay, 0.2, false),
            Self::new(clay, 0.8, false),
            Self::new(clay, 0.5, true),
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
        let wo = sample_matt(u_lobe, u);
        let (value, density) = self.eval_with_density(wi, wo, at, transport);
        BsdfSample::finite(wo, value, density, Lobe::Diffuse)
    }

    #[inline]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, _transport: Transport) -> Rgb {
        if wi.cos() <= 0.0 || wo.cos() <= 0.0 {
            return Rgb::BLACK;
        }
        self.groove(&Angles::new(wi, wo), at) * (FRAC_1_PI * wo.cos())
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
        SolidAngleDensity(matt_density(wo.cos()))
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
            Sampled::Finite(wo) if wi.cos() > 0.0 => invert_matt(wo, spare),
            _ => None,
        }
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.reflectance.colour(at.uv)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Derivatives;

    /// The model written down as in the paper, in 64 bits and with angles.
    fn by_angles(rho: f64, sigma2: f64, (ti, to): (f64, f64), azimuth: f64) -> f64 {
        use std::f64::consts::PI;
        let (a, b, c) = (ti.max(to), ti.min(to), azimuth.cos());
        let k = sigma2 / (sigma2 + 0.09);
        let c1 = 1.0 - 0.5 * sigma2 / (sigma2 + 0.33);
        let less = if c < 0.0 { (2.0 * b / PI).powi(3) } else { 0.0 };
        let c2 = 0.45 * k * (a.sin() - less);
        let c3 = 0.125 * k * (4.0 * a * b / (PI * PI)).powi(2);
        let once = c1 + c * c2 * b.tan() + (1.0 - c.abs()) * c3 * (0.5 * (a + b)).tan();
        let twice = 0.17 * sigma2 / (sigma2 + 0.13) * (1.0 - c * (2.0 * b / PI).powi(2));
        rho * to.cos() / PI * (once + rho * twice)
    }

    #[test]
    fn values_are_those_of_the_paper() {
        let at = SurfacePoint {
            position: glam::Vec3::ZERO,
            geometric_normal: glam::Vec3::Z,
            shading_normal: glam::Vec3::Z,
            derivatives: Derivatives::NONE,
            uv: Vec2::ZERO,
            error: 0.0,
        };
        let model = RoughDiffuse::new(0.7, 0.6, false);
        let direction = |angle: f64, azimuth: f64| {
            let (x, y) = (angle.sin() * azimuth.cos(), angle.sin() * azimuth.sin());
            Local::new(x as f32, y as f32, angle.cos() as f32)
        };
        for angles in [(0.1, 0.2), (1.2, 0.4), (0.9, 1.4), (1.3, 1.3)] {
            for azimuth in [0.0, 0.8, 1.7, 3.0] {
                let (wi, wo) = (direction(angles.0, 0.3), direction(angles.1, 0.3 + azimuth));
                let found = f64::from(model.eval(wi, wo, &at, Transport::Radiance).g());
                let exact = by_angles(0.7, 0.18, angles, azimuth);
                assert!(
                    (found - exact).abs() < 1e-5 * exact.max(0.1),
                    "{angles:?} {azimuth}: {found}, not {exact}"
                );
            }
        }
    }
}
