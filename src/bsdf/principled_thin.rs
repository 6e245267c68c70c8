//! Disney's material for thin things: leaves, paper, panes, cloth.

use super::disney::{Matt, alpha, hue, schlick};
use super::fresnel::RelativeIor;
use super::matt::{invert_matt, matt_density, sample_matt};
use super::microfacet::{MicrofacetKind, Microfacets, halfway, mirrored_at};
use super::principled_parameters::PrincipledThinParameters;
use super::{BsdfModel, BsdfSample, Lobe, LobeSet, SampleNumbers, Sampled, Spare, Transport};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, warp};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A sheet without thickness, the same from both sides: partly matt, partly rough glass that does
/// not bend light.
///
/// Differs: Mitsuba 3.9.1 shows no rough glass for some pairs of slanted directions, and not for the
/// same ones with light going the other way; here there are no such pairs.
///
/// Source: Burley 2015 for the model. What it leaves open is as in Mitsuba 3.9.1: the sheet reflects
/// as one boundary.
#[derive(Clone, Debug)]
pub struct PrincipledThin {
    parameters: Box<PrincipledThinParameters>,
}

/// The sheet at one point.
struct Point {
    base: Rgb,
    hue: Rgb,
    /// The small mirrors that reflect, and those that scatter what goes through.
    reflecting: Microfacets,
    passing: Microfacets,
    glass: f32,
    spec_tint: f32,
    matt: Matt,
    /// Colour of what goes through diffusely.
    behind: Rgb,
    ior: RelativeIor,
}

/// Probabilities of the lobes.
#[derive(Clone, Copy)]
struct Choice {
    matt: f32,
    behind: f32,
    reflecting: f32,
    passing: f32,
}

impl PrincipledThin {
    /// Makes the material.
    pub fn new(parameters: PrincipledThinParameters) -> Self {
        Self {
            parameters: Box::new(parameters),
        }
    }

    fn at(&self, at: &SurfacePoint) -> Point {
        let parameters = &*self.parameters;
        let value = |texture: &Texture| texture.value(at.uv).clamp(0.0, 1.0);
        let base = parameters.base_color.colour(at.uv).clamp(0.0, 1.0);
        let hue = hue(base);
        let roughness = value(&parameters.roughness);
        let anisotropic = value(&parameters.anisotropic);
        let glass = value(&parameters.spec_trans);
        let behind = 0.5 * parameters.diff_trans.value(at.uv).clamp(0.0, 2.0);
        let sheen_hue = Rgb::WHITE + (hue - Rgb::WHITE) * value(&parameters.sheen_tint);
        let sheen = value(&parameters.sheen) * (1.0 - glass) * (1.0 - behind);
        // A thin sheet scatters less than a body of the same substance.
        let passing = roughness * (0.65 * parameters.ior.ratio() - 0.35);
        let facets =
            |roughness| Microfacets::new(MicrofacetKind::Ggx, alpha(roughness, anisotropic));
        Point {
            base,
            hue,
            reflecting: facets(roughness),
            passing: facets(passing),
            glass,
            spec_tint: value(&parameters.spec_tint),
            matt: Matt {
                diffuse: base * ((1.0 - glass) * (1.0 - behind)),
                sheen: sheen_hue * sheen,
                roughness,
                flatness: value(&parameters.flatness),
            },
            behind: base * ((1.0 - glass) * behind),
            ior: parameters.ior,
        }
    }
}

impl Point {
    /// Share of light that the glass reflects.
    #[inline]
    fn reflectance(&self, cos: f32) -> Rgb {
        let plain = Rgb::grey(self.ior.refract(cos).reflectance);
        let root = (self.ior.ratio() - 1.0) / (self.ior.ratio() + 1.0);
        let tinted = schlick(self.hue * (root * root), cos, self.ior);
        (plain + (tinted - plain) * self.spec_tint) * self.glass
    }

    /// Share of light that the glass lets through.
    #[inline]
    fn transmittance(&self, cos: f32) -> Rgb {
        self.base * (self.glass * (1.0 - self.ior.refract(cos).reflectance))
    }

    fn choice(&self, wi: Local) -> Choice {
        let matt = self.matt.importance();
        let behind = self.behind.luminance();
        // Mirrors that lean away from the light reflect more than the sheet as a whole.
        let reflecting = self.reflectance(wi.cos()).luminance() + 0.1 * self.glass;
        let passing = self.transmittance(wi.cos()).luminance() + 0.1 * self.glass;
        let sum = matt + behind + reflecting + passing;
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Choice {
            matt: matt * scale,
            behind: behind * scale,
            reflecting: reflecting * scale,
            passing: passing * scale,
        }
    }

    /// Value times `|cos θ_o|` and density.
    ///
    /// - `wi`: above; `wo`: the direction, turned up where it goes through.
    fn eval(&self, wi: Local, wo: Local, goes_through: bool) -> (Rgb, f32) {
        let (m, cos) = halfway(wi, wo);
        let choice = self.choice(wi);
        let (facets, share, probability) = if goes_through {
            (&self.passing, self.transmittance(cos), choice.passing)
        } else {
            (&self.reflecting, self.reflectance(cos), choice.reflecting)
        };
        let mirrors = facets.reflected_density(wi, m);
        let glass = share * (mirrors * facets.masking(wo));
        let by_cosine = warp::cosine_hemisphere_density(wo.cos());
        let (matt, matt_density) = if goes_through {
            (self.behind * by_cosine, choice.behind * by_cosine)
        } else {
            let value = self.matt.value(wi.cos(), wo.cos(), cos);
            (value, choice.matt * matt_density(wo.cos()))
        };
        (glass + matt, probability * mirrors + matt_density)
    }

    /// Samples a direction above, and says how and whether it goes through.
    fn sample(&self, wi: Local, u_lobe: f32, u: Vec2) -> Option<(Local, Lobe, bool)> {
        let choice = self.choice(wi);
        let mut rest = u_lobe;
        if rest < choice.matt {
            let u_matt = (rest / choice.matt).min(ONE_MINUS_EPSILON);
            return Some((sample_matt(u_matt, u), Lobe::Diffuse, false));
        }
        rest -= choice.matt;
        if rest < choice.behind {
            return Some((Local(warp::cosine_hemisphere(u)), Lobe::Diffuse, true));
        }
        rest -= choice.behind;
        let goes_through = rest >= choice.reflecting;
        let facets = if goes_through {
            &self.passing
        } else {
            &self.reflecting
        };
        let wo = mirrored_at(wi, facets.sample_visible(wi, u));
        (wo.cos() > 0.0 && self.glass > 0.0).then_some((wo, Lobe::Glossy, goes_through))
    }
}

impl Point {
    /// The numbers of [`Point::sample`]; directions as for [`Point::eval`].
    fn invert(
        &self,
        wi: Local,
        wo: Local,
        goes_through: bool,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let choice = self.choice(wi);
        let m = halfway(wi, wo).0;
        let glass = |facets: &Microfacets, choice: f32| choice * facets.reflected_density(wi, m);
        let densities = if goes_through {
            let by_cosine = warp::cosine_hemisphere_density(wo.cos());
            let passing = glass(&self.passing, choice.passing);
            [0.0, choice.behind * by_cosine, 0.0, passing]
        } else {
            let reflecting = glass(&self.reflecting, choice.reflecting);
            [choice.matt * matt_density(wo.cos()), 0.0, reflecting, 0.0]
        };
        let (lobe, spare) = spare.choose(densities)?;
        let sizes = [
            choice.matt,
            choice.behind,
            choice.reflecting,
            choice.passing,
        ];
        let low: f32 = sizes[..lobe].iter().sum();
        let numbers = spare.numbers;
        let numbers = match lobe {
            0 => invert_matt(wo, spare)?,
            1 => numbers.with_direction(warp::cosine_hemisphere_inverse(wo.0)),
            2 => numbers.with_direction(self.reflecting.invert_visible(wi, m)),
            _ => numbers.with_direction(self.passing.invert_visible(wi, m)),
        };
        Some(numbers.within(low, sizes[lobe]))
    }
}

/// The direction above the surface.
#[inline]
fn above(direction: Local) -> Local {
    if direction.cos() < 0.0 {
        direction.flipped()
    } else {
        direction
    }
}

impl BsdfModel for PrincipledThin {
    fn examples() -> Vec<Self> {
        let leaf = Rgb::new(0.3, 0.8, 0.1);
        let make = |ior| {
            let plain = || PrincipledThinParameters::new(leaf, ior);
            let paper = PrincipledThinParameters {
                sheen: 0.2.into(),
                sheen_tint: 0.5.into(),
                flatness: 0.4.into(),
                diff_trans: 0.8.into(),
                ..plain()
            };
            let pane = PrincipledThinParameters {
                roughness: 0.4.into(),
                anisotropic: 0.6.into(),
                spec_trans: 0.8.into(),
                spec_tint: 0.3.into(),
                diff_trans: 1.5.into(),
                ..plain()
            };
            let glass = PrincipledThinParameters {
                spec_trans: 1.0.into(),
                ..plain()
            };
            [plain(), paper, pane, glass].map(Self::new)
        };
        let ior = RelativeIor::new(1.5, 1.0).into_iter();
        ior.flat_map(make).collect()
    }

    fn lobes(&self) -> LobeSet {
        let parameters = &self.parameters;
        LobeSet {
            finite: true,
            dirac: false,
            transmission: !(parameters.spec_trans.is_zero() && parameters.diff_trans.is_zero()),
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
        let (wo, lobe, goes_through) = self.at(at).sample(above(wi), u_lobe, u)?;
        let wo = if goes_through == (wi.cos() > 0.0) {
            wo.flipped()
        } else {
            wo
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
        if wi.cos() == 0.0 || wo.cos() == 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let goes_through = !wi.same_side(wo);
        let (value, density) = self.at(at).eval(above(wi), above(wo), goes_through);
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
        if wi.cos() == 0.0 || wo.cos() == 0.0 {
            return None;
        }
        self.at(at)
            .invert(above(wi), above(wo), !wi.same_side(wo), spare)
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.parameters.base_color.colour(at.uv)
    }
}
