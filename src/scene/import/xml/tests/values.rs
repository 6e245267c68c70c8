//! Every form a value can take.

use super::{check_object, inside, problems, read_body, read_scene};
use crate::math::{Rgb, Vec2, Vec3, blackbody};
use crate::scene::import::xml::{ColourSource, ColourUse, ElementKind, ScalarSource};

fn colour(value: &str, wanted: ColourUse) -> Rgb {
    let body = format!("<bsdf type='x'>{value}</bsdf>");
    check_object(&body, |reader| reader.colour("c", wanted), &[]).unwrap()
}

fn point(transform: &str, point: [f32; 3]) -> Vec3 {
    let body = format!("<shape type='x'><transform name='toWorld'>{transform}</transform></shape>");
    let read = check_object(&body, |reader| reader.transform("to_world"), &[]);
    read.point(Vec3::from_array(point))
}

fn assert_near(found: Vec3, expected: [f32; 3]) {
    let expected = Vec3::from_array(expected);
    assert!(
        found.distance(expected) <= 1e-4 * expected.length().max(1.0),
        "{found}, {expected}"
    );
}

#[test]
fn plain_values_come_in_both_spellings() {
    let body = "<shape type='OBJ'>
        <boolean name='faceNormals' value='TRUE'/><boolean name='b' value='0'/>
        <integer name='maxDepth' value=' -7 '/><float name='intIOR' value='1.5e0'/>
        <integer name='whole' value='3'/><float name='fraction' value='4.0'/>
        <string name='filename' value='a (b).obj'/>
        <point name='p' x='1' z='3'/><vector name='v' value='1, 2 3'/>
        <point name='uv' value='0.5 2'/></shape>";
    let read = |reader: &mut super::ElementReader<'_>| {
        assert_eq!(reader.plugin(), "obj");
        assert!(reader.boolean("face_normals", false));
        assert!(!reader.boolean("b", true));
        assert_eq!(reader.integer("max_depth", 0), -7);
        assert_eq!(reader.float("int_ior", 0.0), 1.5);
        assert_eq!(reader.float("whole", 0.0), 3.0);
        assert_eq!(reader.integer("fraction", 0), 4);
        assert_eq!(reader.required_string("filename"), Some("a (b).obj"));
        assert_eq!(reader.vector3("p"), Some(Vec3::new(1.0, 0.0, 3.0)));
        assert_eq!(reader.vector3("v"), Some(Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(reader.vector2("uv"), Some(Vec2::new(0.5, 2.0)));
        assert_eq!(reader.float("absent", 9.0), 9.0);
        assert_eq!(reader.string("absent", "yes"), "yes");
    };
    check_object(body, read, &[]);
}

#[test]
fn rgb_is_linear_and_srgb_and_hexadecimal_are_encoded() {
    let reflectance = |value| colour(value, ColourUse::Reflectance);
    assert_eq!(
        reflectance("<rgb name='c' value='.1,.2 , .3'/>"),
        Rgb::new(0.1, 0.2, 0.3)
    );
    assert_eq!(reflectance("<rgb name='c' value='0.25'/>"), Rgb::grey(0.25));
    assert_eq!(reflectance("<float name='c' value='0.5'/>"), Rgb::grey(0.5));
    assert_near(
        reflectance("<srgb name='c' value='0.5 1 0'/>").0,
        [0.214041, 1.0, 0.0],
    );
    assert_near(
        reflectance("<srgb name='c' value='#0080FF'/>").0,
        [0.0, 0.215861, 1.0],
    );
    assert_near(
        reflectance("<rgb name='c' value='#0080ff'/>").0,
        [0.0, 0.215861, 1.0],
    );
}

#[test]
fn spectra_become_rgb_by_their_use() {
    let curve = "<spectrum name='c' value='400:0.1, 500 : 0.5,600:0.7 700:0.2'/>";
    // Mitsuba 3.9.1 reads 0.628604, 0.604581, 0.278625; its sum is 1e-3 lower.
    let found = colour(curve, ColourUse::Reflectance);
    assert!((found.r() / 0.628604 - 1.0).abs() < 1.5e-3, "{found:?}");
    assert_ne!(found, colour(curve, ColourUse::Emission));
    let triple = "<spectrum name='c' value='2.9, 2.5, 1.7'/>";
    assert_eq!(colour(triple, ColourUse::Emission), Rgb::new(2.9, 2.5, 1.7));
    let glow = "<blackbody name='c' temperature='5000K' scale='2'/>";
    assert_eq!(colour(glow, ColourUse::Emission), blackbody(5000.0, 2.0));
    let glow = "<spectrum name='c' type='blackbody'><float name='temperature' value='5000'/>
        <float name='scale' value='2'/></spectrum>";
    assert_eq!(colour(glow, ColourUse::Emission), blackbody(5000.0, 2.0));
    let long = "<spectrum name='c' type='irregular'><string name='wavelengths' value='400 500'/>
        <string name='values' value='1, 2'/></spectrum>";
    let short = "<spectrum name='c' value='400:1 500:2'/>";
    assert_eq!(
        colour(long, ColourUse::Emission),
        colour(short, ColourUse::Emission)
    );
    let steps = "<spectrum name='c' type='regular'><float name='wavelength_min' value='400'/>
        <float name='wavelength_max' value='500'/><string name='values' value='1, 2'/></spectrum>";
    assert_eq!(
        colour(steps, ColourUse::Emission),
        colour(short, ColourUse::Emission)
    );
    let white = "<spectrum name='c' type='d65'/>";
    assert_eq!(colour(white, ColourUse::Emission), Rgb::WHITE);
}

#[test]
fn a_light_of_one_number_is_grey_only_in_the_first_generation() {
    for (version, expected) in [
        ("0.6.0", [2.0, 2.0, 2.0]),
        ("2.0.0", [2.40959, 1.89658, 1.81783]),
        ("3", [2.40959, 1.89658, 1.81783]),
    ] {
        let body = "<emitter type='constant'><spectrum name='radiance' value='2'/></emitter>";
        let document = read_scene(version, body);
        let emitter = inside(&document, document.tree.root())[0];
        let mut reader = document.tree.reader(emitter, &document.problems);
        let radiance = reader.colour("radiance", ColourUse::Emission).unwrap();
        assert_near(radiance.0, expected);
        assert_eq!(
            reader.colour("radiance", ColourUse::Index),
            Some(Rgb::grey(2.0))
        );
        assert!(problems(&document).is_empty());
    }
}

#[test]
fn colours_out_of_range_are_clamped_aloud() {
    let body = "<bsdf type='x'><rgb name='a' value='2 .5 -1'/><rgb name='b' value='7 -1 0'/>
<rgb name='c' value='7'/></bsdf>";
    let read = |reader: &mut super::ElementReader<'_>| {
        assert_eq!(
            reader.colour("a", ColourUse::Reflectance),
            Some(Rgb::new(1.0, 0.5, 0.0))
        );
        assert_eq!(
            reader.colour("b", ColourUse::Emission),
            Some(Rgb::new(7.0, 0.0, 0.0))
        );
        assert_eq!(reader.colour("c", ColourUse::Index), Some(Rgb::grey(7.0)));
    };
    let said = [
        "t.xml:2:16: warning: \"a\" is 2, 0.5, -1, which is outside 0 to 1; clamped",
        "t.xml:2:47: warning: \"b\" is 7, -1, 0, which is negative; clamped",
    ];
    check_object(body, read, &said);
}

#[test]
fn transforms_apply_in_the_order_written() {
    assert_near(
        point("<translate x='1'/><scale value='2'/>", [1.0, 1.0, 1.0]),
        [4.0, 2.0, 2.0],
    );
    assert_near(
        point("<scale value='2'/><translate x='1'/>", [1.0, 1.0, 1.0]),
        [3.0, 2.0, 2.0],
    );
    assert_near(
        point("<scale x='2' y='3'/>", [1.0, 1.0, 1.0]),
        [2.0, 3.0, 1.0],
    );
    assert_near(
        point("<scale value='2, 3 4'/>", [1.0, 1.0, 1.0]),
        [2.0, 3.0, 4.0],
    );
    assert_near(
        point("<translate value='2 3 4'/>", [1.0, 1.0, 1.0]),
        [3.0, 4.0, 5.0],
    );
    assert_near(
        point("<rotate z='2' angle='90'/>", [1.0, 0.0, 0.0]),
        [0.0, 1.0, 0.0],
    );
    assert_near(
        point("<rotate value='0,1,0' angle='90'/>", [1.0, 0.0, 0.0]),
        [0.0, 0.0, -1.0],
    );
    let matrix = "<matrix value='1 0 0 5, 0 1 0 6\n0 0 1 7 0 0 0 1'/>";
    assert_near(point(matrix, [1.0, 1.0, 1.0]), [6.0, 7.0, 8.0]);
    assert_near(
        point("<matrix value='0 1 0 2 0 0 0 0 3'/>", [1.0, 5.0, 1.0]),
        [5.0, 2.0, 3.0],
    );
    assert_near(point("", [1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
}

#[test]
fn cameras_look_along_z_under_any_spelling_of_lookat() {
    for tag in ["lookat", "lookAt"] {
        let camera = format!("<{tag} origin='0, 0, 4' target='0 0 0' up='  0,   1,    0'/>");
        assert_near(point(&camera, [1.0, 2.0, 3.0]), [-1.0, 2.0, 1.0]);
    }
    let without_up = "<lookat origin='0, 0, 4' target='0 0 0'/>";
    assert_near(point(without_up, [0.0, 0.0, 3.0]), [0.0, 0.0, 1.0]);
}

#[test]
fn textures_stand_in_for_colours_and_numbers() {
    let body =
        "<bsdf type='x'><texture type='bitmap' name='reflectance'/><ref name='alphaU' id='t'/>
        <float name='alphaV' value='.5'/><rgb name='tint' value='1'/>
        <texture type='checkerboard' id='t'/></bsdf>";
    let read = |reader: &mut super::ElementReader<'_>| {
        let reflectance = reader.texture("reflectance", ColourUse::Reflectance);
        let Some(ColourSource::Texture(bitmap)) = reflectance else {
            panic!("{reflectance:?}")
        };
        assert_eq!(reader.tree()[bitmap].plugin, "bitmap");
        let alpha = reader.scalar_texture("alpha_u");
        let Some(ScalarSource::Texture(checks)) = alpha else {
            panic!("{alpha:?}")
        };
        assert_eq!(reader.tree()[checks].plugin, "checkerboard");
        assert_eq!(
            reader.scalar_texture("alpha_v"),
            Some(ScalarSource::Constant(0.5))
        );
        let tint = reader.texture("tint", ColourUse::Reflectance);
        assert_eq!(tint, Some(ColourSource::Constant(Rgb::WHITE)));
        assert_eq!(reader.children(ElementKind::Texture).len(), 3);
    };
    check_object(body, read, &[]);
}

#[test]
fn refs_come_before_what_they_name_and_share_it() {
    let document = read_body(
        "<shape type='a'><ref id='m'/></shape><shape type='b'><ref name='bsdf' id='n'/></shape>
        <alias id='m' as='n'/><bsdf type='diffuse' id='m'/>
        <luminaire type='point'/><camera type='pinhole'/>",
    );
    let children = inside(&document, document.tree.root());
    let [a, b, diffuse, light, camera] = children[..] else {
        panic!("{children:?}")
    };
    assert_eq!(inside(&document, a), [diffuse]);
    assert_eq!(inside(&document, b), [diffuse]);
    assert_eq!(document.tree[light].kind, ElementKind::Emitter);
    assert_eq!(document.tree[camera].kind, ElementKind::Sensor);
    assert!(problems(&document).is_empty());
}
