use std::path::PathBuf;

use super::*;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

fn parsed(text: &str) -> ImportedMesh {
    parse(text.as_bytes(), true).unwrap()
}

fn with_triangle(lines: &str) -> ImportedMesh {
    parsed(&format!("{TRIANGLE}{lines}"))
}

fn message(text: &str) -> String {
    parse(text.as_bytes(), true).unwrap_err().to_string()
}

#[test]
fn positions_alone_leave_normals_and_coordinates_out() {
    let mesh = with_triangle("f 1 2 3");
    assert_eq!(
        mesh.data.positions,
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]
    );
    assert_eq!(mesh.data.indices, [[0, 1, 2]]);
    assert_eq!((mesh.data.normals, mesh.data.uvs), (None, None));
    assert!(mesh.warnings.is_empty());
}

#[test]
fn numbers_after_positions_are_colours_where_there_are_three() {
    let colours = |text: &str| {
        let mesh = parse(text.as_bytes(), true).unwrap();
        let values = mesh.data.attributes.into_iter().next();
        (
            values.map(|values| (values.name, values.values)),
            mesh.warnings,
        )
    };
    let text = "v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0\nv 0 1 0 0.25 0 1\nf 1 3 2\n";
    let values = vec![[1.0, 0.0, 0.5], [0.25, 0.0, 1.0], [0.0, 1.0, 0.0]];
    let expected = Some(("vertex_color".to_owned(), values));
    assert_eq!(colours(text), (expected, vec![]));
    let ignored = vec!["not all vertices have a colour; colours ignored".to_owned()];
    for lacking in [
        "v 1 0 0\n",
        "v 1 0 0 1\n",
        "v 1 0 0 0 1 0 1\n",
        "v 1 0 0 0 x 0\n",
    ] {
        let text = text.replace("v 1 0 0 0 1 0\n", lacking);
        assert_eq!(colours(&text), (None, ignored.clone()), "{text}");
    }
    let weighted = "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n";
    assert_eq!(colours(weighted), (None, vec![]));
}

#[test]
fn unused_normals_and_coordinates_do_not_count() {
    let mesh = with_triangle("vn 0 0 1\nvt 0 0\nf 1 2 3\n");
    assert_eq!((mesh.data.normals, mesh.data.uvs), (None, None));
}

#[test]
fn the_whole_file_is_one_mesh() {
    let mesh = with_triangle(
        "mtllib a.mtl\no one\ng a b\nusemtl red\ns off\nf 1 2 3\no two\nv 0 0 1\nf 1 2 4\n",
    );
    assert_eq!(mesh.data.positions.len(), 4);
    assert_eq!(mesh.data.indices, [[0, 1, 2], [0, 1, 3]]);
}

#[test]
fn equal_corners_share_a_vertex_and_others_do_not() {
    let mesh = with_triangle(
        "vt 0 0.25\nvt 1 0.25\nvn 0 0 2\nf 1/1/1 2/1/1 3/1/1\nf 1/1/1 2/2/1 3/1/-1\n",
    );
    assert_eq!(mesh.data.indices, [[0, 1, 2], [0, 3, 2]]);
    assert_eq!(
        mesh.data.uvs.unwrap(),
        [[0., 0.75], [0., 0.75], [0., 0.75], [1., 0.75]]
    );
    assert_eq!(mesh.data.normals.unwrap(), [[0., 0., 1.]; 4]);
}

#[test]
fn texture_coordinates_flip_only_if_asked() {
    let text = format!("{TRIANGLE}vt 0.5 0.25\nvt 0.125\nf 1/1 2/1 3/2");
    let uvs = |flip| parse(text.as_bytes(), flip).unwrap().data.uvs.unwrap();
    assert_eq!(uvs(true), [[0.5, 0.75], [0.5, 0.75], [0.125, 1.]]);
    assert_eq!(uvs(false), [[0.5, 0.25], [0.5, 0.25], [0.125, 0.]]);
}

#[test]
fn polygons_become_fans() {
    let mesh = with_triangle("v 1 1 0\nv 0 2 0\nf 1 2 4 5 3\n");
    assert_eq!(mesh.data.indices, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn negative_indices_count_back_from_where_they_stand() {
    let mesh = with_triangle("f -3 -2 -1\nv 0 0 5\nf -4 -3 -1\n");
    assert_eq!(mesh.data.indices, [[0, 1, 2], [0, 1, 3]]);
    assert_eq!(mesh.data.positions[3], [0., 0., 5.]);
}

#[test]
fn faces_may_come_before_their_vertices() {
    let mesh = parsed(&format!("f 1 2 3\n{TRIANGLE}"));
    assert_eq!(mesh.data.positions[1], [1., 0., 0.]);
}

#[test]
fn a_part_without_normals_or_coordinates_is_filled_in() {
    let mesh = with_triangle("v 0 0 1\nvn 0 0 -1\nvt 0.5 0.5\nf 1/1/1 2/1/1 3/1/1\nf 1 4 3/\n");
    let normals = mesh.data.normals.unwrap();
    assert_eq!(normals[..3], [[0., 0., -1.]; 3]);
    assert_eq!(normals[3..], [[-1., 0., 0.]; 3]);
    assert_eq!(mesh.data.uvs.unwrap()[3..], [[0., 0.]; 3]);
    assert_eq!(
        mesh.warnings,
        [
            "vertices without texture coordinates, (0, 0) used: 3",
            "vertex normals missing or zero, computed: 3"
        ]
    );
}

#[test]
fn zero_and_nan_normals_are_computed() {
    let mesh = with_triangle("vn 0 0 0\nvn nan nan nan\nvn 0 3 4\nf 1//1 2//2 3//3\n");
    let normals = mesh.data.normals.unwrap();
    assert_eq!(normals[..2], [[0., 0., 1.]; 2]);
    assert_eq!(normals[2], [0., 0.6, 0.8]);
    assert_eq!(
        mesh.warnings,
        ["vertex normals missing or zero, computed: 2"]
    );
}

#[test]
fn points_lines_and_two_cornered_faces_are_left_out_with_a_warning() {
    let mesh = with_triangle("l 1 2 3\np 1\nf 1 2\nf 1 2 3\n");
    assert_eq!(mesh.data.indices, [[0, 1, 2]]);
    assert_eq!(
        mesh.warnings,
        [
            "faces of less than 3 corners, ignored: 1",
            "points, lines or curves, ignored: 2"
        ]
    );
}

#[test]
fn odd_spelling_is_understood() {
    let text = b"\xEF\xBB\xBF# caf\xE9\r\n\tv  0 0 0 1.0\r\nv 1e0 0 0 .5 .5 .5\r\nv 0 +1. 0\r\n\
        f\t1 \\\r\n 2/ \\\r\n3// \r\n\r\nusemtl caf\xE9\n\\";
    let mesh = parse(text, true).unwrap();
    assert_eq!(mesh.data.indices, [[0, 1, 2]]);
    assert_eq!(mesh.data.positions[1..], [[1., 0., 0.], [0., 1., 0.]]);
}

#[test]
fn malformed_lines_are_named() {
    assert_eq!(message("\n\nv 1 2\n"), "line 3: v has 2 of 3 numbers");
    assert_eq!(message("v 1 2 x\n"), "line 1: \"x\" is not a number");
    assert_eq!(message("vt\n"), "line 1: vt has 0 of 1 numbers");
    assert_eq!(message("vn 1 2\n"), "line 1: vn has 2 of 3 numbers");
    assert_eq!(
        message("v 1 2 inf\n"),
        "line 1: a vertex coordinate is not a finite number"
    );
    assert_eq!(
        message("v 1 1e99 2\n"),
        "line 1: a vertex coordinate is not a finite number"
    );
    assert_eq!(
        message("vt nan 0\n"),
        "line 1: a texture coordinate is not a finite number"
    );
    let face = |words: &str| message(&format!("{TRIANGLE}vt 0 0\nf \\\n{words}\n"));
    assert_eq!(face("1 2 x"), "line 5: \"x\" is not a face corner");
    assert_eq!(face("/1 2 3"), "line 5: \"/1\" is not a face corner");
    assert_eq!(
        face("1/1/1/1 2 3"),
        "line 5: \"1/1/1/1\" is not a face corner"
    );
    assert_eq!(face("1///1 2 3"), "line 5: \"1///1\" is not a face corner");
    assert_eq!(face("1.5 2 3"), "line 5: \"1.5\" is not a face corner");
}

#[test]
fn indices_out_of_range_are_named() {
    let face = |words: &str| message(&format!("f {words}\nf 1 2 8\n{TRIANGLE}vt 0 0\n"));
    assert_eq!(
        face("1 2 9"),
        "line 1: there is no vertex 9, the file has 3"
    );
    assert_eq!(
        face("1 2 3"),
        "line 2: there is no vertex 8, the file has 3"
    );
    assert_eq!(
        face("1 2 0"),
        "line 1: there is no vertex 0, the file has 0"
    );
    assert_eq!(
        face("1 2 -1"),
        "line 1: there is no vertex -1, the file has 0"
    );
    let face = |words: &str| message(&format!("{TRIANGLE}vt 0 0\nf {words}\n"));
    assert_eq!(
        face("1/2 2/1 3/1"),
        "line 5: there is no texture coordinate 2, the file has 1"
    );
    assert_eq!(
        face("1//1 2/1 3/1"),
        "line 5: there is no normal 1, the file has 0"
    );
    assert_eq!(
        face("1 2 -4"),
        "line 5: there is no vertex -4, the file has 3"
    );
    for huge in [
        "4294967296",
        "4294967297",
        "-9223372036854775808",
        "9223372036854775807",
    ] {
        assert_eq!(
            face(&format!("1 2 {huge}")),
            format!("line 5: there is no vertex {huge}, the file has 3")
        );
    }
    assert_eq!(
        face("1 2 99999999999999999999"),
        "line 5: \"99999999999999999999\" is not a face corner"
    );
}

#[test]
fn a_file_without_faces_is_refused() {
    assert!(matches!(parse(b"", true), Err(MeshProblem::Empty)));
    assert!(matches!(
        parse(b"version https://git-lfs.github.com", true),
        Err(MeshProblem::Empty)
    ));
    assert!(matches!(
        parse(b"v 0 0 0\nf 1 1\n", true),
        Err(MeshProblem::Empty)
    ));
}

#[test]
fn messages_carry_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.obj");
    let missing = read(&file, true).unwrap_err().to_string();
    assert!(missing.contains("model.obj: No such file"), "{missing}");
    std::fs::write(&file, "v 0\n").unwrap();
    let broken = read(&file, true).unwrap_err().to_string();
    assert!(
        broken.ends_with("model.obj: line 1: v has 1 of 3 numbers"),
        "{broken}"
    );
}

/// All OBJ files of the shared scenes agree with `tobj`, triangle by triangle.
#[test]
fn shared_scenes_agree_with_tobj() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let files = obj_files(&shared);
    if files.is_empty() {
        eprintln!("SKIPPED: no OBJ files under {}", shared.display());
    }
    for file in files {
        let ours = read(&file, false).unwrap();
        let options = tobj::LoadOptions {
            single_index: true,
            triangulate: true,
            ..tobj::LoadOptions::default()
        };
        let (models, _) = tobj::load_obj(&file, &options).unwrap();
        let mut triangles = ours.data.indices.iter();
        for mesh in models.iter().map(|model| &model.mesh) {
            for corners in mesh.indices.chunks_exact(3) {
                let our_corners = triangles.next().unwrap();
                for (&theirs, &our) in corners.iter().zip(our_corners) {
                    let (theirs, our) = (theirs as usize, our as usize);
                    let position = &mesh.positions[3 * theirs..][..3];
                    assert_eq!(position, ours.data.positions[our], "{}", file.display());
                    if let Some(uvs) = &ours.data.uvs {
                        assert_eq!(&mesh.texcoords[2 * theirs..][..2], uvs[our]);
                    }
                    if let Some(normals) = &ours.data.normals {
                        let distance = (0..3)
                            .map(|i| (mesh.normals[3 * theirs + i] - normals[our][i]).abs())
                            .fold(0., f32::max);
                        assert!(distance < 1e-3, "{}", file.display());
                    }
                }
            }
        }
        assert_eq!(triangles.next(), None, "{}", file.display());
    }
}

fn obj_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    entries
        .map(|entry| entry.unwrap().path())
        .flat_map(|path| match path.extension() {
            _ if path.is_dir() => obj_files(&path),
            Some(extension) if extension == "obj" => vec![path],
            _ => Vec::new(),
        })
        .collect()
}
