//! Seeds from subpaths of both sides.

use super::ChainFilm;
use crate::integrator::camera::{CameraSample, pixel_index};
use crate::math::Vec2;
use crate::path::{Bidirection, Bidirectional, Connection, Found, LightImage, Path, PathSpace};
use crate::random::{PixelAddress, Purpose, Sampler};

impl ChainFilm<'_> {
    /// Traces a subpath from either side for a camera sample, and hands out every path that they make, each
    /// connection its own: as [`PathTracing::trace`](crate::path::PathTracing::trace) does.
    ///
    /// Paths that only the light's subpath has made come with the place where they are seen; those that are seen
    /// beyond the pixels that are sampled are left out, as chains leave them out.
    ///
    /// - `path`: working memory.
    pub(super) fn trace_both_sides(
        &self,
        tracing: &Bidirectional,
        (pixel, pass): ((i32, i32), u32),
        (space, path): (&PathSpace<'_>, &mut Path),
        sample: &mut CameraSample,
        take: &mut impl FnMut(Option<Vec2>, Found<'_>),
    ) -> f32 {
        let address = PixelAddress {
            seed: self.settings.seed,
            purpose: Purpose::Light,
            pixel: pixel_index(&self.settings, pixel.0, pixel.1),
            sample: pass,
        };
        let mut light = Sampler::new(self.settings.sampler, address);
        let mut both = Bidirection::default();
        let image = LightImage {
            paths: f64::from(self.sampled.width) * f64::from(self.sampled.height),
            low: self.domain.low,
            high: self.domain.high,
        };
        let camera = (sample.raster, &sample.ray);
        let samplers = [&mut sample.sampler, &mut light];
        let mut found = |both: &Bidirection<'_>, connection: &Connection| {
            let shown = (connection.eye == 0).then_some(connection.raster);
            let edges = connection.edges() as u32;
            let is_seed = self.seeds.goes_to_chains(edges);
            let fits = is_seed && both.assemble(space, connection, path);
            let found = Found {
                path: fits.then_some(&*path),
                edges,
                is_explicit: connection.light == 1,
                energy: connection.energy(),
            };
            take(shown, found);
        };
        tracing.trace(space, &mut both, camera, &image, samplers, &mut found);
        both.eye.alpha
    }
}
