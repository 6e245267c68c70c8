//! Direct light.

use super::path::shadow_ray;
use super::pixel::{Estimate, PixelIntegrator, first_surface};
use super::render::Counters;
use crate::bsdf::{BsdfModel, Transport};
use crate::emitter::EmitterModel;
use crate::math::{Rgb, Vec3};
use crate::path::Heuristic;
use crate::random::Sampler;
use crate::scene::options::{OptionError, OptionReader};
use crate::scene::{EmitterId, Interaction, Scene};
use crate::sensor::CameraRay;

/// Light that reaches the camera after one scattering at most, with several samples a camera ray.
///
/// `m` directions to emitters and `n` directions of the material are weighed against each other as
/// techniques of densities `m·p` and `n·p`.
///
/// Source: Veach 1997, Sec. 9.2.
#[derive(Clone, Copy, Debug)]
pub struct Direct {
    emitter_samples: u32,
    bsdf_samples: u32,
    hide_emitters: bool,
    heuristic: Heuristic,
}

impl Direct {
    /// Reads the options `emitter_samples`, `bsdf_samples` (or both as `shading_samples`),
    /// `hide_emitters` and `mis`.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range; no samples at all.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let both = options.integer("shading_samples", 1..=1 << 16, 1)?;
        let emitter_samples = options.integer("emitter_samples", 0..=1 << 16, both)?;
        // Without emitter samples, only the material finds light.
        let least = i64::from(emitter_samples == 0);
        let bsdf_samples = options.integer("bsdf_samples", least..=1 << 16, both)?;
        Ok(Self {
            emitter_samples: emitter_samples as u32,
            bsdf_samples: bsdf_samples as u32,
            hide_emitters: options.boolean("hide_emitters", false)?,
            heuristic: super::heuristic(options)?,
        })
    }

    fn emitter_sample(
        &self,
        scene: &Scene,
        hit: &Interaction<'_>,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Option<Rgb> {
        let u = sampler.next_2d();
        let sample = scene.lights().sample_toward(hit.point.position, u)?.sample;
        let wo = hit.frame.to_local(sample.direction);
        let (value, own) = hit
            .bsdf
            .eval_with_density(hit.wi, wo, &hit.point, Transport::Radiance);
        if value.is_black() {
            return None;
        }
        counters.rays += 1;
        let shadow = shadow_ray(hit, sample.target, sample.direction);
        if scene.accel().is_occluded(&shadow) {
            return None;
        }
        let count = self.emitter_samples as f32;
        let weight = if sample.is_dirac {
            1.0
        } else {
            let own = self.bsdf_samples as f32 * own.0;
            self.heuristic.first_weight(count * sample.density.0, own)
        };
        Some(value * sample.radiance * (weight / (count * sample.density.0)))
    }

    fn bsdf_sample(
        &self,
        scene: &Scene,
        hit: &Interaction<'_>,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Option<Rgb> {
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
        counters.rays += 1;
        let met = scene.intersect(&ray);
        let (radiance, other) = match &met {
            Some(met) => {
                let id = met.emitter?;
                let radiance = scene.lights().get(id).radiance(&met.point, met.back);
                (
                    radiance,
                    self.density_toward(scene, id, hit.point.position, met),
                )
            }
            None => {
                let toward = ray.direction();
                let lights = scene.lights();
                (
                    lights.environment_radiance(toward),
                    lights.environment_density(hit.point.position, toward).0,
                )
            }
        };
        if radiance.is_black() {
            return None;
        }
        let count = self.bsdf_samples as f32;
        let weight = if sample.lobe.is_dirac() {
            1.0
        } else {
            let other = self.emitter_samples as f32 * other;
            self.heuristic.second_weight(other, count * sample.density)
        };
        Some(sample.weight * radiance * (weight / count))
    }

    fn density_toward(
        &self,
        scene: &Scene,
        id: EmitterId,
        from: Vec3,
        met: &Interaction<'_>,
    ) -> f32 {
        scene.lights().density_toward(id, from, &met.point).0
    }
}

impl PixelIntegrator for Direct {
    fn estimate(
        &self,
        scene: &Scene,
        camera_ray: &CameraRay,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Estimate {
        let ray = camera_ray.to_ray();
        let Some(hit) = first_surface(scene, ray, self.hide_emitters, counters) else {
            let seen = scene.lights().environment_radiance(ray.direction());
            let radiance = if self.hide_emitters { Rgb::BLACK } else { seen };
            return Estimate {
                radiance,
                alpha: 0.0,
            };
        };
        let mut radiance = match hit.emitter {
            Some(id) => scene.lights().get(id).radiance(&hit.point, hit.back),
            None => Rgb::BLACK,
        };
        if hit.lobes.finite {
            for _ in 0..self.emitter_samples {
                radiance += self
                    .emitter_sample(scene, &hit, sampler, counters)
                    .unwrap_or_default();
            }
        }
        for _ in 0..self.bsdf_samples {
            radiance += self
                .bsdf_sample(scene, &hit, sampler, counters)
                .unwrap_or_default();
        }
        Estimate {
            radiance,
            alpha: 1.0,
        }
    }
}
