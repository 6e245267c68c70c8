//! How far reading has come.

use std::fmt;
use std::sync::Arc;

/// What is told of an import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A file has been read: how many so far, of how many. From any thread, in any order.
    Read {
        /// So far.
        done: usize,
        /// Of how many.
        all: usize,
    },
    /// Everything is read; the search structure is built next.
    Building,
    /// The scene stands.
    Built,
}

/// Tells somebody how far an import has come.
#[derive(Clone, Default)]
pub struct Progress(Option<Arc<dyn Fn(Stage) + Send + Sync>>);

impl Progress {
    /// Tells `told` of each stage.
    pub fn new(told: impl Fn(Stage) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(told)))
    }

    /// Says what has been reached.
    pub(super) fn tell(&self, stage: Stage) {
        if let Some(told) = &self.0 {
            told(stage);
        }
    }
}

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "told" } else { "not told" })
    }
}
