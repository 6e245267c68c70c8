//! Readers of scene and mesh files.

pub mod mesh;
