//! Every kind of mistake and what is said about it.

use super::{ElementReader, check, check_object, problems, read_body, read_scene};
use crate::scene::import::xml::{ColourUse, ElementKind, ReadOptions, Strictness, read_string};

fn options(definitions: &[(&str, &str)], strictness: Strictness) -> ReadOptions {
    let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    let definitions = definitions.iter().map(owned).collect();
    ReadOptions {
        definitions,
        search_paths: Vec::new(),
        strictness,
    }
}

#[test]
fn unknown_elements_and_stray_text_are_warnings() {
    check(
        "<dpt><float name='x' value='y'/></dpt>\n<shap type='obj'/>\nhello\n<scene/>",
        &[
            "t.xml:2:1: warning: unknown element <dpt>; ignored",
            "t.xml:3:1: warning: unknown element <shap> (did you mean \"shape\"?); ignored",
            "t.xml:4:1: warning: stray text \"hello\"; ignored",
            "t.xml:5:1: warning: unknown element <scene>; ignored",
        ],
    );
    check(
        "<bsdf type='a'>\n<film type='b'/></bsdf>",
        &["t.xml:3:1: warning: bsdf \"a\" holds no film; ignored"],
    );
    check(
        "<bsdf id='m'/>\n<shape type='a'><ref id='m'/></shape>",
        &["t.xml:2:1: <bsdf> needs the attribute \"type\""],
    );
}

#[test]
fn refs_say_what_they_may_have_meant() {
    check(
        "<bsdf type='a' id='white'/><film type='f' id='whit'/>
<shape type='s'><ref id='whte'/></shape>
<shape type='s'><ref id='whit'/></shape>
<bsdf type='a' id='white'/>
<alias id='white' as='whit'/>
<alias id='grey' as='gray'/>
<alias id='one' as='two'/><alias id='two' as='one'/>
<shape type='s'><ref/></shape>",
        &[
            "t.xml:3:17: ref to the unknown id \"whte\" (did you mean \"white\"?)",
            "t.xml:4:17: \"whit\" is a film (see t.xml:2:28); shape \"s\" holds bsdf, emitter, sensor, \
             medium, subsurface, shape, texture or volume (did you mean \"white\"?)",
            "t.xml:5:1: the id \"white\" is taken: see t.xml:2:1",
            "t.xml:6:1: the id \"whit\" is taken: see t.xml:2:28",
            "t.xml:7:1: alias of the unknown id \"grey\"",
            "t.xml:8:1: alias of the unknown id \"one\"",
            "t.xml:8:27: alias of the unknown id \"two\"",
            "t.xml:9:17: <ref> needs the attribute \"id\"",
        ],
    );
}

#[test]
fn circles_of_refs_are_cut() {
    let body = "<bsdf type='mask' id='a'>\n<ref id='b'/></bsdf>\n<bsdf type='mask' id='b'>\n<bsdf type='twosided'>\n<ref id='a'/></bsdf></bsdf>\n<bsdf type='mask' id='c'><ref id='c'/></bsdf>";
    check(
        body,
        &[
            "t.xml:6:1: circular reference: \"a\" → \"b\" → bsdf \"twosided\" → \"a\"",
            "t.xml:7:26: circular reference: \"c\" → \"c\"",
        ],
    );
    let document = read_body(body);
    let sizes = document
        .tree
        .ids()
        .map(|id| document.tree[id].children.len());
    assert_eq!(sizes.collect::<Vec<_>>(), [3, 1, 1, 0, 0]);
}

#[test]
fn nesting_has_a_limit_that_no_ref_gets_around() {
    let deep = "<bsdf type='a'>".repeat(100_000) + &"</bsdf>".repeat(100_000);
    let said = problems(&read_body(&deep));
    assert_eq!(
        said,
        ["t.xml:2:1501: elements are nested more than 100 deep"]
    );
    let link = |i| format!("<bsdf type='a' id='b{i}'>\n<ref id='b{}'/></bsdf>\n", i + 1);
    let chain: String = (0..20_000).map(link).collect();
    let said = problems(&read_body(&format!("{chain}<bsdf type='a' id='b20000'/>")));
    assert!(!said.is_empty() && said.iter().all(|line| line.ends_with("more than 100 deep")));
}

#[test]
fn refs_to_refs_cannot_make_a_material_of_any_size() {
    let link = |i| {
        let below = format!("<ref id='b{}'/>", i + 1);
        format!("<bsdf type='a' id='b{i}'>\n{below}{below}</bsdf>\n")
    };
    let chain = |links: usize| {
        let chain: String = (0..links).map(link).collect();
        read_body(&format!("{chain}<bsdf type='a' id='b{links}'/>"))
    };
    // The first one holds 2¹³ − 1 objects, itself included.
    assert!(problems(&chain(12)).is_empty());
    let said = problems(&chain(13));
    let expected = "t.xml:3:15: bsdf \"a\" holds more than 10000 objects, with those of its refs";
    assert_eq!(said, [expected]);
    assert_eq!(problems(&chain(60)).len(), 48);
    // Shapes are no copies of each other: as many as one likes.
    let shape = "<shape type='s'><ref id='b0'/></shape>".repeat(5);
    let many = format!("{shape}{}", (0..12).map(link).collect::<String>());
    assert!(problems(&read_body(&format!("{many}<bsdf type='a' id='b12'/>"))).is_empty());
}

#[test]
fn values_given_twice_count_once() {
    let body =
        "<bsdf type='a'><float name='toWorld' value='1'/>\n<float name='to_world' value='2'/>
<texture type='t' name='r'/>\n<rgb name='r' value='1'/></bsdf>";
    let read = |reader: &mut ElementReader<'_>| {
        assert_eq!(reader.float("to_world", 0.0), 2.0);
        assert!(reader.colour("r", ColourUse::Reflectance).is_some());
    };
    let said = [
        "t.xml:3:1: warning: \"to_world\" is given twice; the last one counts",
        "t.xml:5:1: warning: \"r\" is given twice; the last one counts",
    ];
    check_object(body, read, &said);
}

#[test]
fn what_a_plugin_does_not_ask_for_is_reported() {
    let body = "<bsdf type='diffuse'>
<rgb name='reflectence' value='1'/>
<texture type='t' name='opacity'/>
<bsdf type='b'/>
<texture type='t' name='eta'/>
<float name='banner' value='1'/></bsdf>";
    let read = |reader: &mut ElementReader<'_>| {
        reader.ignore(&["banner"]);
        reader.optional_float("eta");
        reader.texture("reflectance", ColourUse::Reflectance)
    };
    let said = [
        "t.xml:3:1: warning: unknown property \"reflectence\" of bsdf \"diffuse\" (did you mean \"reflectance\"?); ignored",
        "t.xml:4:1: warning: unknown property \"opacity\" of bsdf \"diffuse\"; ignored",
        "t.xml:5:1: warning: bsdf \"diffuse\" makes no use of bsdf \"b\"; ignored",
        "t.xml:6:1: warning: \"eta\" of bsdf \"diffuse\" takes no texture; ignored",
    ];
    check_object(body, read, &said);
}

#[test]
fn getters_note_wrong_types_and_absent_values() {
    let body = "<shape type='s'><string name='fov' value='x'/>
<float name='steps' value='1.5'/>
<rgb name='toWorld' value='1'/>
<string name='axis' value='hex'/>
<medium type='m' name='interior'/><bsdf type='b' name='exterior'/>
<point name='uv' x='1' y='2' z='3'/>
<float name='broken' value=''/>
<bsdf type='c'/></shape>";
    let read = |reader: &mut ElementReader<'_>| {
        assert_eq!(reader.float("fov", 45.0), 45.0);
        assert_eq!(reader.integer("steps", 3), 3);
        reader.transform("to_world");
        assert_eq!(reader.choice("axis", &[("x", 0), ("hexa", 1)], 7), 7);
        assert!(
            reader
                .child_named("interior", ElementKind::Medium)
                .is_some()
        );
        assert!(
            reader
                .child_named("exterior", ElementKind::Medium)
                .is_none()
        );
        assert_eq!(reader.vector2("uv"), None);
        assert_eq!(reader.optional_float("broken"), None);
        assert!(reader.child(ElementKind::Bsdf).is_some());
        assert_eq!(reader.required_string("name"), None);
        assert_eq!(reader.file("filename"), None);
        reader.error("fov", "too wide");
        reader.warning("absent", "as it is");
    };
    let said = [
        "t.xml:2:1: shape \"s\" needs the property \"name\"",
        "t.xml:2:1: shape \"s\" needs the property \"filename\"",
        "t.xml:2:1: warning: as it is",
        "t.xml:2:17: \"fov\" is a string, expected a float",
        "t.xml:2:17: too wide",
        "t.xml:3:1: \"steps\" is a float, expected an integer",
        "t.xml:4:1: \"toWorld\" is a colour, expected a transform",
        "t.xml:5:1: \"axis\": found \"hex\", expected x, hexa (did you mean \"hexa\"?)",
        "t.xml:6:35: \"exterior\" is a bsdf, expected a medium",
        "t.xml:7:1: \"uv\" is a vector, expected a vector of two numbers",
        "t.xml:8:29: found \"\", expected a number",
        "t.xml:9:1: warning: shape \"s\" holds one bsdf only; ignored",
    ];
    check_object(body, read, &said);
}

#[test]
fn parameters_are_defined_before_use_and_longest_names_win() {
    let text = "<scene version='3.0.0'><default name='s' value='1'/><default name='spp' value='$s$s'/>
<default name='spp' value='9'/><default name='kind' value='diffuse'/>
<bsdf type='rough$kind'><integer name='n' value='$spp'/><string name='t' value='$s-$ $sppx'/></bsdf></scene>";
    for (definitions, spp) in [(&[][..], 11), (&[("spp", "64")][..], 64)] {
        let document = read_string("t.xml", text, &options(definitions, Strictness::Normal));
        assert!(problems(&document).is_empty());
        let bsdf = super::inside(&document, document.tree.root())[0];
        let mut reader = document.tree.reader(bsdf, &document.problems);
        assert_eq!(reader.plugin(), "roughdiffuse");
        assert_eq!(reader.integer("n", 0), spp);
        assert_eq!(
            reader.required_string("t"),
            Some(format!("1-$ {spp}x").as_str())
        );
    }
}

#[test]
fn undefined_and_unused_parameters_are_reported() {
    let text = "<scene version='3.0.0'><default name='spp' value='1'/>
<integer name='a' value='$sp'/>
<integrator type='$late'/><default name='late' value='path'/>
<integer name='b' value='$spp'/></scene>";
    let said = |strictness| {
        problems(&read_string(
            "t.xml",
            text,
            &options(&[("ssp", "3")], strictness),
        ))
    };
    let unused = "the scene does not use the parameter \"ssp\" given by -D (did you mean \"spp\"?)";
    let mut expected = vec![
        "t.xml:2:26: undefined parameter \"$sp\" (did you mean \"spp\"?)".to_owned(),
        "t.xml:3:19: undefined parameter \"$late\"; its <default> at t.xml:3:27 comes too late"
            .to_owned(),
        format!("warning: {unused}"),
    ];
    assert_eq!(said(Strictness::Normal), expected);
    expected[2] = unused.to_owned();
    assert_eq!(said(Strictness::Strict), expected);
}

#[test]
fn versions_are_checked() {
    let said = |text: &str| problems(&read_string("t.xml", text, &ReadOptions::default()));
    assert_eq!(
        said("<scene/>"),
        ["t.xml:1:1: warning: the scene gives no version; read as 3.0.0"]
    );
    assert_eq!(
        said("<scene version='3.x'/>"),
        ["t.xml:1:17: found \"3.x\", expected a version like 3.0.0"]
    );
    assert_eq!(
        said("<scene version='4.1'/>"),
        ["t.xml:1:1: warning: version 4.1.0 is newer than 3.0.0"]
    );
    assert_eq!(said("\u{feff}<scene version='0.4.0'/>"), [""; 0]);
    assert_eq!(
        said("<bsdf type='x'/>"),
        ["t.xml:1:1: found <bsdf>, expected <scene>"]
    );
    assert!(read_scene("0.6.0", "").tree.version().is_first_generation());
}

#[test]
fn broken_xml_names_the_place() {
    let said = |text: &str| problems(&read_string("t.xml", text, &ReadOptions::default()));
    let cut = "unexpected end of the file (is it truncated?)";
    assert_eq!(
        said("<scene version='3.0.0'>\n<bsdf type='a'>\n"),
        [format!("t.xml:2:16: {cut}")]
    );
    assert_eq!(said(""), [format!("t.xml:1:1: {cut}")]);
    assert_eq!(
        said("<scene version='3.0.0'>\n<bsdf type='a'></scene>"),
        ["t.xml:2:16: broken XML: expected 'bsdf' tag, not 'scene'"]
    );
}

#[test]
fn every_truncation_is_one_error_and_no_panic() {
    let whole =
        "<?xml version='1.0'?><!-- ä --><scene version='3.0.0'><default name='n' value='é'/>
<bsdf type='diffuse'><rgb name='reflectance' value='#ff00ff'/></bsdf>
<shape type='obj'><transform name='to_world'><scale x='2'/></transform></shape></scene>";
    let cuts = whole.char_indices().map(|(at, _)| at);
    for cut in cuts {
        let document = read_string("t.xml", &whole[..cut], &ReadOptions::default());
        assert_eq!(problems(&document).len(), 1, "{}", &whole[..cut]);
        assert!(document.problems.has_errors());
    }
}

#[test]
fn lenient_and_strict_move_the_border_between_errors_and_warnings() {
    let text = "<scene version='3.0.0'><dpt/><spectrum name='a' type='x'/></scene>";
    for (strictness, expected) in [
        (
            Strictness::Normal,
            ["warning: unknown element", "unknown spectrum"],
        ),
        (
            Strictness::Lenient,
            ["warning: unknown element", "warning: unknown spectrum"],
        ),
        (Strictness::Strict, ["unknown element", "unknown spectrum"]),
    ] {
        let document = read_string("t.xml", text, &options(&[], strictness));
        for (line, expected) in problems(&document).iter().zip(expected) {
            let message = line.splitn(4, ':').nth(3).unwrap().trim();
            assert!(message.starts_with(expected), "{strictness:?}: {line}");
        }
        assert_eq!(
            document.problems.has_errors(),
            strictness != Strictness::Lenient
        );
    }
}
