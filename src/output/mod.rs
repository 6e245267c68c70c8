//! What a render leaves behind: layers, what is to be known about them, and the files.

mod metadata;
mod picture;
mod save;

pub use metadata::{RUN_PREFIX, Record, Run, metadata};
pub use picture::{LayerChoice, Picture};
pub use save::{FileKind, SaveOptions, save};
