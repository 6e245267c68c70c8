//! PLY: vertices with named properties and faces as lists, as text or binary.
//!
//! Elements and properties may come in any order and type; those not needed are read over.
//! Triangle strips (`tristrips`, −1 starts a new one) count as faces. Polygons become fans around
//! their first corner, so that only convex ones come out right.
//!
//! Every count is checked against the bytes that are left before memory is set aside for it.

mod attributes;
mod body;
mod fixed;
mod header;

use std::path::Path;

use attributes::Columns;
use body::Body;
use header::{Element, Header, Kind};

use super::{ImportedMesh, MeshError, MeshProblem, Place, read_with};
use crate::shape::mesh::{AttributeDomain, MeshData};

/// Reads a PLY file; see [`parse`].
///
/// # Errors
/// As [`parse`], and [`MeshProblem::Io`] where the file cannot be read.
pub fn read(file: &Path, flip_tex_coords: bool) -> Result<ImportedMesh, MeshError> {
    read_with(file, |bytes| parse(&bytes, flip_tex_coords))
}

/// Parses the bytes of a PLY file.
///
/// - `flip_tex_coords`: replaces `v` by `1 − v`; off by default in Mitsuba 3, not in Mitsuba 0.6.
///
/// Understood are the vertex properties `x y z`, `nx ny nz` and one of the pairs `u v`, `s t`,
/// `texture_u texture_v`, `texture_s texture_t`; of faces and strips the list `vertex_indices`
/// or `vertex_index`. Other numbers of vertices and faces become attributes, named as Mitsuba 3 does:
/// `r g b` or `red green blue` are `vertex_color` (or `face_color`), `heat_1` is `vertex_heat`.
///
/// # Errors
/// All of [`MeshProblem`] but `Io` and `NoSuchShape`, with the line (header, text) or the byte
/// (binary) where it was found.
pub fn parse(bytes: &[u8], flip_tex_coords: bool) -> Result<ImportedMesh, MeshProblem> {
    let header = Header::parse(bytes)?;
    let vertex_count = header.vertex_count()?;
    let mut body = Body::new(bytes, &header);
    let mut mesh = MeshData::default();
    let mut warnings = Vec::new();
    let mut faces = Faces {
        vertex_count,
        triangles: Vec::new(),
        short: 0,
    };
    let mut of_faces = Columns::default();
    for element in &header.elements {
        body.check_claim(element)?;
        match element.name.as_str() {
            "vertex" if fixed::vertices(&mut body, element, &mut mesh) => {}
            "vertex" => read_vertices(&mut body, element, &mut mesh, &mut warnings)?,
            "face" => match fixed::triangles(&mut body, element, vertex_count) {
                Some(triangles) => faces.take(triangles),
                None => {
                    let is_known = |_: &str| false;
                    of_faces = Columns::of(element, AttributeDomain::Face, is_known, &mut warnings);
                    let others = &mut of_faces;
                    read_lists(&mut body, element, others, &mut faces, Faces::polygon)?;
                }
            },
            "tristrips" => {
                let nothing = &mut Columns::default();
                read_lists(&mut body, element, nothing, &mut faces, Faces::strip)?;
            }
            _ => body.skip_element(element)?,
        }
    }
    if flip_tex_coords {
        mesh.uvs
            .iter_mut()
            .flatten()
            .for_each(|[_, v]| *v = 1.0 - *v);
    }
    if faces.short > 0 {
        warnings.push(format!(
            "faces of less than 3 corners, ignored: {}",
            faces.short
        ));
    }
    let trailing = body.trailing();
    if trailing > 0 {
        warnings.push(format!("bytes after the last element, ignored: {trailing}"));
    }
    mesh.indices = faces.triangles;
    add_attributes(&mut mesh, of_faces, &mut warnings);
    ImportedMesh::finish(mesh, warnings)
}

/// Gives a mesh the attributes of its faces.
fn add_attributes(mesh: &mut MeshData, of_faces: Columns, warnings: &mut Vec<String>) {
    for attribute in of_faces.attributes {
        // Triangles of strips have none.
        if attribute.values.len() == mesh.indices.len() {
            mesh.attributes.push(attribute);
        } else {
            warnings.push(format!("not all faces have {}; ignored", attribute.name));
        }
    }
}

/// Where a vertex property goes in the eight numbers x, y, z, nx, ny, nz, u, v.
fn vertex_slot(property: &str) -> Option<usize> {
    match property {
        "x" => Some(0),
        "y" => Some(1),
        "z" => Some(2),
        "nx" => Some(3),
        "ny" => Some(4),
        "nz" => Some(5),
        "u" | "s" | "texture_u" | "texture_s" => Some(6),
        "v" | "t" | "texture_v" | "texture_t" => Some(7),
        _ => None,
    }
}

fn read_vertices<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    mesh: &mut MeshData,
    warnings: &mut Vec<String>,
) -> Result<(), MeshProblem> {
    let slot = |name: &str| vertex_slot(name);
    let columns: Vec<_> = element
        .properties
        .iter()
        .map(|property| match property.kind {
            Kind::Scalar(_) => (property.kind, slot(&property.name)),
            Kind::List { .. } => (property.kind, None),
        })
        .collect();
    let is_known = |name: &str| slot(name).is_some();
    let mut others = Columns::of(element, AttributeDomain::Vertex, is_known, warnings);
    let has = |slot| columns.iter().any(|column| column.1 == Some(slot));
    let (has_normals, has_uvs) = ((3..6).all(has), (6..8).all(has));
    if !(0..3).all(has) {
        return Err(MeshProblem::Syntax {
            place: Place::Line(element.line),
            message: "vertices need the properties x, y and z".to_owned(),
        });
    }
    let mut positions = Vec::with_capacity(element.count);
    let mut normals = Vec::with_capacity(if has_normals { element.count } else { 0 });
    let mut uvs = Vec::with_capacity(if has_uvs { element.count } else { 0 });
    for row in 0..element.count {
        body.start_row(&element.name, row);
        let mut values = [0_f32; 8];
        for (index, &(kind, slot)) in columns.iter().enumerate() {
            match (kind, slot) {
                (Kind::Scalar(scalar), Some(slot)) => values[slot] = body.scalar(scalar)? as f32,
                _ => others.read(body, index, kind)?,
            }
        }
        others.push(1);
        let [x, y, z, nx, ny, nz, u, v] = values;
        if ![x, y, z].iter().all(|c| c.is_finite()) {
            return Err(body.not_finite("a vertex coordinate"));
        }
        positions.push([x, y, z]);
        // Normals without direction are computed later, as exporters write such.
        if has_normals {
            normals.push([nx, ny, nz]);
        }
        if has_uvs {
            if !(u.is_finite() && v.is_finite()) {
                return Err(body.not_finite("a texture coordinate"));
            }
            uvs.push([u, v]);
        }
    }
    mesh.positions = positions;
    mesh.normals = has_normals.then_some(normals);
    mesh.uvs = has_uvs.then_some(uvs);
    mesh.attributes = others.attributes;
    Ok(())
}

/// Whether a list of this name holds the vertices of a face.
fn is_indices(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

/// Reads the rows of an element of faces.
///
/// - `others`: takes what a row holds beside its list.
/// - `on_list`: reads a list of indices of the given length.
fn read_lists<'a>(
    body: &mut Body<'a>,
    element: &'a Element,
    others: &mut Columns,
    faces: &mut Faces,
    on_list: fn(&mut Faces, &mut ListReader<'_, 'a>, usize) -> Result<(), MeshProblem>,
) -> Result<(), MeshProblem> {
    let indices = element.properties.iter().position(|property| {
        is_indices(&property.name) && matches!(property.kind, Kind::List { .. })
    });
    let Some(indices) = indices else {
        return Err(MeshProblem::Syntax {
            place: Place::Line(element.line),
            message: format!("{} needs a list named vertex_indices", element.name),
        });
    };
    for row in 0..element.count {
        body.start_row(&element.name, row);
        let before = faces.triangles.len();
        for (column, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { count, item } if column == indices => {
                    let length = body.list_length(count, item)?;
                    on_list(faces, &mut ListReader { body, item }, length)?;
                }
                kind => others.read(body, column, kind)?,
            }
        }
        others.push(faces.triangles.len() - before);
    }
    Ok(())
}

/// Reads the items of one list of vertex indices.
struct ListReader<'r, 'a> {
    body: &'r mut Body<'a>,
    item: header::Scalar,
}

impl ListReader<'_, '_> {
    /// The next whole number.
    fn integer(&mut self) -> Result<i64, MeshProblem> {
        self.body.integer(self.item)
    }
}

/// Triangles gathered from faces and strips.
struct Faces {
    vertex_count: usize,
    triangles: Vec<[u32; 3]>,
    short: usize,
}

impl Faces {
    /// Adds triangles.
    fn take(&mut self, triangles: Vec<[u32; 3]>) {
        if self.triangles.is_empty() {
            self.triangles = triangles;
        } else {
            self.triangles.extend(triangles);
        }
    }

    fn polygon(&mut self, list: &mut ListReader<'_, '_>, length: usize) -> Result<(), MeshProblem> {
        let mut fan = (0, 0);
        for corner in 0..length {
            let index = list.integer()?;
            let vertex = self.vertex(list, index)?;
            match corner {
                0 => fan.0 = vertex,
                1 => {}
                _ => self.triangles.push([fan.0, fan.1, vertex]),
            }
            fan.1 = vertex;
        }
        self.short += usize::from(length < 3);
        Ok(())
    }

    fn strip(&mut self, list: &mut ListReader<'_, '_>, length: usize) -> Result<(), MeshProblem> {
        let mut last_two = (0, 0);
        let mut corner = 0_usize;
        for _ in 0..length {
            let index = list.integer()?;
            if index == -1 {
                corner = 0;
                continue;
            }
            let vertex = self.vertex(list, index)?;
            let (a, b) = last_two;
            // A repeated vertex is how strips are stitched together, not a triangle.
            let is_triangle = corner >= 2 && a != b && b != vertex && vertex != a;
            if is_triangle {
                self.triangles.push(if corner % 2 == 0 {
                    [a, b, vertex]
                } else {
                    [b, a, vertex]
                });
            }
            last_two = (b, vertex);
            corner += 1;
        }
        Ok(())
    }

    fn vertex(&self, list: &ListReader<'_, '_>, index: i64) -> Result<u32, MeshProblem> {
        let count = self.vertex_count;
        match u32::try_from(index) {
            Ok(vertex) if (vertex as usize) < count => Ok(vertex),
            _ => Err(MeshProblem::IndexOutOfRange {
                place: list.body.place(),
                what: "vertex",
                index,
                count,
            }),
        }
    }
}

#[cfg(test)]
mod tests;
