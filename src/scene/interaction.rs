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
    /// The triangle or segment of the shape.
    pub primitive: u32,
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
    /// What stands at a hit.
    ///
    /// - `object`: with its index among those of the scene.
    /// - `ray`: with a unit direction.
    #[inline(always)]
    pub(super) fn new(
        point: SurfacePoint,
        (index, object): (u32, &Object),
        bsdf: &'s Bsdf,
        ray: &Ray,
        hit: &Hit,
    ) -> Self {
        let back = -ray.direction();
        let frame = point.shading_frame();
        let wi = frame.to_local(back);
        Self {
            point,
            frame,
            bsdf,
            lobes: object.lobes,
            primitive: hit.primitive,
            object: index,
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

/// Puts the point of a hit on a shape that stands in the world in its place.
///
/// Written out for triangles: a point that passes through memory costs as much as making it.
#[inline(always)]
pub(super) fn put_point_in_world(shape: &Shape, ray: &Ray, hit: &Hit, point: &mut SurfacePoint) {
    match shape {
        Shape::TriangleMesh(mesh) => {
            mesh.put_point(hit.primitive, Vec2::new(hit.u, hit.v), point);
        }
        shape => *point = point_of_other(shape, ray, hit),
    }
}

#[inline(never)]
fn point_of_other(shape: &Shape, ray: &Ray, hit: &Hit) -> SurfacePoint {
    shape.surface_at(&shape_hit(ray, hit))
}

/// The point of a hit on a shape of an instance.
#[inline(never)]
pub(super) fn point_on_instance(
    placement: &Placement,
    shape: &Shape,
    ray: &Ray,
    hit: &Hit,
) -> SurfacePoint {
    let local = placement.to_object(&shape_hit(ray, hit));
    placement.place(&shape.surface_at(&local))
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
