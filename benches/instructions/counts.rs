//! The counts that were accepted.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;

use crate::profile::Count;

/// What stands at the beginning of the file.
const HEAD: &str = "\
# Instructions for each path, mutation or step: of all but Embree, of Embree.
# Written by `cargo bench --bench instructions -- --accept`.
";

/// Counts by compiler and case.
pub(crate) struct Counts(BTreeMap<(String, String), Count>);

fn file() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("benches/instructions/counts.txt")
}

impl Counts {
    /// Reads the file; there may be none.
    pub(crate) fn read() -> Result<Self, String> {
        let text = match std::fs::read_to_string(file()) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(format!("{}: {error}", file().display())),
        };
        let mut counts = BTreeMap::new();
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let bad = || format!("{}: {line}", file().display());
            let words: Vec<&str> = line.split_whitespace().collect();
            let [compiler, case, ours, embree] = words.as_slice() else {
                return Err(bad());
            };
            let number = |word: &str| word.parse().map_err(|_| bad());
            let count = Count {
                ours: number(ours)?,
                embree: number(embree)?,
            };
            counts.insert(((*compiler).to_owned(), (*case).to_owned()), count);
        }
        Ok(Self(counts))
    }

    /// The count of ours that was accepted.
    pub(crate) fn of(&self, compiler: &str, case: &str) -> Option<f64> {
        let key = (compiler.to_owned(), case.to_owned());
        self.0.get(&key).map(|count| count.ours)
    }

    /// Takes another count.
    pub(crate) fn set(&mut self, compiler: &str, case: &str, count: Count) {
        let key = (compiler.to_owned(), case.to_owned());
        self.0.insert(key, count);
    }

    /// Writes the file.
    pub(crate) fn write(&self) -> Result<(), String> {
        let mut text = HEAD.to_owned();
        for ((compiler, case), Count { ours, embree }) in &self.0 {
            text += &format!("{compiler} {case} {ours:.1} {embree:.1}\n");
        }
        let file = file();
        std::fs::write(&file, text).map_err(|error| format!("{}: {error}", file.display()))
    }
}

/// The compiler that is at hand, and what it compiles for.
pub(crate) fn compiler() -> Result<String, String> {
    let program = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let output = Command::new(&program).arg("-vV").output();
    let output = output.map_err(|error| format!("{program}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let value = |key: &str| {
        let found = text.lines().find_map(|line| line.strip_prefix(key));
        found.ok_or_else(|| format!("{program} -vV says nothing of {key}"))
    };
    Ok(format!(
        "rustc-{}-{}",
        value("release: ")?,
        value("host: ")?
    ))
}
