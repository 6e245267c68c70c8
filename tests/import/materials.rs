//! Materials that are read in both generations' spellings, and what is said of broken ones.

use std::f32::consts::{PI, TAU};

use lumiflow::accel::Ray;
use lumiflow::math::{Mat4, Rgb, Vec2, Vec3};
use lumiflow::scene::import::xml::Strictness;
use lumiflow::shape::Derivatives;

use super::models::{below, import_files};
use super::{check, file_of};

/// A shape with a material, whose content begins in the middle of line 3.
fn material(plugin: &str, inside: &str) -> String {
    file_of(&format!(
        "<shape type='rectangle'><bsdf type='{plugin}'>{inside}</bsdf></shape>"
    ))
}

const DIFFUSE: &str = "<bsdf type='diffuse'/>";
const BOARD: &str = "<texture type='checkerboard'/>";

fn float(name: &str) -> String {
    format!("<float name='{name}' value='0.3'/>")
}

fn colour(name: &str) -> String {
    format!("<rgb name='{name}' value='0.3'/>")
}

fn board(name: &str) -> String {
    format!("<texture name='{name}' type='checkerboard'/>")
}

/// Every parameter of every plugin, in the spelling of the generation that has it.
#[test]
fn all_parameters_of_surfaces_are_known() {
    let highlight = colour("specularReflectance") + &board("diffuseReflectance");
    let fast = "<boolean name='useFastApprox' value='true'/>";
    let variant = "<string name='variant' value='ward-duer'/>";
    for (plugin, inside) in [
        (
            "roughdiffuse",
            board("reflectance") + &float("alpha") + fast,
        ),
        ("difftrans", board("transmittance")),
        ("phong", board("exponent") + &highlight),
        (
            "ward",
            float("alphaU") + &board("alphaV") + &highlight + variant,
        ),
        ("roughplastic", board("alpha")),
    ] {
        check(&material(plugin, &inside), &[], "");
    }
    let both = [
        "roughness",
        "anisotropic",
        "spec_trans",
        "spec_tint",
        "sheen",
        "sheen_tint",
        "flatness",
    ];
    let both = board("base_color") + &both.map(float).concat();
    let body = ["metallic", "clearcoat", "clearcoat_gloss", "specular"].map(float);
    check(&material("principled", &(body.concat() + &both)), &[], "");
    let thin = both + &float("diff_trans") + "<float name='eta' value='1.4'/>";
    check(&material("principledthin", &thin), &[], "");
}

#[test]
fn all_parameters_of_materials_that_hold_others_are_known() {
    let coat = [
        "<string name='intIOR' value='bk7'/><float name='extIOR' value='1'/>".to_string(),
        float("thickness"),
        colour("sigmaA"),
        colour("specularReflectance"),
        "<bsdf type='twosided'><bsdf type='conductor'/></bsdf>".to_string(),
    ]
    .concat();
    let ggx = "<string name='distribution' value='ggx'/>";
    let weights = "<string name='weights' value='0.2, 0.7'/>";
    let shadowing = "<boolean name='use_shadowing_function' value='false'/>";
    for (plugin, inside) in [
        ("coating", coat.clone()),
        ("roughcoating", coat + &float("alpha") + ggx),
        ("blendbsdf", board("weight") + DIFFUSE + DIFFUSE),
        ("mixturebsdf", format!("{weights}{DIFFUSE}{DIFFUSE}")),
        ("normalmap", format!("{BOARD}{DIFFUSE}{shadowing}")),
    ] {
        check(&material(plugin, &inside), &[], "");
    }
}

#[test]
fn metal_without_a_name_is_a_mirror_or_copper_by_generation() {
    for plugin in ["conductor", "roughconductor"] {
        let albedo = |version: &str| {
            let text = material(plugin, "").replace("3.0.0", version);
            let imported = import_files(&[("scene.xml", text.as_bytes())], Strictness::Strict);
            below(&imported.expect("a sound scene"), 0.1, 0.1).0
        };
        assert_eq!(albedo("3.0.0"), Rgb::WHITE);
        let copper = albedo("0.6.0");
        assert!(copper.r() > 0.9 && copper.b() < 0.6, "{copper:?}");
    }
}

fn refuse(plugin: &str, cases: &[(&str, &str)]) {
    for (inside, expected) in cases {
        let expected = format!("scene.xml:{expected}");
        check(&material(plugin, inside), &[], &expected);
    }
}

#[test]
fn incomplete_materials_are_refused() {
    refuse(
        "blendbsdf",
        &[(DIFFUSE, "3:25: bsdf \"blendbsdf\" needs two materials")],
    );
    refuse(
        "normalmap",
        &[(DIFFUSE, "3:25: bsdf \"normalmap\" holds no texture")],
    );
    refuse(
        "mixturebsdf",
        &[
            (
                "\n<string name='weights' value='0.2, x'/><bsdf type='diffuse'/><bsdf type='null'/>",
                "4:1: found \"0.2, x\", expected one number for each of 2 materials",
            ),
            (
                "\n<string name='weights' value='1, 1'/><bsdf type='diffuse'/><bsdf type='null'/>",
                "4:1: warning: the weights add up to 2; they are scaled down to 1",
            ),
            (
                "<string name='weights' value='-1, 1'/><bsdf type='diffuse'/><bsdf type='null'/>",
                "3:25: the weights of materials must be 0 or more and add up to 1 at most, not to 0",
            ),
        ],
    );
}

#[test]
fn contradictory_materials_are_refused() {
    refuse(
        "coating",
        &[
            (
                "<bsdf type='dielectric'/>",
                "3:25: a coating cannot hold a material that lets light through",
            ),
            (
                "\n<float name='thickness' value='-1'/><bsdf type='diffuse'/>",
                "4:1: a coat cannot be thinner than nothing",
            ),
        ],
    );
    refuse(
        "ward",
        &[(
            "\n<string name='variant' value='ward-dur'/>",
            "4:1: \"variant\": found \"ward-dur\", expected balanced, ward, ward-duer (did you mean \
             \"ward-duer\"?)",
        )],
    );
    refuse(
        "principled",
        &[
            (
                "\n<float name='specular' value='0.5'/><float name='eta' value='1.5'/>",
                "4:1: \"eta\" says already what \"specular\" says",
            ),
            (
                "\n<float name='specular' value='2'/>",
                "4:1: \"specular\" is 2, expected 0 to 1",
            ),
        ],
    );
    refuse(
        "principle",
        &[(
            "",
            "3:25: unknown bsdf \"principle\" (did you mean \"principled\"?)",
        )],
    );
}

#[test]
fn scaled_textures_are_read_and_empty_ones_refused() {
    let scaled =
        |inside: &str| format!("<texture name='reflectance' type='scale'>{inside}</texture>");
    for factor in [float("scale"), colour("scale"), String::new()] {
        let inside = scaled(&(factor + BOARD));
        check(&material("diffuse", &inside), &[], "");
    }
    refuse(
        "diffuse",
        &[(
            &format!("\n{}", scaled("")),
            "4:1: texture \"scale\" holds no texture",
        )],
    );
}

/// Squares of squares are where arithmetic has them; squares of one grey are that grey.
#[test]
fn squares_hold_textures_and_refs_to_them() {
    let inner = "<texture type='checkerboard' id='inner'><rgb name='color0' value='0.9'/>\
                 <rgb name='color1' value='0.1'/>\
                 <transform name='to_uv'><scale x='4' y='4'/></transform></texture>";
    let at = |fields: &str, x: f32, y: f32| {
        let board = format!("<texture name='reflectance' type='checkerboard'>{fields}</texture>");
        let scene = material("diffuse", &board).replace("<shape", &format!("{inner}<shape"));
        check(&scene, &[], "");
        let files = [("scene.xml", scene.as_bytes())];
        let imported = import_files(&files, Strictness::Strict).expect("a sound scene");
        below(&imported, x, y).0
    };
    let nested = "<ref name='color0' id='inner'/><rgb name='color1' value='0.3, 0.4, 0.5'/>";
    // Coordinates are half the place and a half; the inner squares have sides of an eighth.
    for (x, y, expected) in [
        (-0.9, -0.9, Rgb::grey(0.9)),
        (-0.9, -0.7, Rgb::grey(0.1)),
        (-0.6, -0.6, Rgb::grey(0.9)),
        (0.9, 0.6, Rgb::grey(0.1)),
        (0.9, -0.6, Rgb::new(0.3, 0.4, 0.5)),
        (-0.1, 0.1, Rgb::new(0.3, 0.4, 0.5)),
    ] {
        assert_eq!(at(nested, x, y), expected, "at {x}, {y}");
    }
    let grey = "<texture type='checkerboard' name='color0'><rgb name='color0' value='0.3'/>\
                <rgb name='color1' value='0.3'/></texture><rgb name='color1' value='0.3'/>";
    for x in [-0.9, -0.3, 0.3, 0.9] {
        assert_eq!(at(grey, x, 0.4), Rgb::grey(0.3));
    }
    let unknown = "\n<texture name='reflectance' type='checkerboard'>\n\
                   <texture type='cheesecloth' name='color1'/></texture>";
    let said = "5:1: unknown texture \"cheesecloth\"";
    refuse("diffuse", &[(unknown, said)]);
}

/// Anisotropic materials and bumps do, however deep they lie; others must not pay for it.
#[test]
fn points_know_how_coordinates_run_where_a_material_asks() {
    let brushed = "<bsdf type='roughconductor' id='brushed'><float name='alpha_u' value='0.1'/>
        <float name='alpha_v' value='0.3'/></bsdf>";
    let bumps = format!("<bsdf type='bumpmap'>{BOARD}{DIFFUSE}</bsdf>");
    let nested = "<bsdf type='twosided'><ref id='brushed'/></bsdf>";
    let textured = format!("<bsdf type='diffuse'>{}</bsdf>", board("reflectance"));
    for (material, asks) in [
        (brushed.replace(" id='brushed'", "").as_str(), true),
        (&bumps, true),
        (nested, true),
        (DIFFUSE, false),
        (&textured, false),
    ] {
        for shape in ["sphere", "rectangle"] {
            let scene = file_of(&format!(
                "{brushed}<shape type='{shape}'>{material}</shape>"
            ));
            let imported = import_files(&[("a.xml", scene.as_bytes())], Strictness::Strict);
            let imported = imported.expect("a sound scene");
            let ray = Ray::new(Vec3::new(0.3, 0.2, 4.0), Vec3::NEG_Z);
            let hit = imported.scene.intersect(&ray).expect("the shape is there");
            let knows = hit.point.derivatives != Derivatives::NONE;
            assert_eq!(knows, asks, "{shape}: {material}");
        }
    }
}

/// Textures of material and light do, and whatever asks how coordinates run; the layer of coordinates has
/// them always.
#[test]
fn spheres_know_their_coordinates_where_somebody_asks() {
    let brushed = "<bsdf type='roughconductor'><float name='alpha_u' value='0.1'/>
        <float name='alpha_v' value='0.3'/></bsdf>";
    let textured = format!(
        "<bsdf type='twosided'><bsdf type='diffuse'>{}</bsdf></bsdf>",
        board("reflectance")
    );
    let glowing = format!(
        "{DIFFUSE}<emitter type='area'>{}</emitter>",
        board("radiance")
    );
    let white = format!("{DIFFUSE}<emitter type='area'><rgb name='radiance' value='1'/></emitter>");
    let placed = |of: &str| {
        format!(
            "<shape type='shapegroup' id='group'><shape type='sphere'>{of}</shape></shape>
            <shape type='instance'><ref id='group'/><transform name='to_world'>
            <rotate x='1' y='2' angle='70'/><scale x='2' y='1' z='1'/></transform></shape>"
        )
    };
    let alone = |of: &str| format!("<shape type='sphere'>{of}</shape>");
    for (shapes, asks) in [
        (alone(&textured), true),
        (alone(DIFFUSE), false),
        (alone(brushed), true),
        (alone(&glowing), true),
        (alone(&white), false),
        (placed(DIFFUSE), true),
    ] {
        let scene = file_of(&shapes);
        let imported = import_files(&[("a.xml", scene.as_bytes())], Strictness::Strict);
        let imported = imported.expect("a sound scene");
        let ray = Ray::new(Vec3::new(0.3, 0.2, 4.0), Vec3::NEG_Z);
        let hit = imported.scene.intersect(&ray).expect("the sphere is there");
        assert_eq!(hit.point.uv != Vec2::ZERO, asks, "{shapes}");
        let to_sphere = if shapes.contains("instance") {
            let axis = Vec3::new(1.0, 2.0, 0.0).normalize();
            let turn = Mat4::from_axis_angle(axis, 70_f32.to_radians());
            (Mat4::from_scale(Vec3::new(2.0, 1.0, 1.0)) * turn).inverse()
        } else {
            Mat4::IDENTITY
        };
        let at = to_sphere.transform_point3(hit.point.position);
        let expected = Vec2::new((at.y.atan2(at.x) / TAU).rem_euclid(1.0), at.z.acos() / PI);
        let found = imported.scene.coordinates(&hit);
        assert!(found.distance(expected) < 1e-5, "{found}: {shapes}");
    }
}

/// As spheres do; those of groups, too.
#[test]
fn meshes_know_their_coordinates_where_somebody_asks() {
    let textured = format!("<bsdf type='diffuse'>{}</bsdf>", board("reflectance"));
    let glowing = format!(
        "{DIFFUSE}<emitter type='area'>{}</emitter>",
        board("radiance")
    );
    let white = format!("{DIFFUSE}<emitter type='area'><rgb name='radiance' value='1'/></emitter>");
    let bumps = format!("<bsdf type='bumpmap'>{BOARD}{DIFFUSE}</bsdf>");
    let mirror = format!(
        "<bsdf type='conductor'>{}</bsdf>",
        board("specular_reflectance")
    );
    let holes = format!("<bsdf type='mask'>{}{DIFFUSE}</bsdf>", board("opacity"));
    let brushed = "<bsdf type='roughconductor'><float name='alpha_u' value='0.1'/>
        <float name='alpha_v' value='0.3'/></bsdf>";
    let alone = |of: &str| format!("<shape type='rectangle'>{of}</shape>");
    let placed = |of: &str| {
        format!(
            "<shape type='shapegroup' id='group'>{}</shape>
            <shape type='instance'><ref id='group'/><transform name='to_world'>
            <scale x='2' y='1' z='1'/></transform></shape>",
            alone(of)
        )
    };
    for (shapes, asks) in [
        (alone(&textured), true),
        (alone(&glowing), true),
        (alone(&bumps), true),
        (alone(&mirror), true),
        (alone(&holes), true),
        (alone(brushed), true),
        (alone(&white), false),
        (alone(DIFFUSE), false),
        (placed(&textured), true),
        (placed(DIFFUSE), false),
    ] {
        let scene = file_of(&shapes);
        let imported = import_files(&[("a.xml", scene.as_bytes())], Strictness::Strict);
        let imported = imported.expect("a sound scene");
        for (x, y) in [(0.3, 0.2), (-0.7, 0.1), (0.4, -0.9)] {
            let ray = Ray::new(Vec3::new(x, y, 4.0), Vec3::NEG_Z);
            let hit = imported
                .scene
                .intersect(&ray)
                .expect("the rectangle is there");
            let width = if shapes.contains("instance") {
                2.0
            } else {
                1.0
            };
            let expected = Vec2::new(x / width, y) * 0.5 + 0.5;
            assert_eq!(hit.point.uv.distance(expected) < 1e-6, asks, "{shapes}");
            let found = imported.scene.coordinates(&hit);
            assert!(found.distance(expected) < 1e-6, "{found}: {shapes}");
        }
    }
}
