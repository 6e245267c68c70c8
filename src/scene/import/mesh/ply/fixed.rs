//! Rows of one length in binary files, which all processors read at once.
//!
//! What is not as most files have it is left to the reader of single rows, which knows what is wrong and
//! where: these functions read all of an element, or nothing.

use rayon::prelude::*;

use super::body::Body;
use super::header::{Element, Encoding, Kind, Scalar};
use super::vertex_slot;
use crate::shape::mesh::MeshData;

/// Rows that one processor takes at a time.
const PIECE: usize = 1 << 13;

/// Reads vertices that are floats and nothing but positions, normals and texture coordinates; false
/// where they are otherwise.
pub(super) fn vertices(body: &mut Body<'_>, element: &Element, mesh: &mut MeshData) -> bool {
    let slots = element.properties.iter().map(|property| {
        let is_float = property.kind == Kind::Scalar(Scalar::F32);
        vertex_slot(&property.name).filter(|_| is_float)
    });
    let Some(slots) = slots.collect::<Option<Vec<usize>>>() else {
        return false;
    };
    // Of two properties of one meaning, the last one counts.
    let place = |slot: usize| slots.iter().rposition(|known| *known == slot);
    let places = |first: usize| Some([place(first)?, place(first + 1)?, place(first + 2)?]);
    let (normals, uvs) = (places(3), place(6).zip(place(7)));
    let length = 4 * slots.len();
    let (Some(position), Some(rows)) = (places(0), body.rows(length, element.count)) else {
        return false;
    };
    let order = body.encoding();
    let positions = numbers(rows, length, position, order);
    let uvs = uvs.map(|(u, v)| numbers(rows, length, [u, v], order));
    let is_finite = all_finite(&positions) && uvs.as_deref().is_none_or(all_finite);
    if is_finite {
        mesh.positions = positions;
        mesh.normals = normals.map(|places| numbers(rows, length, places, order));
        mesh.uvs = uvs;
        body.skip_rows(length, element.count);
    }
    is_finite
}

/// Reads faces that are lists of three whole numbers and nothing else, all below `vertex_count`; `None`
/// where they are otherwise.
pub(super) fn triangles(
    body: &mut Body<'_>,
    element: &Element,
    vertex_count: usize,
) -> Option<Vec<[u32; 3]>> {
    const LENGTH: usize = 13;
    let [property] = element.properties.as_slice() else {
        return None;
    };
    let is_list = matches!(
        property.kind,
        Kind::List {
            count: Scalar::U8 | Scalar::I8,
            item: Scalar::I32 | Scalar::U32
        }
    );
    if !is_list || !super::is_indices(&property.name) {
        return None;
    }
    let (rows, order) = (body.rows(LENGTH, element.count)?, body.encoding());
    let mut triangles = vec![[0_u32; 3]; element.count];
    // Negative indices are larger than any count.
    let read = |triangle: &mut [u32; 3], row: &[u8]| {
        *triangle = [1, 5, 9].map(|at| u32::from_ne_bytes(word(row, at, order)));
        row[0] == 3
            && triangle
                .iter()
                .all(|index| (*index as usize) < vertex_count)
    };
    let pieces = triangles.par_chunks_mut(PIECE);
    let are_triangles = pieces
        .zip(rows.par_chunks(LENGTH * PIECE))
        .all(|(triangles, rows)| {
            let mut pairs = triangles.iter_mut().zip(rows.chunks_exact(LENGTH));
            pairs.all(|(triangle, row)| read(triangle, row))
        });
    are_triangles.then(|| {
        body.skip_rows(LENGTH, element.count);
        triangles
    })
}

/// Some floats of each row.
fn numbers<const N: usize>(
    rows: &[u8],
    length: usize,
    places: [usize; N],
    order: Encoding,
) -> Vec<[f32; N]> {
    // Room for what the tracer wants after the last vertex.
    let count = rows.len() / length;
    let mut numbers = Vec::with_capacity(count + 2);
    rows.par_chunks_exact(length)
        .with_min_len(PIECE)
        .map(|row| places.map(|place| f32::from_ne_bytes(word(row, 4 * place, order))))
        .collect_into_vec(&mut numbers);
    numbers
}

/// Four bytes of a row in the order of this machine.
fn word(row: &[u8], at: usize, order: Encoding) -> [u8; 4] {
    let mut word = [row[at], row[at + 1], row[at + 2], row[at + 3]];
    let is_big = order == Encoding::BigEndian;
    if is_big != cfg!(target_endian = "big") {
        word.reverse();
    }
    word
}

fn all_finite<const N: usize>(values: &[[f32; N]]) -> bool {
    let pieces = values.par_chunks(PIECE);
    pieces.all(|piece| piece.iter().flatten().all(|value| value.is_finite()))
}

#[cfg(test)]
mod tests {
    use crate::scene::import::mesh::ply::parse;

    const SIDE: usize = 120;

    /// A bent sheet of more rows than one processor takes at a time, written by `float`, `index` and
    /// `count`.
    fn sheet(
        format: &str,
        float: impl Fn(f32) -> Vec<u8>,
        index: impl Fn(u32) -> Vec<u8>,
        count: &[u8],
    ) -> Vec<u8> {
        let (vertices, faces) = (SIDE * SIDE, 2 * (SIDE - 1) * (SIDE - 1));
        let mut bytes = format!(
            "ply\nformat {format} 1.0\nelement vertex {vertices}\nproperty float z\n\
             property float x\nproperty float y\nproperty float nx\nproperty float ny\n\
             property float nz\nproperty float u\nproperty float v\nelement face {faces}\n\
             property list uchar int vertex_indices\nend_header\n"
        )
        .into_bytes();
        for i in 0..vertices {
            let (x, y) = ((i % SIDE) as f32, (i / SIDE) as f32);
            let numbers = [x * y * 0.25, x, y, 0.0, 1.0, 0.0, x * 0.5, y];
            numbers.iter().for_each(|value| bytes.extend(float(*value)));
        }
        for i in (0..vertices - SIDE).filter(|i| i % SIDE + 1 < SIDE) {
            let [a, b] = [i, i + SIDE].map(|i| i as u32);
            for corners in [[a, a + 1, b], [a + 1, b + 1, b]] {
                bytes.extend(count);
                corners
                    .iter()
                    .for_each(|corner| bytes.extend(index(*corner)));
            }
        }
        bytes
    }

    #[test]
    fn rows_read_at_once_are_those_read_alone() {
        let text = |number: String| format!("{number} ").into_bytes();
        let alone = sheet(
            "ascii",
            |value| text(value.to_string()),
            |index| text(index.to_string()),
            b"3 ",
        );
        let little = sheet(
            "binary_little_endian",
            |value| value.to_le_bytes().to_vec(),
            |index| index.to_le_bytes().to_vec(),
            &[3],
        );
        let big = sheet(
            "binary_big_endian",
            |value| value.to_be_bytes().to_vec(),
            |index| index.to_be_bytes().to_vec(),
            &[3],
        );
        let expected = parse(&alone, true).unwrap();
        assert_eq!(expected.data.indices.len(), 2 * (SIDE - 1) * (SIDE - 1));
        for bytes in [&little, &big] {
            assert_eq!(parse(bytes, true).unwrap(), expected);
        }
        // The last index, too large by far: told as the reader of rows tells it.
        let mut broken = little.clone();
        let place = broken.len() - 1;
        broken[place] = 0x7f;
        let message = parse(&broken, false).unwrap_err().to_string();
        assert!(message.contains("vertex 21"), "{message}");
        broken.truncate(place);
        assert!(parse(&broken, false).is_err());
    }
}
