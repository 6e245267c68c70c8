//! Files of other programs as scenes.

use std::fs;

use lumiflow::accel::Ray;
use lumiflow::bsdf::{Bsdf, BsdfModel};
use lumiflow::math::{Rgb, Vec2, Vec3};
use lumiflow::scene::import::xml::Strictness;
use lumiflow::scene::import::{Imported, import};
use lumiflow::sensor::SensorModel;

use super::options;

/// A red and a glowing square, side by side in z = 0, and one of a library that is not there.
const OBJ: &str = "mtllib some of.mtl
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nv 3 1 0
usemtl red
f 1 2 3 4
usemtl lamp
f 2 5 6 3
usemtl red
f 5 7 8 6
";

const MTL: &str = "newmtl red\nKd 0.8 0.1 0.1\nillum 1\nnewmtl lamp\nKd 0 0 0\nKe 3 2 1\n";

pub(super) fn import_files(
    files: &[(&str, &[u8])],
    strictness: Strictness,
) -> Result<Imported, String> {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).expect("the file can be written");
    }
    let file = folder.path().join(files[0].0);
    let within = folder.path().display().to_string();
    let imported = import(&file, &options(strictness));
    imported.map_err(|error| error.to_string().replace(&format!("{within}/"), ""))
}

/// What a ray down onto the plane z = 0 meets: the material's albedo, and the light there.
pub(super) fn below(imported: &Imported, x: f32, y: f32) -> (Rgb, bool, String) {
    let ray = Ray::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z);
    let hit = imported
        .scene
        .intersect(&ray)
        .expect("something lies there");
    let albedo = hit.bsdf.albedo(&hit.point);
    (albedo, hit.emitter.is_some(), kind(hit.bsdf))
}

fn kind(bsdf: &Bsdf) -> String {
    let text = format!("{bsdf:?}");
    text.split(['(', ' ']).next().unwrap_or_default().to_owned()
}

pub(super) fn notes(imported: &Imported) -> Vec<String> {
    imported.warnings.iter().map(|note| note.brief()).collect()
}

#[test]
fn a_bare_obj_is_a_scene_with_the_materials_of_its_library() {
    let files = [("a.obj", OBJ.as_bytes()), ("some of.mtl", MTL.as_bytes())];
    // A camera that is made up is no fault.
    let imported = import_files(&files, Strictness::Strict).expect("a sound model");
    let camera = "a.obj:1:1: the file has no camera; one that sees all of it is used";
    assert_eq!(notes(&imported), [camera]);
    for (x, glows) in [(0.5, false), (1.5, true), (2.5, false)] {
        let (albedo, found, _) = below(&imported, x, 0.6);
        assert_eq!(found, glows, "{x}");
        let expected = if glows { 0.0 } else { 0.8 };
        assert!((albedo.r() - expected).abs() < 1e-6, "{albedo:?}");
    }
    assert_eq!(imported.scene.lights().emitters().len(), 1);
    // Every corner of the model is on the film.
    let view = &imported.views[0];
    let eye = view.sensor.sample_lens(Vec2::splat(0.5));
    let (width, height) = view.film_size;
    let film = Vec2::new(width as f32, height as f32);
    for (x, y) in [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)] {
        let direction = (Vec3::new(x, y, 0.0) - eye).normalize();
        let seen = view
            .sensor
            .raster_at(eye, direction)
            .expect("it lies ahead");
        let place = seen / film;
        assert!(
            place.cmpgt(Vec2::ZERO).all() && place.cmplt(Vec2::ONE).all(),
            "{place}"
        );
    }
}

#[test]
fn an_obj_without_light_and_library_is_grey_in_white_light() {
    let files = [("b.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".as_bytes())];
    let imported = import_files(&files, Strictness::Normal).expect("a sound model");
    assert_eq!(notes(&imported).len(), 2);
    assert!(notes(&imported)[0].contains("the file has no light"));
    let (albedo, _, _) = below(&imported, 0.25, 0.25);
    assert_eq!(albedo, Rgb::grey(0.5));
}

#[test]
fn problems_of_models_have_their_file_and_line() {
    let said = |obj: &str, mtl: &str| {
        let files = [("a.obj", obj.as_bytes()), ("some of.mtl", mtl.as_bytes())];
        match import_files(&files, Strictness::Normal) {
            Ok(imported) => imported.warnings.iter().map(|w| w.brief()).collect(),
            Err(message) => message,
        }
    };
    let broken = OBJ.replace("f 1 2 3 4", "f 1 2 99");
    assert!(said(&broken, MTL).contains("a.obj:11:1: there is no vertex 99, the file has 8"));
    let broken = MTL.replace("Kd 0 0 0", "Kd black");
    let expected = "some of.mtl:5:4: Kd is \"black\", expected one number or three";
    assert!(said(OBJ, &broken).contains(expected));
    let missing = OBJ.replace("some of.mtl", "some or.mtl");
    assert!(said(&missing, MTL).contains("did you mean \"some of.mtl\"?"));
    let misspelt = OBJ.replace("usemtl red", "usemtl rad");
    let expected = "no library has the material \"rad\" (did you mean \"red\"?); it is grey";
    assert!(said(&misspelt, MTL).contains(expected));
}

#[test]
fn materials_of_libraries_become_what_they_look_like() {
    for (statements, expected) in [
        ("illum 7\nNi 1.33\nTf 1 1 1", "Dielectric"),
        ("Kd 0.5 0.5 0.5\nd 0.5", "Mask"),
        ("Kd 0 0 0\nKs 0.9 0.8 0.2\nNs 200", "TwoSided"),
        ("Kd 0.3 0.3 0.3\nKs 0.2 0.2 0.2\nNs 20", "TwoSided"),
    ] {
        let mtl = format!("newmtl red\n{statements}\nnewmtl lamp\nKe 1 1 1\n");
        let files = [("a.obj", OBJ.as_bytes()), ("some of.mtl", mtl.as_bytes())];
        let imported = import_files(&files, Strictness::Normal).expect("a sound model");
        assert_eq!(below(&imported, 0.5, 0.6).2, expected, "{statements}");
    }
}
