//! Wavefront OBJ: polygons with positions, texture coordinates and normals.
//!
//! The whole file is one mesh: groups, objects and smoothing groups are ignored. [`parse_model`] also
//! tells which triangles have which material.
//! Faces may stand before the vertices that they name. Polygons become fans around their first
//! corner, as in Mitsuba, so that only convex ones come out right.
//!
//! The file is scanned here and not by a crate because every message must carry its line, because
//! texture coordinates and normals may be present on a part of the faces only, and because names
//! and comments of old files are not UTF-8. `tobj` checks the result in the tests.

mod corners;
mod words;

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use corners::Corners;
use words::{colour, integer, name, numbers};

use super::{ImportedMesh, MeshError, MeshProblem, Place, read_with};
use crate::shape::mesh::{AttributeDomain, MeshAttribute, MeshData, MeshFlaw};

/// Stands for a texture coordinate or normal that a corner does not have.
const ABSENT: u32 = u32::MAX;

/// What the three numbers of `f a/b/c` count, in their order.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Reads an OBJ file; see [`parse`].
///
/// # Errors
/// As [`parse`], and [`MeshProblem::Io`] where the file cannot be read.
pub fn read(file: &Path, flip_tex_coords: bool) -> Result<ImportedMesh, MeshError> {
    read_with(file, |bytes| parse(&bytes, flip_tex_coords))
}

/// Parses the text of an OBJ file.
///
/// - `flip_tex_coords`: replaces `v` by `1 − v`. It is Mitsuba's `flip_tex_coords` (3.x) or
///   `flipTexCoords` (0.5, 0.6), on by default in all of them, as OBJ counts `v` from the bottom
///   of the picture and Mitsuba from its top.
///
/// Corners with the same three numbers share a vertex; vertices are in order of first use.
/// Where only some corners name a normal, those without take one computed from the triangles;
/// where only some name a texture coordinate, the others take (0, 0). Both give a warning.
///
/// # Errors
/// [`MeshProblem::Syntax`], `NotFinite` and `IndexOutOfRange` with the line; `Empty` without faces.
pub fn parse(bytes: &[u8], flip_tex_coords: bool) -> Result<ImportedMesh, MeshProblem> {
    Ok(parse_model(bytes, flip_tex_coords)?.mesh)
}

/// An OBJ file, with what it says of materials.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjModel {
    /// All of it as one mesh.
    pub mesh: ImportedMesh,
    /// The libraries of materials that it names, each with its line.
    pub libraries: Vec<(usize, String)>,
    /// The names of its materials, each with the line that names it first.
    pub materials: Vec<(usize, String)>,
    /// Pieces of the triangles' list, in order, each with its index in `materials`; `None` for those
    /// before the first material.
    pub pieces: Vec<(Range<usize>, Option<usize>)>,
}

/// Parses the text of an OBJ file, and keeps what it says of materials; all else as for [`parse`].
///
/// # Errors
/// As [`parse`].
pub fn parse_model(bytes: &[u8], flip_tex_coords: bool) -> Result<ObjModel, MeshProblem> {
    let mut reader = Reader::default();
    for (number, line) in Lines::new(bytes) {
        reader.line(number, &line)?;
    }
    reader.finish(flip_tex_coords)
}

/// Logical lines with the number of their first physical line; a final `\` joins two lines.
struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes),
            number: 0,
        }
    }

    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&b| b == b'\n');
        let line = &self.rest[..end.unwrap_or(self.rest.len())];
        self.rest = &self.rest[end.map_or(self.rest.len(), |end| end + 1)..];
        self.number += 1;
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let mut line = Cow::Borrowed(self.physical()?);
        let number = self.number;
        while line.last() == Some(&b'\\') {
            let Some(continuation) = self.physical() else {
                break;
            };
            let joined = line.to_mut();
            joined.pop();
            joined.push(b' ');
            joined.extend_from_slice(continuation);
        }
        Some((number, line))
    }
}

/// The largest index seen so far that points past what had been read when it was met.
#[derive(Clone, Copy)]
struct Forward {
    index: i64,
    line: usize,
}

#[derive(Default)]
struct Reader {
    positions: Vec<[f32; 3]>,
    /// Of the positions that have one, in order.
    colours: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Corners,
    triangles: Vec<[u32; 3]>,
    libraries: Vec<(usize, String)>,
    materials: Vec<(usize, String)>,
    /// Where another material begins: the next triangle, and the material's index.
    changes: Vec<(usize, usize)>,
    forward: [Option<Forward>; 3],
    short_faces: usize,
    lines_and_curves: usize,
}

impl Reader {
    fn line(&mut self, number: usize, line: &[u8]) -> Result<(), MeshProblem> {
        let mut words = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        let Some(keyword) = words.next() else {
            return Ok(());
        };
        match keyword {
            b"v" => {
                let position = numbers(number, "v", words.by_ref(), 3)?;
                if !position.iter().all(|c| c.is_finite()) {
                    return Err(not_finite(number, "a vertex coordinate"));
                }
                self.positions.push(position);
                self.colours.extend(colour(words));
            }
            b"vt" => {
                let [u, v, _] = numbers(number, "vt", words, 1)?;
                if !(u.is_finite() && v.is_finite()) {
                    return Err(not_finite(number, "a texture coordinate"));
                }
                self.uvs.push([u, v]);
            }
            // Exporters write zeros and NaNs for faces without area; these are computed later.
            b"vn" => self.normals.push(numbers(number, "vn", words, 3)?),
            b"f" => self.face(number, words)?,
            b"usemtl" => self.use_material(number, name(line, keyword)),
            b"mtllib" => self.libraries.push((number, name(line, keyword))),
            b"l" | b"p" | b"curv" | b"curv2" | b"surf" => self.lines_and_curves += 1,
            _ => {}
        }
        Ok(())
    }

    /// Whether all positions have a colour.
    fn has_colours(&self) -> bool {
        self.colours.len() == self.positions.len()
    }

    fn face<'a>(
        &mut self,
        line: usize,
        words: impl Iterator<Item = &'a [u8]>,
    ) -> Result<(), MeshProblem> {
        let mut fan = (0, 0);
        let mut corner_count = 0;
        for word in words {
            let corner = self.corner(line, word)?;
            let vertex = self.vertex(corner)?;
            match corner_count {
                0 => fan.0 = vertex,
                1 => {}
                _ => self.triangles.push([fan.0, fan.1, vertex]),
            }
            fan.1 = vertex;
            corner_count += 1;
        }
        self.short_faces += usize::from(corner_count < 3);
        Ok(())
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`; a part may be empty except the first.
    fn corner(&mut self, line: usize, word: &[u8]) -> Result<[u32; 3], MeshProblem> {
        let malformed = || MeshProblem::Syntax {
            place: Place::Line(line),
            message: format!("\"{}\" is not a face corner", word.escape_ascii()),
        };
        let mut corner = [ABSENT; 3];
        for (kind, part) in word.split(|&b| b == b'/').enumerate() {
            if part.is_empty() && (1..3).contains(&kind) {
                continue;
            }
            let slot = corner.get_mut(kind).ok_or_else(malformed)?;
            *slot = self.resolve(line, kind, integer(part).ok_or_else(malformed)?)?;
        }
        Ok(corner)
    }

    /// Turns an index of the file, from 1 or backwards from −1, into one from 0.
    fn resolve(&mut self, line: usize, kind: usize, index: i64) -> Result<u32, MeshProblem> {
        let count = [self.positions.len(), self.uvs.len(), self.normals.len()][kind];
        let from_zero = if index < 0 {
            usize::try_from(index.unsigned_abs())
                .ok()
                .and_then(|back| count.checked_sub(back))
        } else {
            usize::try_from(index)
                .ok()
                .and_then(|index| index.checked_sub(1))
        };
        let resolved = from_zero
            .and_then(|i| u32::try_from(i).ok())
            .filter(|&i| i != ABSENT);
        let Some(resolved) = resolved else {
            return Err(out_of_range(line, kind, index, count));
        };
        if resolved as usize >= count && self.forward[kind].is_none_or(|f| f.index < index) {
            self.forward[kind] = Some(Forward { index, line });
        }
        Ok(resolved)
    }

    fn vertex(&mut self, corner: [u32; 3]) -> Result<u32, MeshProblem> {
        let count = self.corners.vertices().len();
        let vertex = self.corners.find_or_add(corner, self.positions.len());
        vertex.ok_or(MeshProblem::Flawed(MeshFlaw::TooMany {
            what: "vertices",
            count,
        }))
    }

    /// Gives the triangles from here on a material.
    fn use_material(&mut self, line: usize, name: String) {
        let known = self.materials.iter().position(|known| known.1 == name);
        let index = known.unwrap_or_else(|| {
            self.materials.push((line, name));
            self.materials.len() - 1
        });
        self.changes.push((self.triangles.len(), index));
    }

    /// The pieces of the triangles' list between changes of material.
    fn pieces(&self) -> Vec<(Range<usize>, Option<usize>)> {
        let starts = self
            .changes
            .iter()
            .map(|(start, index)| (*start, Some(*index)));
        let starts: Vec<_> = std::iter::once((0, None)).chain(starts).collect();
        let ends = starts.iter().skip(1).map(|(start, _)| *start);
        let ends = ends.chain([self.triangles.len()]);
        let pieces = starts.iter().zip(ends);
        let pieces = pieces.map(|((start, material), end)| (*start..end, *material));
        pieces.filter(|(piece, _)| !piece.is_empty()).collect()
    }

    fn finish(mut self, flip_tex_coords: bool) -> Result<ObjModel, MeshProblem> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for (kind, (count, forward)) in counts.into_iter().zip(self.forward).enumerate() {
            if let Some(Forward { index, line }) = forward.filter(|f| f.index > count as i64) {
                return Err(out_of_range(line, kind, index, count));
            }
        }
        let pieces = self.pieces();
        let (data, warnings) = self.mesh(flip_tex_coords);
        Ok(ObjModel {
            mesh: ImportedMesh::finish(data, warnings)?,
            libraries: self.libraries,
            materials: self.materials,
            pieces,
        })
    }

    /// Unrolls the corners, and says what was left out; takes the triangles.
    fn mesh(&mut self, flip_tex_coords: bool) -> (MeshData, Vec<String>) {
        let vertices = self.corners.vertices();
        let without_uv = vertices.iter().filter(|v| v[1] == ABSENT).count();
        let without_normal = vertices.iter().filter(|v| v[2] == ABSENT).count();
        let mut warnings = Vec::new();
        if 0 < without_uv && without_uv < vertices.len() {
            warnings.push(format!(
                "vertices without texture coordinates, (0, 0) used: {without_uv}"
            ));
        }
        if self.short_faces > 0 {
            let count = self.short_faces;
            warnings.push(format!("faces of less than 3 corners, ignored: {count}"));
        }
        if self.lines_and_curves > 0 {
            let count = self.lines_and_curves;
            warnings.push(format!("points, lines or curves, ignored: {count}"));
        }
        let uv = |vertex: &[u32; 3]| match self.uvs.get(vertex[1] as usize) {
            Some(&[u, v]) => [u, if flip_tex_coords { 1.0 - v } else { v }],
            None => [0., 0.],
        };
        let normal = |vertex: &[u32; 3]| {
            let normal = self.normals.get(vertex[2] as usize);
            normal.copied().unwrap_or_default()
        };
        let position = |vertex: &[u32; 3]| self.positions[vertex[0] as usize];
        let colours = self.has_colours().then(|| MeshAttribute {
            name: "vertex_color".to_owned(),
            domain: AttributeDomain::Vertex,
            values: vertices
                .iter()
                .map(|v| self.colours[v[0] as usize])
                .collect(),
        });
        if !(self.colours.is_empty() || self.has_colours()) {
            warnings.push("not all vertices have a colour; colours ignored".to_owned());
        }
        let data = MeshData {
            positions: vertices.iter().map(position).collect(),
            indices: std::mem::take(&mut self.triangles),
            normals: (without_normal < vertices.len())
                .then(|| vertices.iter().map(normal).collect()),
            uvs: (without_uv < vertices.len()).then(|| vertices.iter().map(uv).collect()),
            attributes: colours.into_iter().collect(),
        };
        (data, warnings)
    }
}

fn not_finite(line: usize, what: &'static str) -> MeshProblem {
    MeshProblem::NotFinite {
        place: Place::Line(line),
        what,
    }
}

fn out_of_range(line: usize, kind: usize, index: i64, count: usize) -> MeshProblem {
    MeshProblem::IndexOutOfRange {
        place: Place::Line(line),
        what: KINDS[kind],
        index,
        count,
    }
}

#[cfg(test)]
mod tests;
