//! The passes of bidirectional path tracing.

use super::Bdpt;
use super::layers::TechniqueLayers;
use crate::film::{Canvas, Layer, PassBuffer, Unit, Window};
use crate::integrator::aov;
use crate::integrator::camera::{
    CameraSample, SampledWindow, mean_over_film, pixel_index, sample_of_film,
};
use crate::integrator::pixel::PixelSettings;
use crate::integrator::render::{Counters, Driver, Integrator};
use crate::math::{Rgb, Vec2};
use crate::path::{Bidirection, Bidirectional, Connection, LightImage, PathSpace};
use crate::random::{PixelAddress, Purpose, Sampler, SamplerKind};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// A render by subpaths from both sides: every pass makes one camera sample in each pixel that counts, and
/// one light subpath for each pixel of the *full* film and its border.
///
/// What a light subpath shows lands anywhere. For a window to show what the whole film shows there, the light
/// subpaths of all pixels are traced, also of those outside of the window: they get no camera samples.
pub(super) struct BidirectionalRender<'s> {
    scene: &'s Scene,
    sensor: &'s Sensor,
    bdpt: &'s Bdpt,
    settings: PixelSettings,
    tracing: Bidirectional,
    /// The full film with its border.
    film: SampledWindow,
    /// The pixels that get camera samples.
    sampled: SampledWindow,
    image: LightImage,
    /// Where what each technique brings lands.
    techniques: Option<TechniqueLayers>,
    unit: Unit,
}

/// Working memory of a unit of work.
struct Worker<'s> {
    space: PathSpace<'s>,
    sample: Bidirection<'s>,
}

impl<'s> BidirectionalRender<'s> {
    /// Prepares a render: makes the small estimate that fixes the film's unit and what connections are weak.
    pub(super) fn new(
        scene: &'s Scene,
        sensor: &'s Sensor,
        bdpt: &'s Bdpt,
        settings: PixelSettings,
    ) -> Self {
        let (width, height) = settings.film_size;
        let film = SampledWindow::new(&PixelSettings {
            window: Window::full(width, height),
            ..settings.clone()
        });
        let mut render = Self {
            scene,
            sensor,
            bdpt,
            tracing: bdpt.tracing,
            film,
            sampled: SampledWindow::new(&settings),
            image: LightImage {
                paths: f64::from(film.width) * f64::from(film.height),
                low: film.corners().0,
                high: film.corners().1,
            },
            unit: Unit::for_magnitude(1.0),
            techniques: (!settings.own_layers.is_empty())
                .then(|| TechniqueLayers::new(bdpt.technique_edges, 1)),
            settings,
        };
        let mean = render.mean_luminance();
        render.unit = Unit::for_magnitude(mean);
        render.tracing.connection_threshold = (bdpt.connection_roulette * mean) as f32;
        render
    }

    /// Mean luminance, for the film's unit and for weak connections.
    fn mean_luminance(&self) -> f64 {
        let mut worker = self.worker();
        mean_over_film(|place| {
            let purpose = Purpose::FilmUnit;
            let mut camera = sample_of_film(self.sensor, &self.settings, purpose, place);
            let address = PixelAddress {
                seed: self.settings.seed,
                purpose: Purpose::Light,
                pixel: place.0,
                sample: u32::MAX,
            };
            let mut light = Sampler::new(SamplerKind::Independent, address);
            let mut total = Rgb::BLACK;
            self.trace(&mut worker, &mut camera, &mut light, |path| {
                total += path.energy();
            });
            f64::from(total.luminance())
        })
    }

    fn worker(&self) -> Worker<'s> {
        Worker {
            space: PathSpace::new(self.scene, self.sensor, self.bdpt.rules),
            sample: Bidirection::default(),
        }
    }

    /// Hands out the paths of a sample.
    fn trace(
        &self,
        worker: &mut Worker<'s>,
        camera: &mut CameraSample,
        light: &mut Sampler,
        mut add: impl FnMut(&Connection),
    ) {
        let Worker { space, sample } = worker;
        let seen = (camera.raster, &camera.ray);
        if self.bdpt.light_only {
            self.trace_light(space, sample, light, add);
        } else {
            let samplers = [&mut camera.sampler, light];
            self.tracing.trace(
                space,
                sample,
                seen,
                &self.image,
                samplers,
                &mut |_, path| add(path),
            );
        }
    }

    /// Hands out the paths that a light subpath alone makes.
    fn trace_light(
        &self,
        space: &PathSpace<'s>,
        sample: &mut Bidirection<'s>,
        light: &mut Sampler,
        mut add: impl FnMut(&Connection),
    ) {
        let alone = self.bdpt.light_only;
        self.tracing
            .trace_image(space, sample, &self.image, light, alone, &mut |_, path| {
                add(path);
            });
    }

    /// Makes the samples of a unit of work.
    fn run_unit(&self, pass: u32, unit: u32, layers: &[PassBuffer]) -> Counters {
        let mut worker = self.worker();
        let mut counters = Counters::default();
        for pixel in self.film.block(unit).pixels() {
            let is_sampled = self.sampled.contains(pixel);
            if is_sampled || self.tracing.techniques.light_image {
                self.run_pixel(pass, pixel, is_sampled, (&mut worker, layers));
                counters.paths += u64::from(is_sampled);
            }
        }
        counters.rays = worker.space.rays();
        counters
    }

    /// Makes the sample of a pixel.
    ///
    /// - `is_sampled`: whether it gets a camera sample.
    fn run_pixel(
        &self,
        pass: u32,
        pixel: (i32, i32),
        is_sampled: bool,
        (worker, layers): (&mut Worker<'s>, &[PassBuffer]),
    ) {
        let settings = &self.settings;
        let address = PixelAddress {
            seed: settings.seed,
            purpose: Purpose::Light,
            pixel: pixel_index(settings, pixel.0, pixel.1),
            sample: pass,
        };
        let mut light = Sampler::new(settings.sampler, address);
        if !is_sampled {
            let Worker { space, sample } = worker;
            self.trace_light(space, sample, &mut light, |path| {
                self.land_path(layers, path);
            });
            return;
        }
        let mut camera = CameraSample::of_pixel(self.sensor, settings, pixel, Purpose::Pixel, pass);
        let raster = camera.raster;
        let mut radiance = Rgb::BLACK;
        self.trace(worker, &mut camera, &mut light, |path| {
            if path.eye == 0 {
                self.land_path(layers, path);
                return;
            }
            radiance += path.energy();
            if let Some(techniques) = self.techniques {
                techniques.land(layers, &settings.filter, path);
            }
        });
        if !self.bdpt.light_only {
            self.land(layers, raster, radiance, worker.sample.eye.alpha);
        } else if settings.alpha {
            let Worker { space, sample } = worker;
            let seen = (raster, &camera.ray);
            let alpha = self.tracing.alpha(space, sample, seen, &mut camera.sampler);
            self.land(layers, raster, Rgb::BLACK, alpha);
        }
        if !settings.aovs.is_empty() {
            let first = worker.space.meet(camera.ray.to_ray(), false);
            let aovs = &layers[1 + self.technique_count()..];
            aov::add_all(settings, worker.space.scene, first.as_ref(), raster, aovs);
        }
    }

    /// Number of layers of techniques.
    fn technique_count(&self) -> usize {
        self.techniques.map_or(0, TechniqueLayers::count)
    }

    /// Lets what a light subpath shows land on the film.
    fn land_path(&self, layers: &[PassBuffer], path: &Connection) {
        self.land(layers, path.raster, path.energy(), 0.0);
        if let Some(techniques) = self.techniques {
            techniques.land(layers, &self.settings.filter, path);
        }
    }

    /// Lets light land on the film.
    #[inline]
    fn land(&self, layers: &[PassBuffer], raster: Vec2, light: Rgb, alpha: f32) {
        let [r, g, b] = light.to_array();
        if self.settings.alpha {
            layers[0].add(&self.settings.filter, raster, [r, g, b, alpha]);
        } else {
            layers[0].add(&self.settings.filter, raster, [r, g, b]);
        }
    }
}

impl Integrator for BidirectionalRender<'_> {
    fn layers(&self) -> Vec<Layer> {
        let beauty = if self.settings.alpha { "RGBA" } else { "RGB" };
        let mut layers = vec![Layer::new("", beauty)];
        let techniques = self.techniques.into_iter();
        layers.extend(techniques.flat_map(TechniqueLayers::layers));
        layers.extend(self.settings.aovs.iter().map(|aov| aov.layer()));
        layers
    }

    fn units(&self) -> Vec<Unit> {
        let mut units = vec![self.unit; 1 + self.technique_count()];
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
        self.film.unit_count()
    }

    fn run_pass(&self, pass: u32, layers: &[PassBuffer], driver: &Driver<'_>) -> Option<Counters> {
        driver.run_units(self.unit_count(), |unit| self.run_unit(pass, unit, layers))
    }
}
