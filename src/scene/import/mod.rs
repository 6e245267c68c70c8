//! Readers of scene descriptions and meshes.

pub mod xml;
