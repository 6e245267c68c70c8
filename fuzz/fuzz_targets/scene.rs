//! Any bytes as a scene file that is imported to the end: plugins, meshes and the tracer.
//!
//! Beside the scene lies `a.obj`, a triangle.

#![no_main]

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use lumiflow::scene::import::xml::{ReadOptions, Strictness};
use lumiflow::scene::import::{ImportOptions, import};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("lumiflow-fuzz-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("the folder for temporary files is writable");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::write(folder.join("a.obj"), triangle).expect("the folder was just made");
    folder
});

fuzz_target!(|bytes: &[u8]| {
    let file = FOLDER.join("scene.xml");
    fs::write(&file, bytes).expect("the folder was just made");
    let options = ImportOptions {
        // More scenes get to the end when what is unknown does not stop them.
        read: ReadOptions {
            strictness: Strictness::Lenient,
            ..ReadOptions::default()
        },
        ..ImportOptions::default()
    };
    match import(&file, &options) {
        Ok(imported) => {
            assert!(!imported.views.is_empty());
            for view in &imported.views {
                assert!(view.film_size.0 > 0 && view.film_size.1 > 0);
                assert!(view.sample_count > 0);
            }
            let bounds = imported.scene.bounds();
            assert!(bounds.centre.is_finite() && bounds.radius.is_finite());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
