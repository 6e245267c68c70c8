//! Mitsuba's serialized format, versions 3 and 4: many shapes in one file, each compressed.
//!
//! A shape is the magic number 0x041C, the version (both 16 bit) and a zlib stream. At the end
//! of the file stand the offsets of all shapes (32 bit in version 3, 64 bit in version 4) and
//! their number (32 bit). All numbers are little-endian. The stream holds, in this order: flags,
//! a name that ends in 0 (version 4 only), the counts of vertices and triangles (64 bit), then
//! positions, normals, texture coordinates, colours (each if flagged) and vertex indices.
//!
//! A stream may inflate to [`MAX_INFLATION`] times its size and no further, so that a small file
//! cannot fill the memory. Meshes are far below that: even the vertices of a regular flat grid
//! shrink by less than 10.

mod inflate;

use std::path::{Path, PathBuf};

use inflate::Inflated;

use super::{ImportedMesh, MeshError, MeshProblem, Place, read_with};
use crate::shape::mesh::{AttributeDomain, MeshAttribute, MeshData, MeshFlaw};

/// How many times its compressed size a shape may have. Shapes up to 16 MiB are always read.
pub const MAX_INFLATION: u64 = 64;

const MAGIC: u16 = 0x041C;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLOURS: u32 = 0x0008;
const WANTS_FACE_NORMALS: u32 = 0x0010;
const IS_DOUBLE: u32 = 0x2000;

/// A serialized file in memory, whose shapes are decompressed one at a time.
#[derive(Clone, Debug)]
pub struct SerializedFile {
    file: PathBuf,
    bytes: Vec<u8>,
    version: u16,
    /// Where each shape begins.
    offsets: Vec<usize>,
    /// The same in order, and then where the table begins: each shape ends where one of these is.
    ends: Vec<usize>,
}

impl SerializedFile {
    /// Reads a file; see [`SerializedFile::open`].
    ///
    /// # Errors
    /// As [`SerializedFile::open`], and [`MeshProblem::Io`] where the file cannot be read.
    pub fn read(file: &Path) -> Result<Self, MeshError> {
        let (bytes, table) = read_with(file, |bytes| Table::parse(&bytes).map(|t| (bytes, t)))?;
        Ok(Self::assemble(file, bytes, table))
    }

    /// Takes the bytes of a file and reads the table of its shapes.
    ///
    /// - `file`: its name, for messages.
    ///
    /// # Errors
    /// [`MeshProblem::Syntax`] for another kind of file, an unknown version or an offset outside
    /// the file; `Truncated` and `TooLarge` where the table does not fit.
    pub fn open(file: &Path, bytes: Vec<u8>) -> Result<Self, MeshError> {
        let table = Table::parse(&bytes).map_err(|problem| MeshError {
            file: file.to_owned(),
            shape: None,
            problem,
        })?;
        Ok(Self::assemble(file, bytes, table))
    }

    fn assemble(file: &Path, bytes: Vec<u8>, table: Table) -> Self {
        let Table {
            version,
            offsets,
            start,
        } = table;
        let mut ends = offsets.clone();
        ends.push(start);
        ends.sort_unstable();
        Self {
            file: file.to_owned(),
            bytes,
            version,
            offsets,
            ends,
        }
    }

    /// Number of shapes in the file.
    pub fn shape_count(&self) -> usize {
        self.offsets.len()
    }

    /// Decompresses one shape.
    ///
    /// Normals that the file does not have stay `None`. Mitsuba never flips the texture
    /// coordinates of this format. It ignores (3.9.1) the flag given as
    /// [`ImportedMesh::face_normals`].
    ///
    /// - `index`: Mitsuba's `shapeIndex` or `shape_index`, from 0.
    ///
    /// # Errors
    /// [`MeshProblem::NoSuchShape`] for an index too large, otherwise all but `Io`.
    pub fn mesh(&self, index: usize) -> Result<ImportedMesh, MeshError> {
        self.inflate(index).map_err(|problem| {
            let shape = match problem {
                MeshProblem::NoSuchShape { .. } => None,
                _ => Some(index),
            };
            MeshError {
                file: self.file.clone(),
                shape,
                problem,
            }
        })
    }

    fn inflate(&self, index: usize) -> Result<ImportedMesh, MeshProblem> {
        let count = self.offsets.len();
        let &start = self
            .offsets
            .get(index)
            .ok_or(MeshProblem::NoSuchShape { index, count })?;
        let end = self.ends[self.ends.partition_point(|&end| end <= start)];
        let shape = &self.bytes[start..end];
        let [magic, version] = [shape_word(shape, start, 0)?, shape_word(shape, start, 2)?];
        if magic != MAGIC || version != self.version {
            return Err(MeshProblem::Syntax {
                place: Place::Byte(start),
                message: format!("no shape of version {} begins here", self.version),
            });
        }
        read_shape(&mut Inflated::new(&shape[4..]), version)
    }
}

/// What the ends of a file say.
struct Table {
    version: u16,
    offsets: Vec<usize>,
    /// Offset of the table.
    start: usize,
}

impl Table {
    fn parse(bytes: &[u8]) -> Result<Self, MeshProblem> {
        let version = version(bytes)?;
        let width = if version == 3 { 4 } else { 8 };
        let start = table_start(bytes, width)?;
        let entries = bytes[start..bytes.len() - 4].chunks_exact(width);
        let offsets = entries.enumerate().map(|(i, entry)| {
            let little_endian = |value, &byte| (value << 8) | u64::from(byte);
            let offset = entry.iter().rev().fold(0_u64, little_endian);
            let shape = usize::try_from(offset).ok().filter(|&o| o < start);
            shape.ok_or_else(|| MeshProblem::Syntax {
                place: Place::Byte(start + i * width),
                message: format!("shape {i} begins at byte {offset}, past the last shape"),
            })
        });
        Ok(Self {
            version,
            offsets: offsets.collect::<Result<_, _>>()?,
            start,
        })
    }
}

/// The version of a file by its first shape; an error where lumiflow does not read it.
fn version(bytes: &[u8]) -> Result<u16, MeshProblem> {
    let (at, message) = if shape_word(bytes, 0, 0)? != MAGIC {
        let message = "this is not a serialized mesh file of Mitsuba".to_owned();
        (0, message)
    } else {
        match shape_word(bytes, 0, 2)? {
            version @ (3 | 4) => return Ok(version),
            version => (2, format!("version {version} is not known (3 and 4 are)")),
        }
    };
    Err(MeshProblem::Syntax {
        place: Place::Byte(at),
        message,
    })
}

/// Where the table of offsets begins: before the number of shapes, which ends the file.
///
/// - `bytes`: with the head of a shape in front; `width`: bytes of one offset.
fn table_start(bytes: &[u8], width: usize) -> Result<usize, MeshProblem> {
    let Some((body, &count)) = bytes[4..].split_last_chunk::<4>() else {
        return Err(MeshProblem::Truncated {
            place: Place::Byte(bytes.len()),
            expected: "the table of shapes".to_owned(),
        });
    };
    let count = u32::from_le_bytes(count) as usize;
    let size = count.checked_mul(width);
    let start = size.and_then(|size| body.len().checked_sub(size));
    start
        .map(|start| 4 + start)
        .ok_or_else(|| MeshProblem::TooLarge {
            place: Place::Byte(bytes.len() - 4),
            claim: format!("{count} shapes are announced"),
            available: body.len() as u64,
        })
}

/// The 16-bit number at `at` in a shape that begins at `start` in its file.
fn shape_word(shape: &[u8], start: usize, at: usize) -> Result<u16, MeshProblem> {
    let word = shape.get(at..).and_then(|rest| rest.first_chunk());
    word.map(|&word| u16::from_le_bytes(word))
        .ok_or_else(|| MeshProblem::Truncated {
            place: Place::Byte(start + shape.len()),
            expected: "the head of a shape".to_owned(),
        })
}

fn read_shape(stream: &mut Inflated<'_>, version: u16) -> Result<ImportedMesh, MeshProblem> {
    let flags = u32::from_le_bytes(stream.bytes("the flags")?);
    let name = if version >= 4 {
        Some(stream.name()?)
    } else {
        None
    };
    let vertex_count = count(stream, "vertices")?;
    let triangle_count = count(stream, "triangles")?;

    let is_double = flags & IS_DOUBLE != 0;
    let has = |flag: u32| flags & flag != 0;
    let numbers = 3
        + if has(HAS_NORMALS) { 3 } else { 0 }
        + if has(HAS_UVS) { 2 } else { 0 }
        + if has(HAS_COLOURS) { 3 } else { 0 };
    let vertex_size = numbers * if is_double { 8 } else { 4 };
    // Both counts are below 2³², so that this cannot overflow.
    stream.check_claim(
        vertex_count as u64 * vertex_size + triangle_count as u64 * 12,
        || format!("{vertex_count} vertices and {triangle_count} triangles are announced"),
    )?;

    let positions = stream.vectors(vertex_count, is_double, Some("a vertex coordinate"))?;
    // Normals without direction are computed later.
    let normals = match has(HAS_NORMALS) {
        true => Some(stream.vectors(vertex_count, is_double, None)?),
        false => None,
    };
    let uvs = match has(HAS_UVS) {
        true => Some(stream.vectors(vertex_count, is_double, Some("a texture coordinate"))?),
        false => None,
    };
    let mut attributes = Vec::new();
    if has(HAS_COLOURS) {
        attributes.push(MeshAttribute {
            name: "vertex_color".to_owned(),
            domain: AttributeDomain::Vertex,
            values: stream.vectors(vertex_count, is_double, Some("a colour"))?,
        });
    }
    let indices = stream.triangles(triangle_count, vertex_count)?;
    let mut warnings = Vec::new();
    if !stream.is_at_end()? {
        warnings.push("data after the last triangle ignored".to_owned());
    }
    let data = MeshData {
        positions,
        indices,
        normals,
        uvs,
        attributes,
    };
    let mesh = ImportedMesh::finish(data, warnings)?;
    Ok(ImportedMesh {
        name,
        face_normals: has(WANTS_FACE_NORMALS),
        ..mesh
    })
}

/// Reads a count, which the file stores in 64 bits and which must fit into 32.
fn count(stream: &mut Inflated<'_>, what: &'static str) -> Result<usize, MeshProblem> {
    let count = u64::from_le_bytes(stream.bytes("the counts")?);
    let small = u32::try_from(count)
        .ok()
        .and_then(|count| usize::try_from(count).ok());
    small.ok_or_else(|| {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        MeshProblem::Flawed(MeshFlaw::TooMany { what, count })
    })
}

#[cfg(test)]
mod tests;
