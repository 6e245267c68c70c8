//! Bidirectional path tracing: subpaths from the sensor and from a light, and all paths that they make
//! together.
//!
//! Techniques are counted as in the survey: `eye` vertices beyond the lens, its `s`, and `light` vertices,
//! its `t`. With no light vertex, the eye subpath meets a light by chance; with one, a light is sampled from
//! its last vertex; with no eye vertex, the light subpath is connected to the lens and may be seen anywhere
//! on the film. A lens is never met by chance.

mod assemble;
mod backlog;
mod chance;
mod connect;
mod image;
mod subpath;
mod technique;
mod weighing;

pub(super) use subpath::kept;
pub use subpath::{Escape, EyeSubpath, LightSubpath, SubVertex};
pub use weighing::{Backlog, Departure, Weighing};

use self::subpath::{Lit, Reach};
use super::{PathSpace, PathVertex};
use crate::accel::Ray;
use crate::math::{Rgb, Vec2};
use crate::random::Numbers;
use crate::sensor::{CameraRay, Sensor, SensorModel};

/// How paths are traced from both sides.
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional {
    /// Largest number of edges of a path; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// Number of edges of a subpath from which on Russian roulette may end it.
    pub rr_depth: u32,
    /// How techniques are weighed.
    pub weighing: Weighing,
    /// Which techniques there are.
    pub techniques: Techniques,
    /// Connections whose weighed luminance would be below this are made by Russian roulette; zero makes
    /// all.
    pub connection_threshold: f32,
}

/// Techniques that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Techniques {
    /// Whether light subpaths are connected to the lens.
    pub light_image: bool,
    /// Whether eye subpaths sample lights of their own; if not, they are connected to the first vertex of the
    /// light subpath.
    pub sample_direct: bool,
}

/// How light subpaths make images of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightImage {
    /// Light subpaths for each camera sample a pixel: as many as the film, with its filter's border, has
    /// pixels.
    pub paths: f64,
    /// Lower corner of the raster positions that count, in pixels of the full film. What is seen far beside the
    /// film can be brighter than all that is seen on it: pixels are small there.
    pub low: Vec2,
    /// Their upper corner.
    pub high: Vec2,
}

impl LightImage {
    /// Light subpaths that are seen on the film alone, one for each of its pixels.
    ///
    /// - `size`: its columns and rows.
    pub fn of_film((width, height): (u32, u32)) -> Self {
        Self {
            paths: f64::from(width) * f64::from(height),
            low: Vec2::ZERO,
            high: Vec2::new(width as f32, height as f32),
        }
    }

    /// Whether what is seen at a raster position counts.
    #[inline]
    fn contains(&self, raster: Vec2) -> bool {
        raster.cmpge(self.low).all() && raster.cmplt(self.high).all()
    }

    /// Whether a light subpath may be seen at a raster position: not where a sensor shows for a second time
    /// what it shows on its film.
    #[inline]
    fn shows(self, sensor: &Sensor, raster: Vec2) -> bool {
        sensor
            .raster_range()
            .is_none_or(|film| raster.cmpge(Vec2::ZERO).all() && raster.cmplt(film).all())
    }
}

/// A path that two subpaths make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// Number of its vertices that are of the eye subpath, the lens left out: `s`.
    pub eye: usize,
    /// Number of its vertices that are of the light subpath, or sampled on a light: `t`.
    pub light: usize,
    /// Where it is seen, in pixels of the full film.
    pub raster: Vec2,
    /// `f / p`: measurement contribution over the density of its technique.
    pub value: Rgb,
    /// Weight of its technique.
    pub weight: f32,
}

impl Connection {
    /// Number of edges of the path.
    pub fn edges(&self) -> usize {
        self.eye + self.light
    }

    /// What the path adds to the image.
    #[inline]
    pub fn energy(&self) -> Rgb {
        self.value * self.weight
    }
}

/// One sample: a subpath from each side, and working memory.
#[derive(Debug)]
pub struct Bidirection<'s> {
    /// The subpath from the sensor.
    pub eye: EyeSubpath<'s>,
    /// The point of the lens where the eye subpath begins.
    pub lens: PathVertex,
    /// For each vertex of the eye subpath, the point of a light that was sampled from there.
    pub ends: Vec<Option<PathVertex>>,
    /// The subpath from a light.
    pub light: LightSubpath<'s>,
    /// The point of the lens to which the light subpath is connected.
    pub light_lens: PathVertex,
    /// Paths that exist if their rays are free.
    candidates: Vec<Connection>,
    rays: Vec<Ray>,
    occluded: Vec<bool>,
}

impl Default for Bidirection<'_> {
    fn default() -> Self {
        let lens = PathVertex::sensor(crate::math::Vec3::ZERO);
        Self {
            eye: EyeSubpath::default(),
            lens,
            ends: Vec::new(),
            light: LightSubpath::default(),
            light_lens: lens,
            candidates: Vec::new(),
            rays: Vec::new(),
            occluded: Vec::new(),
        }
    }
}

impl Bidirectional {
    /// Traces a subpath from either side and hands every complete path to `found`.
    ///
    /// The energies of all paths, each where it is seen, add up to an estimate of the image.
    ///
    /// - `sample`: the subpaths, made anew.
    /// - `raster`, `camera_ray`: the camera sample.
    /// - `samplers`: the numbers of the eye and of the light subpath.
    ///
    /// Source: van Antwerpen 2011, Algs. 2 to 4.
    pub fn trace<'s>(
        &self,
        space: &PathSpace<'s>,
        sample: &mut Bidirection<'s>,
        camera: (Vec2, &CameraRay),
        image: &LightImage,
        [eye, light]: [&mut impl Numbers; 2],
        found: &mut impl FnMut(&Bidirection<'s>, &Connection),
    ) {
        let (raster, camera_ray) = camera;
        sample.lens = PathVertex::sensor(camera_ray.origin);
        let reach = self.reach();
        let subpath = &mut sample.eye;
        self.trace_eye(space, (raster, camera_ray), (image, reach), eye, subpath);
        // The lens takes an edge: subpaths from lights need one vertex less where none makes an image.
        let spare = u32::from(!self.techniques.light_image);
        self.start_light(space, self.max_depth.saturating_sub(spare), light, sample);
        sample.clear();
        self.meet_lights(space, sample, raster, found);
        // First: what light subpaths show does not depend on eye subpaths.
        self.see_light(space, sample, image);
        self.sample_lights(space, sample, raster);
        self.join_subpaths(space, sample, raster);
        self.complete(space, sample, light, found);
    }

    /// Traces a subpath from a light alone, and hands every path that it makes with the lens to `found`.
    ///
    /// - `alone`: whether there are no other techniques, so that each has its whole weight.
    pub fn trace_image<'s>(
        &self,
        space: &PathSpace<'s>,
        sample: &mut Bidirection<'s>,
        image: &LightImage,
        light: &mut impl Numbers,
        alone: bool,
        found: &mut impl FnMut(&Bidirection<'s>, &Connection),
    ) {
        sample.eye = EyeSubpath::default();
        self.start_light(space, self.max_depth, light, sample);
        sample.clear();
        self.see_light(space, sample, image);
        if alone {
            for candidate in &mut sample.candidates {
                candidate.weight = 1.0;
            }
        }
        self.complete(space, sample, light, found);
    }

    /// Traces a subpath from the sensor alone: one where the sample meets something that is not invisible,
    /// else zero.
    pub fn alpha<'s>(
        &self,
        space: &PathSpace<'s>,
        sample: &mut Bidirection<'s>,
        camera: (Vec2, &CameraRay),
        sampler: &mut impl Numbers,
    ) -> f32 {
        let image = LightImage {
            paths: 1.0,
            low: Vec2::ZERO,
            high: Vec2::ZERO,
        };
        let guide = (&image, self.reach());
        self.trace_eye(space, camera, guide, sampler, &mut sample.eye);
        sample.eye.alpha
    }

    /// How far eye subpaths go where all techniques are wanted.
    fn reach(&self) -> Reach {
        Reach {
            vertices: self.max_depth,
            lit: Lit::All,
        }
    }

    /// Traces the subpath from a light, to be connected to a point of the lens.
    fn start_light<'s>(
        &self,
        space: &PathSpace<'s>,
        limit: u32,
        sampler: &mut impl Numbers,
        sample: &mut Bidirection<'s>,
    ) {
        let lens = space.sensor.sample_lens(sampler.next_2d());
        sample.light_lens = PathVertex::sensor(lens);
        self.trace_light(space, limit, sampler, &mut sample.light);
    }

    /// Hands out those of the candidates that are not hidden.
    fn complete<'s>(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'s>,
        sampler: &mut impl Numbers,
        found: &mut impl FnMut(&Bidirection<'s>, &Connection),
    ) {
        self.drop_weak(sample, sampler);
        let mut occluded = std::mem::take(&mut sample.occluded);
        space.are_occluded(&sample.rays, &mut occluded);
        let rays = sample.candidates.iter().zip(&sample.rays).zip(&occluded);
        for ((candidate, ray), occluded) in rays {
            let passes_emitters = candidate.eye == 0 && space.rules.hide_emitters;
            if !occluded || passes_emitters && space.is_free_past_emitters(*ray) {
                found(sample, candidate);
            }
        }
        sample.occluded = occluded;
    }

    /// Russian roulette on connections: leaves out most of those that would bring little, and strengthens the
    /// others by as much.
    ///
    /// Source: van Antwerpen 2011, Sec. 5.1.
    fn drop_weak(&self, sample: &mut Bidirection<'_>, sampler: &mut impl Numbers) {
        if self.connection_threshold <= 0.0 {
            return;
        }
        let mut kept = 0;
        for index in 0..sample.candidates.len() {
            let mut candidate = sample.candidates[index];
            let survival = candidate.energy().luminance() / self.connection_threshold;
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    continue;
                }
                candidate.value *= 1.0 / survival;
            }
            sample.candidates[kept] = candidate;
            sample.rays[kept] = sample.rays[index];
            kept += 1;
        }
        sample.candidates.truncate(kept);
        sample.rays.truncate(kept);
    }
}

impl Bidirection<'_> {
    /// Makes room for subpaths of one technique.
    ///
    /// - `vertices`: most of either.
    pub fn reserve(&mut self, vertices: usize) {
        self.eye.vertices.reserve(vertices);
        self.ends.reserve(vertices);
        self.light.vertices.reserve(vertices);
        self.candidates.reserve(1);
        self.rays.reserve(1);
        self.occluded.reserve(1);
    }

    /// Forgets what the sample before had found.
    fn clear(&mut self) {
        self.ends.clear();
        self.ends.resize(self.eye.vertices.len(), None);
        self.candidates.clear();
        self.rays.clear();
    }
}
