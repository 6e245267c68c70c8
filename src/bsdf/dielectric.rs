//! Smooth glass, water, and the like.

use super::fresnel::{Refraction, RelativeIor};
use super::{
    BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled, Spare,
    Transport,
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

    /// One component's event, after Fresnel's equations.
    ///
    /// Radiance is concentrated by refraction into the denser side: it grows with the square of the
    /// index, so what comes from `wo`'s side is multiplied by `(η_i / η_o)²`. Importance is not.
    ///
    /// Source: Veach 1997, Ch. 5.
    #[inline]
    fn event(
        &self,
        wi: Local,
        ior: RelativeIor,
        refraction: Refraction,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let (probability, eta, direction, tint) = match component {
            REFLECTION => {
                let tint = self.specular_reflectance.colour(at.uv);
                (refraction.reflectance, 1.0, wi.mirrored(), tint)
            }
            TRANSMISSION => {
                let cos = refraction.cos_refracted.copysign(-wi.cos());
                let eta = ior.inverse();
                let direction = Local::new(-wi.0.x * eta, -wi.0.y * eta, cos);
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
            cosine_ratio: direction.abs_cos() / wi.abs_cos(),
        })
    }

    /// The index and Fresnel's answer as seen from `wi`; `None` in the plane of the surface.
    #[inline]
    fn refract(&self, wi: Local) -> Option<(RelativeIor, Refraction)> {
        let ior = self.ior.seen_from(wi.cos());
        (wi.cos() != 0.0).then(|| (ior, ior.refract(wi.abs_cos())))
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
        let (ior, refraction) = self.refract(wi)?;
        let component = if u_lobe < refraction.reflectance {
            REFLECTION
        } else {
            TRANSMISSION
        };
        self.event(wi, ior, refraction, at, transport, component)?
            .sampled(component)
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
        let (ior, refraction) = self.refract(wi)?;
        self.event(wi, ior, refraction, at, transport, component)
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
