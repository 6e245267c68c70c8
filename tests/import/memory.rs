//! Scenes that do not fit into memory.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use lumiflow::scene::import::xml::Strictness;
use lumiflow::scene::import::{Gauge, ImportError, ImportOptions, Imported, Shortage, import};
use tempfile::TempDir;

use super::options;
use crate::determinism::on_threads;

/// Imports a file where so many bytes are available.
fn within(file: &Path, bytes: u64) -> Result<Imported, ImportError> {
    let options = ImportOptions {
        gauge: Gauge::new(move || Some(bytes)),
        ..options(Strictness::Lenient)
    };
    import(file, &options)
}

/// What is short.
fn shortage(imported: Result<Imported, ImportError>) -> Shortage {
    match imported {
        Err(ImportError::Memory { shortage, .. }) => *shortage,
        other => panic!("{other:?}"),
    }
}

#[test]
fn scenes_that_do_not_fit_into_memory_are_refused() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-box/scene.xml");
    // 36 triangles of at most 120 bytes.
    assert!(within(&file, 4320).is_ok());
    let error = within(&file, 4319).expect_err("one byte is missing");
    let text = error.to_string();
    assert!(
        text.contains("scene.xml: the scene needs about 0.00 GiB of memory (meshes"),
        "{text}"
    );
    let Shortage::Building { needed, available } = shortage(Err(error)) else {
        panic!("{text}");
    };
    assert_eq!((needed.tree.peak, available), (4320, 4319));
}

/// A folder with two meshes of a triangle each and a scene that shows them; the bytes of a mesh's file.
fn two_meshes() -> (TempDir, u64) {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".repeat(40);
    let mut shapes = String::new();
    for name in ["a.obj", "b.obj"] {
        fs::write(folder.path().join(name), &mesh).expect("a mesh");
        let _ = write!(
            shapes,
            r#"<shape type="obj"><string name="filename" value="{name}"/></shape>"#
        );
    }
    let scene = format!(r#"<scene version="3.0.0"><sensor type="perspective"/>{shapes}</scene>"#);
    fs::write(folder.path().join("scene.xml"), scene).expect("a scene");
    (folder, mesh.len() as u64)
}

#[test]
fn files_are_not_read_into_memory_that_is_not_there() {
    let (folder, size) = two_meshes();
    let file = folder.path().join("scene.xml");
    let one_tree = 40 * 120;
    assert!(size < one_tree, "else the first file decides");
    // One alone fits. Beside the tree over its triangles the other one does not; nor does it help that
    // what cannot be read may be left out.
    let Shortage::Reading { tree, .. } = on_threads(1, || shortage(within(&file, size))) else {
        panic!("both files were read")
    };
    assert_eq!(tree, one_tree);
    let Shortage::Reading { size: found, .. } = shortage(within(&file, size - 1)) else {
        panic!("a file of {size} bytes was read");
    };
    assert_eq!(found, size);
    assert!(within(&file, 2 * one_tree).is_ok());
}

#[test]
fn models_and_pictures_are_not_read_into_memory_that_is_not_there() {
    let (folder, size) = two_meshes();
    let model = folder.path().join("a.obj");
    let Shortage::Reading { file, .. } = shortage(within(&model, size - 1)) else {
        panic!("a model of {size} bytes was read");
    };
    assert_eq!(file, model);
    let scene = r#"<scene version="3.0.0"><sensor type="perspective"/>
        <emitter type="envmap"><string name="filename" value="sky.png"/></emitter></scene>"#;
    let file = folder.path().join("sky.xml");
    fs::write(&file, scene).expect("a scene");
    fs::write(folder.path().join("sky.png"), [0; 100]).expect("a picture");
    assert!(matches!(
        shortage(within(&file, 99)),
        Shortage::Reading { size: 100, .. }
    ));
    // It is read, and no picture.
    assert!(matches!(
        within(&file, 100),
        Ok(_) | Err(ImportError::Scene(_))
    ));
}
