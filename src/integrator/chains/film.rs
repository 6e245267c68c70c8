//! The film of a render by chains: camera samples, seeds, and where their energy lands.

use super::energy::MeanEnergy;
use super::{Landing, Places, SeedOptions};
use crate::film::{Canvas, Layer, PassBuffer, Tile, Unit};
use crate::integrator::aov;
use crate::integrator::camera::{Block, CameraSample, SampledWindow};
use crate::integrator::pixel::PixelSettings;
use crate::math::{Rgb, Vec2, warp};
use crate::mutation::RasterDomain;
use crate::path::{Found, Path, PathSpace, PathTracing, camera_sample};
use crate::random::{Numbers, Purpose, SamplerKind};
use crate::scene::Scene;
use crate::sensor::{CameraRay, Sensor, SensorModel};

/// How far around a block chains keep a tile, in pixels. A hundred moves, uniform in a square of nine pixels, end 26
/// pixels away along an axis in the root of the mean square.
const ROAM: u32 = 24;

/// Everything of a render that does not depend on how chains run.
pub(in crate::integrator) struct ChainFilm<'s> {
    scene: &'s Scene,
    pub(in crate::integrator) sensor: &'s Sensor,
    pub(in crate::integrator) seeds: &'s SeedOptions,
    pub(in crate::integrator) settings: PixelSettings,
    pub(in crate::integrator) sampled: SampledWindow,
    /// Where paths are seen.
    pub(in crate::integrator) domain: RasterDomain,
    /// The part of it where paths are moved: without positions that are second names of directions.
    pub(in crate::integrator) moves: RasterDomain,
    /// The estimate that fixes the energy of a deposit.
    pub(in crate::integrator) mean: MeanEnergy,
    /// Energy of a deposit, as luminance.
    pub(in crate::integrator) deposit: f64,
    pub(in crate::integrator) places: Places,
    pub(in crate::integrator) layers: Vec<Layer>,
    unit: Unit,
}

impl<'s> ChainFilm<'s> {
    /// Prepares a render: makes the estimate that fixes the energy of a deposit and the film's unit.
    pub(in crate::integrator) fn new(
        scene: &'s Scene,
        sensor: &'s Sensor,
        seeds: &'s SeedOptions,
        settings: PixelSettings,
    ) -> Self {
        let mean = MeanEnergy::estimate(seeds, scene, sensor, &settings);
        let sampled = SampledWindow::new(&settings);
        let low = Vec2::new(sampled.x as f32, sampled.y as f32);
        let size = Vec2::new(sampled.width as f32, sampled.height as f32);
        let (layers, places) = Places::new(seeds, &settings);
        let domain = RasterDomain {
            low,
            high: low + size,
        };
        Self {
            scene,
            sensor,
            seeds,
            sampled,
            domain,
            moves: sensor.raster_range().map_or(domain, |film| RasterDomain {
                low: low.max(Vec2::ZERO),
                high: domain.high.min(film),
            }),
            deposit: seeds.deposit(&mean),
            unit: Unit::for_magnitude(mean.image),
            mean,
            places,
            layers,
            settings,
        }
    }

    /// The space of paths, with a count of rays of its own.
    pub(in crate::integrator) fn space(&self) -> PathSpace<'s> {
        PathSpace::new(self.scene, self.sensor, self.seeds.rules)
    }

    /// Raster position of a point of the unit square, stretched over where paths are seen.
    #[inline]
    pub(in crate::integrator) fn raster_of(&self, place: Vec2) -> Vec2 {
        warp::stretch(place, self.domain.low, self.domain.high)
    }

    /// Traces a camera sample whose place is a point of the unit square, stretched over where paths are seen; hands
    /// out every path whose energy goes to chains. Returns where the sample is seen.
    ///
    /// - `max_depth`: largest number of edges, beside the option's limit.
    #[inline]
    pub(in crate::integrator) fn trace_at(
        &self,
        place: Vec2,
        (space, path): (&PathSpace<'_>, &mut Path),
        max_depth: u32,
        numbers: &mut impl Numbers,
        found: &mut impl FnMut(Found<'_>),
    ) -> Vec2 {
        let raster = self.raster_of(place);
        let ray = camera_sample(space, raster, numbers);
        let tracing = PathTracing {
            max_depth: max_depth.min(self.seeds.tracing.max_depth),
            ..self.seeds.tracing
        };
        tracing.trace(space, path, (raster, &ray), numbers, &mut |path| {
            if self.seeds.goes_to_chains(path.edges) {
                found(path);
            }
        });
        raster
    }

    /// Where energy lands.
    pub(in crate::integrator) fn landing<'a>(&'a self, layers: &'a [PassBuffer]) -> Landing<'a> {
        let places = self.places;
        let layer = |place: Option<usize>| place.map(|place| &layers[place]);
        Landing {
            filter: &self.settings.filter,
            redistributed: &layers[places.redistributed],
            tile: None,
            filtered: layer(places.filtered),
            proposals: layer(places.proposals),
            acceptance: layer(places.acceptance),
            importance: None,
            consecutive_limit: self.seeds.noise_filter.consecutive_limit(),
        }
    }

    /// A tile of what chains make: a block's pixels, and those around where its chains go.
    pub(in crate::integrator) fn tile<'b>(
        &self,
        block: Block,
        layers: &'b [PassBuffer],
    ) -> Tile<'b> {
        block.tile(&layers[self.places.redistributed], ROAM, false)
    }

    /// Traces the camera sample of a pixel, and the further ones of direct light; hands out every path whose
    /// energy goes to chains. Returns where the sample is seen.
    ///
    /// Seeds from both sides may be seen elsewhere.
    ///
    /// - `path`: working memory.
    /// - `spread`: spreads the energy of a seed; false where it cannot, so that it lands where it is.
    pub(in crate::integrator) fn sample_pixel(
        &self,
        pixel: (i32, i32),
        pass: u32,
        (space, path): (&PathSpace<'_>, &mut Path),
        layers: &[PassBuffer],
        mut spread: impl FnMut(&Path, f64) -> bool,
    ) -> Vec2 {
        let settings = &self.settings;
        let mut sample = CameraSample::of_pixel(self.sensor, settings, pixel, Purpose::Pixel, pass);
        let raster = sample.raster;
        let landing = self.landing(layers);
        let mut direct = Rgb::BLACK;
        let mut take = |shown: Option<Vec2>, found: Found<'_>| {
            if !self.seeds.goes_to_chains(found.edges) {
                match (shown, self.places.direct) {
                    (Some(raster), Some(place)) => {
                        let value = (found.energy * self.direct_weight()).to_array();
                        layers[place].add(&settings.filter, raster, value);
                    }
                    _ => direct += found.energy,
                }
                return;
            }
            let energy = found.luminance();
            let seed = found.path.filter(|_| energy > 0.0 && energy.is_finite());
            if !seed.is_some_and(|seed| spread(seed, energy)) {
                landing.land_unmoved(shown.unwrap_or(raster), found.energy);
            }
        };
        let alpha = match &self.seeds.both_sides {
            Some(tracing) => {
                let workers = (space, &mut *path);
                let place = (pixel, pass);
                self.trace_pixel_from_both_sides(tracing, place, workers, &mut sample, &mut take)
            }
            None => {
                let (camera, tracing) = ((raster, &sample.ray), &self.seeds.tracing);
                let mut take = |found: Found<'_>| take(None, found);
                tracing.trace(space, path, camera, &mut sample.sampler, &mut take)
            }
        };
        if let Some(place) = self.places.direct {
            let value = (direct * self.direct_weight()).to_array();
            layers[place].add(&settings.filter, raster, value);
        }
        if settings.alpha {
            layers[0].add(&settings.filter, raster, [0.0, 0.0, 0.0, alpha]);
        }
        self.add_aovs((raster, &sample.ray), space, layers);
        self.sample_direct(pixel, pass, (space, path), layers, self.direct_weight());
        raster
    }

    /// Describes the first surface of a camera sample.
    fn add_aovs(
        &self,
        (raster, ray): (Vec2, &CameraRay),
        space: &PathSpace<'_>,
        layers: &[PassBuffer],
    ) {
        if !self.settings.aovs.is_empty() {
            let first = space.meet(ray.to_ray(), false);
            let aovs = &layers[self.places.first_aov..];
            aov::add_all(&self.settings, self.scene, first.as_ref(), raster, aovs);
        }
    }

    /// Weight of each of a pixel's samples of direct light in a pass: its own camera sample and the
    /// further ones.
    fn direct_weight(&self) -> f32 {
        1.0 / (self.seeds.direct_samples.unwrap_or(0) + 1) as f32
    }

    /// Whether pixels need camera samples where seeds do not come from them.
    pub(in crate::integrator) fn needs_pixels(&self) -> bool {
        self.places.direct.is_some() || self.settings.alpha || !self.settings.aovs.is_empty()
    }

    /// Makes what chains do not make, where seeds do not come from pixels: direct light, coverage, and what
    /// describes the first surface.
    pub(in crate::integrator) fn sample_apart(
        &self,
        pixel: (i32, i32),
        pass: u32,
        (space, path): (&PathSpace<'_>, &mut Path),
        layers: &[PassBuffer],
    ) {
        let settings = &self.settings;
        if settings.alpha || !settings.aovs.is_empty() {
            let mut sample =
                CameraSample::of_pixel(self.sensor, settings, pixel, Purpose::Pixel, pass);
            let camera = (sample.raster, &sample.ray);
            if settings.alpha {
                let tracing = &self.seeds.tracing;
                let alpha = tracing.trace(space, path, camera, &mut sample.sampler, &mut |_| ());
                layers[0].add(&settings.filter, sample.raster, [0.0, 0.0, 0.0, alpha]);
            }
            self.add_aovs(camera, space, layers);
        }
        let samples = self.seeds.direct_samples.unwrap_or(0).max(1);
        self.sample_direct(pixel, pass, (space, path), layers, 1.0 / samples as f32);
    }

    /// Estimates the light of at most two edges in a pixel by further camera samples.
    ///
    /// The further samples of one pass are spread against each other, and passes are independent.
    ///
    /// - `weight`: of each sample.
    fn sample_direct(
        &self,
        pixel: (i32, i32),
        pass: u32,
        (space, path): (&PathSpace<'_>, &mut Path),
        layers: &[PassBuffer],
        weight: f32,
    ) {
        let (Some(samples), Some(place)) = (self.seeds.direct_samples, self.places.direct) else {
            return;
        };
        let kind = SamplerKind::Sobol;
        let settings = PixelSettings {
            sampler: kind,
            aovs: Vec::new(),
            own_layers: Vec::new(),
            ..self.settings
        };
        let tracing = PathTracing {
            max_depth: self.seeds.tracing.max_depth.min(2),
            ..self.seeds.tracing
        };
        let stride = samples.next_multiple_of(kind.group());
        for index in 0..samples {
            let number = pass.wrapping_mul(stride).wrapping_add(index);
            let mut sample =
                CameraSample::of_pixel(self.sensor, &settings, pixel, Purpose::Direct, number);
            let mut sum = Rgb::BLACK;
            let camera = (sample.raster, &sample.ray);
            let mut add = |found: Found<'_>| sum += found.energy;
            tracing.trace(space, path, camera, &mut sample.sampler, &mut add);
            let value = (sum * weight).to_array();
            layers[place].add(&settings.filter, sample.raster, value);
            self.add_beams((pixel, number), space, &layers[place], weight);
        }
    }

    /// The fixed-point unit of each layer.
    pub(in crate::integrator) fn units(&self) -> Vec<Unit> {
        let mut units = vec![self.unit; self.places.first_aov];
        for place in self.places.counts() {
            units[place] = Unit::for_magnitude(1.0);
        }
        let bounds = self.scene.bounds();
        units.extend(self.settings.aovs.iter().map(|aov| aov.unit(bounds)));
        units
    }

    /// What chains have made in a pass.
    pub(in crate::integrator) fn redistributed<'l>(
        &self,
        layers: &'l mut [PassBuffer],
    ) -> &'l mut PassBuffer {
        &mut layers[self.places.redistributed]
    }

    /// Ends a pass: the image is the sum of its parts.
    pub(in crate::integrator) fn finish_pass(&self, layers: &mut [PassBuffer]) {
        let (beauty, parts) = layers.split_at_mut(1);
        for place in self
            .places
            .direct
            .into_iter()
            .chain([self.places.redistributed])
        {
            beauty[0].add_buffer(&mut parts[place - 1]);
        }
    }

    /// Whether the spread of a layer's replicas tells the noise of something that is looked at.
    pub(in crate::integrator) fn has_variance(layer: &Layer) -> bool {
        matches!(layer.name.as_str(), "" | "direct" | "redistributed")
    }

    /// Turns sums into means, and makes the filtered layer.
    pub(in crate::integrator) fn resolve(&self, means: &mut [Vec<f32>]) {
        self.seeds
            .noise_filter
            .resolve(&self.places, self.settings.window, means);
        for (sum, count) in self.places.ratios() {
            let counts = std::mem::take(&mut means[count]);
            let channels = means[sum].len() / counts.len().max(1);
            for (values, count) in means[sum].chunks_mut(channels.max(1)).zip(&counts) {
                for value in values {
                    *value /= count.max(f32::MIN_POSITIVE);
                }
            }
            means[count] = counts;
        }
    }
}
