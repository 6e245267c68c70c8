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
        (!sent.coefficient.is_black()).then_some(Followed {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Ray;
    use crate::bsdf::{Bsdf, Component};
    use crate::math::{Mat4, Vec2, warp};
    use crate::path::PathRules;
    use crate::scene::{Scene, SceneBuilder};
    use crate::sensor::{Orthographic, Sensor};
    use crate::shape::Sphere;

    fn ball(bsdf: &Bsdf) -> Scene {
        let mut scene = SceneBuilder::new();
        let bsdf = scene.add_bsdf(bsdf.clone());
        let ball = Sphere::new(Vec3::ZERO, 1.0, Mat4::IDENTITY).unwrap();
        scene.add_shape(ball, bsdf, None).unwrap();
        scene.build().unwrap()
    }

    const EVENTS: [Event; 5] = [
        Event::Specular(Component(0)),
        Event::Specular(Component(1)),
        Event::Specular(Component(2)),
        Event::Null(Component(0)),
        Event::Finite,
    ];

    /// A point of the ball whose true normal is not the shaded one, and a direction away from it.
    fn corner(space: &PathSpace<'_>, number: u16) -> (PathVertex, Vec3) {
        let u = Vec2::new(f32::from(number) + 0.5, f32::from(number * 77 % 300)) / 300.0;
        let away = warp::uniform_sphere(u);
        let mut vertex = PathVertex::sensor(Vec3::ZERO);
        let ray = Ray::new(away * 3.0, -away);
        let met = space.meet_at(ray, false, Event::Finite, &mut vertex);
        assert!(met.is_some());
        let tilt = warp::uniform_sphere(Vec2::new(u.y, u.x)) * 0.8;
        vertex.point.geometric_normal = (vertex.point.shading_normal + tilt).normalize();
        (vertex, warp::uniform_sphere(Vec2::new(u.y, 1.0 - u.x)))
    }

    #[test]
    fn without_a_frame_light_is_sent_as_with_one() {
        let camera = Orthographic::new(Mat4::IDENTITY, (0.0, 9.0), (8, 8)).unwrap();
        let sensor = Sensor::from(camera);
        let [mut sent, mut forbidden, mut foreign] = [0; 3];
        for bsdf in Bsdf::smooth_examples() {
            let scene = ball(&bsdf);
            let spaces = [false, true].map(|strict_normals| {
                let rules = PathRules {
                    strict_normals,
                    ..PathRules::default()
                };
                PathSpace::new(&scene, &sensor, rules)
            });
            for (number, event) in (0..300).flat_map(|n| EVENTS.map(|event| (n, event))) {
                let found = spaces.each_ref().map(|space| {
                    let (vertex, from) = corner(space, number);
                    let way = |transport| {
                        let sent = space.send(&vertex, event, from, transport);
                        let expected = space.send_by_frame(&vertex, event, from, transport);
                        assert_eq!(sent.is_some(), expected.is_some(), "{bsdf:?}, {event:?}");
                        if let (Some(sent), Some(expected)) = (&sent, expected) {
                            assert!((sent.direction - expected.direction).length() < 1e-6);
                            assert_eq!(sent.coefficient, expected.coefficient);
                            assert_eq!(sent.inverse_stretch, expected.inverse_stretch);
                        }
                        sent.is_some()
                    };
                    let both = [Transport::Radiance, Transport::Importance].map(way);
                    assert_eq!(both[0], both[1]);
                    both[0]
                });
                sent += i32::from(found[1]);
                forbidden += i32::from(found[0] && !found[1]);
                foreign += i32::from(!found[0]);
            }
        }
        assert!(sent > 1000 && forbidden > 300 && foreign > 1000);
    }
}
