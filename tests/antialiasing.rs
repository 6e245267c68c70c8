//! Textures are smoothed by the samples of a pixel: to the error that `docs/scene-format.md` states.

use std::path::Path;

use lumiflow::film::Window;
use lumiflow::integrator::PixelSettings;
use lumiflow::math::Rgb;
use lumiflow::random::SamplerKind;
use lumiflow::scene::import::{ImportOptions, Imported, import};

use crate::support::render::{picture, settings};

/// Width and height of the film.
const SIZE: (u32, u32) = (64, 48);

fn textured_plane() -> Imported {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/textured-plane/scene.xml");
    let options = ImportOptions {
        film_size: Some(SIZE),
        ..ImportOptions::default()
    };
    import(&file, &options).expect("the scene of this project loads")
}

/// The plane with some samples a pixel, by the scene's own filter and sampler.
fn plane(imported: &Imported, seed: u64, samples: u32) -> Vec<Rgb> {
    let view = &imported.views[0];
    let settings = PixelSettings {
        film_size: SIZE,
        window: Window::full(SIZE.0, SIZE.1),
        filter: view.filter,
        sampler: SamplerKind::Sobol,
        ..settings(seed, SIZE.0)
    };
    picture(&imported.scene, &view.sensor, "direct", settings, samples)
}

fn root_mean_square(image: &[Rgb], reference: &[Rgb]) -> f64 {
    let squared = |(a, b): (&Rgb, &Rgb)| f64::from(a.g() - b.g()).powi(2);
    let sum: f64 = image.iter().zip(reference).map(squared).sum();
    (sum / image.len() as f64).sqrt()
}

/// On a film half as large as the documented one, squares are half as large, and errors larger.
#[test]
fn textures_are_as_smooth_as_documented() {
    let imported = textured_plane();
    let reference = plane(&imported, 1, 4096);
    let error = |samples| root_mean_square(&plane(&imported, 2, samples), &reference);
    for (samples, most) in [(16, 0.02), (64, 0.01), (256, 0.006)] {
        let found = error(samples);
        assert!(found < most, "{samples}: {found}");
    }
    // One sample is aliased.
    let aliased = error(1);
    assert!(aliased > 0.05, "{aliased}");
}
