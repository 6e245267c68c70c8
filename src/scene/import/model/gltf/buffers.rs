//! The numbers of a glTF file: buffers, and the accessors that look into them.

use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::accessor::sparse::IndexType;
use gltf::accessor::{Accessor, DataType};
use gltf::buffer::{Source, View};

use super::super::Model;

/// The bytes of all buffers.
pub(super) struct Buffers {
    bytes: Vec<Vec<u8>>,
}

impl Model<'_> {
    /// Reads all buffers; `None` after noting why not.
    ///
    /// - `blob`: the binary part of a GLB file.
    pub(super) fn gltf_buffers(
        &mut self,
        document: &gltf::Document,
        blob: Option<Vec<u8>>,
    ) -> Option<Buffers> {
        let mut blob = blob;
        let mut bytes = Vec::new();
        for buffer in document.buffers() {
            let what = format!("buffer {}", buffer.index());
            let read = match buffer.source() {
                Source::Bin => blob.take().ok_or_else(|| {
                    format!("{what} names no file, and the file has no binary part")
                }),
                Source::Uri(uri) => self.gltf_resource(uri, &what),
            };
            let expected = buffer.length();
            let read = read.and_then(|read| match read.len() {
                found if found < expected => {
                    Err(format!("{what} has {found} bytes, expected {expected}"))
                }
                _ => Ok(read),
            });
            match read {
                Ok(read) => bytes.push(read),
                Err(message) => {
                    self.problems.error(&self.line(1), message);
                    return None;
                }
            }
        }
        Some(Buffers { bytes })
    }

    /// The bytes that an URI means: those that it holds, or those of a file beside the model.
    ///
    /// # Errors
    /// Why there are none.
    pub(super) fn gltf_resource(&mut self, uri: &str, what: &str) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
            let encoded = encoded.ok_or_else(|| format!("{what}: its data is not in base64"))?;
            let decoded = STANDARD.decode(encoded.trim());
            return decoded.map_err(|error| format!("{what}: broken base64: {error}"));
        }
        let name = unescaped(uri);
        if name.contains("://") {
            return Err(format!("{what}: \"{uri}\" is no file beside the model"));
        }
        let file = self.files.find_noted(&name, &self.line(1), &self.problems);
        let file = file.ok_or_else(|| format!("{what}: its file is missing"))?;
        let admitted = self.options.gauge.check_file(&file, 0);
        admitted.map_err(|shortage| format!("{what}: {shortage}"))?;
        let read = read(&file).map_err(|reason| format!("{what}: {reason}"))?;
        self.take_into_hash(&read);
        Ok(read)
    }
}

fn read(file: &Path) -> Result<Vec<u8>, String> {
    let read = std::fs::read(file);
    read.map_err(|reason| format!("cannot read {}: {reason}", file.display()))
}

/// A name with its `%20` decoded.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| first == b'%');
        let code = code.and_then(|digits| std::str::from_utf8(digits).ok());
        match code.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(code) => {
                bytes.push(code);
                rest = &after[2..];
            }
            None => {
                bytes.push(first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

impl Buffers {
    /// The bytes of a view.
    pub(super) fn view(&self, view: &View<'_>) -> Result<&[u8], String> {
        let buffer = self.bytes.get(view.buffer().index());
        let end = view.offset().checked_add(view.length());
        let bytes = buffer.and_then(|buffer| buffer.get(view.offset()..end?));
        bytes.ok_or_else(|| format!("bufferView {} reaches beyond its buffer", view.index()))
    }

    /// Reads vectors of `N` numbers; whole numbers become 0 to 1 or −1 to 1 where they are normalised.
    ///
    /// # Errors
    /// What contradicts what, in words.
    pub(super) fn vectors<const N: usize>(
        &self,
        accessor: &Accessor<'_>,
    ) -> Result<Vec<[f32; N]>, String> {
        let found = accessor.dimensions().multiplicity();
        if found != N {
            let index = accessor.index();
            return Err(format!(
                "accessor {index} has {found} numbers a value, expected {N}"
            ));
        }
        let scale = scale(accessor);
        let convert = |element: &[u8]| {
            let size = accessor.data_type().size();
            let mut values = [0.0; N];
            for (value, bytes) in values.iter_mut().zip(element.chunks_exact(size)) {
                let scaled = number(accessor.data_type(), bytes) * scale;
                // The least code of a signed number lies a little below −1.
                *value = if scale < 1.0 {
                    scaled.max(-1.0)
                } else {
                    scaled
                } as f32;
            }
            values
        };
        self.elements(accessor, [0.0; N], convert)
    }

    /// Reads whole numbers, as indices are.
    ///
    /// # Errors
    /// As [`Buffers::vectors`].
    pub(super) fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, String> {
        let kind = accessor.data_type();
        let is_whole = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
        if !is_whole || accessor.dimensions().multiplicity() != 1 {
            let index = accessor.index();
            return Err(format!(
                "accessor {index} holds no whole numbers, expected indices"
            ));
        }
        self.elements(accessor, 0, |element| number(kind, element) as u32)
    }

    /// Reads the elements of an accessor, with those that a sparse one puts in their place.
    fn elements<T: Copy>(
        &self,
        accessor: &Accessor<'_>,
        nothing: T,
        convert: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, String> {
        let (index, count, size) = (accessor.index(), accessor.count(), accessor.size());
        let beyond = || format!("accessor {index} reaches beyond its bufferView");
        let mut elements = match accessor.view() {
            Some(view) => {
                let bytes = self.view(&view)?;
                let stride = view.stride().unwrap_or(size);
                let all = strided(bytes, accessor.offset(), stride, size, count);
                all.ok_or_else(beyond)?.map(&convert).collect()
            }
            None => {
                // A count that no bytes stand behind must not fill the memory.
                let behind: usize = self.bytes.iter().map(Vec::len).sum();
                if count > behind {
                    return Err(format!("accessor {index} has {count} values without data"));
                }
                vec![nothing; count]
            }
        };
        let Some(sparse) = accessor.sparse() else {
            return Ok(elements);
        };
        let (places, values) = (sparse.indices(), sparse.values());
        let kind = match places.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        let place_bytes = self.view(&places.view())?;
        let (width, offset) = (kind.size(), places.offset());
        let place_bytes = strided(place_bytes, offset, width, width, sparse.count());
        let value_bytes = self.view(&values.view())?;
        let value_bytes = strided(value_bytes, values.offset(), size, size, sparse.count());
        let pairs = place_bytes
            .ok_or_else(beyond)?
            .zip(value_bytes.ok_or_else(beyond)?);
        for (place, value) in pairs {
            let place = number(kind, place) as usize;
            let element = elements.get_mut(place);
            *element.ok_or_else(|| format!("accessor {index} has no value {place}"))? =
                convert(value);
        }
        Ok(elements)
    }
}

/// `count` pieces of `size` bytes, `stride` apart; `None` where the bytes do not hold them.
fn strided(
    bytes: &[u8],
    offset: usize,
    stride: usize,
    size: usize,
    count: usize,
) -> Option<impl Iterator<Item = &[u8]>> {
    let last = count.saturating_sub(1).checked_mul(stride)?;
    let end = offset.checked_add(last)?.checked_add(size)?;
    let holds = stride >= size && size > 0 && (count == 0 || end <= bytes.len());
    holds.then(|| (0..count).map(move |i| &bytes[offset + i * stride..][..size]))
}

/// A number of a type that is as long as `bytes`.
fn number(kind: DataType, bytes: &[u8]) -> f64 {
    let word = |len: usize| {
        let bytes = bytes.iter().take(len).rev();
        bytes.fold(0_u32, |word, byte| (word << 8) | u32::from(*byte))
    };
    match kind {
        DataType::I8 => f64::from(word(1) as u8 as i8),
        DataType::U8 => f64::from(word(1)),
        DataType::I16 => f64::from(word(2) as u16 as i16),
        DataType::U16 => f64::from(word(2)),
        DataType::U32 => f64::from(word(4)),
        DataType::F32 => f64::from(f32::from_bits(word(4))),
    }
}

/// What a number of an accessor is multiplied by.
fn scale(accessor: &Accessor<'_>) -> f64 {
    let largest = match accessor.data_type() {
        _ if !accessor.normalized() => 1.0,
        DataType::I8 => 127.0,
        DataType::U8 => 255.0,
        DataType::I16 => 32_767.0,
        DataType::U16 => 65_535.0,
        DataType::U32 | DataType::F32 => 1.0,
    };
    1.0 / largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_lie_within_their_bytes() {
        let bytes: Vec<u8> = (0..20).collect();
        let firsts = |offset, stride, size, count| -> Option<Vec<u8>> {
            let pieces = strided(&bytes, offset, stride, size, count)?;
            Some(pieces.map(|piece| piece[0]).collect())
        };
        assert_eq!(firsts(0, 8, 4, 3), Some(vec![0, 8, 16]));
        assert_eq!(firsts(1, 8, 4, 3), None);
        assert_eq!(firsts(4, 4, 4, 4), Some(vec![4, 8, 12, 16]));
        assert_eq!(firsts(0, 4, 4, usize::MAX), None);
        assert_eq!(firsts(99, 4, 4, 0), Some(vec![]));
        assert_eq!(firsts(0, 2, 4, 2), None);
    }

    #[test]
    fn numbers_are_little_endian() {
        assert_eq!(number(DataType::I8, &[0xff]), -1.0);
        assert_eq!(number(DataType::U16, &[0x34, 0x12]), 4660.0);
        assert_eq!(number(DataType::I16, &[0xfe, 0xff]), -2.0);
        assert_eq!(number(DataType::F32, &1.5_f32.to_le_bytes()), 1.5);
        assert_eq!(unescaped("a%20b%2Fc%zz"), "a b/c%zz");
    }
}
