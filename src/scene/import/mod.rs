//! Readers of scene descriptions and meshes.

pub mod mesh;
pub mod xml;
