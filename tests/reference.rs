//! Pictures agree with references that another renderer made, where those are at hand.

use std::path::{Path, PathBuf};

use lumiflow::image::read_exr;
use lumiflow::integrator::PixelSettings;
use lumiflow::math::Rgb;
use lumiflow::random::SamplerKind;
use lumiflow::scene::import::{ImportOptions, import};

use crate::support::render::{Replicas, mean, picture, settings, tiles};

const TILE: usize = 16;
/// Replicas, each with one sample a pixel.
const REPLICAS: u64 = 16;

fn folders() -> Vec<PathBuf> {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/reference");
    let entries = std::fs::read_dir(&shared).into_iter().flatten().flatten();
    let mut folders: Vec<_> = entries.map(|entry| entry.path()).collect();
    folders.retain(|folder| folder.join("scene.xml").is_file());
    folders.sort();
    if folders.is_empty() {
        eprintln!("SKIPPED: no references in {}", shared.display());
    }
    folders
}

fn pixels(file: &Path) -> Vec<Rgb> {
    let image = read_exr(file).unwrap_or_else(|error| panic!("{error}"));
    let pixels = image.rgb("").expect("the reference has R, G and B");
    pixels.into_iter().map(Rgb::from).collect()
}

/// Tile means of luminance, and a bound on their variance.
fn reference(folder: &Path) -> Vec<(f64, f64)> {
    let means = tiles(&pixels(&folder.join("reference.exr")), TILE);
    // Channels of a pixel rise and fall together, so that standard deviations add up.
    let variances: Vec<_> = pixels(&folder.join("reference_var.exr"))
        .into_iter()
        .map(|v| Rgb::grey(v.map(f32::sqrt).luminance().powi(2)))
        .collect();
    let variances = tiles(&variances, TILE);
    let of_mean = |variance: f64| variance / (TILE * TILE) as f64;
    means
        .into_iter()
        .zip(variances.into_iter().map(of_mean))
        .collect()
}

/// Relative error of a picture's mean below which its tiles are tested, too: where rare bright paths
/// carry much of the light, tiles that none of them met know nothing of their own variance.
const TAME: f64 = 0.002;

/// Whether a mean of squared z is what Student's t of 15 degrees of freedom makes it, 15 / 13.
fn is_one(mean_square: f64) -> bool {
    (0.8..1.5).contains(&mean_square)
}

/// How far two sets of tile means lie apart.
struct Distance {
    /// Mean of the squared z of all tiles.
    mean_square: f64,
    /// Ratio of the means of the whole pictures, and its standard error.
    ratio: f64,
    error: f64,
}

fn distance(replicas: &Replicas, reference: &[(f64, f64)]) -> Distance {
    let own = replicas.summary();
    let z = own
        .iter()
        .zip(reference)
        .map(|(a, b)| (a.0 - b.0).powi(2) / (a.1 + b.1));
    let sum = |values: &[(f64, f64)]| {
        let add = |(m, v): (f64, f64), (mean, variance): &(f64, f64)| (m + mean, v + variance);
        values.iter().fold((0.0, 0.0), add)
    };
    let ((a, a_variance), (b, b_variance)) = (sum(&own), sum(reference));
    Distance {
        mean_square: z.sum::<f64>() / own.len() as f64,
        ratio: a / b,
        error: (a_variance + b_variance).sqrt() / b,
    }
}

#[test]
fn pictures_agree_with_references() {
    for folder in folders() {
        let name = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let imported = import(&folder.join("scene.xml"), &ImportOptions::default());
        let imported = imported.unwrap_or_else(|error| panic!("{error}"));
        let view = &imported.views[0];
        let side = view.film_size.0;
        let replicas = Replicas::new(1, REPLICAS, |seed| {
            let settings = PixelSettings {
                filter: view.filter,
                sampler: SamplerKind::Independent,
                ..settings(seed, side)
            };
            tiles(
                &picture(&imported.scene, &view.sensor, "path", settings, 1),
                TILE,
            )
        });
        let reference = reference(&folder);
        let found = distance(&replicas, &reference);
        eprintln!(
            "{name}: mean z² {:.3}, ratio {:.5} ± {:.5}",
            found.mean_square, found.ratio, found.error
        );
        let tame = found.error < TAME;
        assert!(
            !tame || is_one(found.mean_square),
            "{name}: mean z² {}",
            found.mean_square
        );
        let off = (found.ratio - 1.0) / found.error;
        assert!(
            off.abs() < 4.0,
            "{name}: ratio {}, {off:.1} standard errors",
            found.ratio
        );

        // Two per cent more light must be seen, where so few samples can tell.
        let darker: Vec<_> = reference.iter().map(|(m, v)| (m / 1.02, *v)).collect();
        let planted = distance(&replicas, &darker);
        let seen = (planted.ratio - 1.0) / planted.error > 4.0 && !is_one(planted.mean_square);
        assert!(seen || !tame, "{name}: a planted error stays unseen");
    }
}

#[test]
fn the_reader_of_references_takes_all_of_them() {
    for folder in folders() {
        let image = pixels(&folder.join("reference.exr"));
        assert_eq!(image.len(), 256 * 256);
        assert!(mean(&image) > 0.0);
    }
}
