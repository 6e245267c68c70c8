//! Smooth glass, water, and the like.

use super::fresnel::{Refraction, RelativeIor};
use super::{
    Bend, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// The component that reflects.
const REFLECTION: Component = Component(0);
/// The component that refracts.
const TRANSMISSION: Component = Component(1);

/// A smooth boundary between two transparent substances.
///
/// Components: 0 reflects, 1 refracts. Each is selected with its Fresnel share, so that untinted
/// glass has samples of weight one, apart from the change of radiance with the index.
#[derive(Clone, Debug)]
pub struct Dielectric {
    ior: RelativeIor,
    specular_reflectance: Texture,
    specular_transmittance: Texture,
}

impl Dielectric {
    /// Makes the material.
    ///
    /// - `ior`: inside over outside; the normal points outside.
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

    /// One component's event for a signed cosine of `wi`, after Fresnel's equations.
    ///
    /// Radiance is concentrated by refraction into the denser side: it grows with the square of the
    /// index, so what comes from `wo`'s side is multiplied by `(η_i / η_o)²`. Importance is not.
    ///
    /// Source: Veach 1997, Ch. 5.
    #[inline]
    fn event(
        &self,
        cos: f32,
        (ior, refraction): (RelativeIor, Refraction),
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent<Bend>> {
        let (probability, eta, direction, tint) = match component {
            REFLECTION => {
                let tint = self.specular_reflectance.colour(at.uv);
                (refraction.reflectance, 1.0, Bend::mirrored(cos), tint)
            }
            TRANSMISSION => {
                let eta = ior.inverse();
                let direction = Bend::refracted(eta, refraction.cos_refracted.copysign(-cos));
                let tint = self.specular_transmittance.colour(at.uv);
                (1.0 - refraction.reflectance, eta, direction, tint)
            }
            _ => return None,
        };
        let scale = match transport {
            Transport::Radiance => eta * eta,
            Transport::Importance => 1.0,
        };
        (probability > 0.0).then(|| DiracEvent {
            direction,
            coefficient: tint * (probability * scale),
            probability,
            lobe: Lobe::Specular,
            eta,
            cosine_ratio: direction.cos().abs() / cos.abs(),
        })
    }

    /// The index and Fresnel's answer as seen from the side of `wi`, by its signed cosine; `None` in the
    /// plane of the surface.
    #[inline]
    fn refract(&self, cos: f32) -> Option<(RelativeIor, Refraction)> {
        let ior = self.ior.seen_from(cos);
        (cos != 0.0).then(|| (ior, ior.refract(cos.abs())))
    }

    /// [`BsdfModel::follow`] by the signed cosine of `wi`.
    #[inline]
    pub(super) fn bend(
        &self,
        cos: f32,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent<Bend>> {
        self.event(cos, self.refract(cos)?, at, transport, component)
    }

    /// [`BsdfModel::sample`] by the signed cosine of `wi`.
    #[inline]
    pub(super) fn choose(
        &self,
        cos: f32,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
    ) -> Option<(DiracEvent<Bend>, Component)> {
        let optics = self.refract(cos)?;
        let component = if u_lobe < optics.1.reflectance {
            REFLECTION
        } else {
            TRANSMISSION
        };
        let event = self.event(cos, optics, at, transport, component)?;
        Some((event, component))
    }
}

impl BsdfModel for Dielectric {
    fn examples() -> Vec<Self> {
        [(1.5, 1.0), (1.0, 1.33), (1.0, 1.0)]
            .into_iter()
            .filter_map(|(interior, exterior)| RelativeIor::new(interior, exterior).ok())
            .map(|ior| Self::new(ior, 1.0, Rgb::new(1.0, 0.9, 0.3)))
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
        transport: Transport,
        u_lobe: f32,
        _u: Vec2,
    ) -> Option<BsdfSample> {
        let (event, component) = self.choose(wi.cos(), at, transport, u_lobe)?;
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
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let event = self.bend(wi.cos(), at, transport, component)?;
        Some(event.of(wi))
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
        let reflectance = self.ior.refract(1.0).reflectance;
        self.specular_reflectance.colour(at.uv) * reflectance
            + self.specular_transmittance.colour(at.uv) * (1.0 - reflectance)
    }
}
