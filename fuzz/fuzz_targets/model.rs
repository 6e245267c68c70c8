//! Any bytes as a glTF file, an OBJ file, or a library of an OBJ file, imported to the end.
//!
//! The first byte decides which. Beside the models lie `a.obj`, a triangle with a material of `a.mtl`,
//! and `a.bin`, 256 bytes.

#![no_main]

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use lumiflow::scene::import::xml::{ReadOptions, Strictness};
use lumiflow::scene::import::{ImportOptions, import};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = std::env::temp_dir().join(format!("lumiflow-fuzz-model-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("the folder for temporary files is writable");
    let triangle = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    fs::write(folder.join("a.obj"), triangle).expect("the folder was just made");
    let bytes: Vec<u8> = (0..=255).collect();
    fs::write(folder.join("a.bin"), bytes).expect("the folder was just made");
    folder
});

fuzz_target!(|bytes: &[u8]| {
    let Some((&mode, rest)) = bytes.split_first() else {
        return;
    };
    let (written, opened) = match mode % 3 {
        0 => ("b.glb", "b.glb"),
        1 => ("b.obj", "b.obj"),
        _ => ("a.mtl", "a.obj"),
    };
    fs::write(FOLDER.join(written), rest).expect("the folder was just made");
    let options = ImportOptions {
        // More models get to the end when missing files do not stop them.
        read: ReadOptions {
            strictness: Strictness::Lenient,
            ..ReadOptions::default()
        },
        ..ImportOptions::default()
    };
    match import(&FOLDER.join(opened), &options) {
        Ok(imported) => assert!(!imported.views.is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
