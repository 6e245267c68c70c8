//! Vertex normals from triangles.

use glam::DVec3;
use rayon::prelude::*;

use super::MeshData;
use crate::math::Vec3;

/// Triangles whose angles are known at once.
const PIECE: usize = 1 << 16;

impl MeshData {
    /// Replaces the vertex normals by the mean of the adjacent triangles' normals, each weighted
    /// by the triangle's angle at the vertex, so that the result does not depend on how a flat
    /// part is cut into triangles.
    ///
    /// Vertices are joined by index, not by position: two vertices at one place stay a crease.
    /// Where the mean vanishes (the two sides of a sheet in one vertex), the vertex takes the
    /// normal of its first triangle; where no triangle with area touches it, +Z.
    ///
    /// Source: Thürmer and Wüthrich 1998.
    pub fn compute_vertex_normals(&mut self) {
        self.normals = Some(
            self.angle_weighted_normals(self.positions.len(), |triangle, corner| {
                self.indices[triangle][corner] as usize
            }),
        );
    }

    /// Makes every vertex normal unit length. Those that have no direction (zero or not finite)
    /// are computed as [`MeshData::compute_vertex_normals`] does.
    ///
    /// Returns how many were computed.
    pub fn repair_normals(&mut self) -> usize {
        let Some(mut normals) = self.normals.take() else {
            return 0;
        };
        let mut broken = Vec::new();
        for (vertex, normal) in normals.iter_mut().enumerate() {
            // In f64 the length of a finite f32 vector neither overflows nor vanishes.
            let direction = DVec3::from(Vec3::from_array(*normal)).normalize_or_zero();
            if direction == DVec3::ZERO {
                broken.push(vertex);
            } else {
                *normal = direction.as_vec3().to_array();
            }
        }
        if !broken.is_empty() {
            self.compute_vertex_normals();
            let computed = self.normals.take().unwrap_or_default();
            for &vertex in &broken {
                normals[vertex] = computed[vertex];
            }
        }
        self.normals = Some(normals);
        broken.len()
    }

    /// Sums angle-weighted triangle normals into `slot_count` slots and makes the sums unit.
    ///
    /// - `slot`: from (triangle, corner 0..3) to the slot, below `slot_count`.
    pub(super) fn angle_weighted_normals(
        &self,
        slot_count: usize,
        slot: impl Fn(usize, usize) -> usize,
    ) -> Vec<[f32; 3]> {
        let mut sums = vec![DVec3::ZERO; slot_count];
        // A slot takes its first triangle's normal here only if its sum turns out to vanish.
        let mut firsts = vec![Vec3::ZERO; slot_count];
        // Angles are worked out by all processors, a piece of the list at a time, and added in order.
        let mut pieces = Vec::new();
        for (piece, indices) in self.indices.chunks(PIECE).enumerate() {
            indices
                .par_iter()
                .with_min_len(PIECE >> 6)
                .map(|corners| self.normal_and_angles(*corners))
                .collect_into_vec(&mut pieces);
            for (triangle, (normal, angles)) in (piece * PIECE..).zip(&pieces) {
                if *normal == DVec3::ZERO {
                    continue;
                }
                for (corner, angle) in angles.iter().enumerate() {
                    let slot = slot(triangle, corner);
                    sums[slot] += *normal * *angle;
                    if firsts[slot] == Vec3::ZERO {
                        firsts[slot] = normal.as_vec3();
                    }
                }
            }
        }
        let unit = |(sum, first): (DVec3, Vec3)| {
            // Sums of two opposite unit vectors leave rounding noise, which is no direction.
            if sum.length() > 1e-9 {
                sum.normalize().as_vec3().to_array()
            } else if first != Vec3::ZERO {
                first.to_array()
            } else {
                [0., 0., 1.]
            }
        };
        let sums = sums.into_par_iter().with_min_len(PIECE >> 6);
        sums.zip(firsts).map(unit).collect()
    }

    /// Unit normal of a triangle and the angles at its corners in radians; zero where it has no area.
    fn normal_and_angles(&self, corners: [u32; 3]) -> (DVec3, [f64; 3]) {
        let p = self.corner_positions(corners);
        let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        if normal == DVec3::ZERO {
            return (normal, [0.0; 3]);
        }
        let angle = |corner: usize| {
            let to_next = p[(corner + 1) % 3] - p[corner];
            let to_last = p[(corner + 2) % 3] - p[corner];
            angle_between(to_next, to_last)
        };
        (normal, [0, 1, 2].map(angle))
    }
}

/// Angle between two vectors in radians, exact near 0 and π where an arc cosine is not.
pub(super) fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::super::tests::corner_of_a_box;
    use super::*;

    fn assert_close(found: [f32; 3], expected: [f32; 3]) {
        let distance = Vec3::from_array(found).distance(Vec3::from_array(expected));
        assert!(distance < 1e-6, "{found:?} is not {expected:?}");
    }

    #[test]
    fn two_faces_meet_halfway() {
        let mut mesh = corner_of_a_box();
        mesh.compute_vertex_normals();
        let half = 0.5_f32.sqrt();
        let normals = mesh.normals.unwrap();
        assert_close(normals[0], [0., -half, half]);
        assert_close(normals[1], [0., -half, half]);
        assert_close(normals[2], [0., 0., 1.]);
        assert_close(normals[3], [0., -1., 0.]);
    }

    #[test]
    fn the_cut_of_a_flat_part_does_not_matter() {
        // The floor of a box corner as one triangle, then cut in two through the corner.
        let walls = [[0, 3, 2], [0, 1, 3]];
        let mut whole = corner_of_a_box();
        whole.indices = vec![[0, 2, 1], walls[0], walls[1]];
        let mut cut = whole.clone();
        cut.positions.push([0.5, 0.5, 0.]);
        cut.indices = vec![[0, 2, 4], [0, 4, 1], walls[0], walls[1]];
        whole.compute_vertex_normals();
        cut.compute_vertex_normals();
        let third = -(1.0_f32 / 3.0).sqrt();
        assert_eq!(whole.surface_area(), cut.surface_area());
        assert_close(cut.normals.unwrap()[0], whole.normals.as_ref().unwrap()[0]);
        // The walls turn their geometric normals to −x and −y, the floor to −z.
        assert_close(whole.normals.unwrap()[0], [third, third, third]);
    }

    #[test]
    fn no_direction_falls_back() {
        let mut mesh = corner_of_a_box();
        mesh.indices = vec![[0, 1, 2], [0, 2, 1], [3, 3, 3]];
        mesh.compute_vertex_normals();
        let normals = mesh.normals.unwrap();
        assert_eq!(normals[0], [0., 0., 1.]);
        assert_eq!(normals[3], [0., 0., 1.]);
    }

    #[test]
    fn repair_touches_only_what_is_broken() {
        let mut mesh = corner_of_a_box();
        mesh.normals = Some(vec![
            [0., 0., 3e38],
            [1e-30, 0., 0.],
            [0.; 3],
            [f32::NAN, 0., 0.],
        ]);
        assert_eq!(mesh.repair_normals(), 2);
        let normals = mesh.normals.as_ref().unwrap();
        assert_eq!(normals[..2], [[0., 0., 1.], [1., 0., 0.]]);
        assert_close(normals[2], [0., 0., 1.]);
        assert_close(normals[3], [0., -1., 0.]);
        assert_eq!(mesh.repair_normals(), 0);
    }
}
