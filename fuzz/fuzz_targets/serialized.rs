//! Any bytes as a serialized file of Mitsuba, or as the data of a shape before compression.
//!
//! Random changes to a compressed stream hardly get past its checksum. So the first byte decides:
//! odd, and the rest is a file; even, and the rest is compressed here (4 makes it version 4).

#![no_main]

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use libfuzzer_sys::fuzz_target;
use lumiflow::scene::import::mesh::serialized::SerializedFile;
use lumiflow_fuzz::check_mesh;

fuzz_target!(|bytes: &[u8]| {
    let Some((&mode, rest)) = bytes.split_first() else {
        return;
    };
    let file = if mode & 1 == 1 {
        rest.to_vec()
    } else {
        one_shape(mode, rest)
    };
    let Ok(file) = SerializedFile::open(Path::new("fuzz"), file) else {
        return;
    };
    for index in 0..file.shape_count().min(4) + 1 {
        match file.mesh(index) {
            Ok(mesh) => check_mesh(mesh),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
});

/// A file of one shape with this data.
fn one_shape(mode: u8, inflated: &[u8]) -> Vec<u8> {
    let version: u16 = if mode & 4 == 4 { 4 } else { 3 };
    let mut file = [0x041C_u16.to_le_bytes(), version.to_le_bytes()].concat();
    let mut encoder = ZlibEncoder::new(&mut file, Compression::none());
    let written = encoder
        .write_all(inflated)
        .and_then(|()| encoder.finish().map(|_| ()));
    written.expect("writing to memory cannot fail");
    let offset_size = if version == 4 { 8 } else { 4 };
    file.extend(std::iter::repeat_n(0, offset_size));
    file.extend(1_u32.to_le_bytes());
    file
}
