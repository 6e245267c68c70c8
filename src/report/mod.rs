//! What is said about images: how far one is from another, and whether noise explains it.

mod compare;
mod flip;
mod heat;
mod pixels;
mod tiles;

pub use compare::{Comparison, Ratio, compare};
pub use flip::mean_flip;
pub use heat::heat_map;
pub use pixels::{Pixels, Subject};
pub use tiles::{TileScores, tile_scores};
