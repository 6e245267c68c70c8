//! Numbers that a mesh carries beside positions, normals and texture coordinates.

use super::{MeshData, gather};

/// What has a value of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AttributeDomain {
    /// Each vertex.
    Vertex,
    /// Each triangle.
    Face,
}

/// A colour or a number for each vertex or each triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshAttribute {
    /// Its name as materials know it: `vertex_color`, say.
    pub name: String,
    /// What the values belong to.
    pub domain: AttributeDomain,
    /// The values; numbers are grey.
    pub values: Vec<[f32; 3]>,
}

impl MeshAttribute {
    /// How many values `mesh` must have.
    pub(super) fn expected(&self, mesh: &MeshData) -> usize {
        match self.domain {
            AttributeDomain::Vertex => mesh.positions.len(),
            AttributeDomain::Face => mesh.indices.len(),
        }
    }

    /// The attribute of a mesh whose vertices and triangles were made of others.
    ///
    /// - `vertices`, `triangles`: the old one of each new one.
    pub(super) fn gathered(self, vertices: &[u32], triangles: &[u32]) -> Self {
        let values = match self.domain {
            AttributeDomain::Face => gather(&self.values, triangles),
            AttributeDomain::Vertex => gather(&self.values, vertices),
        };
        Self { values, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::primitives;

    #[test]
    fn values_stay_at_their_corners() {
        let mut mesh = primitives::cube();
        let at_corners = |mesh: &MeshData| -> Vec<[[f32; 3]; 3]> {
            let values = &mesh.attributes[0].values;
            let corners = mesh.indices.iter();
            corners.map(|c| c.map(|i| values[i as usize])).collect()
        };
        let attribute = |name: &str, domain, count: usize| MeshAttribute {
            name: name.to_owned(),
            domain,
            values: (0..count).map(|i| [i as f32; 3]).collect(),
        };
        let (vertices, faces) = (mesh.positions.len(), mesh.indices.len());
        mesh.attributes = vec![
            attribute("vertex_color", AttributeDomain::Vertex, vertices),
            attribute("face_color", AttributeDomain::Face, faces),
        ];
        let before = (at_corners(&mesh), mesh.attributes[1].clone());
        mesh.apply_max_smooth_angle(180.0);
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!((at_corners(&mesh), mesh.attributes[1].clone()), before);
        let part = mesh.part([3, 7]);
        assert_eq!((part.validate(), part.indices.len()), (Ok(()), 2));
        assert_eq!(at_corners(&part), [before.0[3], before.0[7]]);
        assert_eq!(part.attributes[1].values, [[3.0; 3], [7.0; 3]]);
        mesh.attributes[0].values.pop();
        assert!(mesh.validate().is_err());
    }
}
