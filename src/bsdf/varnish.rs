//! What smooth and rough coatings share: a layer of varnish over any material that reflects.

use super::fresnel::RelativeIor;
use super::{
    Bsdf, BsdfError, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A layer that bends light on its way to a material and back, and absorbs some of it.
///
/// Light that the material sends out too flat to leave the layer is lost, as is what the layer's
/// boundary reflects of it. What the boundary lets through is not part of this; coatings multiply
/// by it.
///
/// Source: Weidlich & Wilkie 2007.
#[derive(Clone, Debug)]
pub(super) struct Varnish {
    pub(super) ior: RelativeIor,
    /// Absorption in 1/m, and how thick the layer is in m.
    absorption: Texture,
    thickness: f32,
    pub(super) nested: Box<Bsdf>,
    /// Mean share of light that the layer lets through along its normal, down and up.
    clearness: f32,
}

/// A direction outside of the varnish and the one that it is bent into.
#[derive(Clone, Copy)]
struct Bending {
    outside: Local,
    inside: Local,
}

impl Bending {
    /// Solid angle inside for each solid angle outside.
    ///
    /// Refraction keeps `n² |cos θ| dω`.
    #[inline]
    fn stretch(self, ior: RelativeIor) -> f32 {
        self.outside.cos() / self.inside.cos() * (ior.inverse() * ior.inverse())
    }
}

impl Varnish {
    /// Makes the layer; see [`super::Coating::new`].
    pub(super) fn new(
        ior: RelativeIor,
        thickness: f32,
        absorption: Texture,
        nested: Bsdf,
    ) -> Result<Self, BsdfError> {
        if nested.lobes().transmission {
            return Err(BsdfError::NestedTransmission("a coating"));
        }
        let mean = absorption.mean() * (-2.0 * thickness);
        Ok(Self {
            ior,
            clearness: mean.map(f32::exp).mean(),
            absorption,
            thickness,
            nested: Box::new(nested),
        })
    }

    /// Probability of sampling the coat's reflection, where it reflects the share `reflectance` and
    /// is tinted by `tint`.
    #[inline]
    pub(super) fn coat_choice(&self, reflectance: f32, tint: f32) -> f32 {
        let coat = reflectance * tint;
        let below = (1.0 - reflectance) * self.clearness;
        let sum = coat + below;
        if sum > 0.0 { coat / sum } else { 0.0 }
    }

    /// The layer's way for a direction above the surface; `None` where none leads inside.
    #[inline]
    fn bend_in(&self, outside: Local) -> Option<Bending> {
        let cos = self.ior.refract(outside.cos()).cos_refracted;
        let scale = self.ior.inverse();
        let inside = Local::new(outside.0.x * scale, outside.0.y * scale, cos);
        (cos > 0.0).then_some(Bending { outside, inside })
    }

    /// The way out for a direction from the material; `None` under total internal reflection.
    #[inline]
    fn bend_out(&self, inside: Local) -> Option<Bending> {
        let leaving = self.ior.seen_from(-1.0);
        let cos = leaving.refract(inside.cos()).cos_refracted;
        let scale = self.ior.ratio();
        let outside = Local::new(inside.0.x * scale, inside.0.y * scale, cos);
        let outside = Local(outside.0.normalize());
        (cos > 0.0).then_some(Bending { outside, inside })
    }

    /// Share of light that is not absorbed on the way down and up.
    ///
    /// Source: Weidlich & Wilkie 2007 (Beer's law along both ways).
    #[inline]
    fn passed(&self, wi: Bending, wo: Bending, at: &SurfacePoint) -> Rgb {
        let way = self.thickness * (1.0 / wi.inside.cos() + 1.0 / wo.inside.cos());
        (self.absorption.colour(at.uv) * -way).map(f32::exp)
    }

    /// Value of the material below the layer times `|cos θ_o|`, and its density.
    ///
    /// - `wi`, `wo`: above the surface.
    #[inline]
    pub(super) fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        let (Some(wi), Some(wo)) = (self.bend_in(wi), self.bend_in(wo)) else {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        };
        let (value, density) = self
            .nested
            .eval_with_density(wi.inside, wo.inside, at, transport);
        let stretch = wo.stretch(self.ior);
        (
            value * self.passed(wi, wo, at) * stretch,
            SolidAngleDensity(density.0 * stretch),
        )
    }

    /// What the material below makes of `wi`: the direction outside, with the kind of its lobe, and
    /// of Diracs the number.
    #[inline]
    pub(super) fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<(Local, Lobe, Component)> {
        let inside = self.bend_in(wi)?.inside;
        let BsdfSample {
            direction,
            lobe,
            component,
            ..
        } = self.nested.sample(inside, at, transport, u_lobe, u)?;
        let wo = self.bend_out(direction)?.outside;
        Some((wo, lobe, component))
    }

    /// The numbers of [`Varnish::sample`].
    pub(super) fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let sampled = match sampled {
            Sampled::Finite(wo) if wo.cos() > 0.0 => Sampled::Finite(self.bend_in(wo)?.inside),
            Sampled::Finite(_) => return None,
            dirac => dirac,
        };
        let inside = self.bend_in(wi)?.inside;
        self.nested.invert(inside, sampled, at, transport, spare)
    }

    /// One of the material's Dirac components, seen from outside.
    pub(super) fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let wi = self.bend_in(wi)?;
        let event = self.nested.follow(wi.inside, at, transport, component)?;
        let wo = self.bend_out(event.direction)?;
        let bending = wo.stretch(self.ior) / wi.stretch(self.ior);
        Some(DiracEvent {
            direction: wo.outside,
            coefficient: event.coefficient * self.passed(wi, wo, at),
            cosine_ratio: event.cosine_ratio * bending,
            ..event
        })
    }

    /// What the material reflects of light that enters along the normal.
    pub(super) fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let down_and_up = self.absorption.colour(at.uv) * (-2.0 * self.thickness);
        self.nested.albedo(at) * down_and_up.map(f32::exp)
    }
}
