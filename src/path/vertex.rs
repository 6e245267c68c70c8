//! The vertices that paths are made of.

use crate::bsdf::{BsdfSample, Component, Lobe};
use crate::emitter::{EmittedRay, EmitterClass, EmitterSample};
use crate::math::{Rgb, Vec3};
use crate::scene::{EmitterId, Interaction};
use crate::shape::SurfacePoint;

/// Where a vertex lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// On the lens of the sensor.
    Sensor,
    /// On a surface.
    Surface,
    /// At a point light or the start of a beam, which no ray meets.
    Point,
    /// Infinitely far away: its position is the unit direction towards it.
    Infinity,
}

/// What happens to light at a vertex: part of the state of a Markov chain.
///
/// A finite and a Dirac event at the same point make different paths, with measures of their own.
/// Which finite lobe a sampler happened to pick is *not* part of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The sensor measures; only at the first vertex.
    Measurement,
    /// Scattering by the sum of all finite lobes: `D` in signatures, however glossy.
    Finite,
    /// Scattering by one Dirac component: `S`.
    Specular(Component),
    /// Passing straight through by one Dirac component: `N`.
    Null(Component),
    /// Emission; only at the last vertex.
    Emission(EmitterClass),
}

impl Event {
    /// The event of a sampled direction.
    #[inline]
    pub fn of(sample: &BsdfSample) -> Self {
        Self::of_lobe(sample.lobe, sample.component)
    }

    /// The event of a lobe.
    #[inline]
    pub fn of_lobe(lobe: Lobe, component: Component) -> Self {
        match lobe {
            Lobe::Diffuse | Lobe::Glossy => Self::Finite,
            Lobe::Specular => Self::Specular(component),
            Lobe::Null => Self::Null(component),
        }
    }

    /// The Dirac component, where the event is one.
    #[inline]
    pub fn component(self) -> Option<Component> {
        match self {
            Self::Specular(component) | Self::Null(component) => Some(component),
            _ => None,
        }
    }

    /// True for events without a density.
    #[inline]
    pub fn is_dirac(self) -> bool {
        matches!(self, Self::Specular(_) | Self::Null(_))
    }

    /// True where a vertex can be connected to any other: not where light goes one way only.
    #[inline]
    pub fn is_connectable(self) -> bool {
        match self {
            Self::Measurement | Self::Finite => true,
            Self::Specular(_) | Self::Null(_) => false,
            Self::Emission(class) => class.is_connectable(),
        }
    }
}

/// One vertex of a path: a plain value without references.
#[derive(Clone, Copy, Debug)]
pub struct PathVertex {
    /// The point; for [`VertexKind::Infinity`] its position is a direction.
    pub point: SurfacePoint,
    /// What the vertex contributes to the path's value.
    ///
    /// - finite event: `f_s · |n_s · ω_l|`, radiance from the light's side scattered to the eye's, in
    ///   1/sr;
    /// - Dirac event: the component's coefficient, the other direction generated from the eye's side;
    /// - emission: radiance (area, environment), intensity (point), irradiance (directional) or flux (collimated);
    /// - sensor: one.
    pub value: Rgb,
    /// For Dirac events, the factor on `value` when the eye's direction is generated from the light's:
    /// `|n_g · ω_e| / |n_g · ω_l| · dω_e/dω_l`. One for other events.
    pub adjoint: f32,
    /// Index of the object; [`PathVertex::NONE`] where there is none.
    object: u32,
    /// Index of the emitter; [`PathVertex::NONE`] where there is none.
    emitter: u32,
    /// Where it lies.
    pub kind: VertexKind,
    /// What happens there.
    pub event: Event,
}

const _: () = assert!(size_of::<PathVertex>() <= 96, "paths are copied often");

impl PathVertex {
    const NONE: u32 = u32::MAX;

    /// A vertex on the lens.
    pub fn sensor(position: Vec3) -> Self {
        Self {
            point: SurfacePoint::bare(position),
            value: Rgb::WHITE,
            adjoint: 1.0,
            object: Self::NONE,
            emitter: Self::NONE,
            kind: VertexKind::Sensor,
            event: Event::Measurement,
        }
    }

    /// A vertex where a ray met a surface; its value is yet to be found.
    #[inline]
    pub fn surface(met: &Interaction<'_>, event: Event) -> Self {
        let mut vertex = Self {
            point: met.point,
            ..Self::sensor(Vec3::ZERO)
        };
        vertex.lie_on((met.object, met.emitter), event);
        vertex
    }

    /// Makes a vertex of one that has a surface's point already; its value is yet to be found.
    ///
    /// - `object`, `emitter`: index of the object there, and the light there.
    #[inline(always)]
    pub(super) fn lie_on(&mut self, (object, emitter): (u32, Option<EmitterId>), event: Event) {
        self.value = Rgb::BLACK;
        self.adjoint = 1.0;
        self.object = object;
        self.emitter = emitter.map_or(Self::NONE, |id| id.0);
        self.kind = VertexKind::Surface;
        self.event = event;
    }

    /// The last vertex of a path that ends at a sampled point of an emitter.
    ///
    /// Its value is that of the sample only for emitters whose sample shows it; others need
    /// [`PathSpace::emission`](super::PathSpace::emission).
    #[inline]
    pub fn sampled_light(sample: &EmitterSample, emitter: EmitterId, class: EmitterClass) -> Self {
        let (kind, point) = match (sample.surface, sample.target) {
            (Some(surface), _) => (VertexKind::Surface, surface),
            (None, Some(position)) => (VertexKind::Point, SurfacePoint::bare(position)),
            (None, None) => (VertexKind::Infinity, SurfacePoint::bare(sample.direction)),
        };
        Self {
            point,
            value: sample.radiance,
            adjoint: 1.0,
            object: Self::NONE,
            emitter: emitter.0,
            kind,
            event: Event::Emission(class),
        }
    }

    /// The last vertex of a path whose light starts as a sampled ray.
    ///
    /// Its value is that of the ray, which depends on its direction.
    pub fn emitted_from(ray: &EmittedRay, emitter: EmitterId, class: EmitterClass) -> Self {
        let (kind, point) = match (ray.surface, class) {
            (Some(surface), _) => (VertexKind::Surface, surface),
            (None, EmitterClass::Directional | EmitterClass::Environment) => {
                (VertexKind::Infinity, SurfacePoint::bare(-ray.direction))
            }
            (None, _) => (VertexKind::Point, SurfacePoint::bare(ray.origin)),
        };
        Self {
            point,
            value: ray.value,
            adjoint: 1.0,
            object: Self::NONE,
            emitter: emitter.0,
            kind,
            event: Event::Emission(class),
        }
    }

    /// The last vertex of a path that leaves the scene in a unit direction, into an environment.
    #[inline]
    pub fn environment(toward: Vec3, radiance: Rgb, emitter: EmitterId) -> Self {
        Self {
            point: SurfacePoint::bare(toward),
            value: radiance,
            adjoint: 1.0,
            object: Self::NONE,
            emitter: emitter.0,
            kind: VertexKind::Infinity,
            event: Event::Emission(EmitterClass::Environment),
        }
    }

    /// World-space position, or the direction to a vertex at infinity.
    #[inline]
    pub fn position(&self) -> Vec3 {
        self.point.position
    }

    /// Index of the object on which the vertex lies.
    #[inline]
    pub fn object(&self) -> Option<usize> {
        (self.object != Self::NONE).then_some(self.object as usize)
    }

    /// The emitter there.
    #[inline]
    pub fn emitter(&self) -> Option<EmitterId> {
        (self.emitter != Self::NONE).then_some(EmitterId(self.emitter))
    }

    /// Size of the cosine between a unit direction and the geometric normal; one where there is no
    /// surface.
    #[inline]
    pub fn geometric_cos(&self, direction: Vec3) -> f32 {
        match self.kind {
            VertexKind::Surface => self.point.geometric_normal.dot(direction).abs(),
            _ => 1.0,
        }
    }
}
