//! Path space: what paths are made of, and how techniques that make them are weighed.

mod mis;

pub use mis::Heuristic;
