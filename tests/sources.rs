//! Every source that a comment names is listed in `docs/sources.md`, and the list is right.

use std::collections::{BTreeMap, BTreeSet};

use crate::support::source_code::{project, rust_files};

/// The table's keys, each with the files that it says cite it.
fn listed(text: &str) -> BTreeMap<String, BTreeSet<String>> {
    let rows = text.lines().filter_map(|line| line.strip_prefix("| **"));
    rows.filter_map(|row| row.split_once("** |"))
        .map(|(key, rest)| {
            let files = rest.rsplit('|').nth(1).unwrap_or_default();
            let files = files.split('`').skip(1).step_by(2).map(str::to_owned);
            (key.to_owned(), files.collect())
        })
        .collect()
}

/// The texts after `Source:` in a file's comments, each with its line (from 1).
fn citations(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut open = false;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start();
        let comment = line
            .strip_prefix("//")
            .map(|c| c.trim_start_matches(['/', '!']).trim());
        match comment {
            Some(comment) if comment.starts_with("Source: ") => {
                found.push((index + 1, comment["Source: ".len()..].to_owned()));
                open = true;
            }
            Some(comment) if open && !comment.is_empty() => {
                if let Some((_, citation)) = found.last_mut() {
                    citation.push(' ');
                    citation.push_str(comment);
                }
            }
            _ => open = false,
        }
    }
    found
}

/// The keys in a citation; an error where a year belongs to none, or there is no key at all.
fn keys<'k>(
    citation: &str,
    known: impl Iterator<Item = &'k String>,
) -> Result<Vec<String>, String> {
    let mut rest = citation.to_owned();
    let mut found = Vec::new();
    for key in known {
        if rest.contains(key.as_str()) {
            rest = rest.replace(key.as_str(), "");
            found.push(key.clone());
        }
    }
    let words = rest.split(|c: char| !c.is_alphanumeric());
    let is_year = |word: &&str| {
        word.len() == 4 && word.starts_with(['1', '2']) && word.parse::<u32>().is_ok()
    };
    match words.into_iter().find(is_year) {
        Some(year) => Err(format!("no key for {year} in \"{citation}\"")),
        None if found.is_empty() => Err(format!("no key in \"{citation}\"")),
        None => Ok(found),
    }
}

#[test]
fn every_source_is_listed_with_the_files_that_cite_it() {
    let text = std::fs::read_to_string(project().join("docs/sources.md")).expect("docs/sources.md");
    let listed = listed(&text);
    assert!(!listed.is_empty());
    let mut cited: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut wrong = Vec::new();
    for file in rust_files(&["src", "ffi"]) {
        for (line, citation) in citations(&file.text) {
            match keys(&citation, listed.keys()) {
                Ok(keys) => {
                    for key in keys {
                        cited.entry(key).or_default().insert(file.path.clone());
                    }
                }
                Err(error) => wrong.push(format!("{}:{line}: {error}", file.path)),
            }
        }
    }
    for (key, files) in &listed {
        let found = cited.remove(key).unwrap_or_default();
        if found != *files {
            let found: Vec<_> = found.iter().map(|file| format!("`{file}`")).collect();
            wrong.push(format!(
                "docs/sources.md: {key} is cited by {}",
                found.join(", ")
            ));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn unknown_sources_are_found() {
    let text =
        "| Key | Reference | Cited by |\n| **Veach 1997** | A thesis. | `src/a.rs`, `src/b.rs` |";
    let listed = listed(text);
    assert_eq!(listed["Veach 1997"].len(), 2);
    let found = citations(
        "/// What.\n///\n/// Source: Veach 1997, Ch. 8,\n/// and so on.\nfn f() {}\n// Source: Nobody 2001.",
    );
    let texts: Vec<_> = found
        .iter()
        .map(|(line, text)| (*line, text.as_str()))
        .collect();
    assert_eq!(
        texts,
        [(3, "Veach 1997, Ch. 8, and so on."), (6, "Nobody 2001.")]
    );
    assert_eq!(
        keys(texts[0].1, listed.keys()),
        Ok(vec!["Veach 1997".to_owned()])
    );
    let error = keys(texts[1].1, listed.keys()).unwrap_err();
    assert_eq!(error, "no key for 2001 in \"Nobody 2001.\"");
    assert!(keys("Veach 1997; Nobody 2001", listed.keys()).is_err());
    assert!(keys("common sense", listed.keys()).is_err());
}
