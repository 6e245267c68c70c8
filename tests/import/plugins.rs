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
