//! One seed gives the same bits, whatever the number of threads, whatever part of the film.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use lumiflow::film::{Filter, FilterKind, Window};
use lumiflow::integrator::{Aov, Counters, Estimate, PixelIntegrator, PixelSettings, Rendered};
use lumiflow::math::{Mat4, Rgb};
use lumiflow::random::{Sampler, SamplerKind};
use lumiflow::scene::Scene;
use lumiflow::sensor::CameraRay;

use crate::support::render::{integrator, pixel_integrator, run, settings};
use crate::support::scenes::{cornell, cornell_camera};

/// Width and height of the film; not a multiple of the block size.
const SIDE: u32 = 37;
const PASSES: u32 = 3;

fn everything(sampler: SamplerKind, filter: Filter) -> PixelSettings {
    PixelSettings {
        sampler,
        filter,
        alpha: true,
        second_moment: true,
        aovs: Aov::NAMES.map(|(_, aov)| aov).to_vec(),
        ..settings(42, SIDE)
    }
}

/// Bits of all layers: means, then variances.
fn bits(rendered: &Rendered) -> Vec<Vec<u32>> {
    let of = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect();
    let sums = || rendered.layers.iter().map(|(_, sum)| sum);
    let means = sums().map(|sum| of(sum.mean()));
    let variances = sums().map(|sum| of(sum.variance_of_mean().unwrap_or_default()));
    means.chain(variances).collect()
}

fn render(scene: &Scene, settings: PixelSettings, passes: u32) -> Rendered {
    let sensor = cornell_camera(Mat4::IDENTITY, SIDE);
    let integrator = integrator("path max_depth=6");
    run(scene, &sensor, integrator.as_ref(), settings, passes)
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads can be started").install(work)
}

const SAMPLERS: [SamplerKind; 3] = [
    SamplerKind::Independent,
    SamplerKind::Stratified,
    SamplerKind::Sobol,
];

fn filters() -> [Filter; 2] {
    let gaussian = FilterKind::Gaussian { stddev: 0.5 };
    [
        Filter::pixel_box(),
        Filter::new(gaussian).expect("a filter"),
    ]
}

#[test]
fn any_number_of_threads_makes_the_same_bits() {
    let scene = cornell(Mat4::IDENTITY);
    for sampler in SAMPLERS {
        for filter in filters() {
            // More than one replica, so that there is a variance.
            let passes = sampler.group() + 1;
            let render = || render(&scene, everything(sampler, filter), passes);
            let one = on_threads(1, render);
            assert!(one.counters.rays > 0 && one.counters.rejected == 0);
            let expected = bits(&one);
            assert!(expected.iter().all(|layer| !layer.is_empty()));
            for threads in [2, 3, 7] {
                let other = on_threads(threads, render);
                assert_eq!(other.counters, one.counters);
                assert!(
                    bits(&other) == expected,
                    "{sampler:?}, {filter:?}, {threads} threads"
                );
            }
        }
    }
}

/// A faulty integrator: its estimates know in which order they were made.
struct Restless(Box<dyn PixelIntegrator>, AtomicU32);

impl PixelIntegrator for Restless {
    fn estimate(
        &self,
        scene: &Scene,
        ray: &CameraRay,
        sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Estimate {
        let number = self.1.fetch_add(1, Relaxed);
        let estimate = self.0.estimate(scene, ray, sampler, counters);
        Estimate {
            radiance: Rgb::grey(number as f32),
            ..estimate
        }
    }
}

#[test]
fn an_integrator_that_knows_its_threads_is_found() {
    let scene = cornell(Mat4::IDENTITY);
    let sensor = cornell_camera(Mat4::IDENTITY, SIDE);
    let render = || {
        let restless = Restless(pixel_integrator("path"), AtomicU32::new(0));
        let restless: Box<dyn PixelIntegrator> = Box::new(restless);
        bits(&run(&scene, &sensor, &restless, settings(1, SIDE), PASSES))
    };
    let one = on_threads(1, render);
    assert!(one == on_threads(1, render));
    assert!((0..20).any(|_| on_threads(2, render) != one));
}

#[test]
fn another_seed_makes_another_picture() {
    let scene = cornell(Mat4::IDENTITY);
    let first = render(&scene, settings(1, SIDE), PASSES);
    assert!(bits(&first) != bits(&render(&scene, settings(2, SIDE), PASSES)));
}

#[test]
fn more_passes_continue_the_same_render() {
    // The mean of n passes is the sum of those passes over n, whichever number was asked for.
    let scene = cornell(Mat4::IDENTITY);
    let sum = |passes: u32| -> Vec<f64> {
        let rendered = render(&scene, settings(3, SIDE), passes);
        let scale = f64::from(passes);
        rendered.layers[0]
            .1
            .mean()
            .into_iter()
            .map(|v| f64::from(v) * scale)
            .collect()
    };
    let (two, four) = (sum(2), sum(4));
    // Later passes add light and never take any.
    assert!(
        two.iter()
            .zip(&four)
            .all(|(two, four)| *four >= two * (1.0 - 1e-6))
    );
    assert_ne!(two, four);
}

/// Bits of the pixels of a window, in a render that covers it.
fn cut(rendered: &Rendered, window: Window) -> Vec<Vec<u32>> {
    let cut = |values: Vec<f32>, channels: usize| {
        let pixel = |x: u32, y: u32| {
            let column = (x - rendered.window.x) as usize;
            let row = (y - rendered.window.y) as usize;
            let first = (row * rendered.window.width as usize + column) * channels;
            values[first..first + channels].iter().map(|v| v.to_bits())
        };
        let rows = window.y..window.y + window.height;
        rows.flat_map(|y| (window.x..window.x + window.width).map(move |x| (x, y)))
            .flat_map(|(x, y)| pixel(x, y).collect::<Vec<_>>())
            .collect()
    };
    let layers = rendered.layers.iter();
    layers
        .map(|(layer, sum)| cut(sum.mean(), layer.channels.len()))
        .collect()
}

#[test]
fn a_window_shows_what_the_whole_film_shows_there() {
    let scene = cornell(Mat4::IDENTITY);
    for sampler in SAMPLERS {
        for filter in filters() {
            let whole = render(&scene, everything(sampler, filter), PASSES);
            for window in [
                Window {
                    x: 0,
                    y: 0,
                    width: 5,
                    height: SIDE,
                },
                Window {
                    x: 11,
                    y: 23,
                    width: 17,
                    height: 9,
                },
                Window {
                    x: SIDE - 1,
                    y: SIDE - 1,
                    width: 1,
                    height: 1,
                },
            ] {
                let settings = PixelSettings {
                    window,
                    ..everything(sampler, filter)
                };
                let part = render(&scene, settings, PASSES);
                assert!(
                    cut(&part, window) == cut(&whole, window),
                    "{sampler:?}, {filter:?}, {window:?}"
                );
            }
        }
    }
}
