//! Rays against geometry.

use std::sync::Arc;

/// Vertex positions that the tracer shares.
#[derive(Clone, Debug)]
pub struct VertexBuffer(Arc<Vec<[f32; 3]>>);

impl VertexBuffer {
    /// Takes the positions.
    pub fn new(positions: Vec<[f32; 3]>) -> Self {
        Self(Arc::new(positions))
    }

    /// The positions.
    pub fn as_slice(&self) -> &[[f32; 3]] {
        &self.0
    }
}

/// Vertex indices of triangles that the tracer shares.
#[derive(Clone, Debug)]
pub struct IndexBuffer(Arc<Vec<[u32; 3]>>);

impl IndexBuffer {
    /// Takes the indices.
    pub fn new(indices: Vec<[u32; 3]>) -> Self {
        Self(Arc::new(indices))
    }

    /// The indices.
    pub fn as_slice(&self) -> &[[u32; 3]] {
        &self.0
    }
}
