//! The passes of energy redistribution path tracing.

use super::Erpt;
use super::energy::MeanEnergy;
use super::walker::PathWalker;
use crate::energy::FlowRule;
use crate::film::{Filter, Layer, PassBuffer, Unit, Window};
use crate::integrator::aov;
use crate::integrator::camera::{CameraSample, SampledWindow, pixel_index};
use crate::integrator::chains::MutationOptions;
use crate::integrator::pixel::PixelSettings;
use crate::integrator::render::{Counters, Integrator};
use crate::math::{Rgb, Vec2};
use crate::mutation::{Perturbation, RasterDomain};
use crate::path::{Found, Path, PathSpace, PathTracing};
use crate::random::{Purpose, SamplerKind, Stream};
use crate::scene::Scene;
use crate::sensor::Sensor;

/// Place of each layer among the buffers; `None` for those that are not made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Places {
    pub(super) direct: Option<usize>,
    pub(super) redistributed: usize,
    pub(super) filtered: Option<usize>,
    pub(super) proposals: Option<usize>,
    pub(super) expected: Option<usize>,
    pub(super) acceptance: Option<usize>,
    pub(super) chains: Option<usize>,
    first_aov: usize,
}

/// A render by energy redistribution path tracing: every pass makes one camera sample in each pixel and
/// spreads the energy of all its paths.
pub(super) struct ErptRender<'s> {
    scene: &'s Scene,
    sensor: &'s Sensor,
    erpt: &'s Erpt,
    settings: PixelSettings,
    sampled: SampledWindow,
    unit: Unit,
    rule: FlowRule,
    perturbation: Perturbation,
    places: Places,
    layers: Vec<Layer>,
}

/// What one unit of work uses: the space of paths, and where energy lands.
pub(super) struct Work<'a> {
    pub(super) space: PathSpace<'a>,
    pub(super) mutations: &'a MutationOptions,
    pub(super) perturbation: Perturbation,
    filter: &'a Filter,
    redistributed: &'a PassBuffer,
    filtered: Option<&'a PassBuffer>,
    pub(super) proposals: Option<&'a PassBuffer>,
    pub(super) acceptance: Option<&'a PassBuffer>,
    /// After how many steps in a row on one pixel the filtered layer takes no more energy.
    pub(super) consecutive_limit: Option<u32>,
}

impl Work<'_> {
    /// Lets energy of a colour land.
    ///
    /// - `energy`: as luminance; the second number goes to the filtered layer.
    #[inline]
    pub(super) fn land(&self, raster: Vec2, colour: Rgb, energy: (f64, f64)) {
        if energy.0 > 0.0 {
            let value = (colour * energy.0 as f32).to_array();
            self.redistributed.add(self.filter, raster, value);
        }
        if let Some(filtered) = self.filtered.filter(|_| energy.1 > 0.0) {
            let value = (colour * energy.1 as f32).to_array();
            filtered.add(self.filter, raster, value);
        }
    }

    /// Lets a path's energy land where it is.
    fn land_unmoved(&self, raster: Vec2, energy: Rgb) {
        self.land(raster, energy, (1.0, 1.0));
    }
}

impl Erpt {
    /// Whether the energy of paths of so many edges goes to chains.
    ///
    /// Both classes are closed under all mutations, so that nothing leaks.
    pub(super) fn goes_to_chains(&self, edges: u32) -> bool {
        self.direct_samples.is_none() || edges > 2
    }
}

impl<'s> ErptRender<'s> {
    /// Prepares a render: makes the estimate that fixes the energy of a deposit and the film's unit.
    pub(super) fn new(
        scene: &'s Scene,
        sensor: &'s Sensor,
        erpt: &'s Erpt,
        settings: PixelSettings,
    ) -> Self {
        let mean = MeanEnergy::estimate(erpt, scene, sensor, &settings);
        let deposit = erpt
            .deposition_energy
            .unwrap_or_else(|| mean.deposit(erpt.mutations_per_sample));
        let sampled = SampledWindow::new(&settings);
        let low = Vec2::new(sampled.x as f32, sampled.y as f32);
        let size = Vec2::new(sampled.width as f32, sampled.height as f32);
        let domain = RasterDomain {
            low,
            high: low + size,
        };
        let perturbation = erpt
            .mutations
            .perturbation(sensor, settings.film_size, domain);
        let (layers, places) = layers(erpt, &settings);
        Self {
            scene,
            sensor,
            erpt,
            sampled,
            unit: Unit::for_magnitude(mean.image),
            rule: erpt.flow_rule(deposit),
            perturbation,
            places,
            layers,
            settings,
        }
    }

    /// Traces the camera sample of a pixel and spreads the energy of its paths.
    fn sample_pixel(
        &self,
        pixel: (i32, i32),
        pass: u32,
        (walker, path): (&mut PathWalker<'_>, &mut Path),
        work: &Work<'_>,
        layers: &[PassBuffer],
    ) -> u64 {
        let settings = &self.settings;
        let mut sample = CameraSample::of_pixel(self.sensor, settings, pixel, Purpose::Pixel, pass);
        let raster = sample.raster;
        let index = pixel_index(settings, pixel.0, pixel.1);
        walker.draw_from(Stream::new(settings.seed, Purpose::Chain, index, pass));
        let mut chains = 0;
        let mut direct = Rgb::BLACK;
        let mut spread = |found: Found<'_>| {
            if !self.erpt.goes_to_chains(found.edges) {
                direct += found.energy;
                return;
            }
            let energy = found.luminance();
            let seed = found.path.filter(|_| energy > 0.0 && energy.is_finite());
            match seed {
                Some(seed) if walker.start(seed) => {
                    chains += u64::from(self.rule.spread(walker, energy));
                }
                _ => work.land_unmoved(raster, found.energy),
            }
        };
        let camera = (raster, &sample.ray);
        let alpha =
            self.erpt
                .tracing
                .trace(&work.space, path, camera, &mut sample.sampler, &mut spread);
        if let Some(place) = self.places.direct {
            let value = (direct * self.direct_weight()).to_array();
            layers[place].add(&settings.filter, raster, value);
        }
        if settings.alpha {
            layers[0].add(&settings.filter, raster, [0.0, 0.0, 0.0, alpha]);
        }
        if let Some(place) = self.places.chains {
            layers[place].add(&Filter::pixel_box(), raster, [chains as f32]);
        }
        if !settings.aovs.is_empty() {
            let first = work.space.meet(sample.ray.to_ray(), false);
            let aovs = &layers[self.places.first_aov..];
            aov::add_all(settings, first.as_ref(), raster, aovs);
        }
        chains
    }

    /// Weight of each of a pixel's samples of direct light in a pass: its own camera sample and the
    /// further ones.
    fn direct_weight(&self) -> f32 {
        1.0 / (self.erpt.direct_samples.unwrap_or(0) + 1) as f32
    }

    /// Estimates the light of at most two edges in a pixel by further camera samples.
    ///
    /// The further samples of one pass are spread against each other, and passes are independent.
    fn sample_direct(
        &self,
        pixel: (i32, i32),
        pass: u32,
        (samples, path): (u32, &mut Path),
        work: &Work<'_>,
        layer: &PassBuffer,
    ) {
        let kind = SamplerKind::Sobol;
        let settings = PixelSettings {
            sampler: kind,
            aovs: Vec::new(),
            own_layers: Vec::new(),
            ..self.settings
        };
        let tracing = PathTracing {
            max_depth: self.erpt.tracing.max_depth.min(2),
            ..self.erpt.tracing
        };
        let stride = samples.next_multiple_of(kind.group());
        for index in 0..samples {
            let number = pass.wrapping_mul(stride).wrapping_add(index);
            let mut sample =
                CameraSample::of_pixel(self.sensor, &settings, pixel, Purpose::Direct, number);
            let mut sum = Rgb::BLACK;
            let camera = (sample.raster, &sample.ray);
            let mut add = |found: Found<'_>| sum += found.energy;
            tracing.trace(&work.space, path, camera, &mut sample.sampler, &mut add);
            let value = (sum * self.direct_weight()).to_array();
            layer.add(&settings.filter, sample.raster, value);
        }
    }
}

/// The layers of a render and their places.
fn layers(erpt: &Erpt, settings: &PixelSettings) -> (Vec<Layer>, Places) {
    let beauty = if settings.alpha { "RGBA" } else { "RGB" };
    let mut layers = vec![Layer::new("", beauty)];
    let mut push = |name: &str, channels: &str| {
        layers.push(Layer::new(name, channels));
        layers.len() - 1
    };
    let is_wanted = |name: &str| settings.own_layers.iter().any(|wanted| wanted == name);
    let acceptance = is_wanted("acceptance");
    let needs_proposals =
        acceptance || is_wanted("proposals") || erpt.noise_filter.needs_proposals();
    let places = Places {
        direct: erpt.direct_samples.map(|_| push("direct", "RGB")),
        redistributed: push("redistributed", "RGB"),
        filtered: erpt.noise_filter.is_on().then(|| push("filtered", "RGB")),
        proposals: needs_proposals.then(|| push("proposals", "Y")),
        expected: erpt
            .noise_filter
            .needs_proposals()
            .then(|| push("expected_proposals", "Y")),
        acceptance: acceptance.then(|| push("acceptance", "Y")),
        chains: is_wanted("chains").then(|| push("chains", "Y")),
        first_aov: 0,
    };
    let first_aov = layers.len();
    layers.extend(settings.aovs.iter().map(|aov| aov.layer()));
    (
        layers,
        Places {
            first_aov,
            ..places
        },
    )
}

impl Integrator for ErptRender<'_> {
    fn layers(&self) -> Vec<Layer> {
        self.layers.clone()
    }

    fn units(&self) -> Vec<Unit> {
        let mut units = vec![self.unit; self.places.first_aov];
        for place in [
            self.places.proposals,
            self.places.expected,
            self.places.acceptance,
            self.places.chains,
        ]
        .into_iter()
        .flatten()
        {
            units[place] = Unit::for_magnitude(1.0);
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

    fn run_unit(&self, pass: u32, unit: u32, layers: &[PassBuffer]) -> Counters {
        let places = self.places;
        let layer = |place: Option<usize>| place.map(|place| &layers[place]);
        let work = Work {
            space: PathSpace::new(self.scene, self.sensor, self.erpt.rules),
            mutations: &self.erpt.mutations,
            perturbation: self.perturbation,
            filter: &self.settings.filter,
            redistributed: &layers[places.redistributed],
            filtered: layer(places.filtered),
            proposals: layer(places.proposals),
            acceptance: layer(places.acceptance),
            consecutive_limit: self.erpt.noise_filter.consecutive_limit(),
        };
        let mut walker = PathWalker::new(&work, self.rule.levels());
        let mut path = Path::default();
        let mut counters = Counters::default();
        for pixel in self.sampled.pixels(unit) {
            let workers = (&mut walker, &mut path);
            counters.chains += self.sample_pixel(pixel, pass, workers, &work, layers);
            counters.paths += 1;
            if let (Some(samples), Some(direct)) = (self.erpt.direct_samples, layer(places.direct))
            {
                let samples = (samples, &mut path);
                self.sample_direct(pixel, pass, samples, &work, direct);
            }
        }
        walker.flush();
        counters.rays = work.space.rays();
        counters.mutations = walker.chain.statistics;
        counters
    }

    fn finish_pass(&self, layers: &mut [PassBuffer]) {
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

    fn has_variance(&self, layer: &Layer) -> bool {
        matches!(layer.name.as_str(), "" | "direct" | "redistributed")
    }

    fn resolve(&self, means: &mut [Vec<f32>]) {
        self.erpt
            .noise_filter
            .resolve(&self.places, self.settings.window, means);
        if let (Some(acceptance), Some(proposals)) = (self.places.acceptance, self.places.proposals)
        {
            let counts = std::mem::take(&mut means[proposals]);
            for (sum, count) in means[acceptance].iter_mut().zip(&counts) {
                *sum /= count.max(f32::MIN_POSITIVE);
            }
            means[proposals] = counts;
        }
    }
}
