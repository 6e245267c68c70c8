//! Smooth metal.

use super::fresnel::ComplexIor;
use super::{
    Bend, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A mirror of metal on the front side; black from behind.
#[derive(Clone, Debug)]
pub struct Conductor {
    ior: Option<ComplexIor>,
    specular_reflectance: Texture,
}

impl Conductor {
    /// Makes the material.
    ///
    /// - `ior`: index of the metal over that of the outside; `None` for a mirror that reflects all.
    /// - `specular_reflectance`: factor on the reflectance; 1 is physical.
    pub fn new(ior: Option<ComplexIor>, specular_reflectance: impl Into<Texture>) -> Self {
        Self {
            ior,
            specular_reflectance: specular_reflectance.into(),
        }
    }

    /// [`BsdfModel::follow`] by the signed cosine of `wi`; `None` from behind.
    #[inline]
    pub(super) fn bend(
        &self,
        cos: f32,
        at: &SurfacePoint,
        component: Component,
    ) -> Option<DiracEvent<Bend>> {
        (cos > 0.0 && component.0 == 0).then(|| DiracEvent {
            direction: Bend::mirrored(cos),
            coefficient: conductor_reflectance(self.ior.as_ref(), cos)
                * self.specular_reflectance.colour(at.uv),
            probability: 1.0,
            lobe: Lobe::Specular,
            eta: 1.0,
            cosine_ratio: 1.0,
        })
    }
}

/// Reflectance of a metal, or of a perfect mirror where there is no index.
#[inline]
pub(super) fn conductor_reflectance(ior: Option<&ComplexIor>, cos: f32) -> Rgb {
    ior.map_or(Rgb::WHITE, |ior| ior.reflectance(cos))
}

/// Gold against air: what the examples are made of.
pub(super) const EXAMPLE_METAL: ComplexIor = ComplexIor {
    eta: Rgb::new(0.143, 0.375, 1.442),
    k: Rgb::new(3.983, 2.386, 1.603),
};

impl BsdfModel for Conductor {
    fn examples() -> Vec<Self> {
        vec![
            Self::new(None, 1.0),
            Self::new(Some(EXAMPLE_METAL), Rgb::new(1.0, 0.8, 0.5)),
        ]
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            dirac: true,
            single: true,
            ..LobeSet::default()
        }
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        _transport: Transport,
        _u_lobe: f32,
        _u: Vec2,
    ) -> Option<BsdfSample> {
        let only = Component(0);
        self.bend(wi.cos(), at, only)?.of(wi).sampled(only)
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
        1
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
        self.follow(wi, at, transport, component)?;
        Some(spare.numbers)
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        conductor_reflectance(self.ior.as_ref(), 1.0) * self.specular_reflectance.colour(at.uv)
    }
}
