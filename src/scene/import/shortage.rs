//! Whether there is memory for a scene.

use std::fmt;
use std::sync::Arc;

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
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Shortage {
    /// What the scene takes; its search structure is estimated, and not yet there.
    pub needed: SceneMemory,
    /// What can still be taken, in bytes.
    pub available: u64,
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SceneMemory {
            tree,
            buffers,
            surfaces,
            pictures,
        } = self.needed;
        let gib = |bytes: u64| bytes as f64 / GIB;
        let meshes = buffers + surfaces;
        write!(
            f,
            "the scene needs about {:.2} GiB of memory (meshes {:.2}, pictures {:.2}, search \
             structure {:.2}); of these, {:.2} GiB are still to be taken, and {:.2} GiB are \
             available; fewer triangles need less, and so do instances of one shapegroup for \
             shapes that are alike",
            gib(meshes + pictures + tree.peak),
            gib(meshes),
            gib(pictures),
            gib(tree.peak),
            gib(tree.peak),
            gib(self.available)
        )
    }
}
