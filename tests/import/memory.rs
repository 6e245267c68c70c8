//! Scenes that do not fit into memory.

use std::path::Path;

use lumiflow::scene::import::xml::Strictness;
use lumiflow::scene::import::{Gauge, ImportError, ImportOptions, import};

use super::options;

#[test]
fn scenes_that_do_not_fit_into_memory_are_refused() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell-box/scene.xml");
    let within = |bytes: u64| {
        let options = ImportOptions {
            gauge: Gauge::new(move || Some(bytes)),
            ..options(Strictness::Normal)
        };
        import(&file, &options)
    };
    // 36 triangles of at most 120 bytes.
    assert!(within(4320).is_ok());
    let error = within(4319).expect_err("one byte is missing");
    let ImportError::Memory { shortage, .. } = &error else {
        panic!("{error}");
    };
    assert_eq!(
        (shortage.needed.tree.peak, shortage.available),
        (4320, 4319)
    );
    let text = error.to_string();
    assert!(
        text.contains("scene.xml: the scene needs about 0.00 GiB of memory (meshes"),
        "{text}"
    );
}
