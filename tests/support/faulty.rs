//! Materials with planted errors: they prove that the tests can fail.

use lumiflow::bsdf::{
    Bsdf, BsdfModel, BsdfSample, Component, DiracEvent, LobeSet, SampleNumbers, Sampled, Spare,
    Transport,
};
use lumiflow::math::{Local, Rgb, SolidAngleDensity, Vec2};
use lumiflow::shape::SurfacePoint;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// `density` is 5 % too large.
    Density,
    /// `eval` has the cosine of `wi`, not that of `wo`.
    Cosine,
    /// Samples weigh 2 % too much.
    Weight,
    /// Three times as much is scattered.
    Energy,
    /// Radiance is scattered as importance is: the change with the index is left out.
    EtaSquared,
    /// `follow` gives probabilities 10 % too small.
    Selection,
    /// `invert` mirrors the first of the direction's numbers.
    Inverse,
    /// `invert` squares the lobe's number.
    SpareLobe,
}

/// A material with one fault.
pub(crate) struct Faulty {
    pub(crate) bsdf: Bsdf,
    pub(crate) fault: Fault,
}

impl Faulty {
    fn is(&self, fault: Fault) -> bool {
        self.fault == fault
    }

    fn transport(&self, transport: Transport) -> Transport {
        if self.is(Fault::EtaSquared) {
            Transport::Importance
        } else {
            transport
        }
    }

    fn scale(&self) -> f32 {
        if self.is(Fault::Energy) { 3.0 } else { 1.0 }
    }
}

impl BsdfModel for Faulty {
    fn examples() -> Vec<Self> {
        Vec::new()
    }

    fn lobes(&self) -> LobeSet {
        self.bsdf.lobes()
    }

    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let transport = self.transport(transport);
        let mut sample = self.bsdf.sample(wi, at, transport, u_lobe, u)?;
        sample.value *= self.scale();
        sample.weight *= self.scale() * if self.is(Fault::Weight) { 1.02 } else { 1.0 };
        Some(sample)
    }

    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        let value = self.bsdf.eval(wi, wo, at, self.transport(transport)) * self.scale();
        if self.is(Fault::Cosine) {
            value * (wi.abs_cos() / wo.abs_cos())
        } else {
            value
        }
    }

    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        let scale = if self.is(Fault::Density) { 1.05 } else { 1.0 };
        SolidAngleDensity(self.bsdf.density(wi, wo, at, transport).0 * scale)
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let transport = self.transport(transport);
        let mut event = self.bsdf.follow(wi, at, transport, component)?;
        event.coefficient *= self.scale();
        event.probability *= if self.is(Fault::Selection) { 0.9 } else { 1.0 };
        Some(event)
    }

    fn component_count(&self) -> u8 {
        self.bsdf.component_count()
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let numbers = self
            .bsdf
            .invert(wi, sampled, at, self.transport(transport), spare)?;
        let mirrored = Vec2::new(1.0 - numbers.u.x, numbers.u.y).min(Vec2::splat(0.999_999));
        Some(match self.fault {
            Fault::Inverse => SampleNumbers {
                u: mirrored,
                ..numbers
            },
            // One lobe is taken for another now and then.
            Fault::SpareLobe => SampleNumbers {
                u_lobe: numbers.u_lobe * numbers.u_lobe,
                ..numbers
            },
            _ => numbers,
        })
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.bsdf.albedo(at)
    }
}
