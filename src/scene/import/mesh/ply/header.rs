//! The header of a PLY file: which elements follow, and how they are written.

use super::{MeshProblem, Place};

/// How the numbers after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A number type of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        match name {
            "char" | "int8" => Some(Self::I8),
            "uchar" | "uint8" => Some(Self::U8),
            "short" | "int16" => Some(Self::I16),
            "ushort" | "uint16" => Some(Self::U16),
            "int" | "int32" => Some(Self::I32),
            "uint" | "uint32" => Some(Self::U32),
            "float" | "float32" => Some(Self::F32),
            "double" | "float64" => Some(Self::F64),
            _ => None,
        }
    }

    /// Whole numbers from the least to the largest; `None` for numbers of any size.
    pub(super) fn range(self) -> Option<[f64; 2]> {
        let (is_signed, bits) = match self {
            Self::I8 => (true, 8),
            Self::U8 => (false, 8),
            Self::I16 => (true, 16),
            Self::U16 => (false, 16),
            Self::I32 => (true, 32),
            Self::U32 => (false, 32),
            Self::F32 | Self::F64 => return None,
        };
        let count = 2_f64.powi(bits);
        Some(if is_signed {
            [-0.5 * count, 0.5 * count - 1.0]
        } else {
            [0.0, count - 1.0]
        })
    }

    /// Bytes that a value takes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// One number, or a count and as many items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

/// A column of an element.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A table of the file.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// Number of rows, as claimed.
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    /// Line of the header that declares it.
    pub(super) line: usize,
}

/// What stands before the data.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Offset of the first byte after the header.
    pub(super) end: usize,
    /// Number of lines in the header.
    pub(super) line_count: usize,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, MeshProblem> {
        let mut lines = HeaderLines::new(bytes);
        if lines.next().is_none_or(|line| line.trim_end() != "ply") {
            return Err(syntax(1, "the file does not begin with \"ply\""));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        while let Some(text) = lines.next() {
            let line = lines.number;
            let words: Vec<_> = text.split_ascii_whitespace().collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, "1.0"] => encoding = Some(format(line, name)?),
                ["format", ..] => return Err(syntax(line, "only PLY format 1.0 is known")),
                ["element", name, count] => {
                    if elements.iter().any(|element| element.name == name) {
                        return Err(syntax(line, &format!("a second element {name}")));
                    }
                    elements.push(element(line, name, count)?);
                }
                ["property", ref rest @ ..] => {
                    let property = property(line, rest)?;
                    let Some(element) = elements.last_mut() else {
                        return Err(syntax(line, "a property before the first element"));
                    };
                    if element.properties.iter().any(|p| p.name == property.name) {
                        let (element, name) = (&element.name, &property.name);
                        let message = format!("a second property {name} of {element}");
                        return Err(syntax(line, &message));
                    }
                    element.properties.push(property);
                }
                ["end_header"] => {
                    let Some(encoding) = encoding else {
                        return Err(syntax(line, "the header has no format line"));
                    };
                    return Ok(Self {
                        encoding,
                        elements,
                        end: lines.at,
                        line_count: line,
                    });
                }
                _ => {
                    let message = format!("\"{}\" has no place in a header", text.escape_debug());
                    return Err(syntax(line, &message));
                }
            }
        }
        let expected = "the rest of the header".to_owned();
        Err(MeshProblem::Truncated {
            place: Place::Line(lines.number),
            expected,
        })
    }

    /// Number of vertices, as claimed.
    pub(super) fn vertex_count(&self) -> Result<usize, MeshProblem> {
        let vertices = self
            .elements
            .iter()
            .find(|element| element.name == "vertex");
        let missing = || syntax(self.line_count, "the header declares no element vertex");
        vertices.map(|element| element.count).ok_or_else(missing)
    }
}

/// Lines that end in LF, CR LF or (very old files) CR.
struct HeaderLines<'a> {
    bytes: &'a [u8],
    at: usize,
    number: usize,
    /// In files of CR lines the first byte of the data may be 10, which is no line end.
    ends_in_cr: bool,
}

impl<'a> HeaderLines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let ends_in_cr = bytes.starts_with(b"ply\r") && !bytes.starts_with(b"ply\r\n");
        Self {
            bytes,
            at: 0,
            number: 0,
            ends_in_cr,
        }
    }

    /// `None` at the end of the file or for a line that never ends.
    fn next(&mut self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        let end = rest
            .iter()
            .position(|&b| b == b'\n' || (self.ends_in_cr && b == b'\r'))?;
        self.at += end + 1;
        self.number += 1;
        let line = String::from_utf8_lossy(&rest[..end]);
        Some(line.strip_suffix('\r').unwrap_or(&line).to_owned())
    }
}

fn syntax(line: usize, message: &str) -> MeshProblem {
    MeshProblem::Syntax {
        place: Place::Line(line),
        message: message.to_owned(),
    }
}

fn format(line: usize, name: &str) -> Result<Encoding, MeshProblem> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(syntax(
            line,
            &format!("unknown format \"{}\"", name.escape_debug()),
        )),
    }
}

fn element(line: usize, name: &str, count: &str) -> Result<Element, MeshProblem> {
    let message = || format!("\"{}\" is not a count", count.escape_debug());
    let count = count.parse().map_err(|_| syntax(line, &message()))?;
    Ok(Element {
        name: name.to_owned(),
        count,
        properties: Vec::new(),
        line,
    })
}

fn property(line: usize, words: &[&str]) -> Result<Property, MeshProblem> {
    let scalar = |name: &str| {
        let message = || format!("unknown type \"{}\"", name.escape_debug());
        Scalar::named(name).ok_or_else(|| syntax(line, &message()))
    };
    let (kind, name) = match *words {
        ["list", count, item, name] => (
            Kind::List {
                count: scalar(count)?,
                item: scalar(item)?,
            },
            name,
        ),
        [kind, name] => (Kind::Scalar(scalar(kind)?), name),
        _ => return Err(syntax(line, "a property is a type and a name")),
    };
    Ok(Property {
        name: name.to_owned(),
        kind,
    })
}
