//! Triangle meshes as plain data, before any acceleration structure knows them.
//!
//! A vertex is one index for position, normal and texture coordinates together, as Embree and
//! Mitsuba have it. Files that index them apart (OBJ) are unrolled by their reader. The price is
//! that a position on a seam or a crease is stored once per side.
//!
//! The order of a triangle's corners is its geometric orientation: the geometric normal is
//! `(p1 − p0) × (p2 − p0)`. Vertex normals say nothing about that orientation and may disagree.

mod attribute;
mod crease;
mod normals;

pub use attribute::{AttributeDomain, MeshAttribute};

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::math::{Mat4, Vec3};

/// An indexed triangle mesh.
///
/// The fields are open, so a mesh made by hand need not be sound; [`MeshData::validate`] tells.
/// All other methods take a mesh whose indices are in range and panic where they are not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Three vertices per triangle, counter-clockwise seen from the side of the geometric normal.
    pub indices: Vec<[u32; 3]>,
    /// Unit shading normals, one per vertex; `None` for a faceted look.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Texture coordinates, one per vertex.
    pub uvs: Option<Vec<[f32; 2]>>,
    /// What else the mesh carries.
    pub attributes: Vec<MeshAttribute>,
}

/// What makes a mesh unusable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFlaw {
    /// There are more vertices or triangles than a 32-bit index can name.
    #[error("{count} {what} are more than a mesh can have ({})", u32::MAX)]
    TooMany {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// The array of normals, of texture coordinates or of an attribute's values is not as long as that
    /// of positions, or of triangles for an attribute of faces.
    #[error("{found} {what}, expected {expected}")]
    LengthMismatch {
        /// "normals", "texture coordinates" or "values of an attribute".
        what: &'static str,
        /// Number of vertices or triangles.
        expected: usize,
        /// Length of the array.
        found: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("{what} of vertex {vertex} is not finite")]
    NotFinite {
        /// "position", "normal" or "texture coordinate".
        what: &'static str,
        /// Index of the vertex, from 0.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {index}, but there are only {vertex_count}")]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex that it names, from 0.
        index: u32,
        /// Number of vertices.
        vertex_count: usize,
    },
}

impl MeshData {
    /// Checks that arrays agree in length, that all numbers are finite and all indices in range.
    ///
    /// # Errors
    /// The first flaw, in the order of [`MeshFlaw`]'s variants.
    pub fn validate(&self) -> Result<(), MeshFlaw> {
        let vertex_count = self.positions.len();
        check_count("vertices", vertex_count)?;
        check_count("triangles", self.indices.len())?;
        if let Some(normals) = &self.normals {
            check_length("normals", vertex_count, normals.len())?;
        }
        if let Some(uvs) = &self.uvs {
            check_length("texture coordinates", vertex_count, uvs.len())?;
        }
        check_finite("position", &self.positions)?;
        check_finite("normal", self.normals.as_deref().unwrap_or_default())?;
        check_finite(
            "texture coordinate",
            self.uvs.as_deref().unwrap_or_default(),
        )?;
        for attribute in &self.attributes {
            check_length(
                "values of an attribute",
                attribute.expected(self),
                attribute.values.len(),
            )?;
            check_finite("attribute", &attribute.values)?;
        }
        for (triangle, corners) in self.indices.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&i| i as usize >= vertex_count) {
                return Err(MeshFlaw::IndexOutOfRange {
                    triangle,
                    index,
                    vertex_count,
                });
            }
        }
        Ok(())
    }

    /// Moves the mesh by an affine map; the last row of `to_world` is taken as (0, 0, 0, 1).
    ///
    /// Normals go by the inverse transpose and are made unit again; where a map that flattens
    /// space leaves none, it is computed from the triangles.
    ///
    /// A mirroring map (negative determinant) does *not* change the order of corners: the
    /// geometric normal stays the cross product of the moved edges and so turns to the other
    /// side of the surface, while vertex normals stay on theirs. Mitsuba 3.9.1 does the same.
    ///
    /// Large factors can overflow; [`MeshData::validate`] afterwards finds it.
    pub fn transform(&mut self, to_world: Mat4) {
        let positions = self.positions.par_iter_mut().with_min_len(1 << 12);
        positions.for_each(|position| {
            let point = Vec3::from_array(*position);
            *position = to_world.transform_point3(point).to_array();
        });
        let Some(normals) = &mut self.normals else {
            return;
        };
        let inverse_transpose = scaled_inverse_transpose(to_world);
        for normal in normals {
            // Unit before the cast: cofactors of a strong scale leave the range of f32.
            let moved = inverse_transpose * DVec3::from(Vec3::from_array(*normal));
            *normal = moved.normalize_or_zero().as_vec3().to_array();
        }
        self.repair_normals();
    }

    /// Turns the surface inside out: swaps two corners of each triangle and negates the normals.
    pub fn flip_normals(&mut self) {
        for corners in &mut self.indices {
            corners.swap(1, 2);
        }
        for normal in self.normals.iter_mut().flatten() {
            *normal = normal.map(|c| -c);
        }
    }

    /// Some of the triangles, with the vertices that they use.
    ///
    /// - `triangles`: indices below the number of triangles.
    pub fn part(&self, triangles: impl IntoIterator<Item = usize>) -> Self {
        let (mut origins, mut new_of_old) = (Vec::new(), vec![u32::MAX; self.positions.len()]);
        let (mut indices, mut faces) = (Vec::new(), Vec::new());
        for triangle in triangles {
            faces.push(triangle as u32);
            indices.push(self.indices[triangle].map(|old| {
                let new = &mut new_of_old[old as usize];
                if *new == u32::MAX {
                    *new = origins.len() as u32;
                    origins.push(old);
                }
                *new
            }));
        }
        let attributes = self.attributes.iter().cloned();
        Self {
            positions: gather(&self.positions, &origins),
            indices,
            normals: self.normals.as_ref().map(|list| gather(list, &origins)),
            uvs: self.uvs.as_ref().map(|list| gather(list, &origins)),
            attributes: attributes.map(|a| a.gathered(&origins, &faces)).collect(),
        }
    }

    /// Drops the vertex normals, for a faceted look.
    pub fn remove_normals(&mut self) {
        self.normals = None;
    }

    /// Total area of the triangles, in squared units of the positions.
    ///
    /// Zero means that a mesh cannot be seen and cannot emit light.
    pub fn surface_area(&self) -> f64 {
        self.area_vectors().map(|a| 0.5 * a.length()).sum()
    }

    /// Number of triangles without area: no ray hits them and they have no geometric normal.
    pub fn degenerate_count(&self) -> usize {
        self.area_vectors().filter(|a| *a == DVec3::ZERO).count()
    }

    /// For each triangle `(p1 − p0) × (p2 − p0)`: geometric normal times twice the area.
    fn area_vectors(&self) -> impl Iterator<Item = DVec3> {
        self.indices.iter().map(|&corners| {
            let [a, b, c] = self.corner_positions(corners);
            (b - a).cross(c - a)
        })
    }

    /// Corner positions in double precision, where differences of `f32` do not overflow.
    fn corner_positions(&self, corners: [u32; 3]) -> [DVec3; 3] {
        corners.map(|i| DVec3::from(Vec3::from_array(self.positions[i as usize])))
    }
}

/// The elements at some indices.
fn gather<T: Copy>(list: &[T], indices: &[u32]) -> Vec<T> {
    indices.iter().map(|index| list[*index as usize]).collect()
}

/// A positive multiple of the inverse transpose of the linear part.
///
/// The cofactor matrix is determinant times inverse transpose and exists for singular maps too.
fn scaled_inverse_transpose(to_world: Mat4) -> DMat3 {
    let [x, y, z] = [to_world.x_axis, to_world.y_axis, to_world.z_axis]
        .map(|axis| DVec3::from(axis.truncate()));
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 {
        cofactors * -1.0
    } else {
        cofactors
    }
}

fn check_count(what: &'static str, count: usize) -> Result<(), MeshFlaw> {
    if u32::try_from(count).is_ok() {
        Ok(())
    } else {
        Err(MeshFlaw::TooMany { what, count })
    }
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), MeshFlaw> {
    if expected == found {
        Ok(())
    } else {
        Err(MeshFlaw::LengthMismatch {
            what,
            expected,
            found,
        })
    }
}

fn check_finite<const N: usize>(what: &'static str, values: &[[f32; N]]) -> Result<(), MeshFlaw> {
    match values
        .iter()
        .position(|value| value.iter().any(|c| !c.is_finite()))
    {
        Some(vertex) => Err(MeshFlaw::NotFinite { what, vertex }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn corner_of_a_box() -> MeshData {
        MeshData {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
            indices: vec![[0, 1, 2], [0, 1, 3]],
            ..MeshData::default()
        }
    }

    fn one_triangle() -> MeshData {
        MeshData {
            positions: vec![[0., 0., 0.], [2., 0., 0.], [0., 1., 0.]],
            indices: vec![[0, 1, 2]],
            normals: Some(vec![[0., 0., 1.], [0., 0., 1.], [0.6, 0., 0.8]]),
            uvs: Some(vec![[0., 0.], [1., 0.], [0., 1.]]),
            attributes: vec![],
        }
    }

    #[test]
    fn a_sound_mesh_passes() {
        assert_eq!(one_triangle().validate(), Ok(()));
        assert_eq!(MeshData::default().validate(), Ok(()));
    }

    #[test]
    fn every_flaw_is_named() {
        let message = |spoil: fn(&mut MeshData)| {
            let mut mesh = one_triangle();
            spoil(&mut mesh);
            mesh.validate().unwrap_err().to_string()
        };
        assert_eq!(
            message(|m| m.indices.push([0, 1, 3])),
            "triangle 1 refers to vertex 3, but there are only 3"
        );
        assert_eq!(
            message(|m| m.positions[1][2] = f32::NAN),
            "position of vertex 1 is not finite"
        );
        assert_eq!(
            message(|m| m.normals.as_mut().unwrap()[2][0] = f32::INFINITY),
            "normal of vertex 2 is not finite"
        );
        assert_eq!(
            message(|m| m.uvs.as_mut().unwrap()[0][1] = f32::NEG_INFINITY),
            "texture coordinate of vertex 0 is not finite"
        );
        assert_eq!(
            message(|m| m.normals = Some(vec![])),
            "0 normals, expected 3"
        );
        assert_eq!(
            message(|m| m.uvs.as_mut().unwrap().push([0., 0.])),
            "4 texture coordinates, expected 3"
        );
    }

    #[test]
    fn normals_go_by_the_inverse_transpose() {
        let mut mesh = one_triangle();
        let scale = Mat4::from_scale(Vec3::new(2., 1., 1.));
        mesh.transform(Mat4::from_translation(Vec3::new(0., 0., 5.)) * scale);
        assert_eq!(mesh.positions[1], [4., 0., 5.]);
        let [x, y, z] = mesh.normals.unwrap()[2];
        // (0.6 / 2, 0, 0.8), unit: what Mitsuba 3.9.1 prints for the same mesh.
        assert!((x - 0.351_123).abs() < 1e-5 && y == 0. && (z - 0.936_329).abs() < 1e-5);
    }

    #[test]
    fn mirroring_keeps_corner_order_and_the_side_of_vertex_normals() {
        let mut mesh = one_triangle();
        mesh.transform(Mat4::from_scale(Vec3::new(-1., 1., 1.)));
        assert_eq!(mesh.indices, [[0, 1, 2]]);
        assert!(mesh.area_vectors().all(|a| a.z < 0.));
        assert_eq!(mesh.normals.as_ref().unwrap()[0], [0., 0., 1.]);

        let mut mesh = one_triangle();
        mesh.transform(Mat4::from_scale(Vec3::new(1., 1., -1.)));
        assert!(mesh.area_vectors().all(|a| a.z > 0.));
        assert_eq!(mesh.normals.as_ref().unwrap()[2], [0.6, 0., -0.8]);
    }

    #[test]
    fn normals_survive_flattening_and_tiny_scales() {
        for scale in [Vec3::new(1., 1., 0.), Vec3::splat(1e-30), Vec3::splat(1e30)] {
            let mut mesh = one_triangle();
            mesh.transform(Mat4::from_scale(scale));
            for normal in mesh.normals.unwrap() {
                assert!(
                    (Vec3::from_array(normal).length() - 1.).abs() < 1e-6,
                    "{scale}"
                );
            }
        }
    }

    #[test]
    fn flipping_turns_both_normals() {
        let mut mesh = one_triangle();
        mesh.flip_normals();
        assert_eq!(mesh.indices, [[0, 2, 1]]);
        assert_eq!(mesh.normals.as_ref().unwrap()[2], [-0.6, -0., -0.8]);
        mesh.flip_normals();
        assert_eq!(mesh, one_triangle());
        mesh.remove_normals();
        assert_eq!(mesh.normals, None);
    }

    #[test]
    fn area_and_degenerate_triangles() {
        let mut mesh = one_triangle();
        assert_eq!((mesh.surface_area(), mesh.degenerate_count()), (1., 0));
        mesh.indices.push([0, 1, 1]);
        assert_eq!((mesh.surface_area(), mesh.degenerate_count()), (1., 1));
        mesh.positions = vec![[0.; 3], [1.; 3], [3.; 3]];
        assert_eq!((mesh.surface_area(), mesh.degenerate_count()), (0., 2));
        mesh.positions = vec![[0.; 3], [1e30, 0., 0.], [0., 1e30, 0.]];
        assert!(mesh.surface_area() > 4e59 && mesh.surface_area() < 6e59);
    }
}
