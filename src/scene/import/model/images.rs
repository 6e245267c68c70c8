//! Pictures of models, each read once.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Model;
use crate::image::{self, Bitmap};
use crate::scene::import::xml::Location;

/// The pictures that were read; `None` for those that could not be.
#[derive(Default)]
pub(super) struct Images {
    by_file: HashMap<PathBuf, Option<Arc<Bitmap>>>,
}

impl Model<'_> {
    /// The picture of a name in a file of the model; `None` after noting why there is none.
    pub(super) fn image_named(&mut self, name: &str, location: &Location) -> Option<Arc<Bitmap>> {
        let file = self.files.find_noted(name, location, &self.problems)?;
        if let Some(known) = self.images.by_file.get(&file) {
            return known.clone();
        }
        let read = self.read_image(&file, location).map(Arc::new);
        let bytes = read.as_ref().map_or(0, |picture| picture.memory());
        self.builder.note_pictures(bytes);
        self.images.by_file.insert(file, read.clone());
        read
    }

    fn read_image(&mut self, file: &Path, location: &Location) -> Option<Bitmap> {
        let unsupported = |problem: String| {
            self.problems.unsupported(location, problem, "left out");
        };
        match std::fs::read(file) {
            Ok(bytes) => self.take_into_hash(&bytes),
            Err(reason) => {
                unsupported(format!("cannot read {}: {reason}", file.display()));
                return None;
            }
        }
        let read = image::read_bitmap(file);
        read.map_err(|error| {
            let problem = error.to_string();
            self.problems.unsupported(location, problem, "left out");
        })
        .ok()
    }
}
