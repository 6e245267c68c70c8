//! Ground glass.

use super::fresnel::RelativeIor;
use super::microfacet::{MicrofacetKind, Roughness, from_above, halfway, mirrored_at};
use super::{
    BsdfError, BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// Nearer to one than this, the ratio of the indices leaves too few digits to find the normal that
/// refracts one direction into another.
const LEAST_CONTRAST: f32 = 1e-4;

/// A boundary between two transparent substances, of many small smooth ones.
///
/// Light that meets more than one of them is lost.
///
/// Source: Walter 2007 for the model, Heitz 2014 for two roughnesses and for sampling.
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    roughness: Roughness,
    ior: RelativeIor,
    specular_reflectance: Texture,
    specular_transmittance: Texture,
}

impl RoughDielectric {
    /// Makes the material.
    ///
    /// - `ior`: inside over outside; the normal points outside.
    /// - `specular_reflectance`, `specular_transmittance`: factors on what is reflected and what
    ///   goes through; 1 is physical.
    ///
    /// # Errors
    /// [`BsdfError::IndexMatched`] where the ratio is one, but for 1e-4: all light goes straight
    /// on then, and has no density.
    pub fn new(
        roughness: Roughness,
        ior: RelativeIor,
        specular_reflectance: impl Into<Texture>,
        specular_transmittance: impl Into<Texture>,
    ) -> Result<Self, BsdfError> {
        if (ior.ratio() - 1.0).abs() < LEAST_CONTRAST {
            return Err(BsdfError::IndexMatched(ior.ratio()));
        }
        Ok(Self {
            roughness,
            ior,
            specular_reflectance: specular_reflectance.into(),
            specular_transmittance: specular_transmittance.into(),
        })
    }

    /// Turns everything over where `wi` comes from below: the rest sees `wi` above the surface, and
    /// the ratio of the indices as the far side's over the near side's.
    #[inline]
    fn seen_from_above(&self, wi: Local, wo: Local) -> (Local, Local, RelativeIor) {
        let ior = self.ior.seen_from(wi.cos());
        let (wi, wo) = from_above(wi, wo);
        (wi, wo, ior)
    }
}

/// The mirror that refracts `wi` (above) into `wo` (below), and the squared length of
/// `wi + η wo`, which the normal is made from; `None` where none does.
///
/// Source: Walter 2007, Sec. 5.3.
#[inline]
pub(super) fn refracting_normal(wi: Local, wo: Local, ior: RelativeIor) -> Option<(Local, f32)> {
    let sum = wi.0 + wo.0 * ior.ratio();
    let m = sum.normalize_or_zero() * 1.0_f32.copysign(sum.z);
    // Each direction must lie on the same side of the mirror as of the surface.
    (m.z > 0.0 && wi.0.dot(m) > 0.0 && wo.0.dot(m) < 0.0)
        .then_some((Local(m), sum.length_squared()))
}

impl BsdfModel for RoughDielectric {
    fn examples() -> Vec<Self> {
        use MicrofacetKind::{Beckmann, Ggx};
        let make = |kind, alpha_u: f32, alpha_v: f32, interior, exterior| {
            let roughness = Roughness::new(kind, alpha_u, alpha_v);
            let ior = RelativeIor::new(interior, exterior)?;
            Self::new(roughness, ior, Rgb::new(1.0, 1.0, 0.5), 1.0)
        };
        [
            make(Ggx, 0.02, 0.02, 1.5, 1.0),
            make(Ggx, 0.3, 0.3, 1.5, 1.0),
            make(Ggx, 0.1, 0.5, 1.0, 1.33),
            make(Beckmann, 0.02, 0.02, 1.5, 1.0),
            make(Beckmann, 0.1, 0.1, 2.4, 1.0),
            make(Beckmann, 0.5, 0.15, 1.33, 1.5),
            make(Beckmann, 0.3, 0.3, 1.05, 1.0),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            dirac: false,
            transmission: true,
            single: false,
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
        if wi.cos() == 0.0 {
            return None;
        }
        let (above, _, ior) = self.seen_from_above(wi, wi);
        let m = self.roughness.at(at.uv).sample_visible(above, u);
        let cos = above.0.dot(m.0).min(1.0);
        if cos <= 0.0 {
            return None;
        }
        let refraction = ior.refract(cos);
        let reflects = u_lobe < refraction.reflectance;
        let wo = if reflects {
            mirrored_at(above, m)
        } else {
            ior.bend(above, m, cos, refraction.cos_refracted)
        };
        // A mirror that sends light to the wrong side of the surface sends it to other mirrors.
        if (wo.cos() > 0.0) != reflects {
            return None;
        }
        let wo = if wi.cos() > 0.0 { wo } else { wo.flipped() };
        let (value, density) = self.eval_with_density(wi, wo, at, transport);
        BsdfSample::finite(wo, value, density, Lobe::Glossy).map(|sample| BsdfSample {
            eta: if reflects { 1.0 } else { ior.inverse() },
            ..sample
        })
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

    /// The value is the density times `G₁(wo)`, the tint, and for radiance `(η_i / η_o)²`.
    ///
    /// Source: Walter 2007 (Jacobians of reflection and refraction); Veach 1997, Ch. 5 (radiance).
    #[inline(never)]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        const NOTHING: (Rgb, SolidAngleDensity) = (Rgb::BLACK, SolidAngleDensity::ZERO);
        let (wi, wo, ior) = self.seen_from_above(wi, wo);
        if wi.cos() == 0.0 || wo.cos() == 0.0 {
            return NOTHING;
        }
        let facets = self.roughness.at(at.uv);
        let (density, tint) = if wo.cos() > 0.0 {
            let (m, cos) = halfway(wi, wo);
            let reflectance = ior.refract(cos).reflectance;
            let tint = self.specular_reflectance.colour(at.uv);
            (facets.reflected_density(wi, m) * reflectance, tint)
        } else {
            let Some((m, length_squared)) = refracting_normal(wi, wo, ior) else {
                return NOTHING;
            };
            let (cos_i, cos_o) = (wi.0.dot(m.0).min(1.0), -wo.0.dot(m.0));
            // The divisor of the Jacobian, cos θ_i − η cos θ_o, is the length of wi + η wo.
            let jacobian = ior.ratio() * ior.ratio() * cos_o / length_squared;
            let transmittance = ior.transmittance(cos_i, cos_o);
            let scale = match transport {
                Transport::Radiance => ior.inverse() * ior.inverse(),
                Transport::Importance => 1.0,
            };
            let tint = self.specular_transmittance.colour(at.uv) * scale;
            (
                facets.visible_density(wi, m) * transmittance * jacobian,
                tint,
            )
        };
        let above = if wo.cos() > 0.0 { wo } else { wo.flipped() };
        (
            tint * (density * facets.masking(above)),
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
        let Sampled::Finite(wo) = sampled else {
            return None;
        };
        let (wi, wo, ior) = self.seen_from_above(wi, wo);
        if wi.cos() == 0.0 || wo.cos() == 0.0 {
            return None;
        }
        let facets = self.roughness.at(at.uv);
        let reflects = wo.cos() > 0.0;
        let m = if reflects {
            halfway(wi, wo).0
        } else {
            refracting_normal(wi, wo, ior)?.0
        };
        let reflectance = ior.refract(wi.0.dot(m.0).min(1.0)).reflectance;
        let (low, size) = if reflects {
            (0.0, reflectance)
        } else {
            (reflectance, 1.0 - reflectance)
        };
        let u = facets.invert_visible(wi, m);
        let numbers = spare.numbers.with_direction(u);
        (size > 0.0).then(|| numbers.within(low, size))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let reflectance = self.ior.refract(1.0).reflectance;
        self.specular_reflectance.colour(at.uv) * reflectance
            + self.specular_transmittance.colour(at.uv) * (1.0 - reflectance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matched_indices_are_refused() {
        let roughness = Roughness::isotropic(MicrofacetKind::Ggx, 0.1);
        for (interior, refused) in [(1.5, true), (1.500_01, true), (1.501, false)] {
            let ior = RelativeIor::new(interior, 1.5).unwrap();
            let made = RoughDielectric::new(roughness.clone(), ior, 1.0, 1.0);
            assert_eq!(made.is_err(), refused);
        }
    }
}
