//! Renders of chains know how far off they are: pictures by several seeds differ by as much as the spread of
//! each one's passes says.

use statrs::function::gamma::gamma_ur;

use crate::support::effort::{level, samples, seed};
use crate::support::hard_scenes::{View, body_in_glass};
use crate::support::render::{mean, means_of_passes, picture, settings, student_p};
use crate::support::stages::SIDE;

const SEEDS: u64 = 16;
const PASSES: u32 = 12;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

const WAYS: [&str; 8] = [
    "erpt max_depth=8 mutations_per_sample=4",
    "pmc-er max_depth=8 population=200 rounds=3 mutations_per_sample=4",
    "mlt max_depth=8 luminance_samples=1024 chains=40",
    "mlt max_depth=8 seeds=bdpt luminance_samples=1024 chains=40",
    "pssmlt max_depth=8 luminance_samples=1024 chains=40",
    "pssmlt max_depth=8 target=path luminance_samples=1024 chains=40",
    "pssmlt max_depth=8 bidirectional=true luminance_samples=1024 chains=20",
    "mmlt max_depth=8 luminance_samples=1024 chains=40",
];

/// Mean of the picture by path tracing.
fn expected(view: &View) -> f64 {
    let passes = samples(8192);
    mean(&picture(
        &view.scene,
        &view.sensor,
        "path max_depth=8",
        settings(seed(4000), SIDE),
        passes,
    ))
}

/// Means of the passes of every seed.
fn means(view: &View, text: &str) -> Vec<Vec<f64>> {
    let space = (&view.scene, &view.sensor);
    (0..SEEDS)
        .map(|number| {
            let settings = settings(seed(4100 + number), SIDE);
            means_of_passes(space, text, settings, samples(PASSES))
        })
        .collect()
}

/// Chance that the means of all seeds are as far from the expected one as they are, by their own estimates of
/// their errors (Student's t of each; the chances of all together by Fisher's χ²).
fn chance(means: &[Vec<f64>], expected: f64) -> f64 {
    let log = |passes: &Vec<f64>| {
        let count = passes.len() as f64;
        let mean = passes.iter().sum::<f64>() / count;
        let squares: f64 = passes.iter().map(|value| (value - mean).powi(2)).sum();
        let error = (squares / (count * (count - 1.0))).sqrt();
        student_p((mean - expected) / error, count - 1.0).ln()
    };
    gamma_ur(means.len() as f64, -means.iter().map(log).sum::<f64>())
}

#[test]
fn seeds_differ_by_what_their_passes_say() {
    let view = body_in_glass(SIDE);
    let expected = expected(&view);
    let level = level(LEVEL) / WAYS.len() as f64;
    let wrong: Vec<_> = WAYS
        .into_iter()
        .map(|text| (text, chance(&means(&view, text), expected)))
        .filter(|(_, chance)| *chance < level)
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// A brightness that all passes of a render share is in no spread of passes: as where b is estimated once for a render.
#[test]
fn a_brightness_that_passes_share_is_found() {
    let view = body_in_glass(SIDE);
    let expected = expected(&view);
    for text in ["mlt", "mmlt"] {
        let text = format!("{text} max_depth=8 luminance_samples=1024 chains=40");
        let mut means = means(&view, &text);
        for (number, passes) in means.iter_mut().enumerate() {
            let settings = settings(seed(4200 + number as u64), SIDE);
            let few = picture(&view.scene, &view.sensor, "path max_depth=8", settings, 4);
            let shared = mean(&few) / expected;
            passes.iter_mut().for_each(|value| *value *= shared);
        }
        let chance = chance(&means, expected);
        assert!(chance < 1e-6, "{text}: {chance}");
    }
}
