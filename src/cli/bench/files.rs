//! What a bench writes.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cli::failure::Failure;
use crate::cli::outputs::check_file;
use crate::image::{AtomicFile, ExrOptions, Image};
use crate::output::{SaveOptions, save};
use crate::report::Bench;

/// The folder of a bench's files.
pub(super) struct Folder<'a>(pub(super) &'a Path);

const TABLE: &str = "bench.md";
const LINES: &str = "bench.csv";
const ALL: &str = "bench.json";

impl Folder<'_> {
    /// Makes the folder, and tries whether files can be written there.
    ///
    /// # Errors
    /// When that cannot be done.
    pub(super) fn prepare(&self) -> Result<(), Failure> {
        let folder = self.0;
        fs::create_dir_all(folder).map_err(|error| {
            Failure::File(format!(
                "cannot make the folder {}: {error}",
                folder.display()
            ))
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
        let text = format!("# Bench\n\n{}\n\n{}\n", about.join("\n"), bench.markdown());
        self.put(TABLE, text.as_bytes())?;
        let lines = bench
            .csv()
            .map_err(|error| Failure::File(error.to_string()))?;
        self.put(LINES, &lines)?;
        self.put(ALL, format!("{:#}\n", bench.json()).as_bytes())
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.0.join(name);
        let mut file = AtomicFile::create(&path)?;
        file.write_all(bytes)
            .map_err(|error| Failure::File(format!("cannot write {}: {error}", path.display())))?;
        Ok(file.persist()?)
    }

    /// Files of an image.
    pub(super) fn images(&self, scene: &str, integrator: &str, budget: &str) -> Vec<PathBuf> {
        let budget = budget.replace(' ', "");
        let file = |kind| self.0.join(format!("{scene}-{integrator}-{budget}.{kind}"));
        ["exr", "png"].map(file).to_vec()
    }
}

/// Writes an image to all of its files.
///
/// # Errors
/// When one of them cannot be written.
pub(super) fn save_all(files: &[PathBuf], image: &Image) -> Result<(), Failure> {
    let options = SaveOptions {
        exr: ExrOptions::default(),
        exposure: 0.0,
    };
    for file in files {
        save(file, image, &options)?;
    }
    Ok(())
}
