//! The path tracer's paths, sample by sample.

use lumiflow::math::Vec2;
use lumiflow::path::{Found, Heuristic, Path, PathRules, PathSpace, PathTracing, camera_sample};
use lumiflow::random::{PixelAddress, Purpose, Sampler, SamplerKind, Stream};

use super::stages::{SIDE, Stage};

/// How the tests trace: with Russian roulette early enough to matter.
pub(crate) const TRACING: PathTracing = PathTracing {
    max_depth: 6,
    rr_depth: 3,
    heuristic: Heuristic::Power,
};

/// The space of a stage's paths.
pub(crate) fn space(stage: &Stage) -> PathSpace<'_> {
    PathSpace::new(&stage.scene, &stage.sensor, PathRules::default())
}

/// Traces one camera sample, uniform over the film, and hands out its paths.
pub(crate) fn trace(
    space: &PathSpace<'_>,
    tracing: &PathTracing,
    (seed, sample): (u64, u32),
    path: &mut Path,
    found: &mut impl FnMut(Found<'_>),
) {
    let address = PixelAddress {
        seed,
        purpose: Purpose::Pixel,
        pixel: 0,
        sample,
    };
    let mut sampler = Sampler::new(SamplerKind::Independent, address);
    let raster: Vec2 = sampler.next_2d() * SIDE as f32;
    let ray = camera_sample(space, raster, &mut sampler);
    tracing.trace(space, path, (raster, &ray), &mut sampler, found);
}

/// Numbers for the mutations of one sample.
pub(crate) fn numbers(seed: u64, sample: u32) -> Stream {
    Stream::new(seed, Purpose::Chain, 0, sample)
}
