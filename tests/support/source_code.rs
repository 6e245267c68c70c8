//! The project's own sources, as text to be checked.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// One Rust file.
pub(crate) struct SourceFile {
    /// Path from the project's folder, with `/`.
    pub(crate) path: String,
    pub(crate) text: String,
    /// The text line by line, without comments and the content of literals.
    pub(crate) code: Vec<String>,
    /// For each line, whether it is compiled for tests only.
    pub(crate) is_test: Vec<bool>,
}

pub(crate) fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The Rust files of some folders of the project, in the order of their paths.
pub(crate) fn rust_files(folders: &[&str]) -> Vec<SourceFile> {
    let mut paths = Vec::new();
    for folder in folders {
        collect(&project().join(folder), &mut paths);
    }
    paths.sort();
    let read = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path:?}: {e}"));
        let relative = path.strip_prefix(project()).unwrap_or(path);
        (relative.to_string_lossy().replace('\\', "/"), text)
    };
    let mut files: Vec<_> = paths
        .iter()
        .map(read)
        .map(|(p, t)| SourceFile::new(p, t))
        .collect();
    let for_tests: BTreeSet<_> = files.iter().flat_map(SourceFile::test_modules).collect();
    for file in &mut files {
        let inside =
            |m: &String| file.path == format!("{m}.rs") || file.path.starts_with(&format!("{m}/"));
        if for_tests.iter().any(inside) || !file.path.contains("src/") {
            file.is_test.fill(true);
        }
    }
    files
}

impl SourceFile {
    pub(crate) fn new(path: String, text: String) -> Self {
        let code: Vec<_> = without_comments(&text).lines().map(str::to_owned).collect();
        let is_test = test_lines(&code);
        Self {
            path,
            text,
            code,
            is_test,
        }
    }

    /// Names of the modules that lead to this file, from the crate's root: empty for `lib.rs`.
    pub(crate) fn module_path(&self) -> Vec<&str> {
        let inside = self
            .path
            .split_once("src/")
            .map_or("", |(_, inside)| inside);
        let mut parts: Vec<_> = inside.trim_end_matches(".rs").split('/').collect();
        if matches!(parts.last(), Some(&"mod" | &"lib")) {
            parts.pop();
        }
        parts
    }

    /// Paths without `.rs` of the modules that this file declares for tests.
    fn test_modules(&self) -> Vec<String> {
        let folder = self
            .path
            .trim_end_matches(".rs")
            .trim_end_matches("/mod")
            .trim_end_matches("/lib");
        let pairs = self.code.windows(2);
        pairs
            .filter(|pair| pair[0].trim() == "#[cfg(test)]")
            .filter_map(|pair| pair[1].trim().strip_suffix(';')?.rsplit_once("mod "))
            .map(|(_, name)| format!("{folder}/{name}"))
            .collect()
    }

    /// The functions: name, first line (from 1) and number of lines.
    pub(crate) fn functions(&self) -> Vec<(String, usize, usize)> {
        let mut functions = Vec::new();
        for (index, line) in self.code.iter().enumerate() {
            let Some(at) = find_word(line, "fn") else {
                continue;
            };
            let name: String = line[at + 2..]
                .trim_start()
                .chars()
                .take_while(|c| is_word(*c))
                .collect();
            if let Some(last) = self.end_of_block(index, at).filter(|_| !name.is_empty()) {
                functions.push((name, index + 1, last - index + 1));
            }
        }
        functions
    }

    /// Last line of the block that opens at or after a place; `None` where `;` comes first.
    fn end_of_block(&self, line: usize, column: usize) -> Option<usize> {
        let mut braces = 0;
        let mut others = 0;
        for (index, text) in self.code.iter().enumerate().skip(line) {
            let start = if index == line { column } else { 0 };
            for c in text[start..].chars() {
                match c {
                    '{' => braces += 1,
                    '}' => braces -= 1,
                    '(' | '[' => others += 1,
                    ')' | ']' => others -= 1,
                    ';' if braces == 0 && others == 0 => return None,
                    _ => {}
                }
                if c == '}' && braces == 0 {
                    return Some(index);
                }
            }
        }
        None
    }
}

pub(crate) fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Where a word stands in a line; not as a part of a longer one.
pub(crate) fn find_word(line: &str, word: &str) -> Option<usize> {
    line.match_indices(word).map(|(at, _)| at).find(|at| {
        let before = line[..*at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        !before.is_some_and(is_word) && !after.is_some_and(is_word)
    })
}

/// Blanks comments and the content of literals, keeping every line where it is.
fn without_comments(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = literal_length(rest, out.chars().next_back()) {
            length
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        out.extend(rest[..skipped].chars().filter(|c| *c == '\n'));
        rest = &rest[skipped..];
    }
    out
}

/// Length of the text or character that begins here.
fn literal_length(rest: &str, before: Option<char>) -> Option<usize> {
    let raw = rest
        .strip_prefix('r')
        .map(|r| (r, r.len() - r.trim_start_matches('#').len()));
    if let Some((raw, hashes)) = raw {
        if raw[hashes..].starts_with('"') && !before.is_some_and(|c| is_word(c) && c != 'b') {
            let end = format!("\"{}", "#".repeat(hashes));
            let open = 1 + hashes + 1;
            return rest[open..].find(&end).map(|at| open + at + end.len());
        }
    }
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return Some(at + 1),
            // A lifetime: no quote follows its first letter.
            _ if quote == '\'' && !rest[at + c.len_utf8()..].starts_with('\'') => return None,
            _ => {}
        }
        // The rest of an escaped character, as in '\u{1}'.
        if quote == '\'' && c == '\\' {
            return rest[at + 2..].find('\'').map(|end| at + 2 + end + 1);
        }
    }
    None
}

/// For each line, whether it stands in an item under `#[cfg(test)]`.
fn test_lines(code: &[String]) -> Vec<bool> {
    let mut is_test = vec![false; code.len()];
    let mut depth = 0_i32;
    // Depth outside of the item under way, once `#[cfg(test)]` has been seen.
    let mut item: Option<(i32, bool)> = None;
    for (index, line) in code.iter().enumerate() {
        if item.is_none() && line.trim() == "#[cfg(test)]" {
            item = Some((depth, false));
        }
        is_test[index] = item.is_some();
        for c in line.chars() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if let Some((outside, opened)) = &mut item {
                *opened |= c == '{';
                if (c == '}' && depth == *outside && *opened) || (c == ';' && depth == *outside) {
                    item = None;
                }
            }
        }
    }
    is_test
}

#[test]
fn comments_and_literals_are_blanked() {
    let text = "let a = \"crate::x // {\"; // unsafe\nlet b: &'a str = '\\''; /* two\nlines */ let c = r#\"\"}\"#;";
    let found = without_comments(text);
    assert_eq!(found, "let a = ; \nlet b: &'a str = ; \n let c = ;");
}

#[test]
fn items_for_tests_and_functions_are_found() {
    let text = "fn a(x: [u8; 2]) {\n}\n#[cfg(test)]\nmod tests {\n    fn b();\n    fn c() {\n    }\n}\nfn d() {}\n";
    let file = SourceFile::new("src/scene/mod.rs".into(), text.into());
    assert_eq!(
        file.is_test,
        [false, false, true, true, true, true, true, true, false]
    );
    let expected = [("a", 1, 2), ("c", 6, 2), ("d", 9, 1)];
    assert_eq!(
        file.functions(),
        expected.map(|(name, line, n)| (name.to_owned(), line, n))
    );
    assert_eq!(file.module_path(), ["scene"]);
}
