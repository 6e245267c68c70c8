//! Scenes to measure on.

use std::path::{Path, PathBuf};

use lumiflow::scene::Scene;
use lumiflow::scene::import::{ImportOptions, View, import};

/// Width and height of all films, in pixels.
pub(crate) const SIDE: u32 = 64;

/// The file of one of the project's scenes.
pub(crate) fn file_of(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join(format!("scenes/{name}/scene.xml"))
}

/// A scene with its first view, on a small film.
pub(crate) fn load(file: &Path) -> (Scene, View) {
    let options = ImportOptions {
        film_size: Some((SIDE, SIDE)),
        ..ImportOptions::default()
    };
    match import(file, &options) {
        Ok(mut imported) => (imported.scene, imported.views.swap_remove(0)),
        Err(error) => panic!("{error}"),
    }
}
