//! Events of smooth surfaces, which stay in the plane of incidence: a cosine is all that they depend on.

use super::{Bsdf, Component, DiracEvent, Transport};
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

impl Bsdf {
    /// [`BsdfModel::follow`](super::BsdfModel::follow) by the signed cosine of `wi` alone, for the smooth
    /// materials that do with it; `None` for others.
    #[inline(always)]
    pub fn follow_by_cosine(
        &self,
        cos: f32,
        at: &SurfacePoint,
        transport: Transport,
        component: Component,
    ) -> Option<Option<DiracEvent<Bend>>> {
        let (bsdf, turn) = match self {
            Self::TwoSided(sides) if cos <= 0.0 => (sides.sole()?, -1.0),
            Self::TwoSided(sides) => (sides.sole()?, 1.0),
            other => (other, 1.0),
        };
        let event = match bsdf {
            Self::Dielectric(glass) => glass.bend(cos, at, transport, component),
            Self::ThinDielectric(pane) => pane.bend(cos, at, component),
            Self::Conductor(metal) => metal.bend(cos * turn, at, component),
            Self::Null(null) => null.bend(cos, component),
            _ => return None,
        };
        Some(event.map(|mut event| {
            event.direction.cos *= turn;
            event
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{BsdfModel, Conductor, Diffuse, TwoSided};
    use crate::math::{Frame, Rgb, Vec2, warp};
    use crate::shape::{ShapeModel, TriangleMesh, primitives};

    /// A direction that no axis is near to.
    fn slanted() -> Vec3 {
        Vec3::new(0.3, -0.8, 0.4).normalize()
    }

    fn smooth() -> Vec<Bsdf> {
        let mut all = Bsdf::examples();
        all.retain(|bsdf| {
            ["Dielectric", "ThinDielectric", "Conductor", "Null"].contains(&bsdf.name())
        });
        let metal = Conductor::new(None, Rgb::new(0.9, 0.5, 0.1));
        all.push(TwoSided::new(metal, None).unwrap().into());
        assert!(all.len() > 7);
        all
    }

    #[test]
    fn events_by_cosine_are_those_of_the_direction() {
        let mesh = TriangleMesh::from(primitives::rectangle());
        let (at, _) = mesh.sample_area(Vec2::new(0.3, 0.9));
        let frame = Frame::around(slanted());
        let mut found = 0;
        for bsdf in &smooth() {
            for place in 0..200 {
                let u = Vec2::new(
                    (place as f32 + 0.5) / 200.0,
                    (place * 77 % 200) as f32 / 200.0,
                );
                let wi = warp::uniform_sphere(u);
                let seen = frame.to_local(wi);
                for (transport, number) in [Transport::Radiance, Transport::Importance]
                    .into_iter()
                    .flat_map(|transport| (0..3).map(move |number| (transport, number)))
                {
                    let component = Component(number);
                    let bend = bsdf.follow_by_cosine(seen.cos(), &at, transport, component);
                    let bend = bend.expect("a smooth material");
                    let event = bsdf.follow(seen, &at, transport, component);
                    assert_eq!(bend.is_some(), event.is_some(), "{bsdf:?}");
                    let (Some(bend), Some(event)) = (bend, event) else {
                        continue;
                    };
                    found += 1;
                    let wo = bend.direction.of_world(wi, seen.cos(), slanted());
                    assert!(
                        (wo - frame.to_world(event.direction)).length() < 1e-6,
                        "{bsdf:?}"
                    );
                    assert!((wo.length() - 1.0).abs() < 1e-6);
                    assert_eq!(bend.coefficient, event.coefficient);
                    assert_eq!(bend.probability, event.probability);
                    assert_eq!((bend.lobe, bend.eta), (event.lobe, event.eta));
                    assert_eq!(bend.inverse_stretch(), event.inverse_stretch());
                }
            }
        }
        assert!(found > 3000, "{found}");
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
        let smooth: Vec<&str> = smooth().iter().map(Bsdf::name).collect();
        let mesh = TriangleMesh::from(primitives::rectangle());
        let (at, _) = mesh.sample_area(Vec2::new(0.3, 0.9));
        let metal = || Bsdf::from(Conductor::new(None, 0.9));
        let mut others = Bsdf::examples();
        others.retain(|bsdf| !smooth.contains(&bsdf.name()));
        others.push(TwoSided::new(metal(), Some(metal())).unwrap().into());
        others.push(
            TwoSided::new(metal(), Some(Diffuse::new(0.5).into()))
                .unwrap()
                .into(),
        );
        for bsdf in &others {
            for cos in [-0.5, 0.5] {
                let found = bsdf.follow_by_cosine(cos, &at, Transport::Radiance, Component(0));
                assert!(found.is_none(), "{bsdf:?}");
            }
        }
    }
}
