//! One material for each side of a surface.

use super::{
    Bsdf, BsdfError, BsdfModel, BsdfSample, BumpMap, Component, Conductor, Diffuse, DiracEvent,
    LobeSet, Plastic, RoughConductor, SampleNumbers, Sampled, Spare, Transport,
};
use crate::math::{Local, Rgb, SolidAngleDensity, Vec2};
use crate::shape::SurfacePoint;

/// Two opaque materials back to back, or one that is the same from both sides.
///
/// Components: the front's, then the back's; with one material for both sides, its own.
#[derive(Clone, Debug)]
pub struct TwoSided {
    front: Box<Bsdf>,
    back: Option<Box<Bsdf>>,
}

impl TwoSided {
    /// Makes the material.
    ///
    /// - `front`: seen from the side that the normal points to.
    /// - `back`: seen from the other side, turned over; `None` for the same as the front.
    ///
    /// # Errors
    /// [`BsdfError::NestedTransmission`] when one of them lets light through.
    pub fn new(front: impl Into<Bsdf>, back: Option<Bsdf>) -> Result<Self, BsdfError> {
        let front = front.into();
        let transmits = |bsdf: &Bsdf| bsdf.lobes().transmission;
        if transmits(&front) || back.as_ref().is_some_and(transmits) {
            return Err(BsdfError::NestedTransmission("a two-sided material"));
        }
        Ok(Self {
            front: Box::new(front),
            back: back.map(Box::new),
        })
    }

    /// Makes the material whose sides are made from those of this one.
    ///
    /// # Errors
    /// Those of `make`, and [`BsdfError::NestedTransmission`].
    pub fn map(self, make: impl Fn(Bsdf) -> Result<Bsdf, BsdfError>) -> Result<Self, BsdfError> {
        let back = self.back.map(|back| make(*back)).transpose()?;
        Self::new(make(*self.front)?, back)
    }

    /// The material of both sides, where they have one.
    #[inline]
    pub(super) fn sole(&self) -> Option<&Bsdf> {
        self.back.is_none().then_some(&*self.front)
    }

    /// The material behind the front's, or the front's for both.
    #[inline]
    fn behind(&self) -> &Bsdf {
        self.back.as_ref().unwrap_or(&self.front)
    }

    /// The material that `wi` sees, and how to turn directions into its frame and back.
    #[inline]
    fn side(&self, wi: Local) -> (&Bsdf, Turn) {
        if wi.cos() > 0.0 {
            (&self.front, Turn(1.0))
        } else {
            (self.behind(), Turn(-1.0))
        }
    }

    /// [`BsdfModel::sample`] for sides that are not diffuse.
    #[inline(never)]
    fn sample_other(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let (bsdf, turn) = self.side(wi);
        let mut sample = bsdf.sample(turn.over(wi), at, transport, u_lobe, u)?;
        sample.direction = turn.over(sample.direction);
        if sample.lobe.is_dirac() {
            sample.component.0 += self.first_component(wi);
        }
        Some(sample)
    }

    /// Number of the first component of the side that `wi` sees.
    #[inline]
    fn first_component(&self, wi: Local) -> u8 {
        if wi.cos() > 0.0 || self.back.is_none() {
            0
        } else {
            self.front.component_count()
        }
    }
}

/// Factor on the normal's part of a direction: 1 leaves it, -1 turns it over.
#[derive(Clone, Copy)]
struct Turn(f32);

impl Turn {
    #[inline]
    fn over(self, direction: Local) -> Local {
        Local::new(direction.0.x, direction.0.y, direction.0.z * self.0)
    }
}

/// [`BsdfModel::eval_with_density`] of a side that is not diffuse.
#[inline(never)]
fn eval_other(
    bsdf: &Bsdf,
    wi: Local,
    wo: Local,
    at: &SurfacePoint,
    transport: Transport,
) -> (Rgb, SolidAngleDensity) {
    bsdf.eval_with_density(wi, wo, at, transport)
}

impl BsdfModel for TwoSided {
    fn examples() -> Vec<Self> {
        let front_and_back = [
            (Bsdf::from(Diffuse::new(0.5)), None),
            (
                Diffuse::new(Rgb::new(0.8, 0.2, 0.1)).into(),
                RoughConductor::examples().pop().map(Bsdf::from),
            ),
        ];
        let bumps = BumpMap::examples().into_iter().map(|bumps| {
            let back = RoughConductor::examples().pop().map(Bsdf::from);
            (bumps.into(), back)
        });
        let coats = Plastic::examples().into_iter().map(|plastic| {
            let front = Conductor::new(None, 0.9);
            (front.into(), Some(Bsdf::from(plastic)))
        });
        front_and_back
            .into_iter()
            .chain(coats)
            // The second and third: diffuse and mirroring bumps.
            .chain(bumps.skip(1).take(2))
            .filter_map(|(front, back)| Self::new(front, back).ok())
            .collect()
    }

    fn lobes(&self) -> LobeSet {
        self.front.lobes().union(self.behind().lobes())
    }

    #[inline(always)]
    fn sample(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let (bsdf, turn) = self.side(wi);
        // Half of all materials in scene files are this one: its code goes right here.
        if let Bsdf::Diffuse(diffuse) = bsdf {
            let sample = diffuse.sample(turn.over(wi), at, transport, u_lobe, u)?;
            let direction = turn.over(sample.direction);
            return Some(BsdfSample {
                direction,
                ..sample
            });
        }
        self.sample_other(wi, at, transport, u_lobe, u)
    }

    #[inline(always)]
    fn eval(&self, wi: Local, wo: Local, at: &SurfacePoint, transport: Transport) -> Rgb {
        let (bsdf, turn) = self.side(wi);
        let (wi, wo) = (turn.over(wi), turn.over(wo));
        match bsdf {
            Bsdf::Diffuse(diffuse) => diffuse.eval(wi, wo, at, transport),
            other => other.eval_apart(wi, wo, at, transport),
        }
    }

    #[inline]
    fn density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> SolidAngleDensity {
        let (bsdf, turn) = self.side(wi);
        bsdf.density(turn.over(wi), turn.over(wo), at, transport)
    }

    #[inline(always)]
    fn eval_with_density(
        &self,
        wi: Local,
        wo: Local,
        at: &SurfacePoint,
        transport: Transport,
    ) -> (Rgb, SolidAngleDensity) {
        let (bsdf, turn) = self.side(wi);
        let (wi, wo) = (turn.over(wi), turn.over(wo));
        match bsdf {
            Bsdf::Diffuse(diffuse) => diffuse.eval_with_density(wi, wo, at, transport),
            other => eval_other(other, wi, wo, at, transport),
        }
    }

    fn follow(
        &self,
        wi: Local,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<DiracEvent> {
        let (bsdf, turn) = self.side(wi);
        let nested = component.0.checked_sub(self.first_component(wi))?;
        let event = bsdf.follow(turn.over(wi), at, transport, Component(nested))?;
        Some(DiracEvent {
            direction: turn.over(event.direction),
            ..event
        })
    }

    fn component_count(&self) -> u8 {
        let behind = self.back.as_ref().map_or(0, |back| back.component_count());
        self.front.component_count() + behind
    }

    fn invert(
        &self,
        wi: Local,
        sampled: Sampled,
        at: &SurfacePoint,
        transport: Transport,
        spare: Spare,
    ) -> Option<SampleNumbers> {
        let (bsdf, turn) = self.side(wi);
        let sampled = match sampled {
            Sampled::Finite(wo) => Sampled::Finite(turn.over(wo)),
            Sampled::Dirac(component) => {
                let nested = component.0.checked_sub(self.first_component(wi))?;
                Sampled::Dirac(Component(nested))
            }
        };
        bsdf.invert(turn.over(wi), sampled, at, transport, spare)
    }

    fn albedo(&self, at: &SurfacePoint) -> Rgb {
        self.front.albedo(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Dielectric;

    #[test]
    fn glass_cannot_be_two_sided() {
        for glass in Dielectric::examples() {
            assert!(matches!(
                TwoSided::new(glass.clone(), None),
                Err(BsdfError::NestedTransmission(_))
            ));
            assert!(TwoSided::new(Diffuse::new(0.5), Some(glass.into())).is_err());
        }
    }
}
