//! Scene files: real ones load, broken ones say what is wrong and where.

mod attributes;
mod gltf;
mod materials;
mod memory;
mod models;
mod plugins;

use std::fs;
use std::path::{Path, PathBuf};

use lumiflow::scene::import::xml::{ReadOptions, Strictness};
use lumiflow::scene::import::{ImportError, ImportOptions, Imported, import};

fn options(strictness: Strictness) -> ImportOptions {
    let read = ReadOptions {
        strictness,
        ..ReadOptions::default()
    };
    ImportOptions {
        read,
        ..ImportOptions::default()
    }
}

fn real_scene(name: &str) -> Option<PathBuf> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/scenes")
        .join(name)
        .join("scene.xml");
    if !file.is_file() {
        eprintln!("SKIPPED: no scene {}", file.display());
        return None;
    }
    Some(file)
}

#[test]
fn real_scenes_load() {
    for name in [
        "box",
        "cbox-caustics-0",
        "sms-ring",
        "cornell-box",
        "veach-lamp",
        "torus",
        "classroom",
    ] {
        let Some(file) = real_scene(name) else { return };
        let imported = import(&file, &options(Strictness::Normal));
        let imported = imported.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(!imported.scene.objects().is_empty(), "{name}");
        assert!(!imported.scene.lights().emitters().is_empty(), "{name}");
        assert!(!imported.views.is_empty(), "{name}");
    }
}

fn replacements(imported: &Imported) -> Vec<String> {
    let all = imported.warnings.iter().filter(|w| w.is_replacement);
    all.map(|w| w.message.clone()).collect()
}

#[test]
fn scenes_with_unknown_parts_load_when_asked_to_and_say_what_was_replaced() {
    let what = "heightfield";
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let file = folder.path().join("scene.xml");
    let scene = file_of(&format!("<shape type='{what}'/>"));
    fs::write(&file, scene).expect("the file can be written");
    let error = import(&file, &options(Strictness::Normal)).err();
    let error = error.expect("a part is unknown");
    assert!(error.to_string().contains(what), "{error}");
    let imported = import(&file, &options(Strictness::Lenient));
    let replaced = replacements(&imported.expect("it can be left out"));
    assert!(
        replaced.iter().any(|message| message.contains(what)),
        "{replaced:?}"
    );
}

/// A scene file with a sensor and `body`, which begins in line 3.
fn file_of(body: &str) -> String {
    format!("<scene version='3.0.0'>\n<sensor type='perspective'/>\n{body}\n</scene>\n")
}

fn mesh(file: &str) -> String {
    let plugin = file.rsplit('.').next().unwrap_or_default();
    file_of(&format!(
        "<shape type='{plugin}'>\n<string name='filename' value='{file}'/></shape>"
    ))
}

/// What is said about a scene file, with other files beside it; folders are left out.
fn complaint(scene: &str, files: &[(&str, &[u8])]) -> String {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let write = |name: &str, content: &[u8]| {
        fs::write(folder.path().join(name), content).expect("the file can be written");
    };
    write("scene.xml", scene.as_bytes());
    for (name, content) in files {
        write(name, content);
    }
    let found = import(
        &folder.path().join("scene.xml"),
        &options(Strictness::Normal),
    );
    let text = match found {
        Ok(imported) => {
            let warnings = imported.warnings.iter().map(ToString::to_string);
            warnings.collect::<Vec<_>>().join("\n")
        }
        Err(ImportError::Scene(problems)) => {
            let problems = problems.iter().map(ToString::to_string);
            problems.collect::<Vec<_>>().join("\n")
        }
        Err(error) => error.to_string(),
    };
    text.replace(&format!("{}/", folder.path().display()), "")
}

fn check(scene: &str, files: &[(&str, &[u8])], expected: &str) {
    let found = complaint(scene, files);
    assert_eq!(found, expected, "\n{scene}");
}

#[test]
fn broken_files_say_where_they_break() {
    let long = format!(
        "<scene version='3.0.0'>{}",
        "<bsdf type='twosided'>".repeat(20_000)
    );
    for (scene, expected) in [
        (
            "",
            "scene.xml:1:1: unexpected end of the file (is it truncated?)",
        ),
        ("\0\u{1}", "scene.xml:1:1: broken XML: unknown token"),
        (
            "<bsdf type='diffuse'/>",
            "scene.xml:1:1: found <bsdf>, expected <scene>",
        ),
        (
            "<scene version='3.0.0'/>",
            "scene.xml:1:1: the scene has no sensor",
        ),
        (
            "<scene version='3.0.0'>\n<sensor type='perspective'/>\n<shape type='sph",
            "scene.xml:3:17: unexpected end of the file (is it truncated?)",
        ),
        (
            &long,
            "scene.xml:1:440024: unexpected end of the file (is it truncated?)",
        ),
    ] {
        check(scene, &[], expected);
    }
}

#[test]
fn files_that_include_each_other_are_refused() {
    check(
        &file_of("<include filename='scene.xml'/>"),
        &[],
        "scene.xml:3:20: recursive include: scene.xml → scene.xml",
    );
    let back = b"<scene version='3.0.0'>\n<include filename='scene.xml'/></scene>";
    check(
        &file_of("<include filename='b.xml'/>"),
        &[("b.xml", back)],
        "b.xml:2:20: recursive include: scene.xml → b.xml → scene.xml",
    );
}

#[test]
fn parameters_that_multiply_are_stopped() {
    let tenfold = |i: u32| {
        let value = format!("${}", i - 1).repeat(10);
        format!("<default name='{i}' value='{value}'/>\n")
    };
    let bomb: String = (1..=9).map(tenfold).collect();
    check(
        &file_of(&format!("<default name='0' value='ten bytes!'/>\n{bomb}")),
        &[],
        "scene.xml:10:26: the values of parameters fill more than 16777216 bytes",
    );
}

fn ply(body: &str) -> Vec<u8> {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    format!("{header}{body}").into_bytes()
}

#[test]
fn broken_meshes_say_what_is_wrong_with_them() {
    let ply_of_10_gb = "ply\nformat binary_little_endian 1.0\nelement vertex 894784853\n\
                        property float x\nproperty float y\nproperty float z\n\
                        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let serialized_of_6_gb = b"\x1c\x04\x04\0aaaaaaaaaaaaaaaaaaaa";
    for (name, content, expected) in [
        (
            "a.obj",
            b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(),
            "line 2: a vertex coordinate is not a finite number",
        ),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n".to_vec(),
            "line 4: there is no vertex 9, the file has 3",
        ),
        (
            "a.ply",
            ply("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"),
            "line 11: a vertex coordinate is not a finite number",
        ),
        (
            "a.ply",
            ply("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "line 13: there is no vertex 3, the file has 3",
        ),
        (
            "a.ply",
            ply_of_10_gb.as_bytes().to_vec(),
            "line 3: 894784853 rows of vertex are announced, which the rest of the file \
             (at most 0 bytes) cannot hold",
        ),
        (
            "a.serialized",
            serialized_of_6_gb.to_vec(),
            "byte 20: 1633771873 shapes are announced, which the rest of the file \
             (at most 16 bytes) cannot hold",
        ),
    ] {
        let expected = format!("scene.xml:4:1: {name}: {expected}");
        check(&mesh(name), &[(name, &content)], &expected);
    }
    let missing = complaint(&mesh("away.obj"), &[]);
    assert!(
        missing.starts_with("scene.xml:4:1: file \"away.obj\" not found in "),
        "{missing}"
    );
}

#[test]
fn values_that_make_no_scene_are_refused() {
    let flat = b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    let lamp = "<shape type='obj'>\n<string name='filename' value='a.obj'/>\
                <emitter type='area'/></shape>";
    check(
        &file_of(lamp),
        &[("a.obj", flat)],
        "scene.xml:3:1: a shape without area cannot emit light",
    );
    let singular = "the matrix is singular: it flattens space and has no inverse";
    for (body, expected) in [
        (
            "<shape type='sphere'><float name='radius' value='0'/></shape>",
            "scene.xml:3:1: the radius must be positive",
        ),
        (
            "<shape type='cube'><transform name='to_world'>\n\
             <matrix value='1 0 0 0 1 0 0 0 0 0 1 0 0 0 0 1'/></transform></shape>",
            &format!("scene.xml:4:1: <matrix>: {singular}"),
        ),
        (
            "<shape type='cube'><transform name='to_world'>\n<scale value='0'/></transform></shape>",
            &format!("scene.xml:4:1: <scale>: {singular}"),
        ),
        (
            "<bsdf type='twosided'><bsdf type='dielectric'/></bsdf>",
            "scene.xml:3:1: a two-sided material cannot hold a material that lets light through",
        ),
        (
            "<bsdf type='dielectric'><float name='int_ior' value='-1'/></bsdf>",
            "scene.xml:3:1: an index of refraction must be positive and finite, not -1",
        ),
        (
            "<shape type='sphere'/>\n<shape type='sphere'><float name='radius' value='1e20'/></shape>",
            "scene.xml:4:1: Embree: a sphere has an unusable radius: 100000000000000000000; it must \
             be positive and finite",
        ),
        (
            "<shape type='sphere'><float name='radius' value='$r'/></shape>",
            "scene.xml:3:50: undefined parameter \"$r\"",
        ),
        (
            "<bsdf type='diffuse' id='a'/>\n<bsdf type='diffuse' id='a'/>",
            "scene.xml:4:1: the id \"a\" is taken: see scene.xml:3:1",
        ),
        (
            "<emitter type='constant'/>\n<emitter type='constant'/>",
            "scene.xml:4:1: a second environment: the first stands at scene.xml:3:1",
        ),
    ] {
        check(&file_of(body), &[], expected);
    }
}

#[test]
fn cameras_and_films_that_see_nothing_are_refused() {
    for (sensor, expected) in [
        (
            "<film type='hdrfilm'>\n<integer name='width' value='0'/>\n\
             <integer name='height' value='0'/></film>",
            "scene.xml:2:1: \"width\" is 0, expected 1 to 65536 pixels\n\
             scene.xml:3:1: \"height\" is 0, expected 1 to 65536 pixels",
        ),
        (
            "<film type='hdrfilm'>\n<integer name='width' value='-5'/>\n\
             <integer name='height' value='100000000'/></film>",
            "scene.xml:2:1: \"width\" is -5, expected 1 to 65536 pixels\n\
             scene.xml:3:1: \"height\" is 100000000, expected 1 to 65536 pixels",
        ),
        (
            "<film type='hdrfilm'>\n<integer name='width' value='65536'/>\n\
             <integer name='height' value='65536'/></film>",
            "scene.xml:2:1: 65536x65536 pixels are too many, expected 1073741824 at most",
        ),
        (
            "\n<float name='fov' value='180'/>",
            "scene.xml:1:24: the field of view is 180 degrees, expected more than 0 and less \
             than 180",
        ),
        (
            "<transform name='to_world'>\n\
             <lookat origin='1 1 1' target='1 1 1' up='0 1 0'/></transform>",
            "scene.xml:2:1: <lookat>: origin and target are the same point",
        ),
    ] {
        let scene =
            format!("<scene version='3.0.0'><sensor type='perspective'>{sensor}</sensor></scene>");
        check(&scene, &[], expected);
    }
}

#[test]
fn everything_unknown_is_named() {
    let scene = "<scene version='3.0.0'>
<sensor type='perspektive'><sampler type='sobl'/>
<film type='hdrflim'><rfilter type='bx'/></film></sensor>
<bsdf type='difuse' id='a'/>
<emitter type='pont'/>
<shape type='spere'/>
<shape type='sphere'><ref id='b'/>
<float name='radiuss' value='1'/></shape>
<foo/></scene>";
    check(
        scene,
        &[],
        "scene.xml:2:1: unknown sensor \"perspektive\" (did you mean \"perspective\"?)
scene.xml:2:28: warning: unknown sampler \"sobl\"; \"sobol\" is used instead
scene.xml:3:1: warning: unknown film \"hdrflim\"; \"hdrfilm\" is used instead
scene.xml:3:22: warning: unknown rfilter \"bx\"; \"gaussian\" is used instead
scene.xml:4:1: unknown bsdf \"difuse\" (did you mean \"diffuse\"?)
scene.xml:5:1: unknown emitter \"pont\" (did you mean \"point\"?)
scene.xml:6:1: unknown shape \"spere\" (did you mean \"sphere\"?)
scene.xml:7:22: ref to the unknown id \"b\" (did you mean \"a\"?)
scene.xml:8:1: warning: unknown property \"radiuss\" of shape \"sphere\" (did you mean \"radius\"?); ignored
scene.xml:9:1: warning: unknown element <foo>; ignored",
    );
}

#[test]
fn whatever_stands_in_is_recorded_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let file = folder.path().join("scene.xml");
    let scene = "<scene version='3.0.0'>
<sensor type='perspective'><sampler type='sobl'/>
<film type='hdrflim'><rfilter type='bx'/></film></sensor>
<bsdf type='hair'/>
<foo/></scene>";
    fs::write(&file, scene).expect("the file can be written");
    let imported = import(&file, &options(Strictness::Lenient)).expect("all can be replaced");
    let all = imported.warnings.iter().filter(|w| w.is_replacement);
    let brief: Vec<String> = all.map(|warning| warning.brief()).collect();
    assert_eq!(
        brief,
        [
            "scene.xml:2:28: unknown sampler \"sobl\"; \"sobol\" is used instead",
            "scene.xml:3:1: unknown film \"hdrflim\"; \"hdrfilm\" is used instead",
            "scene.xml:3:22: unknown rfilter \"bx\"; \"gaussian\" is used instead",
            "scene.xml:4:1: unknown bsdf \"hair\"; a diffuse material of its colour is used instead",
        ]
    );
}
