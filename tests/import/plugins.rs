//! Plugins that are read in both generations' spellings.

use super::{check, file_of};

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
    let flipped = "\n<boolean name='flip_invalid_normals' value='true'/>";
    check(
        &bumps(&format!("{whole}{flipped}")),
        &[],
        "scene.xml:4:1: warning: normals that lean away from the viewer are not flipped; they are \
         black",
    );
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
            "scene.xml:4:1: an instance needs a ref to a shape \"shapegroup\"",
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
