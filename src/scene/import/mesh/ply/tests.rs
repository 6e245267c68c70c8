use super::*;

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n";

fn parsed(text: &str) -> ImportedMesh {
    parse(text.as_bytes(), false).unwrap()
}

fn message(bytes: &[u8]) -> String {
    parse(bytes, false).unwrap_err().to_string()
}

/// A text file whose rows stand for `replaced` in the header replaced by `with`.
fn message_of_header(replaced: &str, with: &str) -> String {
    assert!(HEADER.contains(replaced));
    message(HEADER.replace(replaced, with).as_bytes())
}

fn message_of_rows(rows: &str) -> String {
    message(format!("{HEADER}{rows}").as_bytes())
}

#[test]
fn a_triangle_as_text() {
    let mesh = parsed(&format!("{HEADER}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n \n"));
    assert_eq!(
        mesh.data.positions,
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]
    );
    assert_eq!(mesh.data.indices, [[0, 1, 2]]);
    assert_eq!((mesh.data.normals, mesh.data.uvs), (None, None));
    assert!(mesh.warnings.is_empty());
}

#[test]
fn header_lines_end_in_any_way_and_may_be_comments() {
    let text = format!("{HEADER}0 0 0\n1 0 0\n0 1 0\n3 0 1 2").replace(
        "element vertex",
        "comment caf\u{e9} element\nobj_info 7\n\nelement vertex",
    );
    let expected = parsed(&text);
    assert_eq!(parsed(&text.replace('\n', "\r\n")), expected);
    assert_eq!(parsed(&text.replace('\n', "\r")), expected);
    assert_eq!(parsed(&text.replace("end_header", "end_header ")), expected);
}

/// Vertices in mixed types and odd order, a skipped element, a face with extra properties.
fn mixed_header(format: &str) -> Vec<u8> {
    format!(
        "ply\nformat {format} 1.0\nelement camera 1\nproperty double focus\n\
         property list ushort short grid\nelement face 2\nproperty uchar red\n\
         property list uint ushort vertex_index\nproperty list uchar float texcoord\n\
         element vertex 4\nproperty ushort nz\nproperty short nx\nproperty char ny\n\
         property double z\nproperty float x\nproperty uint y\nproperty float s\n\
         property list char char marks\nproperty double t\nend_header\n"
    )
    .into_bytes()
}

fn mixed_body(big_endian: bool) -> Vec<u8> {
    let mut body = Vec::new();
    let mut put = |little: &[u8]| {
        if big_endian {
            body.extend(little.iter().rev());
        } else {
            body.extend(little);
        }
    };
    put(&2.5_f64.to_le_bytes());
    put(&2_u16.to_le_bytes());
    put(&(-1_i16).to_le_bytes());
    put(&(-2_i16).to_le_bytes());
    for indices in [&[0_u16, 1, 2, 3][..], &[2, 1, 0]] {
        put(&[255]);
        put(&u32::try_from(indices.len()).unwrap().to_le_bytes());
        indices.iter().for_each(|i| put(&i.to_le_bytes()));
        put(&[1]);
        put(&0.5_f32.to_le_bytes());
    }
    for (x, y) in [(0., 0), (1., 0), (1., 1), (0., 1_u32)] {
        put(&3_u16.to_le_bytes());
        put(&0_i16.to_le_bytes());
        put(&(-4_i8).to_le_bytes());
        put(&(-1.5_f64).to_le_bytes());
        put(&f32::to_le_bytes(x));
        put(&y.to_le_bytes());
        put(&0.25_f32.to_le_bytes());
        put(&[2]);
        put(&[7]);
        put(&[8]);
        put(&0.125_f64.to_le_bytes());
    }
    body
}

#[test]
fn any_order_type_and_encoding_give_one_mesh() {
    let text = "2.5 2 -1 -2\n255 4 0 1 2 3 1 .5\n255 3 2 1 0 1 .5\n\
        3 0 -4 -1.5 0 0 .25 2 7 8 .125\n3 0 -4 -1.5 1 0 .25 2 7 8 .125\n\
        3 0 -4 -1.5 1 1 .25 2 7 8 .125\n3 0 -4 -1.5 0 1 .25 0 .125\n";
    let ascii = parse(&[mixed_header("ascii"), text.into()].concat(), false).unwrap();
    assert_eq!(ascii.data.positions[2], [1., 1., -1.5]);
    assert_eq!(ascii.data.indices, [[0, 1, 2], [0, 2, 3], [2, 1, 0]]);
    assert_eq!(ascii.data.normals.as_ref().unwrap(), &[[0., -0.8, 0.6]; 4]);
    assert_eq!(ascii.data.uvs.as_ref().unwrap(), &[[0.25, 0.125]; 4]);
    for (format, big_endian) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let bytes = [mixed_header(format), mixed_body(big_endian)].concat();
        assert_eq!(parse(&bytes, false).unwrap(), ascii, "{format}");
        let flipped = parse(&bytes, true).unwrap().data.uvs.unwrap();
        assert_eq!(flipped, [[0.25, 0.875]; 4]);
        for end in 0..bytes.len() {
            assert!(parse(&bytes[..end], false).is_err(), "cut at {end}");
        }
    }
}

#[test]
fn strips_alternate_and_start_anew() {
    let header = HEADER
        .replace("vertex 3", "vertex 5")
        .replace("element face 1", "element tristrips 1")
        .replace("uchar int", "int int");
    let rows = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n13 0 1 2 3 4 -1 4 3 2 -1 0 1 1\n";
    let mesh = parsed(&format!("{header}{rows}"));
    assert_eq!(
        mesh.data.indices,
        [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 2]]
    );
    assert_eq!(mesh.data.degenerate_count(), 0);
}

#[test]
fn stitched_strips_keep_their_side() {
    let header = HEADER
        .replace("vertex 3", "vertex 6")
        .replace("element face 1", "element tristrips 1");
    let rows = "0 0 0\n1 0 0\n0 1 0\n5 0 0\n6 0 0\n5 1 0\n9 0 1 2 2 3 3 3 4 5\n";
    let mesh = parsed(&format!("{header}{rows}"));
    assert_eq!(mesh.data.indices, [[0, 1, 2], [3, 4, 5]]);
}

#[test]
fn short_faces_and_trailing_bytes_give_a_warning() {
    let header = HEADER.replace("face 1", "face 3");
    let mesh = parsed(&format!(
        "{header}0 0 0 1 0 0 0 1 0 2 0 1 0 3 0 1 2\n1 0 0\n"
    ));
    assert_eq!(
        mesh.warnings,
        [
            "faces of less than 3 corners, ignored: 2",
            "bytes after the last element, ignored: 5"
        ]
    );
}

#[test]
fn zero_normals_are_computed() {
    let header = HEADER.replace(
        "element face",
        "property float nx\nproperty float ny\nproperty float nz\nelement face",
    );
    let mesh = parsed(&format!(
        "{header}0 0 0 0 0 0\n1 0 0 nan 0 0\n0 1 0 3 0 4\n3 0 1 2\n"
    ));
    assert_eq!(
        mesh.data.normals.unwrap(),
        [[0., 0., 1.], [0., 0., 1.], [0.6, 0., 0.8]]
    );
    assert_eq!(
        mesh.warnings,
        ["vertex normals missing or zero, computed: 2"]
    );
}

#[test]
fn malformed_headers_are_named() {
    assert_eq!(message(b""), "line 1: the file does not begin with \"ply\"");
    assert_eq!(
        message(b"plx\n"),
        "line 1: the file does not begin with \"ply\""
    );
    assert_eq!(
        message(b"ply\nformat ascii 1.0\n"),
        "line 2: the file ends where the rest of the header should follow"
    );
    assert_eq!(
        message_of_header("ascii", "utf8"),
        "line 2: unknown format \"utf8\""
    );
    assert_eq!(
        message_of_header("1.0", "2.0"),
        "line 2: only PLY format 1.0 is known"
    );
    assert_eq!(
        message_of_header("format ascii 1.0\n", ""),
        "line 8: the header has no format line"
    );
    assert_eq!(
        message_of_header("vertex 3", "vertex -3"),
        "line 3: \"-3\" is not a count"
    );
    assert_eq!(
        message_of_header("float y", "half y"),
        "line 5: unknown type \"half\""
    );
    assert_eq!(
        message_of_header("float y", "y"),
        "line 5: a property is a type and a name"
    );
    assert_eq!(
        message_of_header("element vertex 3\n", ""),
        "line 3: a property before the first element"
    );
    assert_eq!(
        message_of_header("element vertex", "elephant vertex"),
        "line 3: \"elephant vertex 3\" has no place in a header"
    );
    assert_eq!(
        message_of_header("element face", "element vertex"),
        "line 7: a second element vertex"
    );
    assert_eq!(
        message_of_header("element vertex", "element point"),
        "line 9: the header declares no element vertex"
    );
    let rows = "0 0 0 0 0 0 0 0 0 3 0 1 2";
    assert_eq!(
        message(format!("{}{rows}", HEADER.replace("float z", "float w")).as_bytes()),
        "line 3: vertices need the properties x, y and z"
    );
    assert_eq!(
        message(format!("{}{rows}", HEADER.replace("vertex_indices", "corners")).as_bytes()),
        "line 7: face needs a list named vertex_indices"
    );
}

#[test]
fn claims_are_checked_before_memory_is_set_aside() {
    let huge = HEADER.replace("vertex 3", "vertex 900000000000");
    assert_eq!(
        message(format!("{huge}0 0 0\n").as_bytes()),
        "line 3: 900000000000 rows of vertex are announced, \
         which the rest of the file (at most 6 bytes) cannot hold"
    );
    let more = HEADER.replace("face 1", &format!("face {}", usize::MAX));
    assert!(
        message(format!("{more}0 0 0 0 0 0 0 0 0 3 0 1 2").as_bytes()).contains("rows of face")
    );
    let binary = HEADER.replace("ascii", "binary_little_endian");
    assert!(message(binary.as_bytes()).contains("rows of vertex are announced"));
    assert_eq!(
        message_of_rows("0 0 0 0 0 0 0 0 0 200 0 1 2"),
        "line 10: face 0 has a list of 200 items, \
         which the rest of the file (at most 6 bytes) cannot hold"
    );
    let nothing = HEADER.replace(
        "element vertex",
        "element nothing 99999999999\nelement vertex",
    );
    assert!(
        parse(
            format!("{nothing}0 0 0 1 0 0 0 1 0 3 0 1 2").as_bytes(),
            false
        )
        .is_ok()
    );
}

#[test]
fn malformed_rows_are_named() {
    let vertices = "0 0 0\n1 0 0\n0 1 0\n";
    let face = |face: &str| message_of_rows(&format!("{vertices}{face}"));
    assert_eq!(
        message_of_rows("0 0 0\n0 x 0\n0 0 0"),
        "line 11: \"x\" is not a number"
    );
    assert_eq!(
        message_of_rows("0 0 0\n0 inf 0\n0 0 0"),
        "line 11: a vertex coordinate is not a finite number"
    );
    assert_eq!(
        message_of_rows("0 0 0\n0 1e39 0\n0 0 0"),
        "line 11: a vertex coordinate is not a finite number"
    );
    assert_eq!(
        message_of_rows("0.000 0 0\n0.00 1 0\n0.0"),
        "line 12: the file ends where vertex 2 should follow"
    );
    assert_eq!(
        face("3 0 1 3"),
        "line 13: there is no vertex 3, the file has 3"
    );
    assert_eq!(
        face("3 0 -1 2"),
        "line 13: there is no vertex -1, the file has 3"
    );
    assert_eq!(
        face("3 0000 1"),
        "line 13: the file ends where face 0 should follow"
    );
    assert_eq!(face("2 0 1"), "there is no face in it");
    let uv = HEADER.replace(
        "element face",
        "property float u\nproperty float v\nelement face",
    );
    assert_eq!(
        message(format!("{uv}0 0 0 nan 0\n0 0 0 0 0\n0 0 0 0 0").as_bytes()),
        "line 12: a texture coordinate is not a finite number"
    );
}

#[test]
fn numbers_that_do_not_fit_their_type_are_named() {
    let face = |face: &str| message_of_rows(&format!("0 0 0\n1 0 0\n0 1 0\n{face}"));
    let expected = "expected a whole number from -2147483648 to 2147483647";
    for (index, shown) in [("0.5", "0.5"), ("nan", "NaN"), ("2147483648", "2147483648")] {
        let row = format!("3 0 {index} 2");
        assert_eq!(face(&row), format!("line 13: found {shown}, {expected}"));
    }
    let expected = "expected a whole number from 0 to 255";
    assert_eq!(face("300 0 1 2"), format!("line 13: found 300, {expected}"));
    let floats = HEADER.replace("uchar int", "char float");
    let of_floats = |row: &str| message(format!("{floats}0 0 0\n0 0 0\n0 0 0\n{row}").as_bytes());
    assert_eq!(of_floats("3 0 0.5 2"), "line 13: 0.5 is not a whole number");
    assert_eq!(
        of_floats("-3 0 1 2"),
        "line 13: -3 is not a length of a list"
    );
    let colours = HEADER.replace("element face", "property uchar red\nelement face");
    assert_eq!(
        message(format!("{colours}0 0 0 7\n0 0 0 300\n0 0 0 9\n3 0 1 2").as_bytes()),
        format!("line 12: found 300, {expected}")
    );
    assert_eq!(
        message_of_header("property float y", "property float x"),
        "line 5: a second property x of vertex"
    );
}

#[test]
fn binary_problems_are_named_by_byte() {
    let header = HEADER.replace("ascii", "binary_little_endian").into_bytes();
    let mut bytes = [header.clone(), vec![0; 36], vec![3], vec![0; 12]].concat();
    assert!(parse(&bytes, false).is_ok());
    let last = bytes.len() - 4;
    bytes[last] = 7;
    assert_eq!(
        message(&bytes),
        format!("byte {}: there is no vertex 7, the file has 3", last + 4)
    );
    bytes[header.len() + 36] = 4;
    assert!(message(&bytes).contains("face 0 has a list of 4 items"));
    bytes[header.len() + 7] = 0x7F;
    bytes[header.len() + 6] = 0x80;
    let place = header.len() + 12;
    assert_eq!(
        message(&bytes),
        format!("byte {place}: a vertex coordinate is not a finite number")
    );
}

#[test]
fn shared_meshes_load() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let expected = [
        ("reference/torus-in-glass/torus.ply", 8192, 16384),
        ("conformance/common/meshes/bunny.ply", 35947, 69451),
        ("conformance/common/meshes/teapot.ply", 1177, 2256),
        ("conformance/common/meshes/bunny_lowres.ply", 453, 948),
        ("conformance/common/meshes/sphere.ply", 422, 840),
    ];
    for (name, vertices, triangles) in expected {
        let file = shared.join(name);
        if !file.exists() {
            eprintln!("SKIPPED: no {}", file.display());
            continue;
        }
        let mesh = read(&file, false).unwrap();
        assert_eq!(
            (mesh.data.positions.len(), mesh.data.indices.len()),
            (vertices, triangles)
        );
        assert!(mesh.warnings.is_empty(), "{name}: {:?}", mesh.warnings);
    }
}
