//! Readers of mesh files: Wavefront OBJ, PLY and Mitsuba's serialized format.
//!
//! Each format has a `parse` from bytes (in memory, no file access, never panics) and a `read`
//! that opens the file. All give one mesh per file or shape as [`ImportedMesh`]; materials and groups
//! in the files are not used.
//!
//! Mitsuba 3.9.1 computes smooth vertex normals for OBJ, PLY and serialized alike where the file
//! has none, unless the shape says `face_normals`. The readers leave `normals` at `None` then and
//! the choice to the caller.

pub mod curves;
mod error;
pub mod obj;
pub mod ply;
pub mod serialized;

pub use error::{MeshError, MeshProblem, Place};

use std::path::Path;

use crate::shape::mesh::MeshData;

/// What a mesh file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedMesh {
    /// The triangles: at least one, finite, all indices in range, normals unit.
    pub data: MeshData,
    /// The name that the file gives the shape (serialized, version 4).
    pub name: Option<String>,
    /// True when the file itself asks for a faceted look (a flag of serialized files).
    pub face_normals: bool,
    /// What was left out or made up, for people; a file as it should be gives none.
    pub warnings: Vec<String>,
}

impl ImportedMesh {
    /// The last steps common to all formats: checks the mesh and makes its normals unit.
    fn finish(mut data: MeshData, mut warnings: Vec<String>) -> Result<Self, MeshProblem> {
        if data.indices.is_empty() {
            return Err(MeshProblem::Empty);
        }
        let computed = data.repair_normals();
        if computed > 0 {
            warnings.push(format!(
                "vertex normals missing or zero, computed: {computed}"
            ));
        }
        data.validate().map_err(MeshProblem::Flawed)?;
        Ok(Self {
            data,
            name: None,
            face_normals: false,
            warnings,
        })
    }
}

/// Reads a whole file and hands it to a parser; both errors get the file's name.
fn read_with<T>(
    file: &Path,
    parse: impl FnOnce(Vec<u8>) -> Result<T, MeshProblem>,
) -> Result<T, MeshError> {
    std::fs::read(file)
        .map_err(MeshProblem::Io)
        .and_then(parse)
        .map_err(|problem| MeshError {
            file: file.to_owned(),
            shape: None,
            problem,
        })
}
