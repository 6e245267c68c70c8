//! Reading scenes as the arguments say.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::args::SceneArgs;
use super::failure::Failure;
use super::memory::{Resident, available, resident};
use crate::accel::Engine;
use crate::scene::import::xml::{ReadOptions, Strictness};
use crate::scene::import::{Gauge, ImportOptions, Imported, Progress, Stage, import};

/// A scene with what it took to load it.
pub(super) struct Loaded {
    /// The scene.
    pub(super) imported: Imported,
    /// What it took.
    pub(super) cost: LoadCost,
}

/// What loading a scene took.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadCost {
    /// Seconds of it all.
    pub(super) seconds: f64,
    /// Seconds of building the search structure.
    pub(super) build_seconds: f64,
    /// Memory of the process after it, where the system tells.
    pub(super) memory: Option<Resident>,
}

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
    pub(super) fn load(&self, file: &Path, quiet: bool, engine: Engine) -> Result<Loaded, Failure> {
        let start = Instant::now();
        let building = Arc::new(Mutex::new(Building::default()));
        let (bar, watch) = ((!quiet).then(bar), Arc::clone(&building));
        let options = ImportOptions {
            read: ReadOptions {
                definitions: self.definitions.clone(),
                search_paths: self.search_paths.clone(),
                strictness: self.strictness(),
            },
            film_size: self.size,
            engine,
            progress: Progress::new(move |stage| match (stage, &bar) {
                (Stage::Read { done, all }, Some(bar)) => show(bar, done, all),
                (Stage::Read { .. }, None) => {}
                _ => lock(&watch).reach(stage),
            }),
            gauge: Gauge::new(available),
        };
        let imported = import(file, &options)?;
        let build_seconds = lock(&building).took.as_secs_f64();
        Ok(Loaded {
            imported,
            cost: LoadCost {
                seconds: start.elapsed().as_secs_f64(),
                build_seconds,
                memory: resident(),
            },
        })
    }
}

/// When the search structure was begun, and how long it took.
#[derive(Debug, Default)]
struct Building {
    start: Option<Instant>,
    took: Duration,
}

impl Building {
    fn reach(&mut self, stage: Stage) {
        match stage {
            Stage::Building => self.start = Some(Instant::now()),
            _ => self.took = self.start.map_or(Duration::ZERO, |start| start.elapsed()),
        }
    }
}

fn lock(building: &Mutex<Building>) -> std::sync::MutexGuard<'_, Building> {
    building.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A bar on the terminal, if there is one, that goes away when all files are read.
fn bar() -> ProgressBar {
    let bar = ProgressBar::hidden();
    if let Ok(style) = ProgressStyle::with_template("reading {wide_bar} {pos}/{len} files") {
        bar.set_style(style);
    }
    bar
}

fn show(bar: &ProgressBar, done: usize, all: usize) {
    if done == 1 {
        bar.set_length(all as u64);
        bar.set_draw_target(ProgressDrawTarget::stderr());
    }
    bar.inc(1);
    if bar.position() >= all as u64 {
        bar.finish_and_clear();
    }
}
