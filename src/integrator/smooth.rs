//! Vertices on smooth surfaces: mirrors and glass.

use super::path::{Departure, PathTracer, Walk};
use crate::accel::{Hit, Ray};
use crate::bsdf::{Lobe, Transport};
use crate::math::Vec3;
use crate::scene::Scene;
use crate::shape::SurfacePoint;

impl PathTracer {
    /// Lets a walk go on by an edge that ends on a smooth surface: what [`PathTracer::depart`] does for any
    /// material, without a frame. The ray after it, if the path does not end there.
    ///
    /// - `depth`: edges of the path that ends at the hit.
    /// - `ray`: with a unit direction.
    ///
    /// `None` on other surfaces, those that glow, and where more is asked for than a direction to go on in.
    #[inline(always)]
    pub(super) fn pass(
        &self,
        scene: &Scene,
        depth: u32,
        (walk, ray, hit): (&mut Walk, &Ray, &Hit),
    ) -> Option<Option<Ray>> {
        let object = scene.object_at(hit);
        let is_passed =
            object.is_smooth && object.emitter.is_none() && self.connects_and_departs(depth);
        is_passed.then(|| self.pass_smooth(scene, depth, (walk, ray, hit)))
    }

    /// [`PathTracer::pass`] where it applies.
    #[inline(never)]
    fn pass_smooth(
        &self,
        scene: &Scene,
        depth: u32,
        (walk, ray, hit): (&mut Walk, &Ray, &Hit),
    ) -> Option<Ray> {
        let mut point = SurfacePoint::bare(Vec3::ZERO);
        let (_, object) = scene.put_surface(ray, hit, &mut point);
        let u_lobe = if object.lobes.single {
            0.0
        } else {
            walk.sampler.next_1d()
        };
        // Those that any material is given.
        let _ = walk.sampler.next_2d();
        let (normal, back) = (point.shading_normal, -ray.direction());
        let cos = back.dot(normal);
        let sampled =
            scene
                .bsdf(object.bsdf)
                .sample_by_cosine(cos, &point, Transport::Radiance, u_lobe);
        let sampled = sampled.flatten();
        if !sampled
            .as_ref()
            .is_some_and(|event| event.lobe == Lobe::Null)
        {
            walk.estimate.alpha = 1.0;
        }
        let event = sampled?;
        let weight = event.coefficient / event.probability;
        if weight.is_black() {
            return None;
        }
        walk.throughput *= weight;
        walk.eta *= event.eta;
        walk.departure = Departure {
            position: point.position,
            density: None,
        };
        let next = point.ray_toward(event.direction.of_world(back, cos, normal));
        self.survives(depth, walk).then_some(next)
    }
}
