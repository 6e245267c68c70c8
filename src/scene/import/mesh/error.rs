//! Why a mesh file cannot be used.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::shape::mesh::MeshFlaw;

/// A mesh file that cannot be used, printed as `model.obj: line 12: …` or, for one shape of
/// several in a file, `model.serialized: shape 3: …`.
#[derive(Debug, thiserror::Error)]
#[error("{}: {}{problem}", file.display(), shape_prefix(*shape))]
pub struct MeshError {
    /// The file, as it was named by the caller.
    pub file: PathBuf,
    /// Index of the shape within a serialized file, from 0.
    pub shape: Option<usize>,
    /// What is wrong with it.
    pub problem: MeshProblem,
}

fn shape_prefix(shape: Option<usize>) -> String {
    shape
        .map(|shape| format!("shape {shape}: "))
        .unwrap_or_default()
}

/// What can be wrong with a mesh file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshProblem {
    /// The file cannot be opened or read.
    #[error("{0}")]
    Io(io::Error),
    /// The bytes are not what the format prescribes at this place.
    #[error("{place}: {message}")]
    Syntax {
        /// Where.
        place: Place,
        /// What was found and expected.
        message: String,
    },
    /// The file ends before all that its header announces has been read.
    #[error("{place}: the file ends where {expected} should follow")]
    Truncated {
        /// Where the file ends.
        place: Place,
        /// What is missing.
        expected: String,
    },
    /// A header announces more data than the rest of the file can hold; found before any memory
    /// is set aside for it.
    #[error("{place}: {claim}, which the rest of the file (at most {available} bytes) cannot hold")]
    TooLarge {
        /// Where the claim stands or the data should begin.
        place: Place,
        /// What is announced.
        claim: String,
        /// Bytes that are left in the file, after inflating where it is compressed.
        available: u64,
    },
    /// A coordinate is infinite, not a number, or too large for a 32-bit float.
    #[error("{place}: {what} is not a finite number")]
    NotFinite {
        /// Where.
        place: Place,
        /// Which value.
        what: &'static str,
    },
    /// A face refers to a vertex, normal or texture coordinate that the file does not have.
    #[error("{place}: there is no {what} {index}, the file has {count}")]
    IndexOutOfRange {
        /// Where the reference stands.
        place: Place,
        /// "vertex", "texture coordinate" or "normal".
        what: &'static str,
        /// The index as written in the file (OBJ counts from 1, and from −1 backwards).
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// The file is read to its end, but the mesh is not sound.
    #[error("{0}")]
    Flawed(MeshFlaw),
    /// The file has no face at all. Harmless in a scene, but often a sign of a wrong file.
    #[error("there is no face in it")]
    Empty,
    /// The serialized file has fewer shapes than the index asked for.
    #[error("there is no shape {index}, the file has {count} (the first is 0)")]
    NoSuchShape {
        /// The index asked for, from 0.
        index: usize,
        /// Number of shapes in the file.
        count: usize,
    },
}

impl MeshProblem {
    /// The line of a text file where the problem is, from 1.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Syntax { place, .. }
            | Self::Truncated { place, .. }
            | Self::TooLarge { place, .. }
            | Self::NotFinite { place, .. }
            | Self::IndexOutOfRange { place, .. } => match place {
                Place::Line(line) | Place::Column(line, _) => Some(*line),
                _ => None,
            },
            _ => None,
        }
    }
}

/// A position in a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// Line of a text file, from 1.
    Line(usize),
    /// Line and column of a text file, from 1.
    Column(usize, usize),
    /// Offset in a binary file, from 0.
    Byte(usize),
    /// Offset in the inflated data of a shape of a serialized file, from 0.
    InflatedByte(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Column(line, column) => write!(f, "line {line}, column {column}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::InflatedByte(byte) => write!(f, "byte {byte} of the inflated data"),
        }
    }
}
