//! Meshes of a glTF file.

use std::sync::Arc;

use gltf::mesh::{Mode, Primitive, Semantic};

use super::super::Model;
use super::buffers::Buffers;
use super::{Asset, Carrier};
use crate::math::{Rgb, Vec2};
use crate::shape::TriangleMesh;
use crate::shape::mesh::{AttributeDomain, MeshAttribute, MeshData};
use crate::texture::{self, MeshSurface};

/// Name of the attribute that holds a mesh's own colours.
const COLOURS: &str = "vertex_color";

impl Model<'_> {
    /// Reads the triangles of a piece of a mesh; `None` after noting why there are none.
    pub(super) fn gltf_primitive(
        &mut self,
        asset: &Asset<'_>,
        mesh: usize,
        primitive: &Primitive<'_>,
    ) -> Option<MeshData> {
        let what = format!("mesh {mesh}, primitive {}", primitive.index());
        if matches!(
            primitive.mode(),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip
        ) {
            let message = format!("{what}: points and lines are left out");
            self.problems.warning(&self.line(1), message);
            return None;
        }
        if primitive.morph_targets().len() > 0 {
            let message = format!("{what}: morph targets are left out");
            self.problems.warning(&self.line(1), message);
        }
        let read = read(&asset.buffers, primitive).and_then(|mut data| {
            data.repair_normals();
            data.validate().map_err(|flaw| flaw.to_string())?;
            Ok(data)
        });
        match read {
            Ok(data) if data.indices.is_empty() => {
                let message = format!("{what} has no triangles");
                self.problems.warning(&self.line(1), message);
                None
            }
            Ok(data) => Some(data),
            Err(message) => {
                self.problems
                    .error(&self.line(1), format!("{what}: {message}"));
                None
            }
        }
    }
}

/// A mesh, and what textures need of it where it has colours of its own.
pub(super) fn carried(data: MeshData) -> (TriangleMesh, Option<Carrier>) {
    let colours = data
        .attributes
        .iter()
        .find(|attribute| attribute.name == COLOURS);
    let colours: Option<Arc<[Rgb]>> = colours.map(|attribute| {
        let values = attribute.values.iter();
        values
            .map(|value| Rgb::new(value[0], value[1], value[2]))
            .collect()
    });
    let mut mesh = TriangleMesh::from(data);
    let carrier = colours.map(|colours| {
        mesh.use_chart();
        let uvs: Option<Arc<[Vec2]>> = mesh.uvs().map(Into::into);
        let surface = MeshSurface::new(mesh.triangles().clone(), uvs);
        let colours = texture::MeshAttribute::new(surface.clone(), colours, false).into();
        Carrier { surface, colours }
    });
    (mesh, carrier)
}

fn read(buffers: &Buffers, primitive: &Primitive<'_>) -> Result<MeshData, String> {
    let positions = primitive
        .get(&Semantic::Positions)
        .ok_or("it has no POSITION")?;
    let positions = buffers.vectors::<3>(&positions)?;
    let count = positions.len();
    let normals = primitive.get(&Semantic::Normals);
    let normals = normals.map(|normals| buffers.vectors::<3>(&normals));
    let uvs = primitive.get(&Semantic::TexCoords(0));
    let uvs = uvs.map(|uvs| buffers.vectors::<2>(&uvs));
    let mut attributes = Vec::new();
    if let Some(colours) = primitive.get(&Semantic::Colors(0)) {
        let values = match colours.dimensions().multiplicity() {
            4 => {
                let with_alpha = buffers.vectors::<4>(&colours)?;
                with_alpha
                    .into_iter()
                    .map(|[r, g, b, _]| [r, g, b])
                    .collect()
            }
            _ => buffers.vectors::<3>(&colours)?,
        };
        attributes.push(MeshAttribute {
            name: COLOURS.to_owned(),
            domain: AttributeDomain::Vertex,
            values,
        });
    }
    let corners = match primitive.indices() {
        Some(indices) => buffers.indices(&indices)?,
        None => (0..u32::try_from(count).map_err(|_| "too many vertices")?).collect(),
    };
    Ok(MeshData {
        positions,
        indices: triangles(primitive.mode(), &corners),
        normals: normals.transpose()?,
        uvs: uvs.transpose()?,
        attributes,
    })
}

/// The triangles that a list of corners means; what is left of them makes none.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let triples = corners.windows(3).enumerate();
            let turned = triples.map(|(i, c)| match i % 2 {
                0 => [c[0], c[1], c[2]],
                _ => [c[1], c[0], c[2]],
            });
            turned
                .filter(|[a, b, c]| a != b && b != c && c != a)
                .collect()
        }
        Mode::TriangleFan => {
            let pairs = corners.get(1..).unwrap_or_default().windows(2);
            pairs.map(|pair| [corners[0], pair[0], pair[1]]).collect()
        }
        _ => corners
            .chunks_exact(3)
            .map(|c| [c[0], c[1], c[2]])
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_side() {
        let corners = [0, 1, 2, 3, 3];
        let strip = triangles(Mode::TriangleStrip, &corners);
        assert_eq!(strip, [[0, 1, 2], [2, 1, 3]]);
        let fan = triangles(Mode::TriangleFan, &corners[..4]);
        assert_eq!(fan, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(Mode::Triangles, &corners), [[0, 1, 2]]);
        assert!(triangles(Mode::TriangleFan, &[]).is_empty());
    }
}
