//! Path tracing.

use super::pixel::{Estimate, PixelIntegrator, first_hit};
use super::render::Counters;
use super::walk::{Departure, Walk};
use super::wave::Wave;
use crate::accel::Ray;
use crate::bsdf::{BsdfModel, BsdfSample, Lobe, Transport};
use crate::emitter::EmitterModel;
use crate::math::{Local, Rgb, Vec2, Vec3};
use crate::path::Heuristic;
use crate::random::Sampler;
use crate::scene::options::{OptionError, OptionReader};
use crate::scene::{EmitterId, Interaction, Scene};
use crate::sensor::CameraRay;

/// Follows light back from the camera, one random direction at each surface, and weighs directions
/// that were sampled at the light against directions that were sampled at the surface.
///
/// Source: Kajiya 1986; van Antwerpen 2011, Alg. 1.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer {
    /// Largest number of edges of a path; `u32::MAX` for no limit.
    max_depth: u32,
    /// Number of edges from which on Russian roulette may end a path.
    rr_depth: u32,
    /// Whether the camera sees through emitting surfaces, and no environment.
    hide_emitters: bool,
    /// Whether directions that lie on different sides of the true and the shaded surface are black.
    strict_normals: bool,
    heuristic: Heuristic,
}

/// Light that arrives if a ray is free.
pub(super) struct Connection {
    /// From the surface to the emitter.
    pub(super) ray: Ray,
    /// What arrives at the camera, in W·m⁻²·sr⁻¹.
    pub(super) radiance: Rgb,
}

impl PathTracer {
    /// Reads the options `max_depth`, `rr_depth`, `hide_emitters`, `strict_normals` and `mis`.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        Ok(Self {
            max_depth: depth_limit(options.integer("max_depth", -1..=i64::MAX, -1)?),
            rr_depth: depth_limit(options.integer("rr_depth", 1..=i64::MAX, 5)?),
            hide_emitters: options.boolean("hide_emitters", false)?,
            strict_normals: options.boolean("strict_normals", false)?,
            heuristic: super::heuristic(options)?,
        })
    }

    /// Light that a ray meets by chance.
    fn met_environment(&self, scene: &Scene, walk: &Walk<'_>, toward: Vec3) -> Rgb {
        let radiance = scene.lights().environment_radiance(toward);
        let weight = walk.departure.density.map_or(1.0, |own| {
            let from = walk.departure.position;
            let other = scene.lights().environment_density(from, toward).0;
            self.heuristic.second_weight(other, own)
        });
        radiance * weight
    }

    /// Light of a surface that a ray meets by chance, and that is an emitter.
    fn met_surface(
        &self,
        scene: &Scene,
        walk: &Walk<'_>,
        hit: &Interaction<'_>,
        id: EmitterId,
    ) -> Rgb {
        let radiance = scene.lights().get(id).radiance(&hit.point, hit.back);
        if radiance.is_black() {
            return radiance;
        }
        let weight = walk.departure.density.map_or(1.0, |own| {
            let other = scene
                .lights()
                .density_toward(id, walk.departure.position, &hit.point)
                .0;
            self.heuristic.second_weight(other, own)
        });
        radiance * weight
    }

    /// Samples the next direction; `None` ends the path.
    #[inline(always)]
    fn scatter(&self, hit: &Interaction<'_>, sampler: &mut Sampler) -> Option<(BsdfSample, Ray)> {
        let u_lobe = if hit.lobes.single {
            0.0
        } else {
            sampler.next_1d()
        };
        let u = sampler.next_2d();
        let sample = hit
            .bsdf
            .sample(hit.wi, &hit.point, Transport::Radiance, u_lobe, u)?;
        let ray = hit.spawn(sample.direction);
        let agree = !self.strict_normals || sides_agree(hit, sample.direction, ray.direction());
        (agree && !sample.weight.is_black()).then_some((sample, ray))
    }

    /// Russian roulette: ends weak paths, and strengthens those that go on; false ends the path.
    #[inline]
    pub(super) fn survives(&self, depth: u32, walk: &mut Walk<'_>) -> bool {
        if depth < self.rr_depth {
            return true;
        }
        // Without the growth by refraction, which is undone on the way out.
        let energy = walk.throughput.max_channel() / (walk.eta * walk.eta);
        let survival = energy.min(0.95);
        if walk.sampler.next_1d() >= survival {
            return false;
        }
        walk.throughput *= 1.0 / survival;
        true
    }
}

impl PathTracer {
    /// A path that has not left the camera yet.
    #[inline]
    pub(super) fn start<'r>(&self, ray: &Ray, sampler: &'r mut Sampler) -> Walk<'r> {
        Walk {
            estimate: Estimate {
                radiance: Rgb::BLACK,
                alpha: 0.0,
            },
            throughput: Rgb::WHITE,
            eta: 1.0,
            departure: Departure {
                position: ray.origin(),
                density: None,
            },
            sampler,
        }
    }

    /// Whether vertices at the ends of so many edges do no more than [`PathTracer::connect`] and
    /// [`PathTracer::depart`] where they do not glow, whatever their true normals are.
    #[inline]
    pub(super) fn connects_and_departs(&self, depth: u32) -> bool {
        !self.strict_normals && depth < self.max_depth
    }

    /// How the directions of emitters and of materials are weighed.
    #[inline]
    pub(super) fn heuristic(&self) -> Heuristic {
        self.heuristic
    }

    /// Whether paths may have so many edges.
    #[inline]
    pub(super) fn allows(&self, depth: u32) -> bool {
        depth <= self.max_depth
    }

    /// Whether an edge, counted from 1, sees through emitting surfaces.
    #[inline]
    pub(super) fn sees_through_emitters(&self, depth: u32) -> bool {
        depth == 1 && self.hide_emitters
    }

    /// Ends a path whose ray has met no surface.
    ///
    /// - `depth`: edges of the path that ends at the ray's other end.
    #[inline]
    pub(super) fn escape(&self, scene: &Scene, depth: u32, walk: &mut Walk<'_>, ray: &Ray) {
        if !self.sees_through_emitters(depth) {
            let met = self.met_environment(scene, walk, ray.direction());
            walk.estimate.radiance += walk.throughput * met;
        }
    }

    /// Takes the light of a surface that a ray has met by chance; false ends the path.
    ///
    /// - `depth`: edges of the path that ends there.
    #[inline(always)]
    pub(super) fn arrive(
        &self,
        scene: &Scene,
        depth: u32,
        walk: &mut Walk<'_>,
        hit: &Interaction<'_>,
    ) -> bool {
        if let Some(id) = hit.emitter {
            walk.estimate.radiance += walk.throughput * self.met_surface(scene, walk, hit, id);
        }
        let is_last = depth == self.max_depth;
        if is_last {
            walk.estimate.alpha = 1.0;
        }
        !is_last
    }

    /// Samples a direction to an emitter, where the material has a lobe that it can be for.
    ///
    /// What it brings belongs to the estimate, if the ray is free, before the path meets its next
    /// surface.
    #[inline(always)]
    pub(super) fn connect(
        &self,
        scene: &Scene,
        walk: &mut Walk<'_>,
        hit: &Interaction<'_>,
    ) -> Option<Connection> {
        if !hit.lobes.finite {
            return None;
        }
        let u = walk.sampler.next_2d();
        let aim = aim(scene, hit.point.position, u)?;
        let wo = hit.frame.to_local(aim.direction);
        if self.strict_normals && !sides_agree(hit, wo, aim.direction) {
            return None;
        }
        let (value, own) = hit
            .bsdf
            .eval_with_density(hit.wi, wo, &hit.point, Transport::Radiance);
        if value.is_black() {
            return None;
        }
        let weight = if aim.is_dirac {
            1.0
        } else {
            self.heuristic.first_weight(aim.density, own.0)
        };
        let connected = value * aim.radiance * (weight / aim.density);
        Some(Connection {
            ray: shadow_ray(hit, aim.target, aim.direction),
            radiance: walk.throughput * connected,
        })
    }

    /// Leaves a surface in a direction of its material; `None` ends the path.
    ///
    /// - `depth`: edges of the path that ends at the surface.
    #[inline(always)]
    pub(super) fn depart(
        &self,
        depth: u32,
        walk: &mut Walk<'_>,
        hit: &Interaction<'_>,
    ) -> Option<Ray> {
        let scattered = self.scatter(hit, walk.sampler);
        if !matches!(&scattered, Some((sample, _)) if sample.lobe == Lobe::Null) {
            walk.estimate.alpha = 1.0;
        }
        let (sample, ray) = scattered?;
        let departure = Departure {
            position: hit.point.position,
            density: (!sample.lobe.is_dirac()).then_some(sample.density),
        };
        walk.scatter(departure, sample.weight, sample.eta);
        self.survives(depth, walk).then_some(ray)
    }
}

impl PixelIntegrator for PathTracer {
    /// One path alone: the slow twin of [`PathTracer::estimate_all`], which makes the same bits.
    fn estimate(
        &self,
        scene: &Scene,
        camera_ray: &CameraRay,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Estimate {
        let mut ray = camera_ray.to_ray();
        let mut walk = self.start(&ray, sampler);
        for depth in 1..=self.max_depth {
            let is_hidden = self.sees_through_emitters(depth);
            let Some(hit) = first_hit(scene, &mut ray, is_hidden, counters) else {
                self.escape(scene, depth, &mut walk, &ray);
                break;
            };
            if let Some(next) = self.pass_alone(scene, depth, (&mut walk, &ray, &hit)) {
                let Some(next) = next else { break };
                ray = next;
                continue;
            }
            let surface = scene.interaction(&ray, &hit);
            if !self.arrive(scene, depth, &mut walk, &surface) {
                break;
            }
            if let Some(connection) = self.connect(scene, &mut walk, &surface) {
                counters.rays += 1;
                if !scene.accel().is_occluded(&connection.ray) {
                    walk.estimate.radiance += connection.radiance;
                }
            }
            let Some(next) = self.depart(depth, &mut walk, &surface) else {
                break;
            };
            ray = next;
        }
        walk.estimate
    }

    fn estimate_all(
        &self,
        scene: &Scene,
        (rays, samplers): (&[CameraRay], &mut [Sampler]),
        counters: &mut Counters,
    ) -> Vec<Estimate> {
        debug_assert_eq!(rays.len(), samplers.len());
        let mut wave = Wave::new(self, scene, rays.len());
        for (ray, sampler) in rays.iter().zip(samplers) {
            let ray = ray.to_ray();
            wave.add(self.start(&ray, sampler), ray);
        }
        wave.run(counters)
    }
}

/// A sampled direction to an emitter, as far as paths need it.
pub(super) struct Aim {
    pub(super) direction: Vec3,
    /// Where the shadow ray must reach to; `None` for infinity.
    pub(super) target: Option<Vec3>,
    pub(super) radiance: Rgb,
    pub(super) density: f32,
    pub(super) is_dirac: bool,
}

/// Samples a direction to an emitter.
#[inline(always)]
pub(super) fn aim(scene: &Scene, from: Vec3, u: Vec2) -> Option<Aim> {
    let mut aim = None;
    scene.lights().sample_toward_then(from, u, |chosen| {
        aim = Some(Aim {
            direction: chosen.sample.direction,
            target: chosen.sample.target,
            radiance: chosen.sample.radiance,
            density: chosen.sample.density.0,
            is_dirac: chosen.sample.is_dirac,
        });
    });
    aim
}

/// The ray that must be free where a sampled emitter lights a surface.
///
/// - `target`, `direction`: as in [`EmitterSample`](crate::emitter::EmitterSample).
#[inline(always)]
pub(super) fn shadow_ray(hit: &Interaction<'_>, target: Option<Vec3>, direction: Vec3) -> Ray {
    match target {
        Some(target) => hit.point.ray_to(target),
        None => hit.point.ray_toward(direction),
    }
}

/// True when both directions lie on the same side of the true surface as of the shaded one.
fn sides_agree(hit: &Interaction<'_>, local: Local, world: Vec3) -> bool {
    let normal = hit.point.geometric_normal;
    normal.dot(hit.back) * hit.wi.cos() > 0.0 && normal.dot(world) * local.cos() > 0.0
}

/// Mitsuba's depth limits: -1 stands for none.
pub(super) fn depth_limit(depth: i64) -> u32 {
    u32::try_from(depth).unwrap_or(u32::MAX)
}
