//! What is said about images: how far one is from another, whether noise explains it, and what it
//! took to come that far.

mod bench;
mod compare;
pub mod crosscheck;
mod flip;
mod heat;
mod pixels;
mod tiles;

pub use bench::{
    Bench, BenchScene, Errors, Mean, Measure, Missed, RecordError, Sheet, Spread, Standing, Tile,
    Trial, Work, error_plot, option_value, read_trial, standings, stored_trial, three_digits,
};
pub use compare::{Comparison, Ratio, compare};
pub use flip::mean_flip;
pub use heat::heat_map;
pub use pixels::{Pixels, Subject};
pub use tiles::{TileScores, tile_scores};
