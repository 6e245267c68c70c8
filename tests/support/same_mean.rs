//! Pictures made by chains, which must have the mean of path-traced ones.

use super::effort::{level, samples, seed};
use super::hard_scenes::View;
use super::render::{Replicas, image, integrator, layer, run, settings, tiles};

/// Width and height of the pictures.
pub(crate) const SIDE: u32 = 16;
const TILE: usize = 4;
const REPLICAS: u64 = 32;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

/// One way of spreading the energy of seeds.
pub(crate) struct Way {
    /// Integrator and its options.
    pub(crate) options: String,
    /// Passes of a replica in the suite.
    pub(crate) passes: u32,
}

const TRACING: &str = "max_depth=6";

/// Means of tiles of a picture, and of what of it chains have made.
fn render(view: &View, text: &str, seed: u64, passes: u32) -> [Vec<f64>; 2] {
    let algorithm = integrator(text);
    let settings = settings(seed, SIDE);
    let rendered = run(
        &view.scene,
        &view.sensor,
        algorithm.as_ref(),
        settings,
        passes,
    );
    let whole = tiles(&image(&rendered), TILE);
    if text.starts_with("path") {
        return [whole.clone(), whole];
    }
    [whole, tiles(&layer(&rendered, "redistributed"), TILE)]
}

/// Path-traced pictures of a scene: what all others must look like.
pub(crate) struct Reference {
    replicas: Replicas,
    means: Vec<f64>,
}

impl Reference {
    pub(crate) fn new(view: &View) -> Self {
        let text = format!("path {TRACING}");
        let passes = samples(32);
        let replicas = Replicas::new(seed(900), REPLICAS, |seed| {
            let [whole, _] = render(view, &text, seed, passes);
            whole
        });
        let means = replicas.summary().iter().map(|(mean, _)| *mean).collect();
        Self { replicas, means }
    }

    /// Checks several ways; tells of all that are wrong, not only of the first.
    pub(crate) fn check_all(
        &self,
        view: &View,
        ways: impl IntoIterator<Item = Way>,
    ) -> Result<(), String> {
        let found = ways.into_iter().map(|way| self.check(view, view, &way));
        let errors: Vec<String> = found.filter_map(Result::err).collect();
        if errors.is_empty() {
            Ok(())
        } else {
            Err(errors.join("\n"))
        }
    }

    /// Checks pictures made by chains, and what chains have made more than the path-traced pictures of
    /// their own seeds show, which varies less.
    ///
    /// - `seeds`: the view whose path-traced pictures are compared.
    pub(crate) fn check(&self, view: &View, seeds: &View, way: &Way) -> Result<(), String> {
        let (name, options) = way.options.split_once(' ').unwrap_or((&way.options, ""));
        let text = format!("{name} {TRACING} luminance_samples=256 {options}");
        // These spread the energy of the very samples that path tracing takes with their seed.
        let is_paired = ["erpt", "pmc-er"].contains(&name);
        let mut differences = Vec::new();
        let pictures = Replicas::new(seed(500), REPLICAS, |seed| {
            let [whole, chains] = render(view, &text, seed, way.passes);
            let [more, spread] = self.differences([&whole, &chains], seeds, way, seed);
            differences.push(spread);
            if is_paired { more } else { whole }
        });
        let differences = Replicas {
            values: differences,
        };
        let level = level(LEVEL) / 3.0;
        differences
            .check(&self.means, level)
            .and_then(|()| differences.check_mean_square(&self.means, level))
            .and_then(|()| match is_paired {
                // Few samples of a caustic hardly ever have its strongest paths: they vary little, and lack
                // some of its light, which long pictures have.
                true => pictures.check(&self.means, level),
                false => pictures.check_same(&self.replicas, level),
            })
            .map_err(|error| format!("{}, {text}: {error}", view.name))
    }

    /// What a picture shows more than path tracing with its seed, and what chains have made more than their
    /// seeds; around the reference, so that rounding has a scale.
    fn differences(
        &self,
        [whole, chains]: [&[f64]; 2],
        seeds: &View,
        way: &Way,
        seed: u64,
    ) -> [Vec<f64>; 2] {
        let traced = |options: &str| {
            let [whole, _] = render(seeds, &format!("path {options}"), seed, way.passes);
            whole
        };
        let all = traced(TRACING);
        let mut indirect = all.clone();
        if !way.options.contains("separate_direct=false") {
            let direct = traced("max_depth=2");
            let pairs = indirect.iter_mut().zip(direct);
            pairs.for_each(|(all, direct)| *all -= direct);
        }
        let more = |made: &[f64], traced: &[f64]| {
            let triples = made.iter().zip(traced).zip(&self.means);
            triples.map(|((a, b), mean)| a - b + mean).collect()
        };
        [more(whole, &all), more(chains, &indirect)]
    }
}
