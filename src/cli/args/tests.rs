use clap::CommandFactory;

use super::*;

fn render(words: &[&str]) -> Result<RenderArgs, String> {
    let words = ["lumiflow", "render"].iter().chain(words);
    match Cli::try_parse_from(words).map(|cli| cli.command) {
        Ok(Some(Command::Render(args))) => Ok(*args),
        Ok(other) => panic!("{other:?}"),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn the_definition_is_sound() {
    Cli::command().debug_assert();
}

#[test]
fn everything_can_be_said() {
    let args = render(&[
        "a.xml",
        "b.xml",
        "-o",
        "{name}.exr",
        "-o",
        "{name}.png",
        "-i",
        "direct",
        "--set",
        "max_depth=3",
        "-Dspp=64",
        "-D",
        "width = 32",
        "-a",
        "meshes",
        "--time",
        "2.5",
        "-t",
        "3",
        "--seed",
        "18446744073709551615",
        "--size",
        "64x32",
        "--aov",
        "uv,depth",
        "--json",
        "-q",
        "--lenient",
        "--half",
        "--compression",
        "piz",
        "--exposure",
        "-1.5",
        "--filter",
        "tent",
    ])
    .unwrap();
    assert_eq!(args.scenes.len(), 2);
    assert_eq!(args.output, ["{name}.exr", "{name}.png"]);
    let pair = |k: &str, v: &str| (k.to_owned(), v.to_owned());
    assert_eq!(
        args.scene.definitions,
        [pair("spp", "64"), pair("width", "32")]
    );
    assert_eq!(args.settings, [pair("max_depth", "3")]);
    assert_eq!(args.effort.time, Some(2.5));
    assert_eq!(args.scene.size, Some((64, 32)));
    assert_eq!((args.threads, args.seed), (Some(3), u64::MAX));
    assert_eq!(args.aov, ["uv", "depth"]);
    assert_eq!(args.file.exposure, -1.5);
    assert_eq!(args.file.compression, CompressionName::Piz);
    assert!(args.json && args.quiet && args.scene.lenient && args.file.half);
}

#[test]
fn nonsense_is_explained() {
    for (words, part) in [
        (&["a.xml", "--size", "0x5"] as &[&str], "from 1 to 32768"),
        (&["a.xml", "--size", "640"], "such as 640x360"),
        (&["a.xml", "--size", "32769x1"], "from 1 to 32768"),
        (&["a.xml", "--size", "1x2x3"], "such as 640x360"),
        (&["a.xml", "--time", "-1"], "--time"),
        (&["a.xml", "--time", "nan"], "positive number of seconds"),
        (&["a.xml", "--spp", "0"], "0 is not in"),
        (
            &["a.xml", "--spp", "4", "--time", "1"],
            "cannot be used with",
        ),
        (
            &["a.xml", "--passes", "4", "--spp", "1"],
            "cannot be used with",
        ),
        (&["a.xml", "--strict", "--lenient"], "cannot be used with"),
        (&["a.xml", "--half", "--float"], "cannot be used with"),
        (&["a.xml", "-D", "spp"], "expected KEY=VALUE"),
        (&["a.xml", "-t", "0"], "0 is not in"),
        (
            &["a.xml", "--compression", "zipp"],
            "similar value exists: 'zip'",
        ),
        (&["a.xml", "--expsure", "1"], "similar argument exists"),
        (&[], "<SCENE>"),
    ] {
        let error = render(words).unwrap_err();
        assert!(error.contains(part), "{words:?}: {error}");
    }
}

#[test]
fn crops_have_four_numbers() {
    let part = Crop {
        x: 1,
        y: 2,
        width: 3,
        height: 4,
    };
    assert_eq!(crop("1,2, 3,4"), Ok(part));
    for broken in ["1,2,3", "1,2,0,4", "-1,2,3,4", "a"] {
        assert!(crop(broken).is_err(), "{broken}");
    }
}

#[test]
fn the_help_names_every_layer() {
    let mut command = Cli::command();
    let render = command.find_subcommand_mut("render").unwrap();
    let help = render.render_help().to_string();
    for (name, _) in crate::integrator::Aov::NAMES {
        assert!(help.contains(name), "{name}");
    }
}
