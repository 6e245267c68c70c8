//! A ray that met a surface.

use super::{EmitterId, Object};
use crate::accel::{Hit, Ray};
use crate::bsdf::{Bsdf, LobeSet};
use crate::math::{Frame, Local, Vec2, Vec3};
use crate::shape::{Placement, Shape, ShapeHit, ShapeModel, SurfacePoint};

/// A surface that a ray met, with the direction that it came from.
#[derive(Clone, Debug)]
pub struct Interaction<'s> {
    /// The point on the surface.
    pub point: SurfacePoint,
    /// The frame that the material writes its directions in.
    pub frame: Frame,
    /// The material there.
    pub bsdf: &'s Bsdf,
    /// Its lobes.
    pub lobes: LobeSet,
    /// Index of the object among [`Scene::objects`](super::Scene::objects).
    pub object: u32,
    /// The light there.
    pub emitter: Option<EmitterId>,
    /// World-space unit direction back to where the ray came from.
    pub back: Vec3,
    /// The same in the shading frame.
    pub wi: Local,
    /// Length of the ray in m.
    pub distance: f32,
}

impl<'s> Interaction<'s> {
    /// Looks up what stands at a hit.
    ///
    /// - `ray`: with a unit direction.
    #[inline(always)]
    pub(super) fn new(object: &Object, bsdf: &'s Bsdf, ray: &Ray, hit: &Hit) -> Self {
        let shape_hit = shape_hit(ray, hit);
        let at = |point| Self::at(point, object, bsdf, ray, hit);
        // Written out for triangles: a point that passes through memory costs as much as making it.
        match &*object.shape {
            Shape::TriangleMesh(mesh) => at(mesh.surface_at(&shape_hit)),
            shape => at(shape.surface_at(&shape_hit)),
        }
    }

    /// Looks up what stands at a hit on an instance.
    ///
    /// - `ray`: with a unit direction.
    /// - `index`: of the object, among those of the scene.
    #[inline(never)]
    pub(super) fn on_instance(
        placement: &Placement,
        (index, object): (u32, &Object),
        bsdf: &'s Bsdf,
        ray: &Ray,
        hit: &Hit,
    ) -> Self {
        let local = placement.to_object(&shape_hit(ray, hit));
        let point = placement.place(&object.shape.surface_at(&local));
        Self {
            object: index,
            ..Self::at(point, object, bsdf, ray, hit)
        }
    }

    #[inline(always)]
    fn at(point: SurfacePoint, object: &Object, bsdf: &'s Bsdf, ray: &Ray, hit: &Hit) -> Self {
        let back = -ray.direction();
        let frame = point.shading_frame();
        let wi = frame.to_local(back);
        Self {
            point,
            frame,
            bsdf,
            lobes: object.lobes,
            object: hit.geometry,
            emitter: object.emitter,
            back,
            wi,
            distance: hit.distance,
        }
    }

    /// The ray that leaves in a direction of the shading frame.
    #[inline]
    pub fn spawn(&self, direction: Local) -> Ray {
        self.point.ray_toward(self.frame.to_world(direction))
    }
}

/// What a shape is told of a hit, in world space.
#[inline(always)]
fn shape_hit(ray: &Ray, hit: &Hit) -> ShapeHit {
    ShapeHit {
        primitive: hit.primitive,
        barycentrics: Vec2::new(hit.u, hit.v),
        position: ray.at(hit.distance),
    }
}
