use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::*;

/// The parts of a shape before compression; a tetrahedron's corner by default.
#[derive(Clone)]
struct Shape {
    version: u16,
    flags: u32,
    name: &'static [u8],
    counts: [u64; 2],
    /// Numbers after the counts, written in the precision of the flags.
    numbers: Vec<f64>,
    indices: Vec<u32>,
}

fn corner_of_a_box(version: u16) -> Shape {
    Shape {
        version,
        flags: 0x1000,
        name: if version == 4 { b"corner\0" } else { b"" },
        counts: [4, 2],
        numbers: vec![0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.],
        indices: vec![0, 1, 2, 0, 1, 3],
    }
}

impl Shape {
    fn inflated(&self) -> Vec<u8> {
        let mut bytes = self.flags.to_le_bytes().to_vec();
        bytes.extend(self.name);
        self.counts
            .iter()
            .for_each(|count| bytes.extend(count.to_le_bytes()));
        for &number in &self.numbers {
            match self.flags & IS_DOUBLE {
                0 => bytes.extend((number as f32).to_le_bytes()),
                _ => bytes.extend(number.to_le_bytes()),
            }
        }
        self.indices
            .iter()
            .for_each(|index| bytes.extend(index.to_le_bytes()));
        bytes
    }

    fn compressed(&self) -> Vec<u8> {
        compressed(self.version, &self.inflated())
    }
}

fn compressed(version: u16, inflated: &[u8]) -> Vec<u8> {
    let mut bytes = [MAGIC.to_le_bytes(), version.to_le_bytes()].concat();
    let mut encoder = ZlibEncoder::new(&mut bytes, Compression::default());
    encoder.write_all(inflated).unwrap();
    encoder.finish().unwrap();
    bytes
}

/// Shapes and their table.
fn file_of(version: u16, shapes: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut table = Vec::new();
    for shape in shapes {
        match version {
            3 => table.extend(u32::try_from(bytes.len()).unwrap().to_le_bytes()),
            _ => table.extend((bytes.len() as u64).to_le_bytes()),
        }
        bytes.extend(shape);
    }
    bytes.extend(table);
    bytes.extend(u32::try_from(shapes.len()).unwrap().to_le_bytes());
    bytes
}

fn open(bytes: Vec<u8>) -> Result<SerializedFile, MeshError> {
    SerializedFile::open(Path::new("a.serialized"), bytes)
}

fn mesh_of(shape: &Shape) -> Result<ImportedMesh, MeshError> {
    open(file_of(shape.version, &[shape.compressed()]))
        .unwrap()
        .mesh(0)
}

fn message_of(change: impl FnOnce(&mut Shape)) -> String {
    let mut shape = corner_of_a_box(4);
    change(&mut shape);
    mesh_of(&shape).unwrap_err().to_string()
}

#[test]
fn both_versions_give_one_mesh() {
    let v3 = mesh_of(&corner_of_a_box(3)).unwrap();
    assert_eq!(v3.data.positions[3], [0., 0., 1.]);
    assert_eq!(v3.data.indices, [[0, 1, 2], [0, 1, 3]]);
    assert_eq!((&v3.data.normals, &v3.data.uvs), (&None, &None));
    assert_eq!(
        (v3.name, v3.face_normals, v3.warnings.len()),
        (None, false, 0)
    );
    let v4 = mesh_of(&corner_of_a_box(4)).unwrap();
    assert_eq!(v4.name.as_deref(), Some("corner"));
    assert_eq!(v4.data, v3.data);
}

#[test]
fn every_flag_is_heeded_in_both_precisions() {
    for precision in [0x1000, IS_DOUBLE, 0] {
        let mut shape = corner_of_a_box(4);
        shape.flags = precision | HAS_NORMALS | HAS_UVS | HAS_COLOURS | WANTS_FACE_NORMALS;
        shape.name = b"caf\xE9\0";
        shape.numbers.extend([0., 0., 2.].repeat(3));
        shape.numbers.extend([0.; 3]);
        shape.numbers.extend([0.25, 0.75].repeat(4));
        shape.numbers.extend([0.1; 12]);
        let mesh = mesh_of(&shape).unwrap();
        let normals = mesh.data.normals.unwrap();
        assert_eq!(normals[..3], [[0., 0., 1.]; 3]);
        assert_eq!(normals[3], [0., -1., 0.]);
        assert_eq!(mesh.data.uvs.unwrap(), [[0.25, 0.75]; 4]);
        assert_eq!(mesh.data.indices, [[0, 1, 2], [0, 1, 3]]);
        assert!(mesh.face_normals);
        assert_eq!(mesh.name.as_deref(), Some("caf\u{FFFD}"));
        assert_eq!(
            mesh.warnings,
            ["vertex normals missing or zero, computed: 1"]
        );
    }
}

#[test]
fn shapes_are_found_by_their_index() {
    for version in [3, 4] {
        let first = corner_of_a_box(version);
        let mut second = first.clone();
        second.numbers[0] = 7.;
        let file = open(file_of(version, &[first.compressed(), second.compressed()])).unwrap();
        assert_eq!(file.shape_count(), 2);
        assert_eq!(file.mesh(0).unwrap().data.positions[0], [0., 0., 0.]);
        assert_eq!(file.mesh(1).unwrap().data.positions[0], [7., 0., 0.]);
        assert_eq!(
            file.mesh(2).unwrap_err().to_string(),
            "a.serialized: there is no shape 2, the file has 2 (the first is 0)"
        );
    }
}

#[test]
fn a_damaged_table_is_named() {
    let message = |bytes: &[u8]| open(bytes.to_vec()).unwrap_err().to_string();
    let good = file_of(4, &[corner_of_a_box(4).compressed()]);
    let size = good.len();
    assert_eq!(
        message(b""),
        "a.serialized: byte 0: the file ends where the head of a shape should follow"
    );
    assert_eq!(
        message(b"ply\nformat"),
        "a.serialized: byte 0: this is not a serialized mesh file of Mitsuba"
    );
    assert_eq!(
        message(b"\x1c\x04\x05\x00\x00\x00\x00\x00"),
        "a.serialized: byte 2: version 5 is not known (3 and 4 are)"
    );
    assert_eq!(
        message(&good[..6]),
        "a.serialized: byte 6: the file ends where the table of shapes should follow"
    );
    let mut many = good.clone();
    many[size - 4..].fill(0xFF);
    assert!(message(&many).contains("4294967295 shapes are announced"));
    let mut far = good.clone();
    far[size - 12] = 0xFF;
    assert!(message(&far).contains("shape 0 begins at byte 255, past the last shape"));
    let mut astray = good.clone();
    astray[size - 12] = 1;
    let file = open(astray).unwrap();
    assert_eq!(
        file.mesh(0).unwrap_err().to_string(),
        "a.serialized: shape 0: byte 1: no shape of version 4 begins here"
    );
    let mut late = good;
    late[size - 12] = u8::try_from(size - 13).unwrap();
    let late = open(late).unwrap().mesh(0).unwrap_err().to_string();
    assert!(
        late.ends_with("the file ends where the head of a shape should follow"),
        "{late}"
    );
    assert!(message(&[0; 4]).contains("this is not a serialized mesh file"));
}

#[test]
fn damaged_shapes_are_named() {
    assert_eq!(
        message_of(|s| s.indices[4] = 4),
        "a.serialized: shape 0: byte 87 of the inflated data: \
         there is no vertex 4, the file has 4"
    );
    assert_eq!(
        message_of(|s| s.numbers[4] = f64::NAN),
        "a.serialized: shape 0: byte 39 of the inflated data: \
         a vertex coordinate is not a finite number"
    );
    assert!(message_of(|s| s.numbers[4] = 1e60).contains("vertex coordinate is not a finite"));
    assert!(
        message_of(|s| {
            s.flags |= HAS_UVS;
            s.numbers.extend([f64::INFINITY; 8]);
        })
        .contains("a texture coordinate is not a finite number")
    );
    assert_eq!(
        message_of(|s| s.indices.truncate(5)),
        "a.serialized: shape 0: byte 95 of the inflated data: \
         the file ends where triangles should follow"
    );
    assert!(message_of(|s| s.numbers.clear()).contains("where vertex data should follow"));
    assert!(message_of(|s| s.name = b"no zero").contains("a.serialized: shape 0: "));
    assert!(message_of(|s| s.name = &[b'x'; MAX_NAME_TESTED]).contains("name of the shape has no"));
    assert_eq!(
        message_of(|s| s.counts[1] = 0),
        "a.serialized: shape 0: there is no face in it"
    );
}

/// Longer than any name that is accepted.
const MAX_NAME_TESTED: usize = (1 << 16) + 1;

#[test]
fn claims_are_checked_before_memory_is_set_aside() {
    assert_eq!(
        message_of(|s| s.counts[0] = 1 << 40),
        "a.serialized: shape 0: \
         1099511627776 vertices are more than a mesh can have (4294967295)"
    );
    assert!(message_of(|s| s.counts[1] = u64::MAX).contains("triangles are more than a mesh"));
    let claim = message_of(|s| s.counts = [u64::from(u32::MAX); 2]);
    assert!(
        claim.contains("4294967295 vertices and 4294967295 triangles are announced"),
        "{claim}"
    );
}

#[test]
fn a_stream_of_zeros_is_not_inflated_without_limit() {
    let mut inflated = corner_of_a_box(4).inflated();
    let million = 4_000_000_u64;
    inflated[11..19].copy_from_slice(&million.to_le_bytes());
    inflated.resize(usize::try_from(million).unwrap() * 12 + 40, 0);
    let bytes = file_of(4, &[compressed(4, &inflated)]);
    assert!(bytes.len() < 100_000);
    let message = open(bytes).unwrap().mesh(0).unwrap_err().to_string();
    assert!(
        message.contains("4000000 vertices and 2 triangles are announced"),
        "{message}"
    );
}

#[test]
fn damaged_compression_is_found() {
    let good = corner_of_a_box(3).compressed();
    let whole = mesh_of(&corner_of_a_box(3)).unwrap();
    for at in 4..good.len() {
        let mut damaged = good.clone();
        damaged[at] ^= 0x10;
        match open(file_of(3, &[damaged])).unwrap().mesh(0) {
            // Two bytes close the last block, when all data has been read.
            Ok(mesh) => assert_eq!(mesh.data, whole.data, "byte {at}"),
            Err(error) => {
                let message = error.to_string();
                assert!(
                    message.ends_with("the compressed data is damaged"),
                    "{message}"
                );
            }
        }
    }
}

#[test]
fn data_after_the_triangles_gives_a_warning() {
    let mut shape = corner_of_a_box(4);
    shape.indices.push(0);
    assert_eq!(
        mesh_of(&shape).unwrap().warnings,
        ["data after the last triangle ignored"]
    );
}

#[test]
fn shared_files_load() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    for name in [
        "scenes/torus/meshes/meshes.serialized",
        "scenes/matpreview/matpreview.serialized",
        "scenes/veach-lamp/bidir.serialized",
        "scenes/box/box.serialized",
        "conformance/common/meshes/matpreview.serialized",
    ] {
        let path = shared.join(name);
        if !path.exists() {
            eprintln!("SKIPPED: no {}", path.display());
            continue;
        }
        let file = SerializedFile::read(&path).unwrap();
        assert!(file.shape_count() > 0, "{name}");
        for index in 0..file.shape_count() {
            let mesh = file.mesh(index).unwrap();
            assert!(mesh.data.surface_area() > 0., "{name} {index}");
            eprintln!(
                "{name} {index}: {:?} {} vertices, {} triangles ({} degenerate), {:?}",
                mesh.name,
                mesh.data.positions.len(),
                mesh.data.indices.len(),
                mesh.data.degenerate_count(),
                mesh.warnings
            );
        }
    }
}
