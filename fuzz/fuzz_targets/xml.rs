//! Any bytes as a Mitsuba scene file: the typed tree, its diagnostics and its getters.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lumiflow::scene::import::xml::{
    ColourUse, Diagnostic, ElementReader, ReadOptions, read_string,
};

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    let document = read_string("fuzz.xml", &text, &ReadOptions::default());
    let tree = &document.tree;
    for id in tree.ids() {
        let mut reader = tree.reader(id, &document.problems);
        for property in &tree[id].properties {
            ask(&mut reader, &property.name.written);
        }
        reader.finish();
    }
    let lines = text.lines().count() as u32 + 1;
    for problem in document.problems.sorted() {
        assert_says_where(&problem, lines);
    }
});

/// Asks for a property as every type: a plugin may want another one than the file has.
fn ask(reader: &mut ElementReader<'_>, name: &str) {
    reader.float(name, 0.0);
    reader.integer(name, 0);
    reader.boolean(name, false);
    reader.string(name, "");
    reader.vector2(name);
    reader.vector3(name);
    reader.transform(name);
    reader.number_or_name(name);
    for wanted in [ColourUse::Reflectance, ColourUse::Emission] {
        if let Some(colour) = reader.colour(name, wanted) {
            assert!(colour.0.is_finite(), "{name}: {colour:?}");
        }
    }
}

fn assert_says_where(problem: &Diagnostic, lines: u32) {
    assert!(!problem.message.is_empty());
    let Some(location) = &problem.location else {
        panic!("no command line, but {problem}")
    };
    // An included file may be longer.
    if location.source.order == 0 {
        assert!((1..=lines).contains(&location.line), "{problem}");
    }
    assert!(location.column >= 1, "{problem}");
}
