//! Events of smooth surfaces, which stay in the plane of incidence: a cosine is all that they depend on.

use super::{Bsdf, Component, Conductor, Dielectric, DiracEvent, Null, ThinDielectric, Transport};
use crate::math::{Local, Vec3};
use crate::shape::SurfacePoint;

/// Where a smooth surface sends light: to `along · wi` with its part along the normal put right.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// Factor on the part of `wi` that lies in the surface.
    along: f32,
    /// Signed cosine of the angle between the normal and `wo`.
    cos: f32,
}

impl Bend {
    /// To where a mirror sends it.
    ///
    /// - `cos`: signed cosine of `wi`.
    #[inline]
    pub(super) fn mirrored(cos: f32) -> Self {
        Self { along: -1.0, cos }
    }

    /// Straight on through the surface.
    ///
    /// - `cos`: signed cosine of `wi`.
    #[inline]
    pub(super) fn straight_on(cos: f32) -> Self {
        Self {
            along: -1.0,
            cos: -cos,
        }
    }

    /// Through the boundary of another substance.
    ///
    /// - `eta`: index of refraction on `wi`'s side over that on `wo`'s side.
    /// - `cos`: signed cosine of `wo`.
    #[inline]
    pub(super) fn refracted(eta: f32, cos: f32) -> Self {
        Self { along: -eta, cos }
    }

    /// Signed cosine of the angle between the normal and `wo`.
    #[inline]
    pub fn cos(self) -> f32 {
        self.cos
    }

    /// `wo` of a `wi` in the shading frame.
    #[inline]
    fn of_local(self, wi: Local) -> Local {
        Local::new(wi.0.x * self.along, wi.0.y * self.along, self.cos)
    }

    /// `wo` of a `wi` in world space: no frame is made.
    ///
    /// - `cos`: signed cosine of `wi`, of which the event was made.
    #[inline]
    pub fn of_world(self, wi: Vec3, cos: f32, normal: Vec3) -> Vec3 {
        wi * self.along + normal * (self.cos - self.along * cos)
    }
}

impl DiracEvent<Bend> {
    /// What it is to a side whose cosines are `turn` times as large.
    #[inline(always)]
    fn turned(mut self, turn: f32) -> Self {
        self.direction.cos *= turn;
        self
    }

    /// The event of a direction that has the cosine of which this one was made.
    #[inline]
    pub(super) fn of(self, wi: Local) -> DiracEvent {
        DiracEvent {
            direction: self.direction.of_local(wi),
            coefficient: self.coefficient,
            probability: self.probability,
            lobe: self.lobe,
            eta: self.eta,
            cosine_ratio: self.cosine_ratio,
        }
    }
}

/// A smooth material.
enum Smooth<'b> {
    Glass(&'b Dielectric),
    Pane(&'b ThinDielectric),
    Metal(&'b Conductor),
    Nothing(Null),
}

impl Bsdf {
    /// Whether the material is smooth: [`Bsdf::follow_by_cosine`] and [`Bsdf::sample_by_cosine`] know it.
    pub fn is_smooth(&self) -> bool {
        self.smooth(1.0).is_some()
    }

    /// The smooth material that this is, on one side or alike on both, and the factor on cosines as it sees
    /// them: -1 from behind. `None` for others.
    #[inline(always)]
    fn smooth(&self, cos: f32) -> Option<(Smooth<'_>, f32)> {
        let (bsdf, turn) = match self {
            Self::TwoSided(sides) => (sides.sole()?, if cos > 0.0 { 1.0 } else { -1.0 }),
            other => (other, 1.0),
        };
        let smooth = match bsdf {
            Self::Dielectric(glass) => Smooth::Glass(glass),
            Self::ThinDielectric(pane) => Smooth::Pane(pane),
            Self::Conductor(metal) => Smooth::Metal(metal),
            Self::Null(null) => Smooth::Nothing(*null),
            _ => return None,
        };
        Some((smooth, turn))
    }

    /// [`BsdfModel::follow`](super::BsdfModel::follow) by the signed cosine of `wi` alone, for smooth
    /// materials; `None` for others.
    #[inline(always)]
    pub fn follow_by_cosine(
        &self,
        cos: f32,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<Option<DiracEvent<Bend>>> {
        let (smooth, turn) = self.smooth(cos)?;
        let event = match smooth {
            Smooth::Glass(glass) => glass.bend(cos * turn, at, transport, component),
            Smooth::Pane(pane) => pane.bend(cos * turn, at, component),
            Smooth::Metal(metal) => metal.bend(cos * turn, at, component),
            Smooth::Nothing(null) => null.bend(cos * turn, component),
        };
        Some(event.map(|event| event.turned(turn)))
    }

    /// [`BsdfModel::sample`](super::BsdfModel::sample) by the signed cosine of `wi` alone, for smooth
    /// materials; `None` for others.
    ///
    /// - `u_lobe`: uniform in `[0, 1)`.
    #[inline(always)]
    pub fn sample_by_cosine(
        &self,
        cos: f32,
        at: &SurfacePoint,
        transport: Transport,
        u_lobe: f32,
    ) -> Option<Option<DiracEvent<Bend>>> {
        let (smooth, turn) = self.smooth(cos)?;
        let only = Component(0);
        let event = match smooth {
            Smooth::Glass(glass) => {
                let chosen = glass.choose(cos * turn, at, transport, u_lobe);
                chosen.map(|(event, _)| event)
            }
            Smooth::Pane(pane) => pane.choose(cos * turn, at, u_lobe).map(|(event, _)| event),
            Smooth::Metal(metal) => metal.bend(cos * turn, at, only),
            Smooth::Nothing(null) => null.bend(cos * turn, only),
        };
        Some(event.map(|event| event.turned(turn)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{BsdfModel, Diffuse, TwoSided};
    use crate::math::{Frame, Rgb, Vec2, warp};
    use crate::shape::{ShapeModel, TriangleMesh, primitives};

    /// A direction that no axis is near to.
    fn slanted() -> Vec3 {
        Vec3::new(0.3, -0.8, 0.4).normalize()
    }

    fn point() -> SurfacePoint {
        let mesh = TriangleMesh::from(primitives::rectangle());
        mesh.sample_area(Vec2::new(0.3, 0.9)).0
    }

    impl Bsdf {
        /// Smooth materials, by their names.
        pub(crate) fn smooth_examples() -> Vec<Self> {
            let mut all = Self::examples();
            all.retain(|bsdf| {
                ["Dielectric", "ThinDielectric", "Conductor", "Null"].contains(&bsdf.name())
            });
            let metal = Conductor::new(None, Rgb::new(0.9, 0.5, 0.1));
            all.push(TwoSided::new(metal, None).unwrap().into());
            assert!(all.len() > 7);
            all
        }
    }

    /// Directions all around, each with what it is in the frame of [`slanted`].
    fn seen() -> Vec<(Vec3, Local)> {
        let frame = Frame::around(slanted());
        let place = |i: u16| Vec2::new(f32::from(i) + 0.5, f32::from(i * 77 % 200)) / 200.0;
        let all = (0..200).map(|i| warp::uniform_sphere(place(i)));
        all.map(|wi| (wi, frame.to_local(wi))).collect()
    }

    fn assert_is_sent_to((bend, eta): (Bend, f32), (wi, seen): (Vec3, Local), wo: Local) {
        let sent = bend.of_world(wi, seen.cos(), slanted());
        assert!((sent - Frame::around(slanted()).to_world(wo)).length() < 1e-6);
        assert!((sent.length() - 1.0).abs() < 1e-6);
        assert_eq!(bend.cos(), wo.cos());
        // Snell's law, and that of the mirror: the parts in the surface are opposite.
        let across = |direction: Vec3| slanted().cross(direction);
        assert!((across(sent) + across(wi) * eta).length() < 1e-6);
    }

    #[test]
    fn events_by_cosine_are_those_of_the_direction() {
        let (at, mut found) = (point(), 0);
        let components = || (0..3).map(Component);
        for bsdf in &Bsdf::smooth_examples() {
            assert!(bsdf.is_smooth());
            for (wi, seen) in seen() {
                for transport in [Transport::Radiance, Transport::Importance] {
                    for component in components() {
                        let bend = bsdf.follow_by_cosine(seen.cos(), &at, transport, component);
                        let bend = bend.expect("a smooth material");
                        let event = bsdf.follow(seen, &at, transport, component);
                        assert_eq!(bend.is_some(), event.is_some(), "{bsdf:?}");
                        let (Some(bend), Some(event)) = (bend, event) else {
                            continue;
                        };
                        found += 1;
                        let sent = (bend.direction, bend.eta);
                        assert_is_sent_to(sent, (wi, seen), event.direction);
                        assert_eq!(bend.coefficient, event.coefficient);
                        assert_eq!(bend.probability, event.probability);
                        assert_eq!((bend.lobe, bend.eta), (event.lobe, event.eta));
                        assert_eq!(bend.inverse_stretch(), event.inverse_stretch());
                    }
                }
            }
        }
        assert!(found > 3000, "{found}");
    }

    #[test]
    fn samples_by_cosine_are_those_of_the_direction() {
        let (at, mut found) = (point(), 0);
        for bsdf in &Bsdf::smooth_examples() {
            for (number, (wi, seen)) in seen().into_iter().enumerate() {
                let u_lobe = (number * 13 % 200) as f32 / 200.0;
                for transport in [Transport::Radiance, Transport::Importance] {
                    let bend = bsdf.sample_by_cosine(seen.cos(), &at, transport, u_lobe);
                    let bend = bend.expect("a smooth material");
                    let sample = bsdf.sample(seen, &at, transport, u_lobe, Vec2::splat(0.5));
                    assert_eq!(bend.is_some(), sample.is_some(), "{bsdf:?}");
                    let (Some(bend), Some(sample)) = (bend, sample) else {
                        continue;
                    };
                    found += 1;
                    let sent = (bend.direction, bend.eta);
                    assert_is_sent_to(sent, (wi, seen), sample.direction);
                    assert_eq!(bend.coefficient, sample.value);
                    assert_eq!(bend.probability, sample.density);
                    assert_eq!(bend.coefficient / bend.probability, sample.weight);
                    assert_eq!((bend.lobe, bend.eta), (sample.lobe, sample.eta));
                }
            }
        }
        assert!(found > 2000, "{found}");
    }

    #[test]
    fn straight_on_and_mirrored_are_exact() {
        let normal = slanted();
        let wi = Vec3::new(0.6, 0.0, 0.8);
        let cos = wi.dot(normal);
        assert_eq!(Bend::straight_on(cos).of_world(wi, cos, normal), -wi);
        let mirrored = Bend::mirrored(cos).of_world(wi, cos, normal);
        assert_eq!(mirrored, normal * (2.0 * cos) - wi);
    }

    #[test]
    fn other_materials_need_the_direction() {
        let at = point();
        let metal = || Bsdf::from(Conductor::new(None, 0.9));
        let grey = || Bsdf::from(Diffuse::new(0.5));
        let both = |front, back| Bsdf::from(TwoSided::new(front, back).unwrap());
        let mut others = Bsdf::examples();
        let smooth = [
            "Dielectric",
            "ThinDielectric",
            "Conductor",
            "Null",
            "TwoSided",
        ];
        others.retain(|bsdf| !smooth.contains(&bsdf.name()));
        others.push(both(grey(), None));
        others.push(both(metal(), Some(metal())));
        others.push(both(metal(), Some(grey())));
        for bsdf in &others {
            assert!(!bsdf.is_smooth());
            for cos in [-0.5, 0.5] {
                let found = bsdf.follow_by_cosine(cos, &at, Transport::Radiance, Component(0));
                assert!(found.is_none(), "{bsdf:?}");
                let found = bsdf.sample_by_cosine(cos, &at, Transport::Radiance, 0.5);
                assert!(found.is_none(), "{bsdf:?}");
            }
        }
    }
}
