//! How far reading has come.

use std::fmt;
use std::sync::Arc;

/// What is told: how many files have been read, of how many.
type Told = dyn Fn(usize, usize) + Send + Sync;

/// Tells somebody how many files of a scene have been read; from any thread, in any order.
#[derive(Clone, Default)]
pub struct Progress(Option<Arc<Told>>);

impl Progress {
    /// Tells `told` of each file that has been read: how many so far, of how many.
    pub fn new(told: impl Fn(usize, usize) + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(told)))
    }

    /// Says that `done` files of `all` have been read.
    pub(super) fn tell(&self, done: usize, all: usize) {
        if let Some(told) = &self.0 {
            told(done, all);
        }
    }
}

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "told" } else { "not told" })
    }
}
