//! What a bench writes.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;
use xxhash_rust::xxh3::xxh3_64;

use crate::cli::failure::Failure;
use crate::cli::outputs::check_file;
use crate::image::AtomicFile;
use crate::report::{Bench, Trial, read_trial, stored_trial};

/// The folder of a bench's files.
pub(super) struct Folder<'a>(pub(super) &'a Path);

const TABLE: &str = "bench.md";
const LINES: &str = "bench.csv";
const ALL: &str = "bench.json";

/// Folder of what belongs to single renders.
const RUNS: &str = "runs";

/// Most characters of a name in the stem of a render's files.
const LONGEST_NAME: usize = 60;

impl Folder<'_> {
    /// Makes the folder, and tries whether files can be written there.
    ///
    /// # Errors
    /// When that cannot be done.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        let folder = self.0.join(RUNS);
        fs::create_dir_all(&folder).map_err(|error| {
            let folder = folder.display();
            Failure::File(format!("cannot make the folder {folder}: {error}"))
        })?;
        [TABLE, LINES, ALL]
            .iter()
            .try_for_each(|name| check_file(&folder.join(name)))
    }

    /// Writes the tables; each appears whole, in place of what was there.
    ///
    /// # Errors
    /// When one of them cannot be written.
    pub(super) fn write(&self, bench: &Bench) -> Result<(), Failure> {
        let about = bench.about.iter();
        let about: Vec<String> = about
            .map(|(name, value)| format!("- {name}: `{value}`"))
            .collect();
        let mut text = format!("# Bench\n\n{}\n\n{}\n", about.join("\n"), bench.markdown());
        for scene in &bench.scenes {
            let names = [self.plot(&scene.name), self.crops(&scene.name)];
            for name in names.iter().filter(|name| self.0.join(name).is_file()) {
                text.push_str(&format!("\n![{}]({name})\n", scene.name));
            }
        }
        self.put(TABLE, text.as_bytes())?;
        let lines = bench
            .csv()
            .map_err(|error| Failure::File(error.to_string()))?;
        self.put(LINES, &lines)?;
        self.put(ALL, format!("{:#}\n", bench.json()).as_bytes())
    }

    /// Writes a file, whole or not at all.
    ///
    /// # Errors
    /// When that cannot be done.
    pub(super) fn put(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.path(name);
        let mut file = AtomicFile::create(&path)?;
        file.write_all(bytes)
            .map_err(|error| Failure::File(format!("cannot write {}: {error}", path.display())))?;
        Ok(file.persist()?)
    }

    /// Path of a file.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Name of a scene's plot.
    pub(super) fn plot(&self, scene: &str) -> String {
        format!("{}-error.svg", plain(scene))
    }

    /// Name of a scene's images side by side.
    pub(super) fn crops(&self, scene: &str) -> String {
        format!("{}-crops.png", plain(scene))
    }

    /// Path of a file that belongs to one render.
    ///
    /// - `stem`: of [`stem`].
    pub(super) fn of_run(&self, stem: &str, kind: &str) -> PathBuf {
        self.0.join(RUNS).join(format!("{stem}.{kind}"))
    }

    /// The record of a render; `None` where there is none.
    ///
    /// # Errors
    /// For a record that cannot be read, and for a damaged one.
    pub(super) fn recorded(&self, stem: &str, key: &Value) -> Result<Option<Trial>, Failure> {
        let path = self.of_run(stem, "json");
        let refuse = |reason: String| {
            let path = path.display();
            Err(Failure::File(format!(
                "{path}: damaged record: {reason}; delete it to make that render again"
            )))
        };
        match fs::read_to_string(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => refuse(error.to_string()),
            Ok(text) => match read_trial(&text, key) {
                Ok(trial) => Ok(Some(trial)),
                Err(error) => refuse(error.to_string()),
            },
        }
    }

    /// Keeps a render.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn record(&self, stem: &str, key: &Value, trial: &Trial) -> Result<(), Failure> {
        let name = format!("{RUNS}/{stem}.json");
        self.put(&name, stored_trial(key, trial).as_bytes())
    }
}

/// The name of a render's files without extension: for people, and with a hash of all that decides
/// what is measured.
///
/// - `names`: scene, integrator, budget, seed.
pub(super) fn stem(names: [&str; 4], key: &Value) -> String {
    let hash = xxh3_64(key.to_string().as_bytes());
    let [scene, integrator, budget, seed] = names.map(plain);
    format!("{scene}-{integrator}-{budget}-seed{seed}-{hash:016x}")
}

/// A name as a part of a file's name, without what shells and file systems take for their own.
fn plain(name: &str) -> String {
    let letters = name.chars().filter(|c| !c.is_whitespace());
    let plain = letters.map(|c| match c {
        '.' | '_' | '-' | '=' | '+' => c,
        c if c.is_alphanumeric() => c,
        _ => '_',
    });
    plain.take(LONGEST_NAME).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn names_of_files_tell_renders_apart() {
        let key = json!({ "seed": 1 });
        let names = ["a box", "erpt:chain_length=50", "0.5 CPU s", "1"];
        let found = stem(names, &key);
        assert!(
            found.starts_with("abox-erpt_chain_length=50-0.5CPUs-seed1-"),
            "{found}"
        );
        assert_ne!(found, stem(names, &json!({ "seed": 2 })));
        assert_eq!(plain("../x y/ä*"), ".._xy_ä_");
        assert_eq!(plain(&"a".repeat(500)).len(), LONGEST_NAME);
    }
}
