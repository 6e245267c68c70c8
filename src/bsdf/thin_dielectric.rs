//! A pane: two parallel boundaries as one surface.

use super::fresnel::RelativeIor;
use super::{
    Bend, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// The component that reflects.
const REFLECTION: Component = Component(0);
/// The component that goes through.
const TRANSMISSION: Component = Component(1);

/// A pane of glass without thickness, with all reflections inside of it.
///
/// Components: 0 reflects, 1 goes straight through. The second is [`Lobe::Specular`], not
/// [`Lobe::Null`]: the pane is a surface that takes light away, and a path through it has a vertex
/// there. Differs: Mitsuba calls it null; the pictures are the same.
#[derive(Clone, Debug)]
pub struct ThinDielectric {
    ior: RelativeIor,
    specular_reflectance: Texture,
    specular_transmittance: Texture,
}

impl ThinDielectric {
    /// Makes the material.
    ///
    /// - `ior`: of the pane over that of what is on either side.
    /// - `specular_reflectance`, `specular_transmittance`: factors on what is reflected and what
    ///   goes through; 1 is physical.
    pub fn new(
        ior: RelativeIor,
        specular_reflectance: impl Into<Texture>,
        specular_transmittance: impl Into<Texture>,
    ) -> Self {
        Self {
            ior,
            specular_reflectance: specular_reflectance.into(),
            specular_transmittance: specular_transmittance.into(),
        }
    }

    /// Share of light that the pane reflects.
    ///
    /// With `R` at each boundary, `R + (1−R)²R + (1−R)²R³ + … = 2R / (1 + R)`.
    #[inline]
    fn reflectance(&self, cos: f32) -> f32 {
        let single = self.ior.refract(cos).reflectance;
        2.0 * single / (1.0 + single)
    }

    /// One component's event for a signed cosine of `wi`.
    #[inline]
    fn event(
        &self,
        cos: f32,
        reflectance: f32,
        at: &SurfacePoint,
        component: Component,
    ) -> Option<DiracEvent<Bend>> {
        let (probability, direction, tint) = match component {
            REFLECTION => (reflectance, Bend::mirrored(cos), &self.specular_reflectance),
            TRANSMISSION => (
                1.0 - reflectance,
                Bend::straight_on(cos),
                &self.specular_transmittance,
            ),
            _ => return None,
        };
        (probability > 0.0).then(|| DiracEvent {
            direction,
            coefficient: tint.colour(at.uv) * probability,
            probability,
            lobe: Lobe::Specular,
            eta: 1.0,
            cosine_ratio: 1.0,
        })
    }

    /// [`BsdfModel::follow`] by the signed cosine of `wi`.
    #[inline]
    pub(super) fn bend(
        &self,
        cos: f32,
        at: &SurfacePoint,
        component: Component,
    ) -> Option<DiracEvent<Bend>> {
        self.event(cos, self.reflectance(cos.abs()), at, component)
    }

    /// [`BsdfModel::sample`] by the signed cosine of `wi`.
    #[inline]
    pub(super) fn choose(
        &self,
        cos: f32,
        at: &SurfacePoint,
        u_lobe: f32,
    ) -> Option<(DiracEvent<Bend>, Component)> {
        let reflectance = self.reflectance(cos.abs());
        let component = if u_lobe < reflectance {
            REFLECTION
        } else {
            TRANSMISSION
        };
        let event = self.event(cos, reflectance, at, component)?;
        Some((event, component))
    }
}

impl BsdfModel for ThinDielectric {
    fn examples() -> Vec<Self> {
        RelativeIor::new(1.5, 1.0)
            .map(|ior| Self::new(ior, Rgb::new(0.9, 1.0, 1.0), 0.8))
            .into_iter()
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: false,
            dirac: true,
            transmission: true,
            single: false,
        }
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        _transport: Transport,
        u_lobe: f32,
        _u: Vec2,
    ) -> Option<BsdfSample> {
        let (event, component) = self.choose(wi.cos(), at, u_lobe)?;
        event.of(wi).sampled(component)
    }

    #[inline]
    fn eval(&self, _wi: Local, _wo: Local, _at: &SurfacePoint, _transport: Transport) -> Rgb {
        Rgb::BLACK
    }

    #[inline]
    fn density(
        &self,
        _wi: Local,
        _wo: Local,
        _at: &SurfacePoint,
        _transport: Transport,
    ) -> SolidAngleDensity {
        SolidAngleDensity::ZERO
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        _transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        Some(self.bend(wi.cos(), at, component)?.of(wi))
    }

    fn component_count(&self) -> u8 {
        2
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let Sampled::Dirac(component) = sampled else {
            return None;
        };
        let event = self.follow(wi, at, transport, component)?;
        let size = event.probability;
        let low = if component == REFLECTION {
            0.0
        } else {
            1.0 - size
        };
        Some(spare.numbers.within(low, size))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        let reflectance = self.reflectance(1.0);
        self.specular_reflectance.colour(at.uv) * reflectance
            + self.specular_transmittance.colour(at.uv) * (1.0 - reflectance)
    }
}
