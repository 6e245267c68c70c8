//! Includes and the search for files, in folders of their own.

use std::fs;
use std::path::Path;

use super::super::{ColourUse, Document, ReadError, ReadOptions, Strictness, read_file};
use super::problems;

/// Writes files into a fresh folder and reads `scene.xml` there. Messages have `@` for the folder.
fn read_files(files: &[(&str, &str)], options: &ReadOptions) -> (Document, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let document = read_file(&folder.path().join("scene.xml"), options).unwrap();
    for id in document.tree.ids() {
        let mut reader = document.tree.reader(id, &document.problems);
        if reader.optional_string("filename").is_some() {
            reader.file("filename");
        }
        reader.colour("radiance", ColourUse::Emission);
    }
    let shown = folder.path().display().to_string();
    let said = problems(&document)
        .iter()
        .map(|line| line.replace(&shown, "@"))
        .collect();
    (document, said)
}

fn check(files: &[(&str, &str)], expected: &[&str]) -> Document {
    let (document, said) = read_files(files, &ReadOptions::default());
    assert_eq!(said, expected);
    document
}

fn scene(body: &str) -> String {
    format!("<scene version=\"3.0.0\">\n{body}</scene>")
}

#[test]
fn a_missing_scene_is_the_only_hard_error() {
    let missing = read_file(Path::new("/no/such.xml"), &ReadOptions::default());
    let Err(error @ ReadError::Io { .. }) = missing else {
        panic!("{missing:?}")
    };
    assert!(error.to_string().starts_with("cannot read /no/such.xml: "));
}

#[test]
fn includes_are_relative_to_their_file_then_to_the_root_then_to_the_paths() {
    let main = scene(
        "<path value='lib'/><default name='n' value='outer'/>
        <include filename='parts/a.xml'/><include filename='far.xml'/>",
    );
    let a = scene(
        "<default name='n' value='inner'/><include filename='b.xml'/>
        <include filename='parts/c.xml'/><bsdf type='$n'/>",
    );
    let document = check(
        &[
            ("scene.xml", &main),
            ("parts/a.xml", &a),
            ("parts/b.xml", &scene("<bsdf type='b'/>")),
            ("parts/c.xml", "<bsdf type='c'/>"),
            (
                "lib/far.xml",
                "<scene version='0.6.0'><bsdf type='far'/></scene>",
            ),
        ],
        &[],
    );
    let root = &document.tree[document.tree.root()];
    let plugins = root
        .children
        .iter()
        .map(|child| document.tree[child.element].plugin.as_str());
    assert_eq!(plugins.collect::<Vec<_>>(), ["b", "c", "outer", "far"]);
}

#[test]
fn recursive_and_broken_includes_are_named_with_their_chain() {
    check(
        &[
            (
                "scene.xml",
                &scene("<include filename='a.xml'/>\n<float value='1'/>"),
            ),
            (
                "a.xml",
                &scene("<include filename='b.xml'/>\n<include filename='c.xml'/>"),
            ),
            (
                "b.xml",
                &scene("<include filename='SCENE.xml'/><include filename='gone.xml'/>"),
            ),
            ("c.xml", "<scene"),
        ],
        &[
            "@/scene.xml:3:1: <float> needs the attribute \"name\"",
            "@/b.xml:2:20: warning: file \"SCENE.xml\" is written \"@/scene.xml\" on disk",
            "@/b.xml:2:20: recursive include: @/scene.xml → @/a.xml → @/b.xml → @/scene.xml",
            "@/b.xml:2:51: file \"gone.xml\" not found in @",
            "@/c.xml:1:7: unexpected end of the file (is it truncated?)",
        ],
    );
}

#[test]
fn files_are_found_with_blanks_brackets_backslashes_and_the_wrong_case() {
    let body =
        "<shape type='a'><string name='filename' value='Models\\my mesh (1) [a].OBJ'/></shape>
<shape type='a'><string name='filename' value='models/My Mesh (1) [a].obj'/></shape>
<shape type='a'><string name='filename' value='models/../models/my mesh (1) [b].obj'/></shape>
<path value='nowhere'/>";
    check(
        &[
            ("scene.xml", &scene(body)),
            ("models/My Mesh (1) [a].obj", ""),
        ],
        &[
            "@/scene.xml:2:17: warning: file \"Models\\my mesh (1) [a].OBJ\" is written \
             \"@/models/My Mesh (1) [a].obj\" on disk",
            "@/scene.xml:4:17: file \"models/../models/my mesh (1) [b].obj\" not found in @ \
             (did you mean \"models/../models/My Mesh (1) [a].obj\"?)",
            "@/scene.xml:5:14: warning: folder \"nowhere\" not found; ignored",
        ],
    );
}

#[test]
fn extra_folders_are_searched_last_and_missing_files_are_forgiven_when_lenient() {
    let extra = tempfile::tempdir().unwrap();
    fs::write(extra.path().join("there.obj"), "").unwrap();
    let body = "<shape type='a'><string name='filename' value='there.obj'/></shape>
        <shape type='a'><string name='filename' value='gone.obj'/></shape>";
    let options = ReadOptions {
        search_paths: vec![extra.path().to_path_buf()],
        strictness: Strictness::Lenient,
        ..ReadOptions::default()
    };
    let (document, said) = read_files(&[("scene.xml", &scene(body))], &options);
    let folder = extra.path().display();
    let missing = format!("warning: file \"gone.obj\" not found in @, {folder}; left out");
    assert_eq!(said, [format!("@/scene.xml:3:25: {missing}")]);
    assert!(!document.problems.has_errors());
}

#[test]
fn spectra_come_from_files() {
    let light = |file| {
        format!("<emitter type='x'><spectrum name='radiance' filename='{file}'/></emitter>\n")
    };
    let body = light("good.spd") + &light("bad.spd") + &light("short.spd");
    let document = check(
        &[
            ("scene.xml", &scene(&body)),
            ("good.spd", "# comment\n400 1\n\n500, 2 # more\n"),
            ("bad.spd", "400 1\n500\n"),
            ("short.spd", "400 1"),
        ],
        &[
            "@/scene.xml:3:55: @/bad.spd: line 2: found 1 number in \"500\", expected 2",
            "@/scene.xml:4:55: @/short.spd: a curve needs at least two wavelengths",
        ],
    );
    let emitter = document.tree[document.tree.root()].children[0].element;
    let mut reader = document.tree.reader(emitter, &document.problems);
    assert!(
        !reader
            .colour("radiance", ColourUse::Emission)
            .unwrap()
            .is_black()
    );
}

#[test]
fn files_that_are_not_utf8_are_read_as_latin_1() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.xml");
    fs::write(
        &path,
        b"<scene version='3.0.0'><!-- K\xfcche --><bsdf type='a'/></scene>",
    )
    .unwrap();
    let document = read_file(&path, &ReadOptions::default()).unwrap();
    assert_eq!(document.tree[document.tree.root()].children.len(), 1);
    let said = problems(&document);
    assert!(
        said.len() == 1 && said[0].ends_with("is not UTF-8; read as Latin-1"),
        "{said:?}"
    );
}

#[test]
fn other_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for (bytes, expected) in [
        (&b"\x76\x2f\x31\x01\x02"[..], "an OpenEXR image"),
        (b"\x89PNG\r\n", "a PNG image"),
        (b"ply\nformat ascii 1.0\n", "a PLY mesh"),
    ] {
        let path = folder.path().join("scene.xml");
        fs::write(&path, bytes).unwrap();
        let document = read_file(&path, &ReadOptions::default()).unwrap();
        let said = problems(&document);
        let expected = format!("scene.xml:1:1: found {expected}, expected a scene as XML");
        assert!(said.len() == 1 && said[0].ends_with(&expected), "{said:?}");
    }
}
