//! Whether there is memory for a scene.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use crate::scene::SceneMemory;

/// Bytes as GiB.
const GIB: f64 = (1_u64 << 30) as f64;

/// Tells how much memory can still be taken, in bytes; without one, there is no limit.
#[derive(Clone, Default)]
pub struct Gauge(Option<Arc<dyn Fn() -> Option<u64> + Send + Sync>>);

impl Gauge {
    /// Asks `tell` when it matters.
    pub fn new(tell: impl Fn() -> Option<u64> + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(tell)))
    }

    /// Whether `bytes` can be taken.
    ///
    /// # Errors
    /// How many there are.
    pub(super) fn check(&self, bytes: u64) -> Result<(), u64> {
        let available = self.0.as_ref().and_then(|tell| tell());
        match available {
            Some(available) if available < bytes => Err(available),
            _ => Ok(()),
        }
    }

    /// Whether a file can be read whole.
    ///
    /// - `tree`: what the search structure over all that is read already will take, in bytes.
    ///
    /// # Errors
    /// [`Shortage::Reading`] where there is no memory for both.
    pub(super) fn check_file(&self, file: &Path, tree: u64) -> Result<(), Shortage> {
        let size = std::fs::metadata(file).map_or(0, |metadata| metadata.len());
        let checked = self.check(size.saturating_add(tree));
        checked.map_err(|available| Shortage::Reading {
            file: file.to_owned(),
            size,
            tree,
            available,
        })
    }
}

impl fmt::Debug for Gauge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() {
            "gauge"
        } else {
            "no limit"
        })
    }
}

/// A scene needs more memory than there is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Shortage {
    /// Found before the search structure is built.
    Building {
        /// What the scene takes; its search structure is estimated, and not yet there.
        needed: SceneMemory,
        /// What can still be taken, in bytes.
        available: u64,
    },
    /// Found before a file is read.
    Reading {
        /// The file.
        file: PathBuf,
        /// Its size in bytes: reading it takes as much.
        size: u64,
        /// What the search structure over all that is read already will take, in bytes, estimated.
        tree: u64,
        /// What can still be taken, in bytes.
        available: u64,
    },
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gib = |bytes: u64| bytes as f64 / GIB;
        match self {
            Self::Building { needed, available } => {
                let SceneMemory {
                    tree,
                    buffers,
                    surfaces,
                    pictures,
                } = needed;
                let meshes = buffers + surfaces;
                write!(
                    f,
                    "the scene needs about {:.2} GiB of memory (meshes {:.2}, pictures {:.2}, \
                     search structure {:.2}); of these, {:.2} GiB are still to be taken, and {:.2} \
                     GiB are available",
                    gib(meshes + pictures + tree.peak),
                    gib(meshes),
                    gib(*pictures),
                    gib(tree.peak),
                    gib(tree.peak),
                    gib(*available)
                )?;
            }
            Self::Reading {
                file,
                size,
                tree,
                available,
            } => write!(
                f,
                "reading {} takes {:.2} GiB of memory, the search structure over what is read \
                 already about {:.2} GiB, and {:.2} GiB are available",
                file.display(),
                gib(*size),
                gib(*tree),
                gib(*available)
            )?,
        }
        f.write_str(
            "; fewer triangles need less, and so do instances of one shapegroup for shapes that \
             are alike",
        )
    }
}

/// Watches memory while the files of a scene are read, by all processors at once.
#[derive(Debug, Default)]
pub(super) struct MemoryWatch {
    gauge: Gauge,
    /// What the search structure over all that is read already will take, in bytes.
    tree: AtomicU64,
    shortage: OnceLock<Shortage>,
}

impl MemoryWatch {
    /// Begins with nothing read.
    pub(super) fn new(gauge: Gauge) -> Self {
        Self {
            gauge,
            ..Self::default()
        }
    }

    /// Whether a file may be read. One that is not there may: the system says it better.
    pub(super) fn admits(&self, file: &Path) -> bool {
        let tree = self.tree.load(Ordering::Relaxed);
        if self.shortage.get().is_some() {
            return false;
        }
        match self.gauge.check_file(file, tree) {
            Ok(()) => true,
            Err(shortage) => {
                // The first one tells; others follow from the same want.
                self.shortage.get_or_init(|| shortage);
                false
            }
        }
    }

    /// Notes geometry that was read.
    ///
    /// - `tree`: what a search structure over it will take, in bytes.
    pub(super) fn note(&self, tree: u64) {
        self.tree.fetch_add(tree, Ordering::Relaxed);
    }

    /// Why a file was not admitted.
    pub(super) fn into_shortage(self) -> Option<Shortage> {
        self.shortage.into_inner()
    }
}
