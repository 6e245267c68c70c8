//! Tables of XML and what reading it says.

mod bad_values;
mod errors;
mod files;
mod scenes;
mod values;

use super::{Document, ElementId, ElementReader, ReadOptions, read_string};

/// Reads `body` as the inside of a scene of version 3; line 1 is `<scene …>`.
fn read_body(body: &str) -> Document {
    read_scene("3.0.0", body)
}

fn read_scene(version: &str, body: &str) -> Document {
    let text = format!("<scene version=\"{version}\">\n{body}\n</scene>");
    read_string("t.xml", &text, &ReadOptions::default())
}

/// The problems of a document, one a line.
fn problems(document: &Document) -> Vec<String> {
    document
        .problems
        .sorted()
        .iter()
        .map(ToString::to_string)
        .collect()
}

/// Checks everything that reading the inside of a scene says.
fn check(body: &str, expected: &[&str]) {
    assert_eq!(problems(&read_body(body)), expected, "{body}");
}

/// Reads one object with `read`, which stands in for a plugin, and checks all that is said.
fn check_object<T>(
    body: &str,
    read: impl FnOnce(&mut ElementReader<'_>) -> T,
    expected: &[&str],
) -> T {
    let document = read_body(body);
    let first = document.tree[document.tree.root()].children[0].element;
    let mut reader = document.tree.reader(first, &document.problems);
    let result = read(&mut reader);
    reader.finish();
    assert_eq!(problems(&document), expected, "{body}");
    result
}

/// The elements inside `parent`.
fn inside(document: &Document, parent: ElementId) -> Vec<ElementId> {
    document.tree[parent]
        .children
        .iter()
        .map(|child| child.element)
        .collect()
}
