//! Seeds from subpaths of both sides.

use super::ChainFilm;
use crate::emitter::EmitterModel;
use crate::film::{Canvas, PassBuffer};
use crate::integrator::camera::{CameraSample, pixel_index};
use crate::math::Vec2;
use crate::path::{Bidirection, Bidirectional, Connection, Found, LightImage, Path, PathSpace};
use crate::random::{Numbers, PixelAddress, Purpose, Sampler, SamplerKind};
use crate::sensor::CameraRay;

/// A path that two subpaths have made, with the place where it is seen.
pub(in crate::integrator) struct FoundAt<'a> {
    pub(in crate::integrator) path: Found<'a>,
    pub(in crate::integrator) raster: Vec2,
    /// Whether the light's subpath alone has made it, so that it may be seen elsewhere than the camera sample.
    pub(in crate::integrator) is_shown: bool,
}

impl ChainFilm<'_> {
    /// Where light subpaths are seen: everywhere that paths are, one for each pixel.
    pub(in crate::integrator) fn light_image(&self) -> LightImage {
        LightImage {
            paths: self.domain.pixels(),
            low: self.domain.low,
            high: self.domain.high,
        }
    }

    /// Traces a subpath from either side for a camera sample, and hands out every path that they make, each
    /// connection its own: as [`PathTracing::trace`](crate::path::PathTracing::trace) does.
    ///
    /// Paths that are seen beyond the pixels that are sampled are left out, as chains leave them out.
    ///
    /// - `path`: working memory; `None` where energies are enough.
    /// - `samplers`: the numbers of the eye and of the light subpath.
    pub(in crate::integrator) fn trace_both_sides(
        &self,
        tracing: &Bidirectional,
        (space, mut path): (&PathSpace<'_>, Option<&mut Path>),
        camera: (Vec2, &CameraRay),
        samplers: [&mut impl Numbers; 2],
        take: &mut impl FnMut(FoundAt<'_>),
    ) -> f32 {
        let mut both = Bidirection::default();
        let image = self.light_image();
        let mut found = |both: &Bidirection<'_>, connection: &Connection| {
            let edges = connection.edges() as u32;
            let path = path.as_deref_mut().and_then(|path| {
                let is_seed = self.seeds.goes_to_chains(edges);
                (is_seed && both.assemble(space, connection, path)).then_some(&*path)
            });
            take(FoundAt {
                path: Found {
                    path,
                    edges,
                    is_explicit: connection.light == 1,
                    energy: connection.energy(),
                },
                raster: connection.raster,
                is_shown: connection.eye == 0,
            });
        };
        tracing.trace(space, &mut both, camera, &image, samplers, &mut found);
        both.eye.alpha
    }

    /// The numbers of the light's side of a pixel's camera sample.
    pub(super) fn light_sampler(&self, pixel: (i32, i32), pass: u32) -> Sampler {
        let address = PixelAddress {
            seed: self.settings.seed,
            purpose: Purpose::Light,
            pixel: pixel_index(&self.settings, pixel.0, pixel.1),
            sample: pass,
        };
        Sampler::new(self.settings.sampler, address)
    }

    /// As [`ChainFilm::trace_both_sides`], for the camera sample of a pixel.
    pub(super) fn trace_pixel_from_both_sides(
        &self,
        tracing: &Bidirectional,
        (pixel, pass): ((i32, i32), u32),
        (space, path): (&PathSpace<'_>, &mut Path),
        sample: &mut CameraSample,
        take: &mut impl FnMut(Option<Vec2>, Found<'_>),
    ) -> f32 {
        let mut light = self.light_sampler(pixel, pass);
        let camera = (sample.raster, &sample.ray);
        let samplers = [&mut sample.sampler, &mut light];
        let workers = (space, Some(path));
        self.trace_both_sides(tracing, workers, camera, samplers, &mut |found| {
            take(found.is_shown.then_some(found.raster), found.path);
        })
    }

    /// What beams without width light at once, for a further sample of direct light: such samples come from the sensor,
    /// which does not find it.
    ///
    /// - `number`: of the sample of the pixel.
    /// - `weight`: of the sample.
    pub(super) fn add_beams(
        &self,
        (pixel, number): ((i32, i32), u32),
        space: &PathSpace<'_>,
        layer: &PassBuffer,
        weight: f32,
    ) {
        let lights = space.scene.lights();
        let Some(tracing) = self.seeds.both_sides.filter(|_| lights.has_beams()) else {
            return;
        };
        let direct = Bidirectional {
            max_depth: tracing.max_depth.min(2),
            ..tracing
        };
        let address = PixelAddress {
            seed: self.settings.seed,
            purpose: Purpose::Beam,
            pixel: pixel_index(&self.settings, pixel.0, pixel.1),
            sample: number,
        };
        let mut light = Sampler::new(SamplerKind::Independent, address);
        let (image, mut both) = (self.light_image(), Bidirection::default());
        let mut found = |both: &Bidirection<'_>, connection: &Connection| {
            let start = both.light.start.as_ref().map(|start| start.emitter);
            if start.is_some_and(|id| !lights.get(id).class().is_connectable()) {
                let value = (connection.energy() * weight).to_array();
                layer.add(&self.settings.filter, connection.raster, value);
            }
        };
        direct.trace_image(space, &mut both, &image, &mut light, true, &mut found);
    }
}
