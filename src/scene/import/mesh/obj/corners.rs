//! Which corners of faces are one vertex.

use std::collections::HashMap;

/// Stands for the end of a chain.
const END: u32 = u32::MAX;

/// The vertices that corners with the same three indices share, in order of first use.
///
/// Corners of one position form a chain, which is short: no hashing for what is nearly all of a file.
#[derive(Default)]
pub(super) struct Corners {
    vertices: Vec<[u32; 3]>,
    /// The next vertex of the same position.
    next: Vec<u32>,
    /// The latest vertex of each position.
    latest: Vec<u32>,
    /// Vertices whose position had not been read when they were met.
    ahead: HashMap<[u32; 3], u32>,
}

impl Corners {
    /// The three indices of each vertex.
    pub(super) fn vertices(&self) -> &[[u32; 3]] {
        &self.vertices
    }

    /// The vertex of a corner; `None` when there are too many.
    ///
    /// - `positions`: how many have been read.
    pub(super) fn find_or_add(&mut self, corner: [u32; 3], positions: usize) -> Option<u32> {
        let position = corner[0] as usize;
        let is_ahead = position >= positions;
        if !self.ahead.is_empty() {
            if let Some(found) = self.ahead.get(&corner) {
                return Some(*found);
            }
        }
        if self.latest.len() < positions {
            self.latest.resize(positions, END);
        }
        let latest = self.latest.get(position).filter(|_| !is_ahead);
        let mut vertex = latest.copied().unwrap_or(END);
        while let Some(known) = self.vertices.get(vertex as usize) {
            if *known == corner {
                return Some(vertex);
            }
            vertex = self.next[vertex as usize];
        }
        let vertex = u32::try_from(self.vertices.len()).ok();
        let vertex = vertex.filter(|vertex| *vertex != END)?;
        self.vertices.push(corner);
        if is_ahead {
            self.next.push(END);
            self.ahead.insert(corner, vertex);
        } else {
            self.next.push(self.latest[position]);
            self.latest[position] = vertex;
        }
        Some(vertex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As a table of all corners would have it, whatever is read before what.
    #[test]
    fn equal_corners_are_one_vertex() {
        let (mut corners, mut table) = (Corners::default(), HashMap::new());
        let mut state = 1_u32;
        for step in 0..5000 {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let corner = [(state >> 8) % 60, (state >> 16) % 3, (state >> 24) % 2];
            let count = table.len() as u32;
            let expected = *table.entry(corner).or_insert(count);
            assert_eq!(corners.find_or_add(corner, step / 100), Some(expected));
        }
        assert_eq!(corners.vertices().len(), table.len());
    }
}
