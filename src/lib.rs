//! A renderer for hard light: caustics, glass in glass, light through a door ajar.

pub mod math;
pub mod scene;
pub mod shape;
