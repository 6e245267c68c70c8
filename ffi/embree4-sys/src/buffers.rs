//! Vertex and index buffers that Embree and the renderer read from the same memory.

use std::sync::Arc;

/// Vertex positions, shared without a copy. Clones are cheap and name the same memory.
#[derive(Clone, Debug)]
pub struct VertexBuffer {
    /// The vertices, followed by `PADDING` that belong to nobody.
    padded: Arc<Vec<[f32; 3]>>,
}

/// Embree reads 16 bytes at the last vertex, which has 12; it asks for 16 bytes after it.
const PADDING: [[f32; 3]; 2] = [[0.0; 3]; 2];

impl VertexBuffer {
    /// The largest coordinate, in absolute value, that Embree accepts: it would leave out triangles
    /// with a larger one without a word.
    pub const LARGEST: f32 = 1.8e18;

    /// Takes over positions.
    ///
    /// - `positions`: in the space of the scene that the buffer is added to. Room for two more
    ///   elements in its capacity saves a reallocation.
    pub fn new(mut positions: Vec<[f32; 3]>) -> Self {
        // Exactly: growth by itself would leave as much room again.
        positions.reserve_exact(PADDING.len());
        positions.extend(PADDING);
        Self {
            padded: Arc::new(positions),
        }
    }

    /// The positions.
    #[inline]
    pub fn as_slice(&self) -> &[[f32; 3]] {
        &self.padded[..self.padded.len() - PADDING.len()]
    }

    /// Where the first vertex stays as long as a clone of this buffer lives.
    pub(crate) fn as_ptr(&self) -> *const [f32; 3] {
        self.padded.as_ptr()
    }
}

/// Three vertex indices per triangle, shared without a copy. Clones are cheap and name the same
/// memory.
#[derive(Clone, Debug)]
pub struct IndexBuffer {
    triangles: Arc<Vec<[u32; 3]>>,
}

impl IndexBuffer {
    /// Takes over triangles.
    ///
    /// - `triangles`: per triangle the positions of its corners in a [`VertexBuffer`], from 0.
    pub fn new(mut triangles: Vec<[u32; 3]>) -> Self {
        triangles.shrink_to_fit();
        Self {
            triangles: Arc::new(triangles),
        }
    }

    /// The triangles.
    #[inline]
    pub fn as_slice(&self) -> &[[u32; 3]] {
        &self.triangles
    }
}

/// Control points of curves with their radii, and where segments begin, shared without a copy. Clones
/// are cheap and name the same memory.
#[derive(Clone, Debug)]
pub struct CurveBuffer {
    points: Arc<Vec<[f32; 4]>>,
    segments: Arc<Vec<u32>>,
}

impl CurveBuffer {
    /// Takes over curves.
    ///
    /// - `points`: x, y, z in the space of the scene that the buffer is added to, and the radius there.
    /// - `segments`: for each segment the first of its control points, from 0; a segment has that one
    ///   and those that follow, two for linear curves and four for B-splines.
    pub fn new(points: Vec<[f32; 4]>, segments: Vec<u32>) -> Self {
        Self {
            points: Arc::new(points),
            segments: Arc::new(segments),
        }
    }

    /// The control points with their radii.
    #[inline]
    pub fn points(&self) -> &[[f32; 4]] {
        &self.points
    }

    /// The first control point of each segment.
    #[inline]
    pub fn segments(&self) -> &[u32] {
        &self.segments
    }
}

#[cfg(test)]
mod tests {
    use super::VertexBuffer;

    #[test]
    fn the_padding_is_not_part_of_the_slice() {
        let buffer = VertexBuffer::new(vec![[1.0, 2.0, 3.0]]);
        assert_eq!(buffer.as_slice(), [[1.0, 2.0, 3.0]]);
        assert!(buffer.padded.len() * 12 >= 12 + 16);
        assert!(VertexBuffer::new(Vec::new()).as_slice().is_empty());
    }
}
