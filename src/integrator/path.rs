//! Path tracing.

use super::pixel::{Estimate, PixelIntegrator, first_surface};
use super::render::Counters;
use crate::accel::Ray;
use crate::bsdf::{BsdfModel, BsdfSample, Lobe, Transport};
use crate::emitter::{EmitterModel, EmitterSample};
use crate::math::{Local, Rgb, Vec3};
use crate::path::Heuristic;
use crate::random::Sampler;
use crate::scene::options::{OptionError, OptionReader};
use crate::scene::{Interaction, Scene};
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

/// How the last direction was made, for weighing the emitter that it meets.
#[derive(Clone, Copy)]
struct Departure {
    /// Where the ray left from.
    position: Vec3,
    /// Density of its direction in 1/sr; `None` for the camera and Dirac lobes, whose directions no
    /// other technique makes.
    density: Option<f32>,
}

/// What a path carries along.
struct Walk {
    throughput: Rgb,
    /// Product of [`BsdfSample::eta`] over the events so far: refraction has made radiance grow by
    /// its square.
    eta: f32,
    departure: Departure,
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
    fn met_environment(&self, scene: &Scene, walk: &Walk, toward: Vec3) -> Rgb {
        let radiance = scene.lights().environment_radiance(toward);
        let weight = walk.departure.density.map_or(1.0, |own| {
            let from = walk.departure.position;
            let other = scene.lights().environment_density(from, toward).0;
            self.heuristic.second_weight(other, own)
        });
        radiance * weight
    }

    /// Light of a surface that a ray meets by chance.
    fn met_surface(&self, scene: &Scene, walk: &Walk, hit: &Interaction<'_>) -> Rgb {
        let Some(id) = hit.emitter else {
            return Rgb::BLACK;
        };
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

    /// Light that a sampled direction to an emitter brings.
    fn connected(
        &self,
        scene: &Scene,
        hit: &Interaction<'_>,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Rgb {
        let u = sampler.next_2d();
        let Some(chosen) = scene.lights().sample_toward(hit.point.position, u) else {
            return Rgb::BLACK;
        };
        let sample = chosen.sample;
        let wo = hit.frame.to_local(sample.direction);
        if self.strict_normals && !sides_agree(hit, wo, sample.direction) {
            return Rgb::BLACK;
        }
        let (value, own) = hit
            .bsdf
            .eval_with_density(hit.wi, wo, &hit.point, Transport::Radiance);
        if value.is_black() {
            return Rgb::BLACK;
        }
        counters.rays += 1;
        if !is_lit(scene, hit, &sample) {
            return Rgb::BLACK;
        }
        let weight = if sample.is_dirac {
            1.0
        } else {
            self.heuristic.first_weight(sample.density.0, own.0)
        };
        value * sample.radiance * (weight / sample.density.0)
    }

    /// Samples the next direction; `None` ends the path.
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
    fn survives(&self, depth: u32, walk: &mut Walk, sampler: &mut Sampler) -> bool {
        if depth < self.rr_depth {
            return true;
        }
        // Without the growth by refraction, which is undone on the way out.
        let energy = walk.throughput.max_channel() / (walk.eta * walk.eta);
        let survival = energy.min(0.95);
        if sampler.next_1d() >= survival {
            return false;
        }
        walk.throughput *= 1.0 / survival;
        true
    }
}

impl PixelIntegrator for PathTracer {
    fn estimate(
        &self,
        scene: &Scene,
        camera_ray: &CameraRay,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Estimate {
        let mut estimate = Estimate {
            radiance: Rgb::BLACK,
            alpha: 0.0,
        };
        let mut ray = camera_ray.to_ray();
        let mut walk = Walk {
            throughput: Rgb::WHITE,
            eta: 1.0,
            departure: Departure {
                position: ray.origin(),
                density: None,
            },
        };
        // `depth` counts the edges of the path that ends at the ray's other end.
        for depth in 1..=self.max_depth {
            let is_hidden = depth == 1 && self.hide_emitters;
            let Some(hit) = first_surface(scene, ray, is_hidden, counters) else {
                if !is_hidden {
                    let met = self.met_environment(scene, &walk, ray.direction());
                    estimate.radiance += walk.throughput * met;
                }
                break;
            };
            estimate.radiance += walk.throughput * self.met_surface(scene, &walk, &hit);
            if depth == self.max_depth {
                estimate.alpha = 1.0;
                break;
            }
            if hit.lobes.finite {
                let connected = self.connected(scene, &hit, sampler, counters);
                estimate.radiance += walk.throughput * connected;
            }
            let scattered = self.scatter(&hit, sampler);
            if !matches!(&scattered, Some((sample, _)) if sample.lobe == Lobe::Null) {
                estimate.alpha = 1.0;
            }
            let Some((sample, next)) = scattered else {
                break;
            };
            ray = next;
            walk.throughput *= sample.weight;
            walk.eta *= sample.eta;
            let density = (!sample.lobe.is_dirac()).then_some(sample.density);
            walk.departure = Departure {
                position: hit.point.position,
                density,
            };
            if !self.survives(depth, &mut walk, sampler) {
                break;
            }
        }
        estimate
    }
}

/// True when nothing stands between a surface and the emitter that was sampled.
#[inline(always)]
pub(super) fn is_lit(scene: &Scene, hit: &Interaction<'_>, sample: &EmitterSample) -> bool {
    match sample.target {
        Some(target) => scene.is_visible(&hit.point, target),
        None => scene.is_visible_to_infinity(&hit.point, sample.direction),
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
