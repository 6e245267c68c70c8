//! Numbers out of the zlib stream of one shape.

use std::io::Read;

use flate2::bufread::ZlibDecoder;

use super::{MAX_INFLATION, MeshProblem, Place};

/// Shapes up to this size are read however well they are compressed.
const ALWAYS_ALLOWED: u64 = 16 << 20;

/// Bytes inflated at a time; memory grows with what the stream really holds. A multiple of 24,
/// so that it holds whole vectors and triangles.
const CHUNK: usize = 24 << 10;

/// A longer name is no name but a damaged file.
const MAX_NAME: usize = 1 << 16;

/// The inflated data of a shape.
pub(super) struct Inflated<'a> {
    decoder: ZlibDecoder<&'a [u8]>,
    /// Bytes read so far.
    at: u64,
    /// Bytes that may be read at all.
    limit: u64,
}

impl<'a> Inflated<'a> {
    pub(super) fn new(compressed: &'a [u8]) -> Self {
        let limit = ALWAYS_ALLOWED.max(compressed.len() as u64 * MAX_INFLATION);
        Self {
            decoder: ZlibDecoder::new(compressed),
            at: 0,
            limit,
        }
    }

    /// Checks that `needed` more bytes may follow.
    pub(super) fn check_claim(
        &self,
        needed: u64,
        claim: impl FnOnce() -> String,
    ) -> Result<(), MeshProblem> {
        let available = self.limit - self.at;
        if needed <= available {
            return Ok(());
        }
        Err(MeshProblem::TooLarge {
            place: self.place(),
            claim: claim(),
            available,
        })
    }

    /// The next bytes as they are.
    pub(super) fn bytes<const N: usize>(
        &mut self,
        what: &'static str,
    ) -> Result<[u8; N], MeshProblem> {
        let mut bytes = [0; N];
        self.fill(&mut bytes, what)?;
        Ok(bytes)
    }

    /// A text that ends in a zero byte; what is not UTF-8 in it is replaced.
    pub(super) fn name(&mut self) -> Result<String, MeshProblem> {
        let mut name = Vec::new();
        loop {
            match self.bytes("the name")? {
                [0] => return Ok(String::from_utf8_lossy(&name).into_owned()),
                [_] if name.len() == MAX_NAME => {
                    let message = "the name of the shape has no end".to_owned();
                    return Err(MeshProblem::Syntax {
                        place: self.place(),
                        message,
                    });
                }
                [byte] => name.push(byte),
            }
        }
    }

    /// Reads `count` vectors of single or double precision.
    ///
    /// - `finite`: what to call a number that is not finite, `None` where all may pass.
    pub(super) fn vectors<const N: usize>(
        &mut self,
        count: usize,
        is_double: bool,
        finite: Option<&'static str>,
    ) -> Result<Vec<[f32; N]>, MeshProblem> {
        let width = if is_double { 8 } else { 4 };
        let mut vectors = Vec::new();
        self.records(count, width * N, "vertex data", |place, record| {
            let mut vector = [0.; N];
            for (value, bytes) in vector.iter_mut().zip(record.chunks_exact(width)) {
                *value = number(bytes);
            }
            vectors.push(vector);
            match finite {
                Some(what) if !vector.iter().all(|c| c.is_finite()) => {
                    Err(MeshProblem::NotFinite { place, what })
                }
                _ => Ok(()),
            }
        })?;
        Ok(vectors)
    }

    /// Reads `count` triangles of 32-bit indices below `vertex_count`.
    pub(super) fn triangles(
        &mut self,
        count: usize,
        vertex_count: usize,
    ) -> Result<Vec<[u32; 3]>, MeshProblem> {
        let mut triangles = Vec::new();
        self.records(count, 12, "triangles", |place, record| {
            let mut corners = [0; 3];
            for (corner, bytes) in corners.iter_mut().zip(record.chunks_exact(4)) {
                *corner = bytes
                    .iter()
                    .rev()
                    .fold(0, |value, &b| (value << 8) | u32::from(b));
            }
            triangles.push(corners);
            match corners
                .iter()
                .find(|&&corner| corner as usize >= vertex_count)
            {
                Some(&corner) => Err(MeshProblem::IndexOutOfRange {
                    place,
                    what: "vertex",
                    index: i64::from(corner),
                    count: vertex_count,
                }),
                None => Ok(()),
            }
        })?;
        Ok(triangles)
    }

    /// True when nothing follows; reaching the end checks the stream's checksum.
    pub(super) fn is_at_end(&mut self) -> Result<bool, MeshProblem> {
        let found = self.decoder.read(&mut [0]).map_err(|_| self.corrupt())?;
        Ok(found == 0)
    }

    /// Reads `count` records of `size` bytes and hands them over with their place.
    fn records(
        &mut self,
        count: usize,
        size: usize,
        what: &'static str,
        mut take: impl FnMut(Place, &[u8]) -> Result<(), MeshProblem>,
    ) -> Result<(), MeshProblem> {
        let mut chunk = vec![0; CHUNK];
        let mut left = count;
        while left > 0 {
            let records = left.min(CHUNK / size);
            let start = self.at;
            let chunk = &mut chunk[..records * size];
            self.fill(chunk, what)?;
            for (i, record) in chunk.chunks_exact(size).enumerate() {
                take(Place::InflatedByte(start + (i * size) as u64), record)?;
            }
            left -= records;
        }
        Ok(())
    }

    fn fill(&mut self, bytes: &mut [u8], what: &'static str) -> Result<(), MeshProblem> {
        let mut filled = 0;
        while filled < bytes.len() {
            let found = self
                .decoder
                .read(&mut bytes[filled..])
                .map_err(|_| self.corrupt())?;
            if found == 0 {
                let expected = what.to_owned();
                return Err(MeshProblem::Truncated {
                    place: self.place(),
                    expected,
                });
            }
            filled += found;
            self.at += found as u64;
        }
        Ok(())
    }

    fn corrupt(&self) -> MeshProblem {
        let message = "the compressed data is damaged".to_owned();
        MeshProblem::Syntax {
            place: self.place(),
            message,
        }
    }

    fn place(&self) -> Place {
        Place::InflatedByte(self.at)
    }
}

/// A little-endian float of four or eight bytes.
fn number(bytes: &[u8]) -> f32 {
    match *bytes {
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        _ => bytes
            .first_chunk()
            .map_or(f32::NAN, |&double| f64::from_le_bytes(double) as f32),
    }
}
