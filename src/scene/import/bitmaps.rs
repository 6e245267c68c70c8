//! Pictures, which all processors decode at once before materials are built.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_64;

use super::loader::Loader;
use super::shortage::MemoryWatch;
use super::xml::{Diagnostics, Location, Strictness};
use crate::image::{self, Bitmap};

/// The plugins that name a picture.
const PLUGINS: [&str; 4] = ["bitmap", "ldrtexture", "exrtexture", "envmap"];

/// What came of reading a picture.
pub(super) enum Outcome {
    /// The file cannot be read.
    Unreadable(String),
    /// There is no memory for the file, as the loader's watch has noted.
    NoMemory,
    /// The hash of its bytes, and what they decode to or why they do not.
    Read(u64, Result<Arc<Bitmap>, String>),
}

impl Loader<'_> {
    /// Reads the pictures that elements of the file name; what is wrong is told where they are used.
    pub(super) fn read_bitmaps_ahead(&mut self) {
        let quiet = Diagnostics::new(Strictness::Lenient);
        let pictures = self.tree.ids().filter(|id| {
            let plugin = self.tree[*id].plugin.as_str();
            PLUGINS.contains(&plugin)
        });
        let files =
            pictures.filter_map(|id| self.tree.reader(id, &quiet).optional_file("filename"));
        let files: HashSet<PathBuf> = files.collect();
        let memory = &self.memory;
        let read = files.into_par_iter().map(|file| {
            let outcome = read(&file, memory);
            (file, outcome)
        });
        self.decoded = read.collect();
    }

    /// Takes a picture, or finds the one that was taken before, and takes it into the scene's hash; one
    /// that cannot be read is noted.
    pub(super) fn read_bitmap(&mut self, file: &Path, location: &Location) -> Option<Arc<Bitmap>> {
        if let Some(known) = self.bitmaps.get(file) {
            return known.clone();
        }
        let outcome = self
            .decoded
            .remove(file)
            .unwrap_or_else(|| read(file, &self.memory));
        let decoded = match outcome {
            Outcome::NoMemory => return None,
            Outcome::Unreadable(message) => Err(message),
            Outcome::Read(hash, decoded) => {
                self.take_into_hash(&hash.to_le_bytes());
                decoded
            }
        };
        let noted = decoded.map_err(|message| {
            self.problems.unsupported(location, message, "left out");
        });
        let bitmap = noted.ok();
        let bytes = bitmap.as_ref().map_or(0, |bitmap| bitmap.memory());
        self.builder.note_pictures(bytes);
        self.bitmaps.insert(file.to_owned(), bitmap.clone());
        bitmap
    }
}

fn read(file: &Path, memory: &MemoryWatch) -> Outcome {
    if !memory.admits(file) {
        return Outcome::NoMemory;
    }
    match std::fs::read(file) {
        Err(reason) => Outcome::Unreadable(format!("cannot read {}: {reason}", file.display())),
        Ok(bytes) => {
            let hash = xxh3_64(&bytes);
            drop(bytes);
            let decoded = image::read_bitmap(file).map(Arc::new);
            Outcome::Read(hash, decoded.map_err(|error| error.to_string()))
        }
    }
}
