//! The paths of samples, by path tracing and from both sides.

use lumiflow::math::Vec2;
use lumiflow::path::{
    Bidirection, Bidirectional, Connection, Found, Heuristic, LightImage, Path, PathRules,
    PathSpace, PathTracing, Techniques, Weighing, camera_sample,
};
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

/// Light subpaths for each camera sample a pixel.
pub(crate) const LIGHT_PATHS: f64 = (SIDE * SIDE) as f64;

/// Which places of light subpaths' images count.
pub(crate) const IMAGE: LightImage = LightImage {
    paths: LIGHT_PATHS,
    low: Vec2::ZERO,
    high: Vec2::splat(SIDE as f32),
};

/// How the tests trace from both sides.
pub(crate) fn from_both_sides(weighing: Weighing) -> Bidirectional {
    Bidirectional {
        max_depth: 6,
        rr_depth: 2,
        weighing,
        techniques: Techniques {
            light_image: true,
            sample_direct: true,
        },
        connection_threshold: 0.0,
    }
}

/// Traces one sample from both sides, uniform over the film.
pub(crate) fn trace_both_sides(
    tracing: &Bidirectional,
    space: &PathSpace<'_>,
    (seed, sample): (u64, u32),
    mut found: impl FnMut(&Bidirection<'_>, &Connection),
) {
    let sampler = |purpose| {
        let address = PixelAddress {
            seed,
            purpose,
            pixel: 0,
            sample,
        };
        Sampler::new(SamplerKind::Independent, address)
    };
    let (mut eye, mut light) = (sampler(Purpose::Pixel), sampler(Purpose::Light));
    let raster: Vec2 = eye.next_2d() * SIDE as f32;
    let ray = camera_sample(space, raster, &mut eye);
    let mut both = Bidirection::default();
    let samplers = [&mut eye, &mut light];
    let camera = (raster, &ray);
    tracing.trace(space, &mut both, camera, &IMAGE, samplers, &mut found);
}
