//! A renderer for hard light: caustics, glass in glass, light through a door ajar.

pub mod image;
pub mod math;
