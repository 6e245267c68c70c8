//! Materials whose normal leans while the surface stays where it is.

use super::{
    Bsdf, BsdfModel, BsdfSample, Component, DiracEvent, Lobe, LobeSet, SampleNumbers, Sampled,
    Spare, Transport,
};
use crate::math::{Frame, Local, Rgb, SolidAngleDensity, Vec2, Vec3};
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
/// With [`Transport::Importance`] values belong to the shading normal all the same, as the module's
/// contract has it: `docs/math.md`, "Bumps".
///
/// Components: those of the material.
#[derive(Clone, Debug)]
pub struct Bent<L> {
    lean: L,
    shadowing: bool,
    nested: Box<Bsdf>,
}

/// The bump at one point.
struct Bump {
    /// The frame that the material works in, written in the shading frame.
    frame: Frame,
    /// Squared roughness of the surface of which this bump could be a facet.
    alpha_squared: f32,
}

/// A direction in the shading frame and in that of a bump.
#[derive(Clone, Copy)]
struct Direction {
    plain: Local,
    bent: Local,
}

impl Direction {
    /// Whether both normals see it from one side.
    #[inline]
    fn is_clear(self) -> bool {
        self.plain.same_side(self.bent)
    }
}

impl<L: Lean> Bent<L> {
    /// Makes the material.
    ///
    /// - `shadowing`: darken slanted light as facets of the normal's slope would shadow it, so that
    ///   there is no hard edge where the normal turns away from light.
    pub(super) fn leaning(lean: L, shadowing: bool, nested: Bsdf) -> Self {
        Self {
            lean,
            shadowing,
            nested: Box::new(nested),
        }
    }

    /// The frame of the leaning normal: its tangent is as near to the surface's as it can be.
    #[inline]
    fn bump(&self, at: &SurfacePoint) -> Bump {
        let normal = self.lean.normal(at);
        let alpha_squared = if self.shadowing {
            let slope_squared = (1.0 / (normal.z * normal.z) - 1.0).max(0.0);
            (0.125 * slope_squared).min(1.0)
        } else {
            0.0
        };
        Bump {
            frame: Frame::with_tangent(normal, Vec3::X),
            alpha_squared,
        }
    }
}

impl Bump {
    #[inline]
    fn bend(&self, plain: Local) -> Direction {
        Direction {
            plain,
            bent: self.frame.to_local(plain.0),
        }
    }

    #[inline]
    fn unbend(&self, bent: Local) -> Direction {
        Direction {
            plain: Local(self.frame.to_world(bent)),
            bent,
        }
    }

    /// Share of the light from a direction that other facets let through.
    ///
    /// Source: Conty Estevez, Lecocq & Stein 2019.
    #[inline]
    fn unshadowed(&self, light: Local) -> f32 {
        if self.alpha_squared == 0.0 {
            return 1.0;
        }
        let cos = light.abs_cos();
        2.0 * cos / (cos + (cos * cos + self.alpha_squared * light.sin_squared()).sqrt())
    }

    /// What the material's values are multiplied by; zero where a direction is black.
    #[inline]
    fn factor(&self, wi: Direction, wo: Direction, transport: Transport) -> f32 {
        if !(wi.is_clear() && wo.is_clear()) {
            return 0.0;
        }
        match transport {
            Transport::Radiance => self.unshadowed(wo.plain),
            Transport::Importance => {
                let plain = wo.plain.abs_cos() / wi.plain.abs_cos();
                let bent = wi.bent.abs_cos() / wo.bent.abs_cos();
                self.unshadowed(wi.plain) * plain * bent
            }
        }
    }
}

impl<L: Lean> BsdfModel for Bent<L> {
    fn examples() -> Vec<Self> {
        L::examples()
    }

    fn lobes(&self) -> LobeSet {
        self.nested.lobes()
    }

    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let bump = self.bump(at);
        let wi = bump.bend(wi);
        let mut sample = self.nested.sample(wi.bent, at, transport, u_lobe, u)?;
        if sample.lobe == Lobe::Null {
            sample.direction = wi.plain.straight_on();
            return Some(sample);
        }
        let wo = bump.unbend(sample.direction);
        let factor = bump.factor(wi, wo, transport);
        sample.direction = wo.plain;
        sample.value *= factor;
        sample.weight *= factor;
        (factor > 0.0).then_some(sample)
    }

    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        self.eval_with_density(wi, wo, at, transport).0
    }

    fn density(&self, wi: Local, wo: Local, at: &SurfacePoint) -> SolidAngleDensity {
        let bump = self.bump(at);
        let (wi, wo) = (bump.bend(wi), bump.bend(wo));
        if wi.is_clear() && wo.is_clear() {
            self.nested.density(wi.bent, wo.bent, at)
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
        let bump = self.bump(at);
        let (wi, wo) = (bump.bend(wi), bump.bend(wo));
        let factor = bump.factor(wi, wo, transport);
        if factor == 0.0 {
            return (Rgb::BLACK, SolidAngleDensity::ZERO);
        }
        let nested = self
            .nested
            .eval_with_density(wi.bent, wo.bent, at, transport);
        (nested.0 * factor, nested.1)
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let bump = self.bump(at);
        let wi = bump.bend(wi);
        let event = self.nested.follow(wi.bent, at, transport, component)?;
        if event.lobe == Lobe::Null {
            let direction = wi.plain.straight_on();
            return Some(DiracEvent { direction, ..event });
        }
        let wo = bump.unbend(event.direction);
        let factor = bump.factor(wi, wo, transport);
        (factor > 0.0).then(|| DiracEvent {
            direction: wo.plain,
            coefficient: event.coefficient * factor,
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        self.nested.component_count()
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let bump = self.bump(at);
        let wi = bump.bend(wi);
        let sampled = match sampled {
            Sampled::Finite(wo) => {
                let wo = bump.bend(wo);
                if !(wi.is_clear() && wo.is_clear()) {
                    return None;
                }
                Sampled::Finite(wo.bent)
            }
            dirac => dirac,
        };
        self.nested.invert(wi.bent, sampled, at, spare)
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.nested.albedo(at)
    }
}
