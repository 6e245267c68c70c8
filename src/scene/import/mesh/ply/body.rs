//! The numbers after the header of a PLY file.

use super::header::{Element, Encoding, Header, Kind, Scalar};
use super::{MeshProblem, Place};

/// A position in the data, and what is being read there.
pub(super) struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
    encoding: Encoding,
    element: &'a str,
    row: usize,
}

impl<'a> Body<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self {
            bytes,
            at: header.end,
            encoding: header.encoding,
            element: "",
            row: 0,
        }
    }

    /// Says what is read next, for messages.
    pub(super) fn start_row(&mut self, element: &'a str, row: usize) {
        (self.element, self.row) = (element, row);
    }

    /// Where the next number stands: the line in text files, the byte in binary ones.
    pub(super) fn place(&self) -> Place {
        match self.encoding {
            Encoding::Ascii => {
                let before = &self.bytes[..self.at];
                Place::Line(1 + before.iter().filter(|&&b| b == b'\n').count())
            }
            _ => Place::Byte(self.at),
        }
    }

    /// Checks that an element's rows, at their shortest, fit into the bytes that are left.
    pub(super) fn check_claim(&self, element: &Element) -> Result<(), MeshProblem> {
        let shortest: usize = element
            .properties
            .iter()
            .map(|p| self.shortest(p.kind))
            .sum();
        // In text the last number needs no blank after it.
        let available = self.available() + usize::from(self.encoding == Encoding::Ascii);
        match element.count.checked_mul(shortest) {
            Some(needed) if needed <= available => Ok(()),
            _ => Err(MeshProblem::TooLarge {
                place: Place::Line(element.line),
                claim: format!("{} rows of {} are announced", element.count, element.name),
                available: self.available() as u64,
            }),
        }
    }

    /// How numbers are written.
    pub(super) fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The next rows of a binary file, each of so many bytes; `None` in a text, and where there are fewer.
    pub(super) fn rows(&self, length: usize, count: usize) -> Option<&'a [u8]> {
        let bytes = length.checked_mul(count)?;
        let is_binary = self.encoding != Encoding::Ascii && length > 0;
        self.bytes[self.at..].get(..bytes).filter(|_| is_binary)
    }

    /// Goes on after rows that have been read as [`Body::rows`].
    pub(super) fn skip_rows(&mut self, length: usize, count: usize) {
        self.at += length * count;
    }

    /// Reads one number.
    pub(super) fn scalar(&mut self, scalar: Scalar) -> Result<f64, MeshProblem> {
        match self.encoding {
            Encoding::Ascii => self.word(scalar),
            Encoding::LittleEndian | Encoding::BigEndian => Ok(match scalar {
                Scalar::I8 => f64::from(i8::from_le_bytes(self.value()?)),
                Scalar::U8 => f64::from(u8::from_le_bytes(self.value()?)),
                Scalar::I16 => f64::from(i16::from_le_bytes(self.value()?)),
                Scalar::U16 => f64::from(u16::from_le_bytes(self.value()?)),
                Scalar::I32 => f64::from(i32::from_le_bytes(self.value()?)),
                Scalar::U32 => f64::from(u32::from_le_bytes(self.value()?)),
                Scalar::F32 => f64::from(f32::from_le_bytes(self.value()?)),
                Scalar::F64 => f64::from_le_bytes(self.value()?),
            }),
        }
    }

    /// Reads one number that must be whole; a float type is accepted.
    pub(super) fn integer(&mut self, scalar: Scalar) -> Result<i64, MeshProblem> {
        let start = self.at;
        let value = self.scalar(scalar)?;
        if value.fract() == 0.0 && value.abs() < 9e15 {
            Ok(value as i64)
        } else {
            self.at = start;
            Err(self.syntax(format!("{value} is not a whole number")))
        }
    }

    /// Reads the count of a list and checks that as many items fit into the rest.
    pub(super) fn list_length(
        &mut self,
        count: Scalar,
        item: Scalar,
    ) -> Result<usize, MeshProblem> {
        let length = self.integer(count)?;
        let too_large = |length: &str| MeshProblem::TooLarge {
            place: self.place(),
            claim: format!("{} {} has a list of {length} items", self.element, self.row),
            available: self.available() as u64,
        };
        let length = usize::try_from(length)
            .map_err(|_| self.syntax(format!("{length} is not a length of a list")))?;
        match length.checked_mul(self.shortest(Kind::Scalar(item))) {
            Some(needed) if needed <= self.available() + 1 => Ok(length),
            _ => Err(too_large(&length.to_string())),
        }
    }

    /// Reads over a number or a list.
    pub(super) fn skip(&mut self, kind: Kind) -> Result<(), MeshProblem> {
        match kind {
            Kind::Scalar(scalar) => self.scalar(scalar).map(|_| ()),
            Kind::List { count, item } => {
                let length = self.list_length(count, item)?;
                (0..length).try_for_each(|_| self.skip(Kind::Scalar(item)))
            }
        }
    }

    /// Reads over all rows of an element.
    pub(super) fn skip_element(&mut self, element: &'a Element) -> Result<(), MeshProblem> {
        if element.properties.is_empty() {
            // Rows of nothing can be claimed in any number.
            return Ok(());
        }
        for row in 0..element.count {
            self.start_row(&element.name, row);
            for property in &element.properties {
                self.skip(property.kind)?;
            }
        }
        Ok(())
    }

    /// Bytes that nothing has read, without blanks at the end of a text.
    pub(super) fn trailing(&self) -> usize {
        let rest = &self.bytes[self.at..];
        match self.encoding {
            Encoding::Ascii => rest.trim_ascii().len(),
            _ => rest.len(),
        }
    }

    /// The problem of a number just read that is infinite or not a number.
    pub(super) fn not_finite(&self, what: &'static str) -> MeshProblem {
        MeshProblem::NotFinite {
            place: self.place(),
            what,
        }
    }

    fn syntax(&self, message: String) -> MeshProblem {
        MeshProblem::Syntax {
            place: self.place(),
            message,
        }
    }

    fn truncated(&self) -> MeshProblem {
        let expected = format!("{} {}", self.element, self.row);
        MeshProblem::Truncated {
            place: self.place(),
            expected,
        }
    }

    fn available(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The fewest bytes that a property can take: in text, a digit and a blank.
    fn shortest(&self, kind: Kind) -> usize {
        match (self.encoding, kind) {
            (Encoding::Ascii, _) => 2,
            (_, Kind::Scalar(scalar) | Kind::List { count: scalar, .. }) => scalar.size(),
        }
    }

    /// The next bytes in little-endian order.
    fn value<const N: usize>(&mut self) -> Result<[u8; N], MeshProblem> {
        let Some(&value) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(self.truncated());
        };
        self.at += N;
        let mut value = value;
        if self.encoding == Encoding::BigEndian {
            value.reverse();
        }
        Ok(value)
    }

    /// The next number of a text.
    fn word(&mut self, scalar: Scalar) -> Result<f64, MeshProblem> {
        let rest = &self.bytes[self.at..];
        let Some(start) = rest.iter().position(|b| !b.is_ascii_whitespace()) else {
            self.at = self.bytes.len();
            return Err(self.truncated());
        };
        self.at += start;
        let rest = &rest[start..];
        let word = &rest[..rest
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len())];
        let number = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse().ok());
        let Some(number) = number else {
            return Err(self.syntax(format!("\"{}\" is not a number", word.escape_ascii())));
        };
        if let Some([least, most]) = scalar.range() {
            let is_in_range = (least..=most).contains(&number);
            if !is_in_range || number.fract() != 0.0 {
                let expected = format!("expected a whole number from {least} to {most}");
                return Err(self.syntax(format!("found {number}, {expected}")));
            }
        }
        self.at += word.len();
        Ok(number)
    }
}
