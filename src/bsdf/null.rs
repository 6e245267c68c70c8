//! No surface at all.

use super::{
    Bend, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;

/// A boundary that light does not notice, such as the hull of a medium.
#[derive(Clone, Copy, Debug, Default)]
pub struct Null;

impl Null {
    /// The event of every direction, by its signed cosine: straight on, unchanged.
    #[inline]
    pub(super) fn bend(self, cos: f32, component: Component) -> Option<DiracEvent<Bend>> {
        (component.0 == 0).then(|| DiracEvent {
            direction: Bend::straight_on(cos),
            coefficient: Rgb::WHITE,
            probability: 1.0,
            lobe: Lobe::Null,
            eta: 1.0,
            cosine_ratio: 1.0,
        })
    }
}

impl BsdfModel for Null {
    fn examples() -> Vec<Self> {
        vec![Self]
    }

    fn lobes(&self) -> LobeSet {
        LobeSet {
            finite: false,
            dirac: true,
            transmission: true,
            single: true,
        }
    }

    #[inline(never)]
    fn sample(
        &self,
        wi: Local,
        _at: &SurfacePoint,
        _transport: Transport,
        _u_lobe: f32,
        _u: Vec2,
    ) -> Option<BsdfSample> {
        let only = Component(0);
        self.bend(wi.cos(), only)?.of(wi).sampled(only)
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
        _at: &SurfacePoint,
        _transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        Some(self.bend(wi.cos(), component)?.of(wi))
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

    fn albedo(&self, _at: &SurfacePoint) -> Rgb {
        Rgb::WHITE
    }
}
