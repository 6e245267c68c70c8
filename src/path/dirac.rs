//! Events without a density: where they send light, and what becomes of it.

use super::{Event, PathSpace, PathVertex};
use crate::bsdf::{BsdfModel, DiracEvent, Transport};
use crate::math::{Local, Rgb, Vec3};

/// The only direction into which a Dirac component sends light.
#[derive(Clone, Copy, Debug)]
pub struct Followed {
    /// World-space unit direction away from the vertex.
    pub direction: Vec3,
    /// As [`PathVertex::value`].
    pub value: Rgb,
    /// As [`PathVertex::adjoint`].
    pub adjoint: f32,
}

/// Where a Dirac component sends light from a direction.
struct Sent {
    /// As [`Followed::direction`].
    direction: Vec3,
    /// As [`DiracEvent::coefficient`].
    coefficient: Rgb,
    /// As [`DiracEvent::inverse_stretch`].
    inverse_stretch: f32,
}

impl Sent {
    #[inline(always)]
    fn new<D>(direction: Vec3, event: &DiracEvent<D>) -> Self {
        Self {
            direction,
            coefficient: event.coefficient,
            inverse_stretch: event.inverse_stretch(),
        }
    }
}

impl PathSpace<'_> {
    /// Follows a Dirac event from the eye's side to the light's.
    ///
    /// `None` where the material has no such event there, or sends nothing.
    #[inline(always)]
    pub fn follow(&self, vertex: &PathVertex, event: Event, to_eye: Vec3) -> Option<Followed> {
        let sent = self.send(vertex, event, to_eye, Transport::Radiance)?;
        let cosines = vertex.geometric_cos(to_eye) / vertex.geometric_cos(sent.direction);
        (!sent.coefficient.is_black()).then(|| Followed {
            direction: sent.direction,
            value: sent.coefficient,
            adjoint: cosines * sent.inverse_stretch,
        })
    }

    /// Follows a Dirac event from the light's side to the eye's; value and factor are those of
    /// [`PathSpace::follow`] from there.
    ///
    /// Differs: the coefficient for importance with its shading-normal factor (Veach 1997, Sec. 5.3) is
    /// kept as the one for radiance times [`PathVertex::adjoint`], so that a vertex means the same
    /// whichever side it was made from.
    #[inline]
    pub fn follow_back(
        &self,
        vertex: &PathVertex,
        event: Event,
        to_light: Vec3,
    ) -> Option<Followed> {
        let sent = self.send(vertex, event, to_light, Transport::Importance)?;
        let from_eye = self.follow(vertex, event, sent.direction)?;
        Some(Followed {
            direction: sent.direction,
            ..from_eye
        })
    }

    /// Where a Dirac event sends light.
    ///
    /// - `from`: unit direction towards where the path comes from; to the eye's side for radiance.
    ///
    /// `None` where the material has no such event there, or `strict_normals` forbids it.
    #[inline(always)]
    fn send(
        &self,
        vertex: &PathVertex,
        event: Event,
        from: Vec3,
        transport: Transport,
    ) -> Option<Sent> {
        let point = &vertex.point;
        let (bsdf, component) = (self.bsdf(vertex)?, event.component()?);
        let cos = from.dot(point.shading_normal);
        // Smooth materials alone need no frame.
        let Some(found) = bsdf.follow_by_cosine(cos, point, transport, component) else {
            return self.send_by_frame(vertex, event, from, transport);
        };
        let found = found.filter(|found| Event::of_lobe(found.lobe, component) == event)?;
        let direction = found.direction.of_world(from, cos, point.shading_normal);
        let agree = self.sides_agree(point, (cos, from), (found.direction.cos(), direction));
        agree.then(|| Sent::new(direction, &found))
    }

    /// [`PathSpace::send`] for any material.
    #[inline(never)]
    fn send_by_frame(
        &self,
        vertex: &PathVertex,
        event: Event,
        from: Vec3,
        transport: Transport,
    ) -> Option<Sent> {
        let frame = vertex.point.shading_frame();
        let wi = frame.to_local(from);
        let found = self.dirac(vertex, event, wi, transport)?;
        let direction = frame.to_world(found.direction);
        let (a, b) = ((wi.cos(), from), (found.direction.cos(), direction));
        self.sides_agree(&vertex.point, a, b)
            .then(|| Sent::new(direction, &found))
    }

    /// A Dirac event in the shading frame.
    #[inline]
    pub(super) fn dirac(
        &self,
        vertex: &PathVertex,
        event: Event,
        wi: Local,
        transport: Transport,
    ) -> Option<DiracEvent> {
        let component = event.component()?;
        let bsdf = self.bsdf(vertex)?;
        if component.0 >= bsdf.component_count() {
            return None;
        }
        let found = bsdf.follow(wi, &vertex.point, transport, component)?;
        (Event::of_lobe(found.lobe, component) == event).then_some(found)
    }
}
