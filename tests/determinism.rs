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

/// Bits of all layers: means, what is made of them, then variances.
pub(crate) fn bits(rendered: &Rendered) -> Vec<Vec<u32>> {
    let of = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect();
    let sums = || rendered.layers.iter().map(|(_, sum)| sum);
    let means = sums().map(|sum| of(sum.mean()));
    let shown = rendered.means.iter().map(|shown| of(shown.clone()));
    let variances = sums().map(|sum| of(sum.variance_of_mean().unwrap_or_default()));
    means.chain(shown).chain(variances).collect()
}

fn render(scene: &Scene, settings: PixelSettings, passes: u32) -> Rendered {
    let sensor = cornell_camera(Mat4::IDENTITY, SIDE);
    let integrator = integrator("path max_depth=6");
    run(scene, &sensor, integrator.as_ref(), settings, passes)
}

pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
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
pub(crate) fn cut(rendered: &Rendered, window: Window) -> Vec<Vec<u32>> {
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

const CHAINS: [&str; 13] = [
    "erpt max_depth=6 chain_length=10 mutations_per_sample=10 direct_samples=2 proposal_filter=luminance consecutive_limit=4",
    "erpt max_depth=6 flow=detailed chain_length=4 separate_direct=false proposal_filter=median",
    "erpt max_depth=6 flow=iterated flow_depth=3 mutations_per_sample=10 direct_samples=1",
    "pmc-er max_depth=6 population=100 rounds=3 mutations=4 mutations_per_sample=10 consecutive_limit=4 proposal_filter=box",
    "pmc-er max_depth=6 population=100 scheme=lai mutations_per_sample=10 separate_direct=false",
    "pmc-er max_depth=6 population=50 transfer=balance rounds=2 mutations=3 mutations_per_sample=10 proposal_density=mixture",
    "pssmlt max_depth=6 direct_samples=2 chains=30",
    "pssmlt max_depth=6 bidirectional=true luminance_samples=500 mutations_per_pixel=2",
    "mlt max_depth=6 direct_samples=2 chains=30 proposal_filter=box consecutive_limit=4",
    "mlt max_depth=6 seeds=bdpt separate_direct=false noise_aware=true luminance_samples=500",
    "pssmlt max_depth=6 separate_direct=false target=path deposits=expected luminance_samples=500",
    "mmlt max_depth=6 direct_samples=2 chains=30",
    "mmlt separate_direct=false noise_aware=true luminance_samples=500 mutations_per_pixel=10",
];

/// A render by chains with all the layers that there are.
fn chains(scene: &Scene, text: &str, settings: PixelSettings, passes: u32) -> Rendered {
    let sensor = cornell_camera(Mat4::IDENTITY, SIDE);
    let algorithm = integrator(text);
    let own = algorithm.own_layers();
    let settings = PixelSettings {
        second_moment: false,
        own_layers: own.iter().map(|name| (*name).to_owned()).collect(),
        ..settings
    };
    run(scene, &sensor, algorithm.as_ref(), settings, passes)
}

#[test]
fn chains_make_the_same_bits_on_any_number_of_threads() {
    let scene = cornell(Mat4::IDENTITY);
    for (text, filter) in CHAINS.into_iter().zip(filters().into_iter().cycle()) {
        let settings = || everything(SamplerKind::Independent, filter);
        let render = || chains(&scene, text, settings(), 2);
        let one = on_threads(1, render);
        assert!(one.counters.chains > 0 && one.counters.rejected == 0);
        for name in ["redistributed", "proposals", "acceptance", "chains"] {
            let mut layers = one.layers.iter().zip(&one.means);
            let values = layers.find(|((layer, _), _)| layer.name == name);
            let is_filled = values.is_some_and(|(_, values)| values.iter().any(|v| *v > 0.0));
            assert!(is_filled, "{name}");
        }
        let expected = bits(&one);
        for threads in [2, 3, 7] {
            let other = on_threads(threads, render);
            assert_eq!(other.counters, one.counters);
            assert!(bits(&other) == expected, "{text}, {threads} threads");
        }
    }
}

/// What a layer shows.
fn shown<'r>(rendered: &'r Rendered, name: &str) -> &'r [f32] {
    let mut layers = rendered.layers.iter().zip(&rendered.means);
    let found = layers.find(|((layer, _), _)| layer.name == name);
    found.expect("the layer is made").1
}

#[test]
fn direct_and_redistributed_light_add_up_to_the_picture() {
    let scene = cornell(Mat4::IDENTITY);
    let render = |text: &str| chains(&scene, text, settings(5, SIDE), PASSES);
    let rendered = render(CHAINS[0]);
    let parts = shown(&rendered, "direct")
        .iter()
        .zip(shown(&rendered, "redistributed"));
    for ((direct, redistributed), beauty) in parts.zip(shown(&rendered, "")) {
        // The sums are whole numbers, and agree to the last bit; each was rounded to `f32` on its way out.
        let sum = f64::from(*direct) + f64::from(*redistributed);
        let rounding = f64::from(direct + redistributed + beauty) * 2.0_f64.powi(-24);
        assert!(
            (sum - f64::from(*beauty)).abs() <= rounding,
            "{sum}, {beauty}"
        );
    }
    let rendered = render(CHAINS[1]);
    assert!(shown(&rendered, "") == shown(&rendered, "redistributed"));
}

#[test]
fn more_passes_continue_the_same_chains() {
    let scene = cornell(Mat4::IDENTITY);
    for text in CHAINS {
        let sums = |passes: u32| -> Vec<f64> {
            let rendered = chains(&scene, text, settings(6, SIDE), passes);
            let mean = rendered.layers[0].1.mean();
            let scaled = mean.iter().map(|v| f64::from(*v) * f64::from(passes));
            scaled.collect()
        };
        let [one, two, three] = [1, 2, 3].map(sums);
        let mut changed = 0;
        for ((one, two), three) in one.iter().zip(&two).zip(&three) {
            assert!(*two >= one * (1.0 - 1e-6) && *three >= two * (1.0 - 1e-6));
            changed += u32::from(three != two && two != one);
        }
        assert!(changed > SIDE * SIDE, "{text} {changed}");
    }
}
