//! Plugins that are read in both generations' spellings.

use super::{check, complaint, file_of};

#[test]
fn lenses_are_read_in_both_spellings() {
    for (lens, expected) in [
        (
            "<float name='apertureRadius' value='0.1'/>\n\
             <float name='focusDistance' value='3'/>",
            "",
        ),
        (
            "<float name='aperture_radius' value='0.1'/>\n<float name='fov' value='30'/>",
            "",
        ),
        (
            "",
            "scene.xml:1:24: sensor \"thinlens\" needs the property \"aperture_radius\"",
        ),
        (
            "\n<float name='aperture_radius' value='0'/>",
            "scene.xml:2:1: warning: a lens of radius 0 is a pinhole",
        ),
        (
            "\n<float name='aperture_radius' value='-1'/>",
            "scene.xml:1:24: the radius of the aperture is -1, expected more than 0",
        ),
        (
            "\n<float name='aperture_radius' value='1'/>\n\
             <float name='focus_distance' value='0'/>",
            "scene.xml:1:24: the distance of focus is 0, expected more than 0",
        ),
    ] {
        let scene =
            format!("<scene version='3.0.0'><sensor type='thinlens'>{lens}</sensor></scene>");
        check(&scene, &[], expected);
    }
}

#[test]
fn bumps_are_read_and_incomplete_ones_refused() {
    let board = "<texture type='checkerboard'/>";
    let diffuse = "<bsdf type='diffuse'/>";
    let bumps = |inside: &str| {
        file_of(&format!(
            "<shape type='rectangle'><bsdf type='bumpmap'>{inside}</bsdf></shape>"
        ))
    };
    let whole = format!("{board}{diffuse}<float name='scale' value='2'/>");
    check(&bumps(&whole), &[], "");
    check(
        &bumps(diffuse),
        &[],
        "scene.xml:3:25: bsdf \"bumpmap\" holds no texture",
    );
    check(
        &bumps(board),
        &[],
        "scene.xml:3:25: bsdf \"bumpmap\" holds no material",
    );
    let given = "<boolean name='flip_invalid_normals' value='false'/>";
    check(&bumps(&format!("{whole}{given}")), &[], "");
}

#[test]
fn instances_are_read_and_groups_that_cannot_be_placed_refused() {
    let cube = "<shape type='cube'/>";
    let group = |inside: &str| format!("<shape type='shapegroup' id='g'>{inside}</shape>");
    let instance = "\n<shape type='instance'><ref id='g'/></shape>";
    let singular = "the matrix is singular: it flattens space and has no inverse";
    for (body, expected) in [
        (group(cube) + instance + instance, ""),
        (
            format!("<shape type='instance'>{}</shape>", group(cube)),
            "",
        ),
        (
            group(cube) + "\n<shape type='instance'><ref id='h'/></shape>",
            "scene.xml:4:24: ref to the unknown id \"h\" (did you mean \"g\"?)",
        ),
        (
            format!("<shape type='sphere' id='g'/>{instance}"),
            "scene.xml:4:1: an instance of shape \"sphere\", expected one of a \"shapegroup\"",
        ),
        (
            format!("<bsdf type='diffuse' id='g'/>{instance}"),
            "scene.xml:4:1: an instance needs a ref to a shape \"shapegroup\"\n\
             scene.xml:4:24: warning: shape \"instance\" makes no use of bsdf \"diffuse\"; ignored",
        ),
        (
            group(&format!("\n{}", "<shape type='shapegroup'/>")),
            "scene.xml:4:1: found shape \"shapegroup\" in a shapegroup, expected a shape by itself",
        ),
        (
            group("\n<shape type='cube'>\n<emitter type='area'/></shape>"),
            "scene.xml:5:1: an emitter in a shapegroup: shapes that are placed by instances cannot \
             emit light",
        ),
        (
            group("") + instance,
            "scene.xml:3:1: warning: the group holds no shapes",
        ),
        (
            group("\n<shape type='spere'/>") + instance,
            "scene.xml:4:1: unknown shape \"spere\" (did you mean \"sphere\"?)",
        ),
        (
            group("\n<shape type='sphere'><float name='radius' value='1e20'/></shape>") + instance,
            "scene.xml:4:1: Embree: a sphere has an unusable radius: 100000000000000000000; it \
             must be positive and finite",
        ),
        (
            group(cube)
                + "<shape type='instance'><ref id='g'/><transform name='toWorld'>\n\
                   <scale x='0'/></transform></shape>",
            &format!("scene.xml:4:1: <scale>: {singular}"),
        ),
    ] {
        check(&file_of(&body), &[], expected);
    }
}

#[test]
fn days_are_read_in_both_generations() {
    let scene = |version: &str, inside: &str| {
        format!(
            "<scene version='{version}'>\n<sensor type='perspective'/>\n\
             <emitter type='sunsky'>{inside}</emitter>\n</scene>\n"
        )
    };
    let at_night = "scene.xml:3:1: warning: the sun is below the horizon; all is dark";
    let direction =
        |y: f32, z: f32| format!("<vector name='sunDirection' x='0.3' y='{y}' z='{z}'/>");
    let in_air = |turbidity: f32| format!("\n<float name='turbidity' value='{turbidity}'/>");
    for (version, inside, expected) in [
        ("0.6.0", String::new(), ""),
        ("3.0.0", String::new(), ""),
        ("0.6.0", direction(1.0, -0.1), ""),
        ("3.0.0", direction(-0.1, 1.0), ""),
        (
            "0.6.0",
            "<float name='sunRadiusScale' value='0'/><float name='skyScale' value='2'/>".into(),
            "",
        ),
        (
            "3.0.0",
            "<float name='sun_aperture' value='2'/><integer name='year' value='2020'/>\
             <integer name='month' value='6'/><float name='latitude' value='50'/>"
                .into(),
            "",
        ),
        ("3.0.0", "<float name='hour' value='1'/>".into(), at_night),
        (
            "3.0.0",
            in_air(11.0),
            "scene.xml:4:1: the turbidity must lie between 1 and 10, and the albedo between 0 and 1",
        ),
        (
            "3.0.0",
            format!("<float name='hour' value='9'/>\n{}", direction(0.0, 1.0)),
            "scene.xml:4:1: found \"sun_direction\" and a date, a time or a place, expected one of \
             the two",
        ),
        (
            "0.6.0",
            "\n<float name='stretch' value='1.2'/>".into(),
            "scene.xml:4:1: warning: \"stretch\" is ignored: the sky is as published",
        ),
    ] {
        check(&scene(version, &inside), &[], expected);
    }
    let (up_in_the_first, up_in_the_second) = (direction(-1.0, 0.5), direction(0.5, -1.0));
    let found = complaint(&scene("0.6.0", &up_in_the_first), &[]);
    assert!(
        found.ends_with("the sun is below the horizon; all is dark"),
        "{found}"
    );
    let found = complaint(&scene("3.0.0", &up_in_the_second), &[]);
    assert!(
        found.ends_with("the sun is below the horizon; all is dark"),
        "{found}"
    );
}

#[test]
fn projectors_are_read() {
    let board = "<texture type='checkerboard' name='irradiance'/>";
    let projector =
        |inside: &str| file_of(&format!("<emitter type='projector'>{inside}</emitter>"));
    check(&projector(board), &[], "");
    check(
        &projector("<rgb name='irradiance' value='1 2 3'/><float name='fov' value='30'/>"),
        &[],
        "",
    );
    check(
        &projector("\n<float name='fov' value='180'/>"),
        &[],
        "scene.xml:4:1: the field of view is 180 degrees, expected more than 0 and less than 180",
    );
}

#[test]
fn merged_shapes_are_in_the_scene_by_themselves() {
    let merged = |inside: &str| file_of(&format!("<shape type='merge'>{inside}</shape>"));
    let lamp = "<shape type='sphere'><emitter type='area'/></shape>";
    check(&merged(&format!("<shape type='cube'/>{lamp}")), &[], "");
    check(
        &merged("\n<shape type='merge'/>"),
        &[],
        "scene.xml:4:1: found shape \"merge\" in a merge, expected a shape by itself",
    );
}

#[test]
fn integrators_around_others_that_are_unknown_say_so() {
    let inner = "<integrator type='path'/>";
    let around = |name: &str| {
        let outer = format!("<integrator type='{name}'><float name='max_error' value='5'/>");
        file_of(&format!("{outer}{inner}</integrator>"))
    };
    check(
        &around("adaptive"),
        &[],
        "scene.xml:3:1: warning: unknown integrator \"adaptive\"; the one inside of it is used instead",
    );
}

#[test]
fn beams_without_width_are_read() {
    let beam = |inside: &str| file_of(&format!("<emitter type='collimated'>{inside}</emitter>"));
    check(&beam(""), &[], "");
    check(&beam("<spectrum name='power' value='3'/>"), &[], "");
    check(&beam("<rgb name='irradiance' value='1 2 3'/>"), &[], "");
    check(
        &beam("<rgb name='irradiance' value='1 2 3'/>\n<rgb name='power' value='1 2 3'/>"),
        &[],
        "scene.xml:3:28: \"power\" and \"irradiance\" are the same",
    );
}

#[test]
fn sensors_without_a_pinhole_are_read() {
    let sensor = |plugin: &str, inside: &str| {
        format!("<scene version='3.0.0'><sensor type='{plugin}'>{inside}</sensor></scene>")
    };
    let scale = "<transform name='to_world'><scale x='3' y='3'/></transform>";
    check(&sensor("orthographic", scale), &[], "");
    check(&sensor("spherical", scale), &[], "");
    check(
        &sensor(
            "orthographic",
            "<float name='near_clip' value='9'/><float name='far_clip' value='1'/>",
        ),
        &[],
        "scene.xml:1:24: the clip planes are at 9 and 1, expected 0 or more and growing",
    );
    check(
        &sensor("orthografic", ""),
        &[],
        "scene.xml:1:24: unknown sensor \"orthografic\" (did you mean \"orthographic\"?)",
    );
}

#[test]
fn curves_are_read_and_those_that_are_none_refused() {
    let folder = tempfile::tempdir().expect("a folder for the scene");
    let said = |plugin: &str, text: &str, inside: &str| {
        std::fs::write(folder.path().join("hair.txt"), text).expect("the file can be written");
        let body = format!(
            "<shape type='{plugin}'><string name='filename' value='hair.txt'/>{inside}</shape>"
        );
        let file = folder.path().join("scene.xml");
        std::fs::write(&file, file_of(&body)).expect("the file can be written");
        let imported = lumiflow::scene::import::import(&file, &Default::default());
        imported
            .map(|imported| imported.scene.objects().len())
            .map_err(|e| e.to_string())
    };
    let sound = "0 0 0 .1\n1 0 0 .1\n2 1 0 .2\n3 0 0 .1\n";
    assert_eq!(said("bsplinecurve", sound, ""), Ok(1));
    assert_eq!(said("linearcurve", sound, ""), Ok(1));
    let short = said("bsplinecurve", "0 0 0 .1\n1 0 0 .1\n", "").expect_err("two points");
    assert!(
        short.contains("hair.txt: a curve has 2 control points, expected 4 at least"),
        "{short}"
    );
    let broken = said("linearcurve", "0 0 0\n", "").expect_err("no radius");
    assert!(
        broken.contains("line 1, column 1: found \"0 0 0\", expected x, y, z and a radius"),
        "{broken}"
    );
    let light = "<emitter type='area'/>";
    let glowing = said("linearcurve", sound, light).expect_err("hairs do not glow");
    assert!(glowing.contains("curves cannot emit light"), "{glowing}");
}
