//! Renders of small scenes, and what their replicas say about each other.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use lumiflow::film::{Filter, PassBuffer, Window};
use lumiflow::integrator::{
    self, Algorithm, Driver, PixelIntegrator, PixelSettings, Progress, Rendered,
};
use lumiflow::math::Rgb;
use lumiflow::math::statistics::sidak;
use lumiflow::random::{Purpose, SamplerKind, Stream};
use lumiflow::scene::Scene;
use lumiflow::scene::options::{OptionError, OptionReader, OptionValue, Options};
use lumiflow::sensor::Sensor;
use statrs::function::{beta::beta_reg, gamma::gamma_ur};

/// An integrator by name with options as on the command line: `path max_depth=5 mis=balance`.
pub(crate) fn integrator(text: &str) -> Box<dyn Algorithm> {
    made_from(text, integrator::from_options)
}

/// As [`integrator`], for those that estimate one camera ray at a time.
pub(crate) fn pixel_integrator(text: &str) -> Box<dyn PixelIntegrator> {
    made_from(text, integrator::pixel_integrator)
}

fn made_from<T>(text: &str, make: fn(&str, &mut OptionReader<'_>) -> Result<T, OptionError>) -> T {
    let mut words = text.split(' ');
    let name = words.next().unwrap_or_default();
    let options: Options = words
        .map(|word| word.split_once('=').expect("an option is KEY=VALUE"))
        .map(|(key, value)| (key.to_owned(), OptionValue::parse(value)))
        .collect();
    let mut reader = OptionReader::new(&options);
    let made = make(name, &mut reader).expect("the options are right");
    assert_eq!(reader.unused(), Vec::<String>::new(), "{text}");
    made
}

/// Settings of a plain render: one sample falls into one pixel.
pub(crate) fn settings(seed: u64, side: u32) -> PixelSettings {
    PixelSettings {
        seed,
        film_size: (side, side),
        window: Window::full(side, side),
        filter: Filter::pixel_box(),
        sampler: SamplerKind::Independent,
        alpha: false,
        second_moment: false,
        aovs: Vec::new(),
        own_layers: Vec::new(),
    }
}

/// Renders a number of passes, keeping the variance of every layer.
pub(crate) fn run(
    scene: &Scene,
    sensor: &Sensor,
    integrator: &dyn Algorithm,
    settings: PixelSettings,
    passes: u32,
) -> Rendered {
    let render = integrator.start(scene, sensor, settings);
    integrator::render(
        &*render,
        |_| true,
        &AtomicBool::default(),
        &Default::default(),
        |step| {
            if step.passes < passes {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        },
    )
}

/// The image of a render, without alpha.
pub(crate) fn image(rendered: &Rendered) -> Vec<Rgb> {
    let (layer, sum) = &rendered.layers[0];
    sum.mean()
        .chunks(layer.channels.len())
        .map(|pixel| Rgb::new(pixel[0], pixel[1], pixel[2]))
        .collect()
}

/// What a layer shows, without alpha.
pub(crate) fn layer(rendered: &Rendered, name: &str) -> Vec<Rgb> {
    let mut layers = rendered.layers.iter().zip(&rendered.means);
    let found = layers.find(|((layer, _), _)| layer.name == name);
    let ((layer, _), values) = found.expect("the layer is made");
    values
        .chunks(layer.channels.len())
        .map(|pixel| Rgb::new(pixel[0], pixel[1], pixel[2]))
        .collect()
}

/// Mean luminance of the image of each pass of a render.
pub(crate) fn means_of_passes(
    (scene, sensor): (&Scene, &Sensor),
    text: &str,
    settings: PixelSettings,
    passes: u32,
) -> Vec<f64> {
    let algorithm = integrator(text);
    let render = algorithm.start(scene, sensor, settings);
    let (cancelled, progress) = (AtomicBool::default(), Progress::default());
    let driver = Driver::new(&cancelled, &progress);
    let (layers, units, window) = (render.layers(), render.units(), render.window());
    assert_eq!(render.passes_per_replica(), 1, "a pass is a replica");
    let mean = |pass| {
        let layers = layers.iter().zip(&units);
        let mut buffers: Vec<_> = layers
            .map(|(layer, unit)| PassBuffer::new(window, layer.channels.len(), *unit))
            .collect();
        let counters = render.run_pass(pass, &buffers, &driver);
        assert!(counters.is_some(), "nobody cancels");
        render.finish_pass(&mut buffers);
        let luminances = buffers[0].luminances();
        luminances.iter().sum::<f64>() / luminances.len() as f64
    };
    (0..passes).map(mean).collect()
}

/// One image of a scene, by the integrator that `text` describes.
pub(crate) fn picture(
    scene: &Scene,
    sensor: &Sensor,
    text: &str,
    settings: PixelSettings,
    passes: u32,
) -> Vec<Rgb> {
    let integrator = integrator(text);
    image(&run(scene, sensor, integrator.as_ref(), settings, passes))
}

/// Mean luminance of an image.
pub(crate) fn mean(image: &[Rgb]) -> f64 {
    let sum: f64 = image.iter().map(|c| f64::from(c.luminance())).sum();
    sum / image.len() as f64
}

/// Mean luminance of each square of `tile` × `tile` pixels of a square image.
pub(crate) fn tiles(image: &[Rgb], tile: usize) -> Vec<f64> {
    let side = image.len().isqrt();
    assert_eq!(side * side, image.len(), "the image is square");
    let count = side / tile;
    let mut sums = vec![0.0; count * count];
    for (index, colour) in image.iter().enumerate() {
        let (x, y) = (index % side / tile, index / side / tile);
        if x < count && y < count {
            sums[y * count + x] += f64::from(colour.luminance()) / (tile * tile) as f64;
        }
    }
    sums
}

/// Values of several independent renders of the same thing.
pub(crate) struct Replicas {
    /// For each replica its values: one a tile.
    pub(crate) values: Vec<Vec<f64>>,
}

impl Replicas {
    /// Runs `render` with one seed after another.
    ///
    /// - `render`: a seed's values.
    pub(crate) fn new(first_seed: u64, count: u64, render: impl FnMut(u64) -> Vec<f64>) -> Self {
        Self {
            values: (first_seed..first_seed + count).map(render).collect(),
        }
    }

    /// Mean of each value, and the variance of that mean.
    pub(crate) fn summary(&self) -> Vec<(f64, f64)> {
        (0..self.values[0].len())
            .map(|i| self.mean_and_variance(i))
            .collect()
    }

    /// Mean of one value, and the variance of that mean.
    fn mean_and_variance(&self, index: usize) -> (f64, f64) {
        let n = self.values.len() as f64;
        let mean = self.values.iter().map(|v| v[index]).sum::<f64>() / n;
        let squares = self.values.iter().map(|v| (v[index] - mean).powi(2));
        (mean, squares.sum::<f64>() / (n * (n - 1.0)))
    }

    /// Checks each value against its expectation, and the mean of all values against theirs.
    ///
    /// Student's t; the family of all of them errs with probability `level` (Šidák).
    pub(crate) fn check(&self, expected: &[f64], level: f64) -> Result<(), String> {
        let known = expected.iter().map(|e| (*e, 0.0)).collect::<Vec<_>>();
        self.compare(&known, f64::INFINITY, level)
    }

    /// Checks that two sets of replicas have the same means, as [`Replicas::check`].
    pub(crate) fn check_same(&self, other: &Self, level: f64) -> Result<(), String> {
        self.check_against(&other.summary(), other.values.len(), level)
    }

    /// Checks against the [`Replicas::summary`] of others, as [`Replicas::check`].
    ///
    /// - `count`: number of the other replicas.
    pub(crate) fn check_against(
        &self,
        summary: &[(f64, f64)],
        count: usize,
        level: f64,
    ) -> Result<(), String> {
        self.compare(summary, count as f64 - 1.0, level)
    }

    fn compare(&self, other: &[(f64, f64)], other_freedom: f64, level: f64) -> Result<(), String> {
        let level = sidak(level, other.len() + 1);
        let freedom = self.values.len() as f64 - 1.0;
        let mut wrong = Vec::new();
        for (index, (expected, variance)) in other.iter().enumerate() {
            let (mean, own) = self.mean_and_variance(index);
            let total = own + variance;
            // Welch and Satterthwaite's number of degrees of freedom.
            let denominator = own * own / freedom + variance * variance / other_freedom;
            let freedom = total * total / denominator.max(f64::MIN_POSITIVE);
            let what = format!("value {index}");
            wrong.extend(verdict(&what, mean, *expected, total, freedom, level));
        }
        let (mean, own) = self.overall().mean_and_variance(0);
        let expected = other.iter().map(|(e, _)| e).sum::<f64>() / other.len() as f64;
        // Values of one replica may be correlated; those of pixels are not.
        let variance = other.iter().map(|(_, v)| v).sum::<f64>() / (other.len() as f64).powi(2);
        let total = own + variance;
        wrong.extend(verdict(
            "the mean of all",
            mean,
            expected,
            total,
            freedom,
            level,
        ));
        match wrong.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, worst)) => Err(worst),
            None => Ok(()),
        }
    }

    /// Checks the mean over all values of t² against what it is where nothing is wrong: finds errors that
    /// are small everywhere.
    ///
    /// Values of a replica may be correlated. The statistic's distribution is that of replicas drawn with
    /// replacement, after their mean was moved to the expectation; its tail is that of the gamma
    /// distribution with the same mean and variance.
    pub(crate) fn check_mean_square(&self, expected: &[f64], level: f64) -> Result<(), String> {
        const DRAWS: u32 = 1000;
        let all: Vec<usize> = (0..self.values.len()).collect();
        let found = self.mean_square(&all, expected);
        let centre: Vec<f64> = self.summary().iter().map(|(mean, _)| *mean).collect();
        let mut stream = Stream::new(71, Purpose::Check, 0, 0);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..DRAWS {
            let draw = |_: &usize| (stream.next_f32() * all.len() as f32) as usize;
            let drawn: Vec<usize> = all.iter().map(draw).collect();
            let value = self.mean_square(&drawn, &centre);
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(DRAWS);
        let variance = squares / f64::from(DRAWS) - mean * mean;
        if gamma_ur(mean * mean / variance, found * mean / variance) > level {
            return Ok(());
        }
        let spread = variance.sqrt();
        Err(format!(
            "mean square of t: {found:.2}, not {mean:.2} ± {spread:.2}"
        ))
    }

    /// Mean over all values of t² against an expectation, from some of the replicas.
    fn mean_square(&self, replicas: &[usize], expected: &[f64]) -> f64 {
        let n = replicas.len() as f64;
        let square = |(index, expected): (usize, &f64)| {
            let values = || replicas.iter().map(|replica| self.values[*replica][index]);
            let mean = values().sum::<f64>() / n;
            let variance = values().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0));
            let difference = mean - expected;
            // As in `verdict`.
            if difference.abs() <= 1e-5 * expected.abs() {
                0.0
            } else {
                difference * difference / variance
            }
        };
        expected.iter().enumerate().map(square).sum::<f64>() / expected.len() as f64
    }

    /// The same replicas with one value, the mean of all.
    fn overall(&self) -> Self {
        let mean = |values: &Vec<f64>| vec![values.iter().sum::<f64>() / values.len() as f64];
        Self {
            values: self.values.iter().map(mean).collect(),
        }
    }
}

/// Checks one mean against its expectation; says how many standard errors it is off where that is too
/// much.
fn verdict(
    what: &str,
    mean: f64,
    expected: f64,
    variance: f64,
    freedom: f64,
    level: f64,
) -> Option<(f64, String)> {
    let difference = mean - expected;
    // Where nothing varies, single precision is the only error left.
    if difference.abs() <= 1e-5 * expected.abs() {
        return None;
    }
    let t = difference / variance.sqrt();
    let p = student_p(t, freedom);
    if p > level {
        return None;
    }
    let text = format!(
        "{what}: {mean:.6}, not {expected:.6} (t = {t:.2}, p = {p:.1e}, level {level:.1e})"
    );
    // NaN is as far off as can be.
    Some((if t.is_nan() { f64::INFINITY } else { t.abs() }, text))
}

/// Chance that a value at least as far out as `t` comes from Student's distribution, on either side.
pub(crate) fn student_p(t: f64, freedom: f64) -> f64 {
    if !t.is_finite() {
        return 0.0;
    }
    let x = freedom / (freedom + t * t);
    beta_reg(freedom / 2.0, 0.5, x)
}

#[test]
fn student_quantiles_are_those_of_the_tables() {
    assert!((student_p(2.0423, 30.0) - 0.05).abs() < 1e-4);
    assert!((student_p(-12.706, 1.0) - 0.05).abs() < 1e-4);
}

#[test]
fn replicas_that_are_a_little_off_are_found() {
    // Eight values a replica, uniform around 1 with a deviation of 0.3.
    let replicas = |offset: f64| {
        Replicas::new(1, 32, |seed| {
            let mut stream = Stream::new(seed, Purpose::Check, 0, 0);
            let mut value = || 0.5 + offset + f64::from(stream.next_f32());
            (0..8).map(|_| value()).collect()
        })
    };
    assert_eq!(replicas(0.0).check(&[1.0; 8], 0.01), Ok(()));
    assert!(replicas(0.1).check(&[1.0; 8], 0.01).is_err());
    assert_eq!(replicas(0.0).check_mean_square(&[1.0; 8], 0.01), Ok(()));
    assert!(replicas(0.15).check_mean_square(&[1.0; 8], 0.01).is_err());
    assert!(replicas(0.0).check_same(&replicas(0.3), 0.01).is_err());
}
