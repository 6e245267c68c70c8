//! The rules of `ARCHITECTURE.md` about what may stand where.

use std::collections::BTreeMap;

use crate::support::source_code::{SourceFile, find_word, is_word, project, rust_files};

/// Files with more lines are divided.
const LONGEST_FILE: usize = 400;
/// Functions with more lines are divided.
const LONGEST_FUNCTION: usize = 60;

/// What may be longer, and why: file, or `file::function`.
const MAY_BE_LONGER: &[(&str, &str)] = &[];

/// The layer of each module, from the table in `ARCHITECTURE.md`.
fn layers() -> BTreeMap<String, usize> {
    let text = std::fs::read_to_string(project().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    layers_in(&text)
}

fn layers_in(text: &str) -> BTreeMap<String, usize> {
    let mut layers = BTreeMap::new();
    for line in text.lines() {
        let mut cells = line.trim().trim_matches('|').split('|').map(str::trim);
        let Some(layer) = cells.next().and_then(|cell| cell.parse().ok()) else {
            continue;
        };
        let names = cells
            .next()
            .unwrap_or_default()
            .split('`')
            .skip(1)
            .step_by(2);
        layers.extend(names.map(|name| (name.to_owned(), layer)));
    }
    layers
}

/// Names of top-level modules that a line's paths begin with: `crate::a`, `crate::{a, b::c}`,
/// `lumiflow::a`, and chains of `super` that lead out of their top-level module.
fn used_modules(line: &str, module_path: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for root in ["crate", "lumiflow"] {
        let mut rest = line;
        while let Some(at) = find_word(rest, root) {
            rest = &rest[at + root.len()..];
            if let Some(path) = rest.strip_prefix("::") {
                found.extend(first_names(path));
            }
        }
    }
    let chain = "super::".repeat(module_path.len().max(1));
    if let Some((before, path)) = line.split_once(&chain) {
        if !module_path.is_empty() && !before.ends_with(is_word) {
            found.extend(first_names(path));
        }
    }
    found
}

/// First names of a path or of a group of paths.
fn first_names(path: &str) -> Vec<String> {
    let name = |path: &str| -> String { path.trim().chars().take_while(|c| is_word(*c)).collect() };
    let Some(group) = path.strip_prefix('{') else {
        return vec![name(path)];
    };
    let mut depth = 0;
    let inside = |c: char| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    };
    group
        .split(inside)
        .map(name)
        .filter(|name| !name.is_empty())
        .collect()
}

/// Joins groups that go over several lines, so that each `use` stands in its first line.
fn joined(file: &SourceFile) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut open = false;
    for (index, line) in file.code.iter().enumerate() {
        match lines.last_mut().filter(|_| open) {
            Some((_, statement)) => statement.push_str(line),
            None => lines.push((index, line.clone())),
        }
        let starts = find_word(line, "use").is_some() && line.contains('{');
        open = (open || starts) && !line.contains(';');
    }
    lines
}

/// What breaks the layers in a file.
fn breaches(file: &SourceFile, layers: &BTreeMap<String, usize>) -> Vec<String> {
    let path = file.module_path();
    let Some(own) = path.first().copied() else {
        return Vec::new();
    };
    let Some(layer) = layers.get(own) else {
        return vec![format!(
            "{}:1: {own} is not in the table of layers",
            file.path
        )];
    };
    let mut found = Vec::new();
    for (index, line) in joined(file) {
        if file.is_test[index] {
            continue;
        }
        for used in used_modules(&line, &path) {
            let may = used == own || layers.get(&used).is_some_and(|other| other < layer);
            if !may {
                found.push(format!(
                    "{}:{}: {own} may not use {used}",
                    file.path,
                    index + 1
                ));
            }
        }
    }
    found
}

#[test]
fn modules_use_lower_layers_only() {
    let layers = layers();
    assert!(layers["math"] < layers["scene"] && layers["scene"] < layers["integrator"]);
    let found: Vec<_> = rust_files(&["src"])
        .iter()
        .flat_map(|f| breaches(f, &layers))
        .collect();
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn planted_breaches_are_found() {
    let layers = layers_in("| 0 | `math` | x |\n| 1 | `film`, `image` | y |\n| 2 | `bsdf` | z |");
    for (path, text, expected) in [
        (
            "src/math/a.rs",
            "\nuse crate::bsdf::Bsdf;",
            "src/math/a.rs:2: math may not use bsdf",
        ),
        (
            "src/film/mod.rs",
            "use crate::{math::Vec3,\n image};",
            "src/film/mod.rs:1: film may not use image",
        ),
        (
            "src/math/a/b.rs",
            "use super::super::super::film;",
            "src/math/a/b.rs:1: math may not use film",
        ),
        (
            "src/film/mod.rs",
            "fn f() { lumiflow::bsdf::f() }",
            "src/film/mod.rs:1: film may not use bsdf",
        ),
        (
            "src/other.rs",
            "",
            "src/other.rs:1: other is not in the table of layers",
        ),
    ] {
        let file = SourceFile::new(path.into(), text.into());
        assert_eq!(breaches(&file, &layers), [expected]);
    }
    let allowed = "use crate::math::{Vec2, Vec3};\nuse super::microfacet;\n#[cfg(test)]\nmod tests {\n    use crate::other;\n}";
    let file = SourceFile::new("src/bsdf/a.rs".into(), allowed.into());
    assert_eq!(breaches(&file, &layers), Vec::<String>::new());
}

/// Lines outside of tests that hold one of some words, in files that `concerned` picks.
fn uses(words: &[&str], concerned: impl Fn(&SourceFile) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for file in rust_files(&["src"]).iter().filter(|file| concerned(file)) {
        for (index, line) in file
            .code
            .iter()
            .enumerate()
            .filter(|(i, _)| !file.is_test[*i])
        {
            if let Some(word) = words.iter().find(|word| find_word(line, word).is_some()) {
                found.push(format!("{}:{}: {word}", file.path, index + 1));
            }
        }
    }
    found
}

fn is_in(file: &SourceFile, modules: &[&str]) -> bool {
    let path = file.module_path().join("::");
    modules
        .iter()
        .any(|module| path == *module || path.starts_with(&format!("{module}::")))
}

#[test]
fn unsafe_code_stays_behind_the_foreign_functions() {
    for file in rust_files(&["src", "tests", "examples", "benches", "fuzz"]) {
        for (index, line) in file.code.iter().enumerate() {
            assert!(
                find_word(line, "unsafe").is_none(),
                "{}:{}",
                file.path,
                index + 1
            );
        }
    }
}

#[test]
fn files_are_read_and_written_where_that_belongs() {
    let words = ["std::fs", "fs", "File", "OpenOptions", "TcpStream"];
    let may = ["image", "scene::import", "output", "report", "cli"];
    let found = uses(&words, |file| !is_in(file, &may));
    assert!(found.is_empty(), "\n{}", found.join("\n"));
    assert!(!uses(&words, |file| is_in(file, &["image"])).is_empty());
}

#[test]
fn what_is_rendered_knows_no_clock_no_environment_and_no_thread() {
    let layers = layers();
    let highest = layers["integrator"];
    let below = |file: &SourceFile| {
        let own = file.module_path().first().and_then(|own| layers.get(*own));
        own.is_some_and(|layer| *layer <= highest)
    };
    let words = [
        "Instant",
        "SystemTime",
        "env",
        "thread",
        "ThreadId",
        "current_thread_index",
    ];
    let found = uses(&words, below);
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn nothing_is_added_up_in_floating_point_by_several_threads() {
    let found = uses(
        &["AtomicF32", "AtomicF64", "AtomicFloat", "atomic_float"],
        |_| true,
    );
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn files_and_functions_are_short() {
    let mut found = Vec::new();
    for file in rust_files(&["src", "tests", "ffi"]) {
        let mut note = |what: String, lines: usize, longest: usize| {
            let excused = MAY_BE_LONGER.iter().any(|(name, _)| *name == what);
            if lines > longest && !excused {
                found.push(format!("{what} has {lines} lines, more than {longest}"));
            }
            assert!(
                lines > longest || !excused,
                "{what} needs no exception any more"
            );
        };
        note(file.path.clone(), file.text.lines().count(), LONGEST_FILE);
        for (name, _, lines) in file.functions() {
            note(format!("{}::{name}", file.path), lines, LONGEST_FUNCTION);
        }
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn invariants_name_tests_that_exist() {
    let text = std::fs::read_to_string(project().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let table = text
        .split("## ")
        .find(|part| part.starts_with("Invariants"));
    let rows = table
        .unwrap_or_default()
        .lines()
        .filter(|line| line.starts_with("| "));
    let mut count = 0;
    for row in rows.skip(1) {
        let tests = row
            .trim_end_matches('|')
            .rsplit('|')
            .next()
            .unwrap_or_default();
        for name in tests
            .split('`')
            .skip(1)
            .step_by(2)
            .filter(|n| n.chars().all(|c| is_word(c) || c == ':'))
        {
            let (module, test) = name.split_once("::").unwrap_or((name, ""));
            let file = project().join(format!("tests/{module}.rs"));
            let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(
                text.contains(&format!("fn {test}")),
                "{name} does not exist"
            );
            count += 1;
        }
    }
    assert!(count > 10, "{count}");
}
