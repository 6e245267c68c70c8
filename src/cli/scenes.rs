//! Reading scenes as the arguments say.

use std::path::Path;

use super::args::SceneArgs;
use super::failure::Failure;
use crate::scene::import::xml::{ReadOptions, Strictness};
use crate::scene::import::{ImportOptions, Imported, import};

impl SceneArgs {
    /// How severely problems are judged.
    pub(super) fn strictness(&self) -> Strictness {
        match (self.strict, self.lenient) {
            (true, _) => Strictness::Strict,
            (_, true) => Strictness::Lenient,
            _ => Strictness::Normal,
        }
    }

    /// Reads a scene.
    ///
    /// # Errors
    /// A file that cannot be read, or a scene that cannot be rendered.
    pub(super) fn load(&self, file: &Path) -> Result<Imported, Failure> {
        let options = ImportOptions {
            read: ReadOptions {
                definitions: self.definitions.clone(),
                search_paths: self.search_paths.clone(),
                strictness: self.strictness(),
            },
            film_size: self.size,
        };
        Ok(import(file, &options)?)
    }
}
