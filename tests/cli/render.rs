//! `lumiflow render`: files, layers, metadata, messages.

use lumiflow::image::{AttributeValue, Precision, read_bitmap};

use super::{BLIND, Place, without_run};

fn text(place: &Place, file: &str, name: &str) -> String {
    match place.exr(file).metadata.get(name) {
        Some(AttributeValue::String(text)) => text.clone(),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn a_scene_becomes_a_file_of_its_name() {
    let place = Place::with_room();
    let done = place.succeed(&["render", "room.xml", "--json", "--seed", "7"]);
    assert_eq!(place.names(), ["room.exr", "room.xml"]);
    let found = done.json();
    assert_eq!(found["passes"], 4);
    assert_eq!(found["spp"], 4);
    assert_eq!(found["paths"], 24 * 16 * 4);
    assert_eq!(found["options"]["max_depth"], 6);
    assert_eq!(found["options"]["mis"], "power");
    assert_eq!(found["outputs"][0], "room.exr");
    assert_eq!(found["interrupted"], false);
    assert_eq!(found["warnings"].as_array().unwrap().len(), 0);
    for name in ["wall_s", "cpu_s", "load_s"] {
        assert!(found[name].as_f64().unwrap() >= 0.0, "{name}");
    }
    let image = place.exr("room.exr");
    assert_eq!(
        (image.width(), image.height(), image.channels.len()),
        (24, 16, 3)
    );
    let red = &image.channel("R").unwrap().data;
    let mean = red.iter().map(|v| f64::from(*v)).sum::<f64>() / red.len() as f64;
    assert!(mean > 0.01);
    assert!((found["mean"][0].as_f64().unwrap() - mean).abs() < 1e-9 * mean);
    assert_eq!(image.channel("R").unwrap().precision, Precision::Float);
    assert!(image.metadata.contains_key("chromaticities"));
    assert_eq!(text(&place, "room.exr", "lumiflow.seed"), "7");
    assert_eq!(text(&place, "room.exr", "lumiflow.integrator"), "path");
    assert!(text(&place, "room.exr", "lumiflow.options").contains("max_depth=6 mis=power"));
    let passes = image.metadata.get("lumiflow.passes");
    assert_eq!(passes, Some(&AttributeValue::Int(4)));
    assert_eq!(
        text(&place, "room.exr", "lumiflow.version"),
        env!("CARGO_PKG_VERSION")
    );
    assert_eq!(text(&place, "room.exr", "lumiflow.scene_hash").len(), 16);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let place = Place::with_room();
    let common = [
        "render", "room.xml", "-q", "--size", "37x21", "--filter", "mitchell", "--aov",
    ];
    for threads in ["1", "2", "3", "7"] {
        let output = format!("{threads}.exr");
        let mut arguments = common.to_vec();
        arguments.extend(["albedo,depth,variance", "-t", threads, "-o", &output]);
        let done = place.succeed(&arguments);
        assert_eq!((done.stdout.as_str(), done.stderr.as_str()), ("", ""));
    }
    let first = without_run(place.exr("1.exr"));
    for threads in ["2", "3", "7"] {
        let other = without_run(place.exr(&format!("{threads}.exr")));
        assert!(first == other, "{threads} threads differ from one");
    }
    place.succeed(&["render", "room.xml", "-q", "--size", "37x21", "--seed", "1"]);
    let another_seed = place.exr("room.exr");
    assert_ne!(first.rgb(""), another_seed.rgb(""));
}

#[test]
fn layers_are_those_that_are_asked_for() {
    let place = Place::with_room();
    let layers = "albedo,sh_normal,geo_normal,depth,position,uv,variance";
    let arguments = [
        "render", "room.xml", "-q", "--half", "--aov", layers, "--spp", "8",
    ];
    place.succeed(&arguments);
    let image = place.exr("room.exr");
    let mut names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    let mut expected = vec!["R", "G", "B", "depth.Z", "uv.U", "uv.V"];
    for layer in [
        "albedo.R",
        "albedo.G",
        "albedo.B",
        "variance.R",
        "variance.G",
        "variance.B",
    ] {
        expected.push(layer);
    }
    let vectors = ["sh_normal", "geo_normal", "position"];
    let components: Vec<String> = vectors
        .iter()
        .flat_map(|layer| ["X", "Y", "Z"].map(|axis| format!("{layer}.{axis}")))
        .collect();
    expected.extend(components.iter().map(String::as_str));
    expected.sort_unstable();
    assert_eq!(names, expected);
    // The middle of the back wall stands 4 m away and faces the camera.
    let middle = 8 * 24 + 10;
    let value = |name: &str| image.channel(name).unwrap().data[middle];
    assert!((value("depth.Z") - 4.0).abs() < 0.1, "{}", value("depth.Z"));
    assert_eq!(value("sh_normal.Z"), 1.0);
    assert!((value("albedo.G") - 0.4).abs() < 1e-3);
    assert_eq!(image.channel("R").unwrap().precision, Precision::Half);
    assert_eq!(
        image.channel("depth.Z").unwrap().precision,
        Precision::Float
    );
    assert!(
        image
            .channel("variance.R")
            .unwrap()
            .data
            .iter()
            .any(|v| *v > 0.0)
    );
}

#[test]
fn two_files_of_one_render() {
    let place = Place::with_room();
    let output = ["-o", "a.exr", "-o", "a.png", "--exposure", "-10"];
    let mut arguments = vec!["render", "room.xml", "-q"];
    arguments.extend(output);
    place.succeed(&arguments);
    assert_eq!(place.names(), ["a.exr", "a.png", "room.xml"]);
    let png = read_bitmap(&place.path("a.png")).unwrap();
    let shown = (0..24).map(|x| png.rgb(x, 8).r()).fold(0.0, f32::max);
    // The light, 20, at ten stops less is the brightest that there can be.
    assert!(shown < 0.05, "{shown}");
}

#[test]
fn scenes_are_told_apart_by_name() {
    let place = Place::with_room();
    place.write("hall/scene.xml", super::ROOM);
    let scenes = [
        "render",
        "room.xml",
        "hall/scene.xml",
        "-q",
        "--json",
        "--spp",
        "1",
    ];
    let done = place.succeed(&scenes);
    assert_eq!(place.names(), ["hall", "hall.exr", "room.exr", "room.xml"]);
    assert_eq!(done.stdout.lines().count(), 2);
    let both = ["render", "room.xml", "hall/scene.xml", "-o", "x.exr"];
    place.fail(&both, 2, "put {name} into the name of the file");
    place.fail(
        &["render", "room.xml", "-o", "x.jpg"],
        2,
        "one of .exr, .png",
    );
}

#[test]
fn a_broken_scene_does_not_stop_the_others() {
    let place = Place::with_room();
    place.write(
        "broken.xml",
        "<scene version=\"3.0.0\">\n  <bsdf type=\"difuse\"/>",
    );
    let done = place.fail(
        &["render", "broken.xml", "room.xml", "-q"],
        3,
        "broken.xml:2:",
    );
    assert!(done.stdout.is_empty());
    assert_eq!(place.names(), ["broken.xml", "room.exr", "room.xml"]);
}

#[test]
fn options_are_checked_where_they_come_from() {
    let place = Place::with_room();
    let render = |more: &[&str], code: i32, part: &str| {
        let mut arguments = vec!["render", "room.xml"];
        arguments.extend(more);
        place.fail(&arguments, code, part);
    };
    render(&["-i", "pathh"], 2, "did you mean \"path\"?");
    render(&["--set", "max_dpeth=3"], 2, "did you mean \"max_depth\"?");
    render(
        &["--set", "max_depth=-2"],
        2,
        "expected a whole number from -1 on",
    );
    render(&["--aov", "normals"], 2, "there are albedo, sh_normal");
    render(&["--sensor", "1"], 2, "has one sensor, --sensor 0");
    assert_eq!(place.names(), ["room.xml"]);
    let scene = super::ROOM.replace("value=\"6\"", "value=\"-3\"");
    place.write("wrong.xml", &scene);
    place.fail(&["render", "wrong.xml"], 3, "wrong.xml:4:");
}

#[test]
fn what_the_scene_has_wrong_is_a_warning_with_its_place() {
    let place = Place::new();
    let scene = super::ROOM.replace("type=\"path\"", "type=\"sppm\"");
    place.write("a.xml", &scene);
    let done = place.succeed(&["render", "a.xml", "--json", "--spp", "1"]);
    let warning = "a.xml:4:3: warning: unknown integrator \"sppm\"; \"path\" is used instead";
    assert!(done.stderr.contains(warning), "{}", done.stderr);
    let found = done.json();
    assert!(found["warnings"][0].as_str().unwrap().starts_with(warning));
    let replaced =
        "a.xml:4:3: unknown integrator \"sppm\"; \"path\" is used instead, with its max_depth=6";
    assert_eq!(found["replaced"], serde_json::json!([replaced]));
    assert_eq!(found["options"]["max_depth"], 6);
    assert_eq!(text(&place, "a.exr", "lumiflow.replaced"), replaced);
    place.fail(
        &["render", "a.xml", "--strict"],
        3,
        "unknown integrator \"sppm\"",
    );
    let quiet = place.succeed(&["render", "a.xml", "-q", "--spp", "1"]);
    assert_eq!(quiet.stderr, "");
}

#[test]
fn integrators_that_do_not_find_beams_say_so() {
    let place = Place::with_room();
    place.write_room_with_beam();
    let render = |scene, integrator| ["render", scene, "--spp", "1", "-i", integrator, "--json"];
    let done = place.succeed(&render("beam.xml", "path"));
    let expected = format!("warning: \"path\" does {BLIND}");
    assert!(done.stderr.contains(&expected), "{}", done.stderr);
    let warnings = done.json()["warnings"].to_string();
    assert!(warnings.contains(BLIND), "{warnings}");
    for [scene, integrator] in [["beam.xml", "bdpt"], ["room.xml", "path"]] {
        let done = place.succeed(&render(scene, integrator));
        assert!(
            !done.stderr.contains(BLIND),
            "{integrator}: {}",
            done.stderr
        );
    }
    place.fail(&["render", "beam.xml", "--strict"], 3, BLIND);
}

#[test]
fn variance_that_cannot_be_known_is_said_to_be_missing() {
    let place = Place::with_room();
    let done = place.succeed(&["render", "room.xml", "--aov", "variance", "--spp", "1"]);
    assert!(
        done.stderr.contains("no layer \"variance\""),
        "{}",
        done.stderr
    );
    assert!(place.exr("room.exr").channel("variance.R").is_none());
}

#[test]
fn time_limits_give_whole_passes_that_can_be_made_again() {
    let place = Place::with_room();
    let timed = [
        "render",
        "room.xml",
        "--time",
        "0.3",
        "--json",
        "-o",
        "timed.exr",
    ];
    let found = place.succeed(&timed).json();
    let passes = found["passes"].as_u64().unwrap();
    assert!(passes >= 1);
    if passes > 1 {
        assert!(found["wall_s"].as_f64().unwrap() < 0.6, "{found}");
    }
    let count = passes.to_string();
    place.succeed(&[
        "render",
        "room.xml",
        "--passes",
        &count,
        "-q",
        "-o",
        "counted.exr",
    ]);
    assert!(without_run(place.exr("timed.exr")) == without_run(place.exr("counted.exr")));
}

#[test]
fn an_overrun_of_the_time_is_printed() {
    let place = Place::with_room();
    let done = place.succeed(&["render", "room.xml", "--time", "0.000001", "--json"]);
    assert!(
        done.stderr.contains("longer than the 0.000001 s"),
        "{}",
        done.stderr
    );
    assert_eq!(done.json()["passes"], 1);
}

#[test]
fn definitions_and_integrators_come_from_the_arguments() {
    let place = Place::with_room();
    let arguments = [
        "render", "room.xml", "-Dspp=2", "-D", "width=12", "-i", "depth", "--json",
    ];
    let found = place.succeed(&arguments).json();
    assert_eq!(found["spp"], 2);
    assert_eq!(found["integrator"], "depth");
    let image = place.exr("room.exr");
    assert_eq!((image.width(), image.height()), (12, 16));
    let farthest = image
        .channel("R")
        .unwrap()
        .data
        .iter()
        .copied()
        .fold(0.0, f32::max);
    assert!((4.0..4.7).contains(&farthest), "{farthest}");
}

#[test]
fn elements_of_mitsuba_are_read() {
    let place = Place::with_room();
    let of_room = r#"<integrator type="path"><integer name="max_depth" value="6"/></integrator>"#;
    let render = |element: &str| {
        assert!(super::ROOM.contains(of_room));
        place.write("other.xml", &super::ROOM.replace(of_room, element));
        place.succeed(&["render", "other.xml", "--json"]).json()
    };
    let found = render(
        r#"<integrator type="bdpt">
             <integer name="maxDepth" value="4"/><integer name="rrDepth" value="3"/>
             <boolean name="lightImage" value="false"/><boolean name="sampleDirect" value="false"/>
           </integrator>"#,
    );
    assert_eq!(found["integrator"], "bdpt");
    for (option, value) in [("max_depth", 4), ("rr_depth", 3)] {
        assert_eq!(found["options"][option], value);
    }
    for option in ["light_image", "sample_direct"] {
        assert_eq!(found["options"][option], false);
    }
    assert_eq!(found["warnings"].as_array().unwrap().len(), 0);
    let found =
        render(r#"<integrator type="ptracer"><integer name="maxDepth" value="5"/></integrator>"#);
    assert_eq!(found["integrator"], "ptracer");
    assert_eq!(found["options"]["max_depth"], 5);
    assert!(found["mean"][0].as_f64().unwrap() > 0.01);
    assert_eq!(found["warnings"].as_array().unwrap().len(), 0);
}

/// The smallest deposit makes so many mutations that a pass would hardly end; it is not rendered here.
#[test]
fn deposits_that_make_hardly_any_chain_are_told_of() {
    let place = Place::with_room();
    let render = |deposit: &str| {
        let set = format!("deposition_energy={deposit}");
        let call = ["render", "room.xml", "-i", "erpt", "--spp", "1", "--json"];
        let done = place.succeed(&[&call[..], &["--set", &set]].concat());
        (done.json(), done.stderr)
    };
    let (found, said) = render("1e12");
    let warning = found["warnings"][0].as_str().unwrap();
    assert!(
        warning.contains("so that hardly any chain begins"),
        "{warning}"
    );
    assert_eq!(said.matches(warning).count(), 1, "{said}");
    assert_eq!(found["chains"], 0);
    let (found, _) = render("0");
    assert_eq!(found["warnings"], serde_json::json!([]));
    assert!(found["chains"].as_u64().unwrap() > 0);
}

#[test]
fn values_of_options_that_are_nearly_right_are_suggested() {
    let place = Place::with_room();
    let call = ["render", "room.xml", "-i", "erpt", "--set", "flow=equall"];
    let expected = "expected one of equal, detailed, iterated (did you mean \"equal\"?)";
    place.fail(&call, 2, expected);
}
