//! Smooth normals that stop at creases.

use std::collections::HashMap;

use glam::DVec3;

use super::MeshData;
use super::normals::angle_between;

/// Two triangles in one plane, computed from `f32` positions, differ by about this angle (rad).
const ROUNDING: f64 = 1e-5;

impl MeshData {
    /// Discards the vertex normals and builds new ones that are smooth across an edge where the
    /// two triangles' normals differ by at most `degrees`, and break at sharper ones.
    ///
    /// Positions are first joined where they are equal, whatever the indices, then a vertex is
    /// split where creases (or texture seams) pass through it. Smoothness carries over from edge
    /// to edge around a vertex: one sharp edge that ends in a smooth surface does not split its
    /// end. Triangles without area join nothing. The mesh of Mitsuba 0.6's `maxSmoothAngle`.
    ///
    /// - `degrees`: in [0, 180]; 0 gives a faceted mesh, 180 a wholly smooth one.
    pub fn apply_max_smooth_angle(&mut self, degrees: f32) {
        let clusters = self.smooth_clusters(f64::from(degrees).to_radians() + ROUNDING);
        let root = |triangle: usize, corner: usize| clusters[3 * triangle + corner];
        let cluster_normals = self.angle_weighted_normals(clusters.len(), root);

        let mut rebuilt = Self {
            normals: Some(Vec::new()),
            uvs: self.uvs.as_ref().map(|_| Vec::new()),
            ..Self::default()
        };
        let mut vertices = HashMap::new();
        // The vertex that each new one was made of.
        let mut origins = Vec::new();
        for (triangle, corners) in self.indices.iter().enumerate() {
            let mut new_corners = [0; 3];
            for (corner, &old) in corners.iter().enumerate() {
                let cluster = root(triangle, corner);
                let uv = self.uvs.as_ref().map(|uvs| uvs[old as usize]);
                // Vertices that carry more than these stay apart.
                let apart = (!self.attributes.is_empty()).then_some(old);
                let key = (cluster, uv.map(|uv| uv.map(f32::to_bits)), apart);
                let next = rebuilt.positions.len();
                let vertex = *vertices.entry(key).or_insert(next);
                if vertex == next {
                    origins.push(old);
                    rebuilt.positions.push(self.positions[old as usize]);
                    rebuilt
                        .normals
                        .iter_mut()
                        .for_each(|n| n.push(cluster_normals[cluster]));
                    rebuilt.uvs.iter_mut().for_each(|uvs| uvs.extend(uv));
                }
                // A number beyond u32 means too many vertices, which `validate` reports.
                new_corners[corner] = u32::try_from(vertex).unwrap_or(u32::MAX);
            }
            rebuilt.indices.push(new_corners);
        }
        let triangles: Vec<u32> = (0..self.indices.len() as u32).collect();
        let attributes = std::mem::take(&mut self.attributes).into_iter();
        let attributes = attributes.map(|a| a.gathered(&origins, &triangles));
        rebuilt.attributes = attributes.collect();
        *self = rebuilt;
    }

    /// Joins corners (3 · triangle + corner) at one position across edges not sharper than
    /// `limit` radians; returns for each the smallest corner of its cluster.
    fn smooth_clusters(&self, limit: f64) -> Vec<usize> {
        let normals: Vec<DVec3> = self.area_vectors().map(DVec3::normalize_or_zero).collect();
        let places = self.corner_places();
        let mut edges: Vec<(u32, u32, usize)> = (0..places.len())
            .map(|corner| {
                let (a, b) = (places[corner], places[next_corner(corner)]);
                (a.min(b), a.max(b), corner)
            })
            .collect();
        edges.sort_unstable();

        let mut clusters = Clusters((0..places.len()).collect());
        // Where more than two triangles share an edge, each is compared with the one before it.
        for pair in edges.windows(2) {
            let ((a, b, first), (c, d, second)) = (pair[0], pair[1]);
            let (n1, n2) = (normals[first / 3], normals[second / 3]);
            let both_have_area = n1 != DVec3::ZERO && n2 != DVec3::ZERO;
            if (a, b) != (c, d) || !both_have_area || angle_between(n1, n2) > limit {
                continue;
            }
            let (first_end, second_end) = (next_corner(first), next_corner(second));
            if places[first] == places[second] {
                clusters.join(first, second);
                clusters.join(first_end, second_end);
            } else {
                clusters.join(first, second_end);
                clusters.join(first_end, second);
            }
        }
        (0..places.len())
            .map(|corner| clusters.root(corner))
            .collect()
    }

    /// Numbers the distinct positions and gives each corner (3 · triangle + corner) its number.
    fn corner_places(&self) -> Vec<u32> {
        let mut numbers = HashMap::new();
        let mut place_of_vertex = Vec::with_capacity(self.positions.len());
        for (vertex, position) in (0_u32..).zip(&self.positions) {
            // Adding zero makes −0 and 0 one place.
            let key = position.map(|c| (c + 0.0).to_bits());
            place_of_vertex.push(*numbers.entry(key).or_insert(vertex));
        }
        self.indices
            .iter()
            .flatten()
            .map(|&i| place_of_vertex[i as usize])
            .collect()
    }
}

/// The corner after this one in its triangle.
fn next_corner(corner: usize) -> usize {
    if corner % 3 == 2 {
        corner - 2
    } else {
        corner + 1
    }
}

/// A forest over corners (union-find); the root of a tree is its smallest member.
struct Clusters(Vec<usize>);

impl Clusters {
    fn root(&mut self, mut corner: usize) -> usize {
        while self.0[corner] != corner {
            self.0[corner] = self.0[self.0[corner]];
            corner = self.0[corner];
        }
        corner
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::corner_of_a_box;
    use super::*;

    /// A unit cube of 12 triangles and 8 shared vertices.
    fn cube() -> MeshData {
        let positions = (0..8_u8)
            .map(|i| [i & 1, (i >> 1) & 1, i >> 2].map(f32::from))
            .collect();
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let indices = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        MeshData {
            positions,
            indices,
            ..MeshData::default()
        }
    }

    #[test]
    fn a_cube_splits_into_six_faces() {
        let mut mesh = cube();
        mesh.apply_max_smooth_angle(60.);
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!((mesh.positions.len(), mesh.indices.len()), (24, 12));
        assert_eq!(mesh.surface_area(), 6.);
        // Each vertex normal is now the face's own.
        let area_vectors: Vec<_> = mesh.area_vectors().collect();
        for (corners, area) in mesh.indices.iter().zip(area_vectors) {
            for &i in corners {
                assert_eq!(
                    mesh.normals.as_ref().unwrap()[i as usize],
                    area.as_vec3().to_array()
                );
            }
        }
    }

    #[test]
    fn a_wide_angle_joins_what_the_file_split() {
        let mut mesh = cube();
        mesh.apply_max_smooth_angle(30.);
        assert_eq!(mesh.positions.len(), 24);
        mesh.apply_max_smooth_angle(91.);
        assert_eq!(mesh.positions.len(), 8);
        let mut smooth = cube();
        smooth.compute_vertex_normals();
        for (position, normal) in mesh.positions.iter().zip(mesh.normals.unwrap()) {
            let same = smooth.positions.iter().position(|p| p == position).unwrap();
            assert_eq!(normal, smooth.normals.as_ref().unwrap()[same]);
        }
    }

    #[test]
    fn seams_keep_their_coordinates_and_share_the_normal() {
        let mut mesh = corner_of_a_box();
        mesh.positions
            .extend([mesh.positions[0], mesh.positions[1]]);
        mesh.indices[1] = [4, 5, 3];
        mesh.uvs = Some(vec![
            [0., 0.],
            [1., 0.],
            [0., 1.],
            [0.5, 0.5],
            [0.25, 0.],
            [0.75, 0.],
        ]);
        mesh.apply_max_smooth_angle(120.);
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(mesh.positions.len(), 6);
        let (normals, uvs) = (mesh.normals.unwrap(), mesh.uvs.unwrap());
        assert_eq!(
            normals[mesh.indices[0][0] as usize],
            normals[mesh.indices[1][0] as usize]
        );
        assert_eq!(uvs[mesh.indices[1][1] as usize], [0.75, 0.]);
    }

    #[test]
    fn a_flat_sheet_is_whole_even_at_zero_degrees_and_slivers_join_nothing() {
        let mut mesh = corner_of_a_box();
        mesh.positions[3] = [1., 1., 0.];
        mesh.indices = vec![[0, 1, 2], [1, 3, 2], [0, 1, 1]];
        mesh.apply_max_smooth_angle(0.);
        assert_eq!(mesh.indices[..2], [[0, 1, 2], [1, 3, 2]]);
        assert_eq!((mesh.indices.len(), mesh.degenerate_count()), (3, 1));
        assert_eq!(mesh.validate(), Ok(()));
    }
}
