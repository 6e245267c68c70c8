//! Disney's material for bodies.

use super::clearcoat::Clearcoat;
use super::disney::{Matt, alpha, hue, schlick};
use super::fresnel::RelativeIor;
use super::matt::{invert_matt, matt_density, sample_matt};
use super::microfacet::{MicrofacetKind, Microfacets, from_above, halfway, mirrored_at};
use super::principled_parameters::PrincipledParameters;
use super::rough_dielectric::refracting_normal;
use super::{
    BsdfError, BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport,
};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A mixture of plastic, metal and glass with sheen and a clear coat; without `spec_trans`, black
/// from behind.
///
/// As published it is made to look right, not to keep energy: a white one reflects 4 % more than it
/// gets along the normal and up to half as much again where light grazes it; sheen and clear coat
/// come on top. Below a base of about 0.6 it makes no light.
///
/// Source: Burley 2012; Burley 2015. The constants that they leave open are those of Mitsuba 3.9.1.
#[derive(Clone, Debug)]
pub struct Principled {
    parameters: Box<PrincipledParameters>,
    transmits: bool,
}

/// The material at one point, seen from one side.
struct Point {
    base: Rgb,
    hue: Rgb,
    facets: Microfacets,
    metallic: f32,
    /// Share of glass in all.
    glass: f32,
    spec_tint: f32,
    matt: Matt,
    clearcoat: Clearcoat,
    /// The far side's index over the near side's.
    ior: RelativeIor,
    is_front: bool,
}

/// Probabilities of the lobes.
#[derive(Clone, Copy)]
struct Choice {
    matt: f32,
    clearcoat: f32,
    /// Reflection and refraction by the same small mirrors.
    mirrors: f32,
}

impl Principled {
    /// Makes the material.
    ///
    /// # Errors
    /// [`BsdfError::IndexMatched`] where light goes through and the indices of both sides are the
    /// same, but for 1e-4.
    pub fn new(parameters: PrincipledParameters) -> Result<Self, BsdfError> {
        let transmits = !parameters.spec_trans.is_zero();
        let ratio = parameters.ior.ratio();
        if transmits && (ratio - 1.0).abs() < 1e-4 {
            return Err(BsdfError::IndexMatched(ratio));
        }
        Ok(Self {
            parameters: Box::new(parameters),
            transmits,
        })
    }

    fn at(&self, wi: Local, at: &SurfacePoint) -> Point {
        let parameters = &*self.parameters;
        let value = |texture: &Texture| texture.value(at.uv).clamp(0.0, 1.0);
        let base = parameters.base_color.colour(at.uv).clamp(0.0, 1.0);
        let hue = hue(base);
        let roughness = value(&parameters.roughness);
        let metallic = value(&parameters.metallic);
        let spec_trans = value(&parameters.spec_trans);
        let sheen_hue = Rgb::WHITE + (hue - Rgb::WHITE) * value(&parameters.sheen_tint);
        let clearcoat = value(&parameters.clearcoat);
        Point {
            base,
            hue,
            facets: Microfacets::new(
                MicrofacetKind::Ggx,
                alpha(roughness, value(&parameters.anisotropic)),
            ),
            metallic,
            glass: (1.0 - metallic) * spec_trans,
            spec_tint: value(&parameters.spec_tint),
            matt: Matt {
                diffuse: base * ((1.0 - metallic) * (1.0 - spec_trans)),
                sheen: sheen_hue * (value(&parameters.sheen) * (1.0 - metallic)),
                roughness,
                flatness: value(&parameters.flatness),
            },
            clearcoat: Clearcoat::new(clearcoat, value(&parameters.clearcoat_gloss)),
            ior: parameters.ior.seen_from(wi.cos()),
            is_front: wi.cos() > 0.0,
        }
    }
}

impl Point {
    /// Share of light that the small mirrors reflect.
    ///
    /// - `cos`: of light to the mirror's normal, positive; `fresnel`: what glass reflects there.
    #[inline]
    fn reflectance(&self, cos: f32, fresnel: f32) -> Rgb {
        let glass = Rgb::grey(fresnel);
        if !self.is_front {
            return glass * self.glass;
        }
        let root = (self.ior.ratio() - 1.0) / (self.ior.ratio() + 1.0);
        let tinted = schlick(self.hue * (root * root), cos, self.ior);
        let other = glass + (tinted - glass) * self.spec_tint;
        let metal = schlick(self.base, cos, self.ior);
        other * (1.0 - self.metallic) + metal * self.metallic
    }

    /// Probability that a small mirror reflects, and that it refracts; arguments as for
    /// [`Point::reflectance`].
    #[inline]
    fn mirror_choice(&self, cos: f32, fresnel: f32) -> (f32, f32) {
        let reflected = self.reflectance(cos, fresnel).luminance();
        let passed = self.glass * (1.0 - fresnel);
        let sum = reflected + passed;
        if sum > 0.0 {
            (reflected / sum, passed / sum)
        } else {
            (0.0, 0.0)
        }
    }

    fn choice(&self, wi: Local) -> Choice {
        if !self.is_front {
            return Choice {
                matt: 0.0,
                clearcoat: 0.0,
                mirrors: 1.0,
            };
        }
        let matt = self.matt.importance();
        let clearcoat = 0.1 * self.clearcoat.strength;
        // Mirrors that lean away from the light reflect more than the surface as a whole.
        let fresnel = self.ior.refract(wi.cos()).reflectance;
        let mirrors = 0.1 + self.reflectance(wi.cos(), fresnel).luminance() + self.glass;
        let sum = matt + clearcoat + mirrors;
        Choice {
            matt: matt / sum,
            clearcoat: clearcoat / sum,
            mirrors: mirrors / sum,
        }
    }

    /// Value times `|cos θ_o|` and density of reflection, for two directions on the near side.
    fn reflect(&self, wi: Local, wo: Local) -> (Rgb, f32) {
        let (m, cos) = halfway(wi, wo);
        let choice = self.choice(wi);
        let mirrors = self.facets.reflected_density(wi, m);
        let fresnel = self.ior.refract(cos).reflectance;
        let mut value = self.reflectance(cos, fresnel) * (mirrors * self.facets.masking(wo));
        let mut density = choice.mirrors * mirrors * self.mirror_choice(cos, fresnel).0;
        if self.is_front {
            value += self.matt.value(wi.cos(), wo.cos(), cos);
            density += choice.matt * matt_density(wo.cos());
        }
        if self.is_front && self.clearcoat.strength > 0.0 {
            value += Rgb::grey(self.clearcoat.value(wi, wo, m, cos));
            density += choice.clearcoat * self.clearcoat.density(m, cos);
        }
        (value, density)
    }

    /// Importance times `|cos θ_o|` and density of refraction; `wo` is on the far side.
    fn refract(&self, wi: Local, wo: Local) -> (Rgb, f32) {
        let normal = refracting_normal(wi, wo, self.ior).filter(|_| self.glass > 0.0);
        let Some((m, length_squared)) = normal else {
            return (Rgb::BLACK, 0.0);
        };
        let (cos_i, cos_o) = (wi.0.dot(m.0).min(1.0), -wo.0.dot(m.0));
        let jacobian = self.ior.ratio() * self.ior.ratio() * cos_o / length_squared;
        let visible = self.facets.visible_density(wi, m) * jacobian;
        let transmittance = self.ior.transmittance(cos_i, cos_o);
        let value = visible * self.glass * transmittance * self.facets.masking(wo.flipped());
        let (_, passes) = self.mirror_choice(cos_i, 1.0 - transmittance);
        let density = self.choice(wi).mirrors * passes * visible;
        (self.base.map(f32::sqrt) * value, density)
    }

    /// Samples a direction, on the near side unless it is refracted, and says how.
    ///
    /// - `wi`: on the near side, above.
    fn sample(&self, wi: Local, u_lobe: f32, u: Vec2) -> Option<(Local, Lobe)> {
        let choice = self.choice(wi);
        let within = |below: f32, size: f32| ((u_lobe - below) / size).min(ONE_MINUS_EPSILON);
        if u_lobe < choice.matt {
            return Some((sample_matt(within(0.0, choice.matt), u), Lobe::Diffuse));
        }
        if u_lobe < choice.matt + choice.clearcoat {
            return Some((self.clearcoat.sample(wi, u)?, Lobe::Glossy));
        }
        let m = self.facets.sample_visible(wi, u);
        let cos = wi.0.dot(m.0).min(1.0);
        if cos <= 0.0 {
            return None;
        }
        let refraction = self.ior.refract(cos);
        let (reflected, passed) = self.mirror_choice(cos, refraction.reflectance);
        let u_mirror = within(choice.matt + choice.clearcoat, choice.mirrors);
        if u_mirror < reflected {
            let wo = mirrored_at(wi, m);
            return (wo.cos() > 0.0).then_some((wo, Lobe::Glossy));
        }
        let wo = self.ior.bend(wi, m, cos, refraction.cos_refracted);
        (passed > 0.0 && wo.cos() < 0.0).then_some((wo, Lobe::Glossy))
    }
}

impl Point {
    /// The numbers of [`Point::sample`].
    fn invert(&self, wi: Local, wo: Local, spare: Spare) -> Option<SampleNumbers> {
        let choice = self.choice(wi);
        let reflects = wo.cos() > 0.0;
        let m = if reflects {
            halfway(wi, wo).0
        } else {
            refracting_normal(wi, wo, self.ior)?.0
        };
        let cos = wi.0.dot(m.0).min(1.0);
        let (reflected, passed) = self.mirror_choice(cos, self.ior.refract(cos).reflectance);
        let clearcoat = if reflects && choice.clearcoat > 0.0 {
            choice.clearcoat * self.clearcoat.density(m, cos)
        } else {
            0.0
        };
        let densities = if reflects {
            let mirrors = choice.mirrors * reflected * self.facets.reflected_density(wi, m);
            [choice.matt * matt_density(wo.cos()), clearcoat, mirrors]
        } else {
            [0.0, 0.0, passed]
        };
        let (lobe, spare) = spare.choose(densities)?;
        Some(match lobe {
            0 => invert_matt(wo, spare)?.within(0.0, choice.matt),
            1 => {
                let numbers = spare.numbers.with_direction(self.clearcoat.invert(m));
                numbers.within(choice.matt, choice.clearcoat)
            }
            _ => {
                let u = self.facets.invert_visible(wi, m);
                let (low, size) = if reflects {
                    (0.0, reflected)
                } else {
                    (reflected, passed)
                };
                let numbers = spare.numbers.with_direction(u).within(low, size);
                numbers.within(choice.matt + choice.clearcoat, choice.mirrors)
            }
        })
    }
}

impl BsdfModel for Principled {
    fn examples() -> Vec<Self> {
        let orange = Rgb::new(0.6, 0.4, 0.1);
        let plain = |ior| PrincipledParameters::new(orange, ior);
        let make = |ior| {
            let cloth = PrincipledParameters {
                roughness: 0.8.into(),
                sheen: 0.2.into(),
                sheen_tint: 0.5.into(),
                flatness: 0.6.into(),
                ..plain(ior)
            };
            let paint = PrincipledParameters {
                roughness: 0.3.into(),
                anisotropic: 0.7.into(),
                metallic: 0.6.into(),
                spec_tint: 0.4.into(),
                clearcoat: 0.8.into(),
                clearcoat_gloss: 0.3.into(),
                ..plain(ior)
            };
            let glass = PrincipledParameters {
                roughness: 0.4.into(),
                spec_trans: 0.7.into(),
                metallic: 0.2.into(),
                ..plain(ior)
            };
            [plain(ior), cloth, paint, glass]
        };
        let ior = RelativeIor::new(1.5, 1.0).into_iter();
        ior.flat_map(make)
            .filter_map(|all| Self::new(all).ok())
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: true,
            dirac: false,
            transmission: self.transmits,
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
        if wi.cos() == 0.0 || wi.cos() < 0.0 && !self.transmits {
            return None;
        }
        let point = self.at(wi, at);
        let (wo, lobe) = point.sample(from_above(wi, wi).0, u_lobe, u)?;
        let eta = if wo.cos() > 0.0 {
            1.0
        } else {
            point.ior.inverse()
        };
        let wo = if wi.cos() > 0.0 { wo } else { wo.flipped() };
        let (value, density) = self.eval_with_density(wi, wo, at, transport);
        BsdfSample::finite(wo, value, density, lobe).map(|sample| BsdfSample { eta, ..sample })
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
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        if wi.cos() == 0.0 || wo.cos() == 0.0 || !self.transmits && wi.cos().min(wo.cos()) < 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let point = self.at(wi, at);
        let (wi, wo) = from_above(wi, wo);
        let (value, density) = if wo.cos() > 0.0 {
            point.reflect(wi, wo)
        } else {
            let (value, density) = point.refract(wi, wo);
            let inverse = point.ior.inverse();
            match transport {
                Transport::Radiance => (value * (inverse * inverse), density),
                Transport::Importance => (value, density),
            }
        };
        (value, SolidAngleDensity(density))
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
        if wi.cos() == 0.0 || wo.cos() == 0.0 || !self.transmits && wi.cos().min(wo.cos()) < 0.0 {
            return None;
        }
        let point = self.at(wi, at);
        let (wi, wo) = from_above(wi, wo);
        point.invert(wi, wo, spare)
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.parameters.base_color.colour(at.uv)
    }
}
