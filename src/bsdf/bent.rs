//! Materials whose normal leans while the surface stays where it is.

use super::tilt::{Leaning, Tilt, Way, eye};
use super::{
    Bsdf, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::SurfacePoint;

/// Where a normal leans to.
pub trait Lean: Sized {
    /// As [`BsdfModel::examples`].
    fn examples() -> Vec<Bent<Self>>;

    /// The leaning normal in the shading frame, unit.
    fn normal(&self, at: &SurfacePoint) -> Vec3;
}

/// A material with a leaning normal.
///
/// The material works in the frame of the leaning normal, its cosine included. A direction that lies
/// on different sides of the leaning and of the shading normal is black, known or sampled. Holes
/// have no normal: a [`Lobe::Null`] goes straight on whatever the normal does.
///
/// Where [`Leaning::turning`] is set, the direction to the eye alone says which way the normal leans. So
/// light does not go both ways between two directions, but radiance and importance stay adjoint.
///
/// With [`Transport::Importance`] values belong to the shading normal all the same, as the module's
/// contract has it: `docs/math.md`, "Bumps".
///
/// Components: those of the material; where normals turn, once more for those that have turned.
#[derive(Clone, Debug)]
pub struct Bent<L> {
    lean: L,
    leaning: Leaning,
    nested: Box<Bsdf>,
}

impl<L: Lean> Bent<L> {
    /// Makes the material.
    pub(super) fn new_leaning(lean: L, leaning: Leaning, nested: Bsdf) -> Self {
        Self {
            lean,
            leaning,
            nested: Box::new(nested),
        }
    }

    #[inline]
    fn tilt(&self, at: &SurfacePoint) -> Tilt {
        Tilt {
            normal: self.lean.normal(at),
            leaning: self.leaning,
        }
    }

    /// A component as the material numbers it, and the way that the normal leans for it.
    #[inline]
    fn component(&self, component: Component) -> Option<(Way, Component)> {
        let count = self.nested.component_count();
        if component.0 < count {
            return Some((Way::Given, component));
        }
        let turned = Component(component.0 - count);
        self.leaning.turning.then_some((Way::Turned, turned))
    }
}

impl<L: Lean> BsdfModel for Bent<L> {
    fn examples() -> Vec<Self> {
        L::examples()
    }

    fn lobes(&self) -> LobeSet {
        let nested = self.nested.lobes();
        LobeSet {
            single: nested.single && !self.leaning.turning,
            ..nested
        }
    }

    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let tilt = self.tilt(at);
        let turned = tilt.turned_share(wi, transport);
        let (way, share, u_lobe) = if u_lobe < turned {
            (Way::Turned, turned, u_lobe / turned)
        } else {
            let rest = 1.0 - turned;
            (Way::Given, rest, (u_lobe - turned) / rest)
        };
        let u_lobe = u_lobe.min(ONE_MINUS_EPSILON);
        let bump = tilt.bump(way);
        let wi = bump.bend(wi);
        let mut sample = self.nested.sample(wi.bent, at, transport, u_lobe, u)?;
        if sample.lobe == Lobe::Null {
            sample.direction = wi.plain.straight_on();
            return Some(sample);
        }
        let wo = bump.unbend(sample.direction);
        if tilt.way(eye(wi.plain, wo.plain, transport)) != way {
            return None;
        }
        let factor = bump.factor(wi, wo, transport);
        sample.direction = wo.plain;
        sample.value *= factor;
        sample.density *= share;
        sample.weight *= factor / share;
        if sample.lobe.is_dirac() && way == Way::Turned {
            sample.component.0 += self.nested.component_count();
        }
        (factor > 0.0).then_some(sample)
    }

    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        self.eval_with_density(wi, wo, at, transport).0
    }

    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        let tilt = self.tilt(at);
        let way = tilt.way(eye(wi, wo, transport));
        let share = tilt.share(way, wi, transport);
        let bump = tilt.bump(way);
        let (wi, wo) = (bump.bend(wi), bump.bend(wo));
        if wi.is_clear() && wo.is_clear() {
            let nested = self.nested.density(wi.bent, wo.bent, at, transport);
            SolidAngleDensity(nested.0 * share)
        } else {
            SolidAngleDensity::ZERO
        }
    }

    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        let tilt = self.tilt(at);
        let way = tilt.way(eye(wi, wo, transport));
        let share = tilt.share(way, wi, transport);
        let bump = tilt.bump(way);
        let (wi, wo) = (bump.bend(wi), bump.bend(wo));
        let factor = bump.factor(wi, wo, transport);
        if factor == 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let (value, density) = self
            .nested
            .eval_with_density(wi.bent, wo.bent, at, transport);
        (value * factor, SolidAngleDensity(density.0 * share))
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let (way, component) = self.component(component)?;
        let tilt = self.tilt(at);
        let share = tilt.share(way, wi, transport);
        let bump = tilt.bump(way);
        let wi = bump.bend(wi);
        let event = self.nested.follow(wi.bent, at, transport, component)?;
        if event.lobe == Lobe::Null {
            let direction = wi.plain.straight_on();
            return (way == Way::Given).then_some(DiracEvent { direction, ..event });
        }
        let wo = bump.unbend(event.direction);
        let factor = bump.factor(wi, wo, transport);
        let is_seen = tilt.way(eye(wi.plain, wo.plain, transport)) == way;
        (factor > 0.0 && is_seen).then(|| DiracEvent {
            direction: wo.plain,
            coefficient: event.coefficient * factor,
            probability: event.probability * share,
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        let ways = if self.leaning.turning { 2 } else { 1 };
        ways * self.nested.component_count()
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let tilt = self.tilt(at);
        let (way, nested) = match sampled {
            Sampled::Finite(wo) => (tilt.way(eye(wi, wo, transport)), sampled),
            Sampled::Dirac(component) => {
                let (way, component) = self.component(component)?;
                (way, Sampled::Dirac(component))
            }
        };
        let turned = tilt.turned_share(wi, transport);
        let bump = tilt.bump(way);
        let wi = bump.bend(wi);
        let nested = match nested {
            Sampled::Finite(wo) => {
                let wo = bump.bend(wo);
                if !(wi.is_clear() && wo.is_clear()) {
                    return None;
                }
                Sampled::Finite(wo.bent)
            }
            dirac => dirac,
        };
        let is_hole = |c| {
            let event = self.nested.follow(wi.bent, at, transport, c);
            event.is_some_and(|event| event.lobe == Lobe::Null)
        };
        let (way, spare) = match nested {
            // What goes straight on is made around either normal.
            Sampled::Dirac(component) if is_hole(component) => {
                let (number, spare) = spare.choose([1.0 - turned, turned])?;
                ([Way::Given, Way::Turned][number], spare)
            }
            _ => (way, spare),
        };
        let (low, share) = match way {
            Way::Given => (turned, 1.0 - turned),
            Way::Turned => (0.0, turned),
        };
        if share == 0.0 {
            return None;
        }
        let numbers = self.nested.invert(wi.bent, nested, at, transport, spare)?;
        Some(numbers.within(low, share))
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.nested.albedo(at)
    }
}
