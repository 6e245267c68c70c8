//! glTF files as scenes.

use std::fs;

use lumiflow::image::write_png;
use lumiflow::math::{Rgb, Vec2, Vec3};
use lumiflow::scene::import::import;
use lumiflow::scene::import::xml::Strictness;
use lumiflow::sensor::SensorModel;

use super::models::{below, import_files, notes};
use super::options;

/// A square over [0, 1]² in z = 0, with texture coordinates, colours and indices.
fn buffer() -> Vec<u8> {
    let corners = [[0.0_f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut numbers: Vec<f32> = Vec::new();
    numbers.extend(corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]));
    numbers.extend(corners.as_flattened());
    numbers.extend(corners.iter().flat_map(|[x, _]| [*x, 0.5, 1.0]));
    let mut bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes
}

/// A file with that square.
///
/// - `material`: of the square; `attributes`: beside its position; `rest`: nodes and what they name.
fn file(material: &str, attributes: &str, rest: &str) -> String {
    let length = buffer().len();
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0,
"buffers": [{{"uri": "the%20square.bin", "byteLength": {length}}}],
"bufferViews": [{{"buffer": 0, "byteLength": 48}},
  {{"buffer": 0, "byteOffset": 48, "byteLength": 32}},
  {{"buffer": 0, "byteOffset": 80, "byteLength": 48}},
  {{"buffer": 0, "byteOffset": 128, "byteLength": 12}}],
"accessors": [
  {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0,0,0], "max": [1,1,0]}},
  {{"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"}},
  {{"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"}},
  {{"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0{attributes}}}, "indices": 3, "material": 0}}]}}],
"materials": [{material}],
{rest}}}"#
    )
}

const ONE_NODE: &str = r#""scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}]"#;

fn notes_of(text: &str) -> Result<Vec<String>, String> {
    let square = buffer();
    let files = [("a.gltf", text.as_bytes()), ("the square.bin", &square[..])];
    Ok(notes(&import_files(&files, Strictness::Normal)?))
}

#[test]
fn nodes_place_meshes_lights_and_cameras() {
    let rest = r#""scenes": [{"nodes": [0, 2, 3]}],
"nodes": [{"children": [1], "translation": [5, 0, 0]},
  {"mesh": 0, "scale": [2, 2, 2]},
  {"camera": 0, "translation": [6, 1, 4]},
  {"translation": [6, 1, 9], "extensions": {"KHR_lights_punctual": {"light": 0}}}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 2, "znear": 0.1}}],
"extensionsUsed": ["KHR_lights_punctual"],
"extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 7}]}}"#;
    let material =
        r#"{"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.6, 1], "metallicFactor": 0}}"#;
    let text = file(material, "", rest);
    let square = buffer();
    let files = [("a.gltf", text.as_bytes()), ("the square.bin", &square[..])];
    let imported = import_files(&files, Strictness::Strict).expect("a sound file");
    assert_eq!(notes(&imported), Vec::<String>::new());
    let (albedo, glows, _) = below(&imported, 6.5, 1.5);
    assert!(
        albedo.0.distance(Vec3::new(0.2, 0.4, 0.6)) < 1e-6 && !glows,
        "{albedo:?}"
    );
    let view = &imported.views[0];
    assert_eq!(view.film_size, (1152, 576));
    let eye = view.sensor.sample_lens(Vec2::splat(0.5));
    assert!(eye.distance(Vec3::new(6.0, 1.0, 4.0)) < 1e-6);
    let middle = view
        .sensor
        .raster_at(eye, Vec3::NEG_Z)
        .expect("it looks there");
    assert!(middle.distance(Vec2::new(576.0, 288.0)) < 1e-2, "{middle}");
    // What lies to the right in the world lies to the right on the film.
    let right = view
        .sensor
        .raster_at(eye, Vec3::new(0.1, 0.05, -1.0).normalize());
    let right = right.expect("it is ahead") - middle;
    assert!(right.x > 0.0 && right.y < 0.0, "{right}");
    assert_eq!(imported.scene.lights().emitters().len(), 1);
}

#[test]
fn meshes_of_several_nodes_are_instances_unless_they_glow() {
    let rest = r#""scenes": [{"nodes": [0, 1]}],
"nodes": [{"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]}]"#;
    for (emission, instances, lights) in [("", 2, 1), (r#", "emissiveFactor": [1, 1, 0]"#, 0, 2)] {
        let material = format!(r#"{{"doubleSided": true{emission}}}"#);
        let text = file(&material, "", rest);
        let square = buffer();
        let files = [("a.gltf", text.as_bytes()), ("the square.bin", &square[..])];
        let imported = import_files(&files, Strictness::Normal).expect("a sound file");
        assert_eq!(imported.scene.instances().len(), instances);
        assert_eq!(imported.scene.lights().emitters().len(), lights);
        for x in [0.3, 3.3] {
            assert_eq!(below(&imported, x, 0.3).1, instances == 0);
        }
    }
}

#[test]
fn pictures_and_colours_of_vertices_multiply() {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let in_folder = |name: &str| folder.path().join(name);
    // Left black, right white.
    let picture = [[0.0; 3], [1.0; 3]];
    write_png(&in_folder("p.png"), 2, 1, &picture, 0.0).expect("a picture");
    let material = r#"{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "metallicFactor": 0,
  "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}}}}"#;
    let rest = format!(
        r#""images": [{{"uri": "p.png"}}], "samplers": [{{"magFilter": 9728}}],
"textures": [{{"source": 0, "sampler": 0}}], "extensionsUsed": ["KHR_texture_transform"], {ONE_NODE}"#
    );
    let text = file(material, r#", "TEXCOORD_0": 1, "COLOR_0": 2"#, &rest);
    fs::write(in_folder("a.gltf"), text).expect("the file can be written");
    fs::write(in_folder("the square.bin"), buffer()).expect("the file can be written");
    let imported = import(&in_folder("a.gltf"), &options(Strictness::Normal)).expect("sound");
    // Moved by a half, the white half lies left; colours are (x, 1/2, 1).
    for (x, expected) in [(0.2, Rgb::new(0.1, 0.5, 1.0)), (0.7, Rgb::BLACK)] {
        let found = below(&imported, x, 0.4).0;
        assert!(
            (found - expected).0.abs().max_element() < 1e-4,
            "{found:?} at {x}"
        );
    }
}

#[test]
fn materials_become_what_they_look_like() {
    for (material, expected) in [
        ("{}", "TwoSided"),
        (
            r#"{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}"#,
            "Mask",
        ),
        (r#"{"alphaMode": "MASK"}"#, "TwoSided"),
        (
            r#"{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}"#,
            "PrincipledThin",
        ),
        (
            r#"{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
                "KHR_materials_volume": {"thicknessFactor": 1}}}"#,
            "Principled",
        ),
        (r#"{"extensions": {"KHR_materials_unlit": {}}}"#, "Diffuse"),
    ] {
        let used = r#""extensionsUsed": ["KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_unlit"]"#;
        let text = file(material, "", &format!("{used}, {ONE_NODE}"));
        let square = buffer();
        let files = [("a.gltf", text.as_bytes()), ("the square.bin", &square[..])];
        let imported = import_files(&files, Strictness::Normal).expect("a sound file");
        let (_, glows, kind) = below(&imported, 0.3, 0.3);
        assert_eq!(
            (kind.as_str(), glows),
            (expected, expected == "Diffuse"),
            "{material}"
        );
    }
}

#[test]
fn what_is_not_read_or_broken_is_told() {
    let sound = file("{}", "", ONE_NODE);
    let cases = [
        (
            "\"scene\": 0",
            "\"scene\": 0, \"extensionsUsed\": [\"EXT_x\"]",
            "the extension EXT_x is not read; ignored",
        ),
        (
            "the%20square",
            "the%20squire",
            "did you mean \"the square.bin\"?",
        ),
        (
            "\"byteLength\": 140",
            "\"byteLength\": 150",
            "buffer 0 has 140 bytes, expected 150",
        ),
        (
            "\"count\": 6",
            "\"count\": 7",
            "accessor 3 reaches beyond its bufferView",
        ),
        (
            "\"byteOffset\": 128, \"byteLength\": 12",
            "\"byteOffset\": 132, \"byteLength\": 12",
            "bufferView 3 reaches beyond its buffer",
        ),
        (
            "\"indices\": 3",
            "\"indices\": 1",
            "accessor 1 holds no whole numbers, expected indices",
        ),
        ("\"POSITION\": 0", "\"NORMAL\": 0", "POSITION"),
        ("{\"asset\"", "[\"asset\"", "not a sound glTF file"),
    ];
    for case in cases {
        is_said(&sound, case);
    }
}

#[test]
fn versions_and_nodes_that_are_not_of_the_format_are_refused() {
    let sound = file("{}", "", ONE_NODE);
    let cases = [
        (
            "\"version\": \"2.0\"",
            "\"version\": \"1.0\"",
            "found version \"1.0\" of glTF, expected \"2.0\"",
        ),
        (
            "\"version\": \"2.0\"",
            "\"version\": \"2.0\", \"minVersion\": \"2.1\"",
            "found version \"2.1\" of glTF, expected \"2.0\"",
        ),
        // Each such node would double what is there.
        (
            "\"nodes\": [{\"mesh\": 0}]",
            "\"nodes\": [{\"children\": [1, 1]}, {\"mesh\": 0}]",
            "node 1 is a child of node 0 and again of node 0, expected one parent",
        ),
    ];
    for case in cases {
        is_said(&sound, case);
    }
}

#[test]
fn numbers_out_of_range_are_clamped_aloud() {
    let material = r#"{"name": "paint", "emissiveFactor": [1, -1, 0],
        "pbrMetallicRoughness": {"baseColorFactor": [2, 0.5, -1, 1], "roughnessFactor": 1.5},
        "extensions": {"KHR_materials_ior": {"ior": 0.5}}}"#;
    let used = r#""extensionsUsed": ["KHR_materials_ior", "KHR_lights_punctual"]"#;
    let lamp = r#""extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": -2}]}}"#;
    let text = file(material, "", &format!("{used}, {lamp}, {ONE_NODE}"));
    let notes = notes_of(&text).expect("a sound file");
    for expected in [
        "material 0 (\"paint\"): baseColorFactor is 2, 0.5, -1, 1, which is outside 0 to 1; clamped",
        "material 0 (\"paint\"): roughnessFactor is 1.5, which is outside 0 to 1; clamped",
        "material 0 (\"paint\"): emissiveFactor is 1, -1, 0, which is negative; clamped",
        "material 0 (\"paint\"): ior is 0.5, which is below 1; clamped",
        "light 0: intensity is -2, which is negative; clamped",
    ] {
        let expected = format!("a.gltf:1:1: {expected}");
        assert!(notes.contains(&expected), "{expected}: {notes:?}");
    }
    let sound = notes_of(&file("{}", "", ONE_NODE)).expect("a sound file");
    assert!(!sound.join("\n").contains("clamped"), "{sound:?}");
}

/// Replaces a piece of a file, and checks what is said then.
fn is_said(sound: &str, (from, to, expected): (&str, &str, &str)) {
    assert!(sound.contains(from), "{from}");
    let said = match notes_of(&sound.replace(from, to)) {
        Ok(notes) => notes.join("\n"),
        Err(message) => message,
    };
    assert!(
        said.contains(expected) && said.starts_with("a.gltf:1:1: "),
        "{to}: {said}"
    );
}

/// A binary file of a text and a buffer.
fn binary(text: &str, buffer: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], bytes: &[u8], fill: u8| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), fill);
        let mut chunk = (padded.len() as u32).to_le_bytes().to_vec();
        chunk.extend(kind);
        chunk.extend(padded);
        chunk
    };
    let chunks = [
        chunk(b"JSON", text.as_bytes(), b' '),
        chunk(b"BIN\0", buffer, 0),
    ]
    .concat();
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((chunks.len() as u32 + 12).to_le_bytes());
    file.extend(chunks);
    file
}

#[test]
fn a_file_that_claims_to_be_shorter_than_its_header_is_refused() {
    let mut bytes = binary(&file("{}", "", ONE_NODE), &buffer());
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let path = folder.path().join("a.glb");
    for length in [0, 11] {
        bytes[8..12].copy_from_slice(&u32::to_le_bytes(length));
        for end in [12, 13, bytes.len()] {
            fs::write(&path, &bytes[..end]).expect("the file can be written");
            let refused = import(&path, &options(Strictness::Lenient));
            let message = refused
                .map(|_| ())
                .expect_err("it has no content")
                .to_string();
            let expected = format!("says that all of it has {length} bytes, expected 12 or more");
            assert!(message.contains(&expected), "{message}");
        }
    }
}

/// Single bytes changed in thousands of ways, in text and numbers: nothing may panic.
#[test]
fn damaged_files_are_refused_or_read() {
    let rest = r#""scenes": [{"nodes": [0, 1, 2]}], "nodes": [{"mesh": 0}, {"camera": 0}, {"mesh": 0}],
"cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}}]"#;
    let text = file("{}", r#", "TEXCOORD_0": 1, "COLOR_0": 2"#, rest);
    let whole = binary(
        &text.replace("\"uri\": \"the%20square.bin\", ", ""),
        &buffer(),
    );
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let path = folder.path().join("a.glb");
    let (mut refused, mut read) = (0, 0);
    let mut state = 12_345_u32;
    for round in 0..1500 {
        let mut bytes = whole.clone();
        if round > 0 {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let place = (state >> 8) as usize % bytes.len();
            bytes[place] = [b'9', b'0', b'-', b'"', 0xff, b'}', b'1'][(state >> 4) as usize % 7];
        }
        fs::write(&path, &bytes).expect("the file can be written");
        match import(&path, &options(Strictness::Normal)) {
            Ok(_) => read += 1,
            Err(error) => {
                assert!(round > 0, "{error}");
                refused += 1;
            }
        }
    }
    assert!(
        refused > 250 && read > 250,
        "{refused} refused, {read} read"
    );
}
