//! Reading scenes as the arguments say.

use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::args::SceneArgs;
use super::failure::Failure;
use crate::accel::Engine;
use crate::scene::import::xml::{ReadOptions, Strictness};
use crate::scene::import::{ImportOptions, Imported, Progress, import};

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
    /// - `quiet`: no bar on the terminal.
    /// - `engine`: what traces its rays.
    ///
    /// # Errors
    /// A file that cannot be read, or a scene that cannot be rendered.
    pub(super) fn load(
        &self,
        file: &Path,
        quiet: bool,
        engine: Engine,
    ) -> Result<Imported, Failure> {
        let options = ImportOptions {
            read: ReadOptions {
                definitions: self.definitions.clone(),
                search_paths: self.search_paths.clone(),
                strictness: self.strictness(),
            },
            film_size: self.size,
            engine,
            progress: if quiet { Progress::default() } else { bar() },
        };
        Ok(import(file, &options)?)
    }
}

/// A bar on the terminal, if there is one, that goes away when all files are read.
fn bar() -> Progress {
    let bar = ProgressBar::hidden();
    if let Ok(style) = ProgressStyle::with_template("reading {wide_bar} {pos}/{len} files") {
        bar.set_style(style);
    }
    Progress::new(move |done, all| {
        if done == 1 {
            bar.set_length(all as u64);
            bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        bar.inc(1);
        if bar.position() >= all as u64 {
            bar.finish_and_clear();
        }
    })
}
