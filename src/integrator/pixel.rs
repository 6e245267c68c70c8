//! Integrators that estimate the radiance along camera rays.

use super::Algorithm;
use super::aov::{self, Aov};
use super::camera::{CameraSamples, SampledWindow, mean_over_film, sample_of_film};
use super::render::{Counters, Driver, Integrator};
use crate::accel::{Hit, Ray};
use crate::film::{Canvas, Filter, Layer, PassBuffer, Tile, Unit, Window};
use crate::math::{Rgb, Vec2};
use crate::random::{Purpose, Sampler, SamplerKind};
use crate::scene::{Interaction, Scene};
use crate::sensor::{CameraRay, Sensor};

/// Estimate of the radiance along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Radiance in W·m⁻²·sr⁻¹.
    pub radiance: Rgb,
    /// One where the ray met something that is not invisible, else zero.
    pub alpha: f32,
}

/// An algorithm that estimates the radiance along one camera ray at a time.
pub trait PixelIntegrator: Send + Sync {
    /// Estimates the radiance that arrives along a ray.
    ///
    /// - `sampler`: the numbers of this camera sample, those of the ray itself already taken.
    fn estimate(
        &self,
        scene: &Scene,
        ray: &CameraRay,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Estimate;

    /// Estimates the radiance along many rays: the same as [`PixelIntegrator::estimate`] for each.
    ///
    /// - `samplers`: one for each ray, the numbers of the rays themselves already taken.
    fn estimate_all(
        &self,
        scene: &Scene,
        (rays, samplers): (&[CameraRay], &mut [Sampler]),
        counters: &mut Counters,
    ) -> Vec<Estimate> {
        rays.iter()
            .zip(samplers)
            .map(|(ray, sampler)| self.estimate(scene, ray, sampler, counters))
            .collect()
    }
}

/// The first surface that a camera ray meets.
///
/// - `hide_emitters`: pass through surfaces that emit, as if they were not there.
#[inline(always)]
pub(super) fn first_surface<'s>(
    scene: &'s Scene,
    mut ray: Ray,
    hide_emitters: bool,
    counters: &mut Counters,
) -> Option<Interaction<'s>> {
    let hit = first_hit(scene, &mut ray, hide_emitters, counters)?;
    Some(scene.interaction(&ray, &hit))
}

/// The first hit of a ray.
///
/// - `hide_emitters`: pass through surfaces that emit; `ray` becomes what is left of it.
#[inline(always)]
pub(super) fn first_hit(
    scene: &Scene,
    ray: &mut Ray,
    hide_emitters: bool,
    counters: &mut Counters,
) -> Option<Hit> {
    if hide_emitters {
        first_dark_hit(scene, ray, counters)
    } else {
        counters.rays += 1;
        scene.hit(ray)
    }
}

/// [`first_hit`] on surfaces that do not emit.
///
/// Out of line, so that the loop of a path has one intersection.
#[inline(never)]
fn first_dark_hit(scene: &Scene, ray: &mut Ray, counters: &mut Counters) -> Option<Hit> {
    loop {
        counters.rays += 1;
        let hit = scene.hit(ray)?;
        let surface = scene.interaction(ray, &hit);
        if surface.emitter.is_none() {
            return Some(hit);
        }
        let direction = ray.direction();
        let left = ray.far() - hit.distance;
        *ray = Ray::new(surface.point.ray_origin(direction), direction).between(0.0, left);
    }
}

/// How camera samples are made, and which layers they fill.
#[derive(Clone, Debug)]
pub struct PixelSettings {
    /// The render's seed.
    pub seed: u64,
    /// Width and height of the full film, in pixels: random numbers go by a pixel's place on it, so
    /// that a window shows what the whole picture shows there.
    pub film_size: (u32, u32),
    /// The pixels to render.
    pub window: Window,
    /// Reconstruction filter.
    pub filter: Filter,
    /// How the samples of a pixel are spread.
    pub sampler: SamplerKind,
    /// Whether the image has an alpha channel.
    pub alpha: bool,
    /// Whether a layer holds the mean of the squared samples.
    pub second_moment: bool,
    /// Layers that describe the first surface.
    pub aovs: Vec<Aov>,
    /// Layers of the algorithm's own that are wanted, by name.
    pub own_layers: Vec<String>,
}

/// A render by a [`PixelIntegrator`]: every pass makes one camera sample in every pixel.
pub struct PixelRender<'s> {
    scene: &'s Scene,
    sensor: &'s Sensor,
    integrator: &'s dyn PixelIntegrator,
    settings: PixelSettings,
    unit: Unit,
    /// The pixels that get samples: the window and the filter's border around it.
    sampled: SampledWindow,
}

impl<'s> PixelRender<'s> {
    /// Prepares a render: makes the small estimate that fixes the film's unit.
    pub fn new(
        scene: &'s Scene,
        sensor: &'s Sensor,
        integrator: &'s dyn PixelIntegrator,
        settings: PixelSettings,
    ) -> Self {
        let sampled = SampledWindow::new(&settings);
        let unit = Unit::for_magnitude(1.0);
        let mut render = Self {
            scene,
            sensor,
            integrator,
            settings,
            unit,
            sampled,
        };
        render.unit = Unit::for_magnitude(render.mean_luminance());
        render
    }

    /// Mean luminance, for the film's unit.
    fn mean_luminance(&self) -> f64 {
        let mut counters = Counters::default();
        mean_over_film(|place| {
            let purpose = Purpose::FilmUnit;
            let mut sample = sample_of_film(self.sensor, &self.settings, purpose, place);
            let estimate = self.integrator.estimate(
                self.scene,
                &sample.ray,
                &mut sample.sampler,
                &mut counters,
            );
            f64::from(estimate.radiance.luminance())
        })
    }

    /// Makes one camera sample in every pixel of a unit.
    fn run_unit(&self, pass: u32, unit: u32, layers: &[PassBuffer]) -> Counters {
        let mut counters = Counters::default();
        let block = self.sampled.block(unit);
        let CameraSamples {
            rasters,
            rays,
            mut samplers,
        } = CameraSamples::of_block(self.sensor, &self.settings, block, pass);
        let samples = (&rays[..], &mut samplers[..]);
        let estimates = self
            .integrator
            .estimate_all(self.scene, samples, &mut counters);
        counters.paths += estimates.len() as u64;
        let filter = &self.settings.filter;
        // Samples stay in their own pixels where the filter keeps them there.
        let is_sole = filter.is_pixel_box();
        let tiles = layers.iter();
        let tiles = tiles.map(|layer| block.tile(layer, filter.border(), is_sole));
        let tiles: Vec<_> = tiles.collect();
        for ((ray, raster), estimate) in rays.iter().zip(rasters).zip(&estimates) {
            self.add((ray, raster), estimate, &tiles, &mut counters);
        }
        counters
    }

    /// Adds one camera sample to all layers.
    fn add(
        &self,
        (ray, raster): (&CameraRay, Vec2),
        estimate: &Estimate,
        layers: &[Tile<'_>],
        counters: &mut Counters,
    ) {
        let settings = &self.settings;
        let [r, g, b] = estimate.radiance.to_array();
        let mut layers = layers.iter();
        let mut next_layer = || layers.next().expect("one tile for each layer");
        if settings.alpha {
            next_layer().add(&settings.filter, raster, [r, g, b, estimate.alpha]);
        } else {
            next_layer().add(&settings.filter, raster, [r, g, b]);
        }
        if settings.second_moment {
            next_layer().add(&settings.filter, raster, [r * r, g * g, b * b]);
        }
        if !settings.aovs.is_empty() {
            counters.rays += 1;
            let first = self.scene.intersect(&ray.to_ray());
            aov::add_all(
                settings,
                self.scene,
                first.as_ref(),
                raster,
                layers.as_slice(),
            );
        }
    }
}

impl Integrator for PixelRender<'_> {
    fn layers(&self) -> Vec<Layer> {
        let mut layers = vec![Layer::new(
            "",
            if self.settings.alpha { "RGBA" } else { "RGB" },
        )];
        if self.settings.second_moment {
            layers.push(Layer::new("moment2", "RGB"));
        }
        layers.extend(self.settings.aovs.iter().map(|aov| aov.layer()));
        layers
    }

    fn units(&self) -> Vec<Unit> {
        let mut units = vec![self.unit];
        if self.settings.second_moment {
            units.push(Unit::for_magnitude(
                (self.unit.value() * 2.0_f64.powi(32)).powi(2),
            ));
        }
        let bounds = self.scene.bounds();
        units.extend(self.settings.aovs.iter().map(|aov| aov.unit(bounds)));
        units
    }

    fn window(&self) -> Window {
        self.settings.window
    }

    fn passes_per_replica(&self) -> u32 {
        self.settings.sampler.group()
    }

    fn unit_count(&self) -> u32 {
        self.sampled.unit_count()
    }

    fn run_pass(&self, pass: u32, layers: &[PassBuffer], driver: &Driver<'_>) -> Option<Counters> {
        driver.run_units(self.unit_count(), |unit| self.run_unit(pass, unit, layers))
    }
}

impl Algorithm for Box<dyn PixelIntegrator> {
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's> {
        Box::new(PixelRender::new(scene, sensor, &**self, settings))
    }
}
