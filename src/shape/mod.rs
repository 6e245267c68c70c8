//! Surfaces.

pub mod mesh;
