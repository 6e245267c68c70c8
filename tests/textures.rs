//! The textures of `scenes/` are those that `examples/make_textures` makes.

use std::fs;
use std::path::Path;

#[path = "../examples/make_textures/textures.rs"]
mod recipes;

/// Sines differ by a rounding from system to system: edges may move by a pixel here and there.
const TOLERANCE: f64 = 1e-3;

/// The part of the codes that differ by more than one.
fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len(), "sizes");
    let far = a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 1);
    far.count() as f64 / a.len() as f64
}

#[test]
fn stored_textures_are_those_that_are_made() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/textures");
    for (name, make) in recipes::ALL {
        let path = folder.join(format!("{name}.png"));
        let bytes = fs::read(&path).expect(name);
        assert!(bytes.len() <= 100_000, "{name} is large");
        let made = make();
        let stored = image::load_from_memory(&bytes).expect(name).into_rgb8();
        assert_eq!(stored.width() as usize, made.width, "{name}");
        let far = difference(&made.codes, stored.as_raw());
        assert!(far < TOLERANCE, "{name}: {far}; see examples/make_textures");
        let made = image::load_from_memory(&made.to_png()).expect(name);
        assert_eq!(made.into_rgb8().as_raw(), &make().codes, "{name}");
    }
    let stored = fs::read_dir(folder).expect("scenes/textures").count();
    assert_eq!(stored, recipes::ALL.len(), "files without a recipe");
}

#[test]
fn another_texture_is_told_from_it() {
    let (_, make) = recipes::ALL[0];
    let made = make().codes;
    let mut shifted = made.clone();
    shifted.rotate_left(3);
    assert!(difference(&made, &made) == 0.0);
    assert!(difference(&made, &shifted) > 10.0 * TOLERANCE);
}
