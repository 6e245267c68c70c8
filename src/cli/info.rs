//! `lumiflow info`.

use std::time::Instant;

use serde_json::{Value, json};

use super::args::InfoArgs;
use super::console::{duration, print_line, say};
use super::failure::Failure;
use crate::accel::Geometry;
use crate::emitter::{Emitter, EmitterClass, EmitterModel};
use crate::scene::import::xml::Diagnostic;
use crate::scene::import::{Imported, View};
use crate::scene::{Object, Scene};
use crate::shape::ShapeModel;

/// What a scene holds.
struct Contents {
    triangles: usize,
    objects: usize,
    instances: usize,
    /// Triangles that all instances together place.
    instanced_triangles: usize,
    materials: usize,
    lights: [(&'static str, usize); 5],
    load_seconds: f64,
    build_seconds: f64,
    /// Largest memory of the process so far, in bytes, where the system tells.
    memory: Option<u64>,
}

/// Loads a scene and tells what is in it.
///
/// # Errors
/// A file that cannot be read, or a scene that cannot be rendered.
pub(super) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let imported = args
        .scene
        .load(&args.file, args.json, args.tracer.engine())?;
    let load_seconds = start.elapsed().as_secs_f64();
    let contents = Contents::of(&imported.scene, load_seconds)?;
    if args.json {
        return print_line(&json_line(args, &imported, &contents).to_string());
    }
    for warning in &imported.warnings {
        say(&warning.to_string());
    }
    print_line(&table(args, &imported, &contents))
}

impl Contents {
    fn of(scene: &Scene, load_seconds: f64) -> Result<Self, Failure> {
        let memory = peak_memory();
        let build_seconds = build_seconds(scene)?;
        let placed = scene.instances().iter();
        let placed = placed.map(|instance| triangles(scene.objects_of(instance)));
        let of_class = |class| {
            let emitters = scene.lights().emitters().iter();
            emitters
                .filter(|emitter: &&Emitter| emitter.class() == class)
                .count()
        };
        Ok(Self {
            triangles: triangles(scene.objects()),
            objects: scene.objects().len(),
            instances: scene.instances().len(),
            instanced_triangles: placed.sum(),
            materials: scene.bsdfs().len(),
            lights: [
                ("area", of_class(EmitterClass::Area)),
                ("point", of_class(EmitterClass::Point)),
                ("directional", of_class(EmitterClass::Directional)),
                ("collimated", of_class(EmitterClass::Collimated)),
                ("environment", of_class(EmitterClass::Environment)),
            ],
            load_seconds,
            build_seconds,
            memory,
        })
    }

    fn light_count(&self) -> usize {
        self.lights.iter().map(|(_, count)| count).sum()
    }
}

/// Triangles of the meshes among objects.
fn triangles(objects: &[Object]) -> usize {
    let of_each = objects.iter().map(|object| match object.shape.geometry() {
        Geometry::Triangles(_, triangles) => triangles.as_slice().len(),
        _ => 0,
    });
    of_each.sum()
}

/// Seconds to build the search structure, by building it once more.
fn build_seconds(scene: &Scene) -> Result<f64, Failure> {
    let start = Instant::now();
    let built = scene.build_anew();
    built.map_err(|error| Failure::File(error.to_string()))?;
    Ok(start.elapsed().as_secs_f64())
}

/// Largest resident memory of this process so far, in bytes.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

fn json_line(args: &InfoArgs, imported: &Imported, contents: &Contents) -> Value {
    let view = |view: &View| {
        let window = view.window;
        json!({
            "width": view.film_size.0,
            "height": view.film_size.1,
            "window": [window.x, window.y, window.width, window.height],
            "filter": view.filter.kind().name(),
            "sampler": view.sampler.name(),
            "spp": view.sample_count,
            "alpha": view.alpha,
        })
    };
    let lights = contents.lights.iter();
    let lights: serde_json::Map<String, Value> = lights
        .map(|(class, count)| ((*class).to_owned(), json!(count)))
        .collect();
    let warnings = imported.warnings.iter();
    json!({
        "scene": args.file.display().to_string(),
        "hash": format!("{:016x}", imported.hash),
        "triangles": contents.triangles,
        "objects": contents.objects,
        "instances": contents.instances,
        "instanced_triangles": contents.instanced_triangles,
        "materials": contents.materials,
        "lights": lights,
        "sensors": imported.views.iter().map(view).collect::<Vec<_>>(),
        "integrator": imported.integrator.name,
        "accel": args.tracer.engine().name(),
        "memory_bytes": contents.memory,
        "load_s": contents.load_seconds,
        "build_s": contents.build_seconds,
        "warnings": warnings.map(Diagnostic::to_string).collect::<Vec<_>>(),
    })
}

fn table(args: &InfoArgs, imported: &Imported, contents: &Contents) -> String {
    let mut rows = vec![
        ("scene", args.file.display().to_string()),
        ("triangles", contents.triangles.to_string()),
        ("objects", contents.objects.to_string()),
        ("materials", contents.materials.to_string()),
        ("lights", lights(contents)),
    ];
    if contents.instances > 0 {
        let (count, triangles) = (contents.instances, contents.instanced_triangles);
        rows.insert(
            3,
            ("instances", format!("{count}, of {triangles} triangles")),
        );
    }
    for (index, view) in imported.views.iter().enumerate() {
        let (width, height) = view.film_size;
        let text = format!(
            "{index}: {width}x{height} pixels, {} samples ({}), filter {}",
            view.sample_count,
            view.sampler.name(),
            view.filter.kind().name()
        );
        rows.push(("sensor", text));
    }
    let integrator = match imported.integrator.name.as_str() {
        "" => "none named".to_owned(),
        name => name.to_owned(),
    };
    rows.push(("integrator", integrator));
    rows.push(("accel", args.tracer.engine().name().to_owned()));
    let memory = contents.memory.map_or_else(
        || "unknown".to_owned(),
        |bytes| {
            format!(
                "{:.1} MiB at most while loading",
                bytes as f64 / f64::from(1 << 20)
            )
        },
    );
    rows.push(("memory", memory));
    let build = duration(contents.build_seconds);
    let load = duration(contents.load_seconds);
    rows.push((
        "loading",
        format!("{load}, of which {build} for the search structure"),
    ));
    rows.push(("hash", format!("{:016x}", imported.hash)));
    let lines: Vec<String> = rows
        .into_iter()
        .map(|(name, value)| format!("{name:<12}{value}"))
        .collect();
    lines.join("\n")
}

fn lights(contents: &Contents) -> String {
    let present = contents.lights.iter().filter(|(_, count)| *count > 0);
    let parts: Vec<String> = present
        .map(|(class, count)| format!("{count} {class}"))
        .collect();
    match parts.as_slice() {
        [] => "none".to_owned(),
        parts => format!("{} ({})", contents.light_count(), parts.join(", ")),
    }
}
