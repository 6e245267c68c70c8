//! The archive of real scenes, where it is at hand.

use std::path::{Path, PathBuf};

use super::super::{ElementKind, ReadOptions, read_file};

fn xml_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            xml_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "xml") {
            found.push(path);
        }
    }
}

#[test]
fn real_scenes_are_read_without_errors() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let mut files = Vec::new();
    for folder in ["scenes", "conformance/tests/scenes", "reference"] {
        xml_files(&shared.join(folder), &mut files);
    }
    // Fragments use parameters and folders that only their includers set.
    files.retain(|file| {
        !["fragments", "include"]
            .iter()
            .any(|part| file.iter().any(|p| p == *part))
    });
    if files.is_empty() {
        eprintln!("SKIPPED: no scenes in {}", shared.display());
        return;
    }
    for file in files {
        let document = read_file(&file, &ReadOptions::default()).unwrap();
        let all: Vec<String> = document
            .problems
            .sorted()
            .iter()
            .map(ToString::to_string)
            .collect();
        for line in &all {
            eprintln!("{line}");
        }
        assert!(!document.problems.has_errors(), "{}", file.display());
        let mut root = document
            .tree
            .reader(document.tree.root(), &document.problems);
        assert!(
            !root.children(ElementKind::Shape).is_empty(),
            "{}",
            file.display()
        );
        let expected = usize::from(file.ends_with("veach-door/scene.xml"));
        assert_eq!(all.len(), expected, "{}", file.display());
    }
}
