//! The energy that a chain deposits at each step.

use rayon::prelude::*;

use super::SeedOptions;
use crate::integrator::camera::sample_of_film;
use crate::integrator::pixel::PixelSettings;
use crate::path::{Bidirection, LightImage, Path, PathSpace};
use crate::random::{PixelAddress, Purpose, Sampler, SamplerKind};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// Means over camera samples all over the film, zeros included, as luminance.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::integrator) struct MeanEnergy {
    /// Of all paths.
    pub(in crate::integrator) image: f64,
    /// Of the paths whose energy goes to chains.
    pub(in crate::integrator) chains: f64,
}

/// Samples a pixel, where no number is given.
const SAMPLES_PER_PIXEL: u32 = 4;

/// Most samples, where no number is given: more would not make rendering faster.
const MOST_SAMPLES: u32 = 1 << 20;

impl MeanEnergy {
    /// Estimates the energies from samples that serve nothing else.
    ///
    /// Depends on scene, options and seed alone. A poor estimate changes the time of the render, never
    /// its mean.
    pub(super) fn estimate(
        seeds: &SeedOptions,
        scene: &Scene,
        sensor: &Sensor,
        settings: &PixelSettings,
    ) -> Self {
        let (width, height) = settings.film_size;
        let wanted = seeds.luminance_samples.unwrap_or_else(|| {
            let pixels = width.saturating_mul(height);
            pixels.saturating_mul(SAMPLES_PER_PIXEL).min(MOST_SAMPLES)
        });
        let side = wanted.isqrt().max(1);
        // One slot a row, summed in order: the same bits for any number of threads.
        let rows: Vec<Self> = (0..side)
            .into_par_iter()
            .with_max_len(1)
            .map(|row| {
                let space = PathSpace::new(scene, sensor, seeds.rules);
                let mut path = Path::default();
                let mut sum = Self::default();
                for column in 0..side {
                    let cell = (row * side + column, side);
                    sum.add_sample(seeds, &space, &mut path, settings, cell);
                }
                sum
            })
            .collect();
        let count = f64::from(side) * f64::from(side);
        let sum = |of: fn(&Self) -> f64| rows.iter().map(of).sum::<f64>() / count;
        Self {
            image: sum(|row| row.image),
            chains: sum(|row| row.chains),
        }
    }

    fn add_sample(
        &mut self,
        seeds: &SeedOptions,
        space: &PathSpace<'_>,
        path: &mut Path,
        settings: &PixelSettings,
        cell: (u32, u32),
    ) {
        let mut sample = sample_of_film(space.sensor, settings, Purpose::DepositionEnergy, cell);
        let camera = (sample.raster, &sample.ray);
        // Beams without width are not found from the sensor.
        let both_sides = seeds.both_sides;
        if let Some(tracing) = both_sides.filter(|_| space.scene.lights().has_beams()) {
            let address = PixelAddress {
                seed: settings.seed,
                purpose: Purpose::Beam,
                pixel: cell.0,
                sample: u32::MAX,
            };
            let mut light = Sampler::new(SamplerKind::Independent, address);
            let image = LightImage::of_film(settings.film_size);
            let samplers = [&mut sample.sampler, &mut light];
            let both = &mut Bidirection::default();
            tracing.trace(space, both, camera, &image, samplers, &mut |_, made| {
                let luminance = f64::from(made.energy().luminance());
                self.add_path(seeds, made.edges() as u32, luminance);
            });
            return;
        }
        let numbers = &mut sample.sampler;
        seeds
            .tracing
            .trace(space, path, camera, numbers, &mut |found| {
                self.add_path(seeds, found.edges, found.luminance());
            });
    }

    fn add_path(&mut self, seeds: &SeedOptions, edges: u32, luminance: f64) {
        if !luminance.is_finite() {
            return;
        }
        self.image += luminance;
        if seeds.goes_to_chains(edges) {
            self.chains += luminance;
        }
    }

    /// Energy of a deposit such that a camera sample leads to a number of deposits in the mean.
    ///
    /// Falls back to the mean luminance of the image, and to one, where no energy was found.
    ///
    /// Source: Cline et al. 2005, Sec. 3.2.
    pub(super) fn deposit(&self, mutations_per_sample: f64) -> f64 {
        [self.chains, self.image, 1.0]
            .into_iter()
            .find(|energy| *energy > 0.0 && energy.is_finite())
            .unwrap_or(1.0)
            / mutations_per_sample
    }
}
