//! Vertices on smooth surfaces: mirrors and glass.

use super::path::PathTracer;
use super::walk::{Departure, Walk};
use crate::accel::{Hit, Ray};
use crate::bsdf::{Lobe, Transport};
use crate::math::Vec3;
use crate::scene::{Object, Scene};
use crate::shape::SurfacePoint;

impl PathTracer {
    /// Whether walks pass an object by [`PathTracer::pass`]: one that is smooth, does not glow, and where no more is
    /// asked for than a direction to go on in.
    ///
    /// - `depth`: edges of the path that ends there.
    #[inline(always)]
    pub(super) fn passes(&self, object: &Object, depth: u32) -> bool {
        object.is_smooth && object.emitter.is_none() && self.connects_and_departs(depth)
    }

    /// Lets a walk go on by an edge that ends on a smooth surface: what [`PathTracer::depart`] does for any
    /// material, without a frame.
    ///
    /// - `depth`: edges of the path that ends at the hit.
    /// - `object`: what is hit, where [`PathTracer::passes`] says yes.
    /// - `ray`: with a unit direction.
    /// - `onward`: gets the ray after it, if the path does not end there. A call, so that the ray is written where it
    ///   stays: as a value that returns it would be read in other pieces than it was written in, and wait.
    #[inline(never)]
    pub(super) fn pass(
        &self,
        scene: &Scene,
        (depth, object): (u32, &Object),
        (walk, ray, hit): (&mut Walk<'_>, &Ray, &Hit),
        onward: impl FnOnce(Ray),
    ) {
        let u_lobe = if object.lobes.single {
            0.0
        } else {
            walk.sampler.next_1d()
        };
        // Those that any material is given.
        let _ = walk.sampler.next_2d();
        let mut point = SurfacePoint::bare(Vec3::ZERO);
        scene.put_surface(ray, hit, &mut point);
        let (normal, back) = (point.shading_normal, -ray.direction());
        let cos = back.dot(normal);
        let sampled =
            scene
                .bsdf(object.bsdf)
                .sample_by_cosine(cos, &point, Transport::Radiance, u_lobe);
        debug_assert!(sampled.is_some(), "the object says that it is smooth");
        let sampled = sampled.flatten();
        if !sampled
            .as_ref()
            .is_some_and(|event| event.lobe == Lobe::Null)
        {
            walk.estimate.alpha = 1.0;
        }
        let Some(event) = sampled else { return };
        let weight = event.coefficient / event.probability;
        if weight.is_black() {
            return;
        }
        let departure = Departure {
            position: point.position,
            density: None,
        };
        let next = point.ray_toward(event.direction.of_world(back, cos, normal));
        walk.scatter(departure, weight, event.eta);
        if self.survives(depth, walk) {
            onward(next);
        }
    }

    /// [`PathTracer::pass`] where it applies: the ray after it, if the path goes on.
    ///
    /// - `depth`, `ray`: as there.
    #[inline]
    pub(super) fn pass_alone(
        &self,
        scene: &Scene,
        depth: u32,
        (walk, ray, hit): (&mut Walk<'_>, &Ray, &Hit),
    ) -> Option<Option<Ray>> {
        let object = scene.object_at(hit);
        self.passes(object, depth).then(|| {
            let mut next = None;
            let onward = |ray| next = Some(ray);
            self.pass(scene, (depth, object), (walk, ray, hit), onward);
            next
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, Diffuse};
    use crate::math::lanes::Vec4;
    use crate::math::{Mat4, Rgb, warp};
    use crate::random::{PixelAddress, Purpose, Sampler, SamplerKind};
    use crate::scene::SceneBuilder;
    use crate::scene::options::{OptionReader, OptionValue, Options};
    use crate::shape::{Shape, Sphere, TriangleMesh, primitives};

    fn tracer(options: [(&str, OptionValue); 2]) -> PathTracer {
        let options = options.map(|(name, value)| (name.to_owned(), value));
        PathTracer::from_options(&mut OptionReader::new(&Options::from(options))).unwrap()
    }

    fn unlimited() -> PathTracer {
        let depths = [("max_depth", -1), ("rr_depth", 4)];
        tracer(depths.map(|(name, depth)| (name, OptionValue::Integer(depth))))
    }

    /// A ball, a wall behind it with normals of its own, and another ball, of an instance that mirrors it and of
    /// another material, beside it.
    fn scene([bsdf, instanced]: [Bsdf; 2], radiance: Option<f32>) -> Scene {
        let mut scene = SceneBuilder::new();
        let [bsdf, instanced] = [bsdf, instanced].map(|bsdf| scene.add_bsdf(bsdf));
        let ball = || Shape::from(Sphere::new(Vec3::ZERO, 1.0, Mat4::IDENTITY).unwrap());
        let glow = || radiance.map(|radiance| Rgb::grey(radiance).into());
        scene.add_shape(ball(), bsdf, glow()).unwrap();
        let mut wall = primitives::rectangle();
        for [x, y, z] in &mut wall.positions {
            (*x, *y, *z) = (8.0 * *x, 8.0 * *y, -2.0);
        }
        wall.normals = Some(vec![
            [0.3, 0.0, 1.0],
            [-0.3, 0.1, 1.0],
            [0.0, 0.3, 1.0],
            [0.0, 0.0, 1.0],
        ]);
        scene
            .add_shape(TriangleMesh::from(wall), bsdf, glow())
            .unwrap();
        let group = scene.add_group([(ball(), instanced)]);
        let aside = Mat4::from_translation(Vec3::new(4.0, 0.0, 0.0));
        let mirrored = Mat4::from_scale(Vec3::new(-1.5, 1.0, 1.0));
        scene.add_instance(group, aside * mirrored).unwrap();
        scene.build().unwrap()
    }

    /// Rays from all around, and from inside of what stands there, with numbers for the walks along them.
    fn walks(scene: &Scene) -> Vec<(Ray, Hit, Sampler)> {
        let ray = |pixel: u32| {
            let address = PixelAddress {
                seed: 3,
                purpose: Purpose::Check,
                pixel,
                sample: 0,
            };
            let mut sampler = Sampler::new(SamplerKind::Independent, address);
            let target = Vec3::new(4.0 * (pixel % 2) as f32, 0.0, 0.0);
            let reach = if pixel % 3 == 0 { 0.5 } else { 6.0 };
            let from = target + warp::uniform_sphere(sampler.next_2d()) * reach;
            let to = target + warp::uniform_sphere(sampler.next_2d()) * 1.2;
            let ray = Ray::new(from, (to - from).normalize());
            Some((ray, scene.hit(&ray)?, sampler))
        };
        (0..600).filter_map(ray).collect()
    }

    /// Passes a hit in both ways; true where the path goes on.
    fn passes_as_any(scene: &Scene, depth: u32, (ray, hit, sampler): &(Ray, Hit, Sampler)) -> bool {
        let tracer = unlimited();
        let mut samplers = [sampler.clone(), sampler.clone()];
        let [mut walk, mut expected] = samplers.each_mut().map(|sampler| {
            let mut walk = tracer.start(ray, sampler);
            walk.set_state(Vec4::new(0.8, 0.3, 0.5, 1.25));
            walk
        });
        let next = tracer
            .pass_alone(scene, depth, (&mut walk, ray, hit))
            .unwrap();
        let surface = scene.interaction(ray, hit);
        assert!(tracer.arrive(scene, depth, &mut expected, &surface));
        assert!(tracer.connect(scene, &mut expected, &surface).is_none());
        let departed = tracer.depart(depth, &mut expected, &surface);
        assert_eq!(next.is_some(), departed.is_some());
        if let (Some(next), Some(departed)) = (next, departed) {
            assert!((next.direction() - departed.direction()).length() < 2e-6);
            assert!((next.origin() - departed.origin()).length() < 1e-6);
        }
        assert_eq!(walk.state(), expected.state());
        assert_eq!(walk.estimate.alpha, expected.estimate.alpha);
        assert_eq!(walk.departure.position, expected.departure.position);
        assert_eq!(walk.departure.density, expected.departure.density);
        assert_eq!(walk.sampler.next_1d(), expected.sampler.next_1d());
        next.is_some()
    }

    #[test]
    fn smooth_surfaces_are_passed_as_any_material_is() {
        // Of each object, hits from its front and from behind.
        let mut hits = [[0; 2]; 3];
        let mut passed = 0;
        for bsdf in Bsdf::smooth_examples() {
            let scene = scene([bsdf.clone(), bsdf], None);
            for walk in walks(&scene) {
                let (ray, hit, _) = &walk;
                let object = hit.instance.map_or(hit.geometry as usize, |_| 2);
                let surface = scene.interaction(ray, hit);
                hits[object][usize::from(surface.wi.cos() < 0.0)] += 1;
                for depth in [1, 7] {
                    passed += i32::from(passes_as_any(&scene, depth, &walk));
                }
            }
        }
        assert!(
            hits.as_flattened().iter().all(|hits| *hits > 100),
            "{hits:?}"
        );
        assert!(passed > 3000, "{passed}");
    }

    #[test]
    fn where_more_is_asked_for_nothing_is_passed() {
        let glass = || Bsdf::smooth_examples().swap_remove(0);
        let strict = [
            ("max_depth", OptionValue::Integer(-1)),
            ("strict_normals", OptionValue::Boolean(true)),
        ];
        let depths = [("max_depth", 2), ("rr_depth", 4)];
        let short = tracer(depths.map(|(name, depth)| (name, OptionValue::Integer(depth))));
        for (tracer, bsdf, radiance, depth) in [
            (tracer(strict), glass(), None, 1),
            (short, glass(), None, 2),
            (unlimited(), glass(), Some(1.0), 1),
            (unlimited(), Diffuse::new(0.5).into(), None, 1),
        ] {
            // The instance does not glow.
            let instanced = if radiance.is_some() {
                Diffuse::new(0.5).into()
            } else {
                bsdf.clone()
            };
            let scene = scene([bsdf, instanced], radiance);
            for (ray, hit, mut sampler) in walks(&scene) {
                let mut walk = tracer.start(&ray, &mut sampler);
                let passed = tracer.pass_alone(&scene, depth, (&mut walk, &ray, &hit));
                assert!(passed.is_none());
            }
        }
    }

    #[test]
    fn instances_are_passed_by_their_own_material() {
        let (tracer, glass) = (unlimited(), || Bsdf::smooth_examples().swap_remove(0));
        for glass_in_world in [true, false] {
            let mut bsdfs = [glass(), Diffuse::new(0.5).into()];
            if !glass_in_world {
                bsdfs.reverse();
            }
            let scene = scene(bsdfs, None);
            for (ray, hit, mut sampler) in walks(&scene) {
                let mut walk = tracer.start(&ray, &mut sampler);
                let passed = tracer.pass_alone(&scene, 1, (&mut walk, &ray, &hit));
                assert_eq!(passed.is_some(), hit.instance.is_none() == glass_in_world);
            }
        }
    }
}
