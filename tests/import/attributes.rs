//! Attributes of meshes as textures.

use std::fs;

use lumiflow::accel::Ray;
use lumiflow::bsdf::BsdfModel;
use lumiflow::emitter::EmitterModel;
use lumiflow::math::{Rgb, Vec3};
use lumiflow::scene::import::xml::Strictness;
use lumiflow::scene::import::{Imported, import};

use super::{file_of, options};

/// Two triangles over [0, 1]², red where x grows; their faces have weights 0.25 and 0.75.
const PLY: &str = "ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float u
property float v
property float r
property float g
property float b
element face 2
property list uchar int vertex_indices
property float weight_0
end_header
0 0 0 0 0 0 0.5 0
1 0 0 3 0 1 0.5 0
1 1 0 3 3 1 0.5 0
0 1 0 0 3 0 0.5 0
3 0 1 2 0.25
3 0 2 3 0.75
";

fn imported(bodies: &str) -> Result<Imported, String> {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    fs::write(folder.path().join("a.ply"), PLY).expect("the mesh can be written");
    let file = folder.path().join("scene.xml");
    fs::write(&file, file_of(bodies)).expect("the scene can be written");
    import(&file, &options(Strictness::Normal)).map_err(|error| error.to_string())
}

/// The reflectance at a point of the plane z = 0.
fn albedo(scene: &Imported, x: f32, y: f32) -> Rgb {
    let ray = Ray::new(Vec3::new(x, y, 2.0), Vec3::NEG_Z);
    let hit = scene.scene.intersect(&ray).expect("the mesh lies there");
    hit.bsdf.albedo(&hit.point)
}

fn shape(bsdf: &str) -> String {
    format!("<shape type='ply'><string name='filename' value='a.ply'/>{bsdf}</shape>")
}

fn attribute(name: &str, slot: &str) -> String {
    format!(
        "<texture type='mesh_attribute' name='{slot}'><string name='name' value='{name}'/></texture>"
    )
}

#[test]
fn colours_of_vertices_are_reflectances() {
    let bsdf = format!(
        "<bsdf type='diffuse'>{}</bsdf>",
        attribute("vertex_color", "reflectance")
    );
    // Two shapes share the material; the second one stands beside.
    let moved = "<transform name='to_world'><translate x='5'/><scale y='2'/></transform>";
    let body = format!("{}{}", shape(&bsdf), shape(&format!("{bsdf}{moved}")));
    let scene = imported(&body).expect("a sound scene");
    for (x, y, red) in [(0.2, 0.1, 0.2), (0.3, 0.8, 0.3), (5.75, 1.0, 0.75)] {
        let found = albedo(&scene, x, y).0;
        assert!(found.distance(Vec3::new(red, 0.5, 0.0)) < 1e-4, "{found}");
    }
}

#[test]
fn bitmaps_beside_attributes_keep_their_place() {
    let board = "<texture type='checkerboard' name='NAME'>\
                 <rgb name='color0' value='0.8'/><rgb name='color1' value='0.1'/></texture>";
    let second = |slot: &str| board.replace("NAME", slot);
    let weight = attribute("face_weight", "weight");
    let bsdf = format!(
        "<bsdf type='blendbsdf'>{weight}\
         <bsdf type='diffuse'>{}</bsdf>\
         <bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></bsdf>",
        second("reflectance")
    );
    let scene = imported(&shape(&bsdf)).expect("a sound scene");
    // The coordinates are three times the position: squares of a sixth.
    for (x, y, expected) in [
        (0.1, 0.05, 0.8 * 0.75),
        (0.25, 0.05, 0.1 * 0.75),
        (0.05, 0.25, 0.1 * 0.25),
        (0.2, 0.25, 0.8 * 0.25),
    ] {
        let found = albedo(&scene, x, y).r();
        assert!((found - expected).abs() < 1e-4, "{found} at {x}, {y}");
    }
}

/// The squares lie by texture coordinates, what they show by the mesh, whatever is asked for where.
#[test]
fn squares_show_attributes() {
    let inside = "<texture type='checkerboard' name='color1'>\
                  <rgb name='color0' value='0.9'/><rgb name='color1' value='0.1'/>\
                  <transform name='to_uv'><scale x='2' y='2'/></transform></texture>";
    let board = format!(
        "<texture type='checkerboard' name='reflectance'>{}{inside}</texture>",
        attribute("vertex_color", "color0")
    );
    let bsdf = format!("<bsdf type='diffuse'>{board}</bsdf>");
    let scene = imported(&shape(&bsdf)).expect("a sound scene");
    // As above; the red of a vertex is its place along x.
    for (x, y, expected) in [
        (0.1, 0.05, 0.1),
        (0.2, 0.25, 0.2),
        (0.2, 0.05, 0.9),
        (0.2, 0.1, 0.1),
        (0.3, 0.05, 0.1),
        (0.3, 0.1, 0.9),
    ] {
        let found = albedo(&scene, x, y).r();
        assert!((found - expected).abs() < 1e-4, "{found} at {x}, {y}");
    }
}

#[test]
fn attributes_that_are_not_there_are_refused() {
    let bsdf = |name: &str| {
        format!(
            "<bsdf type='diffuse'>{}</bsdf>",
            attribute(name, "reflectance")
        )
    };
    let said = imported(&shape(&bsdf("vertex_colour"))).expect_err("a name is misspelt");
    let expected = "the mesh has no attribute \"vertex_colour\" (did you mean \"vertex_color\"?); it \
                    has vertex_color, face_weight";
    assert!(said.contains(expected), "{said}");
    let sphere = format!("<shape type='sphere'>{}</shape>", bsdf("vertex_color"));
    let said = imported(&sphere).expect_err("a sphere carries nothing");
    assert!(
        said.contains("a shape without attributes has no \"vertex_color\""),
        "{said}"
    );
}

#[test]
fn negative_light_is_clamped_aloud() {
    let light = |scale: &str| {
        let texture = attribute("vertex_color", "radiance");
        let scaled = format!("<float name='scale' value='{scale}'/></texture>");
        let texture = texture.replace("</texture>", &scaled);
        shape(&format!("<emitter type='area'>{texture}</emitter>"))
    };
    let radiance = |scene: &Imported| {
        let ray = Ray::new(Vec3::new(0.5, 0.25, 2.0), Vec3::NEG_Z);
        let hit = scene.scene.intersect(&ray).expect("the mesh lies there");
        let [light] = scene.scene.lights().emitters() else {
            panic!("one light");
        };
        light.radiance(&hit.point, Vec3::Z)
    };
    let bright = imported(&light("2")).expect("a sound scene");
    assert!((radiance(&bright).0 - Vec3::new(1.0, 1.0, 0.0)).length() < 1e-4);
    assert!(bright.warnings.is_empty(), "{:?}", bright.warnings);
    let dark = imported(&light("-2")).expect("a sound scene");
    assert_eq!(radiance(&dark), Rgb::BLACK);
    let said: Vec<String> = dark.warnings.iter().map(ToString::to_string).collect();
    let expected = "warning: some values of this light's texture are negative; clamped";
    assert!(said.len() == 1 && said[0].ends_with(expected), "{said:?}");
}
