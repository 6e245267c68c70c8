//! The `lumiflow` command as a user meets it: arguments, exit codes, what it prints and writes.

mod bench;
mod compare;
mod crosscheck;
mod interrupt;
mod memory;
mod race;
mod render;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use lumiflow::image::{Image, read_exr};
use tempfile::TempDir;

/// A small room: four walls of different colours, a light, and a block in the way.
const ROOM: &str = r#"<scene version="3.0.0">
  <default name="spp" value="4"/>
  <default name="width" value="24"/>
  <integrator type="path"><integer name="max_depth" value="6"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="$width"/><integer name="height" value="16"/>
      <string name="pixel_format" value="rgb"/><string name="component_format" value="float32"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <bsdf type="diffuse" id="grey"><rgb name="reflectance" value="0.5, 0.4, 0.3"/></bsdf>
  <shape type="rectangle"><ref id="grey"/></shape>
  <shape type="cube">
    <transform name="to_world"><scale value="0.2"/><translate x="0.3" z="0.5"/></transform>
    <ref id="grey"/>
  </shape>
  <shape type="rectangle">
    <transform name="to_world"><rotate y="1" angle="180"/><scale value="0.3"/><translate y="0.5" z="1.5"/></transform>
    <ref id="grey"/>
    <emitter type="area"><rgb name="radiance" value="20, 15, 10"/></emitter>
  </shape>
</scene>
"#;

/// What is said of integrators that do not find the light of a beam.
const BLIND: &str = "not find the light of collimated beams; bdpt, ptracer, ";

/// A folder of its own for each test, in which the command runs.
struct Place(TempDir);

/// What a command did.
struct Done {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for the test"))
    }

    /// A folder with the small room in `room.xml`.
    fn with_room() -> Self {
        let place = Self::new();
        place.write("room.xml", ROOM);
        place
    }

    /// Puts a beam without width into the room, which not every integrator finds, as `beam.xml`.
    fn write_room_with_beam(&self) {
        let beam = r#"<emitter type="collimated"><float name="power" value="3"/></emitter>"#;
        self.write(
            "beam.xml",
            &ROOM.replace("</scene>", &format!("{beam}</scene>")),
        );
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// The names of all files here, sorted.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lumiflow"));
        command
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    fn run(&self, arguments: &[&str]) -> Done {
        Done::from(
            self.command(arguments)
                .output()
                .expect("the command starts"),
        )
    }

    /// Runs a command that must succeed.
    fn succeed(&self, arguments: &[&str]) -> Done {
        let done = self.run(arguments);
        assert_eq!(done.code, Some(0), "{arguments:?}: {}", done.stderr);
        done
    }

    /// Runs a command that must fail with a code and with `part` on stderr.
    fn fail(&self, arguments: &[&str], code: i32, part: &str) -> Done {
        let done = self.run(arguments);
        assert_eq!(done.code, Some(code), "{arguments:?}: {}", done.stderr);
        assert!(done.stderr.contains(part), "{arguments:?}: {}", done.stderr);
        done
    }

    fn exr(&self, name: &str) -> Image {
        exr(&self.path(name))
    }
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Done {
    /// The last line of stdout, which is JSON.
    fn json(&self) -> serde_json::Value {
        let line = self.stdout.lines().last().expect("a line on stdout");
        serde_json::from_str(line).expect("JSON on the last line of stdout")
    }
}

fn exr(path: &Path) -> Image {
    read_exr(path).expect("an EXR file")
}

/// The image without what differs between two runs of one render.
fn without_run(mut image: Image) -> Image {
    let of_run = lumiflow::output::RUN_PREFIX;
    let before = image.metadata.len();
    image.metadata.retain(|name, _| !name.starts_with(of_run));
    assert!(image.metadata.len() < before, "times are in the metadata");
    image
}

#[test]
fn the_version_names_all_parts() {
    let done = Place::new().succeed(&["--version"]);
    let lines: Vec<&str> = done.stdout.lines().collect();
    assert!(lines[0].starts_with(concat!("lumiflow ", env!("CARGO_PKG_VERSION"), " (")));
    assert!(
        lines[1].starts_with("Embree ") && lines[1].contains("headers "),
        "{lines:?}"
    );
    assert!(
        lines[2].starts_with("OpenEXR 3.") && lines[2].contains("headers 3."),
        "{lines:?}"
    );
    assert!(lines[3].starts_with("obvhs 0."), "{lines:?}");
}

#[test]
fn help_lists_commands_options_and_exit_codes() {
    let place = Place::new();
    let done = place.succeed(&["--help"]);
    for part in [
        "render",
        "info",
        "convert",
        "compare",
        "bench",
        "crosscheck",
        "143",
    ] {
        assert!(done.stdout.contains(part), "{part}: {}", done.stdout);
    }
    let done = place.succeed(&["help", "render"]);
    for part in [
        "--spp",
        "max_depth=-1",
        "rr_depth=5",
        "mis=power",
        "Examples:",
    ] {
        assert!(done.stdout.contains(part), "{part}: {}", done.stdout);
    }
}

#[test]
fn wrong_use_is_told_from_other_failures() {
    let place = Place::with_room();
    place.fail(&[], 2, "Usage");
    place.fail(
        &["rendr", "room.xml"],
        2,
        "similar subcommand exists: 'render'",
    );
    place.fail(&["render", "room.xml", "--siz", "4x4"], 2, "--size");
    place.fail(&["render", "absent.xml"], 4, "cannot read absent.xml");
    place.fail(&["info", "absent.xml"], 4, "cannot read absent.xml");
    place.fail(
        &["render", "room.xml", "-o", "no/where.exr"],
        4,
        "no/where.exr",
    );
    assert_eq!(place.names(), ["room.xml"]);
}

#[test]
fn info_counts_what_is_there() {
    let place = Place::with_room();
    let done = place.succeed(&["info", "room.xml", "--json", "-Dspp=9", "--size", "30x20"]);
    let found = done.json();
    assert_eq!(found["triangles"], 16);
    assert_eq!(found["objects"], 3);
    assert_eq!(found["lights"]["area"], 1);
    assert_eq!(found["sensors"][0]["width"], 30);
    assert_eq!(found["sensors"][0]["spp"], 9);
    assert_eq!(found["integrator"], "path");
    assert!(found["memory_bytes"].as_u64().unwrap() > 1 << 20);
    let text = place.succeed(&["info", "room.xml"]).stdout;
    assert!(text.contains("triangles   16\n"), "{text}");
    assert!(text.contains("1 (1 area)"), "{text}");
}

#[test]
fn scenes_of_ours_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        // Beside the scenes stand meshes, textures and a description.
        let is_stock = ["meshes", "textures"]
            .iter()
            .any(|name| path.ends_with(name));
        if path.is_file() || is_stock {
            continue;
        }
        let path = path.join("scene.xml");
        let done = Place::new().succeed(&["info", "--strict", path.to_str().unwrap()]);
        assert!(done.stdout.contains("triangles"), "{}", done.stdout);
        count += 1;
    }
    assert!(count >= 12);
}
