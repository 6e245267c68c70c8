//! `lumiflow info`.

use serde_json::{Value, json};

use super::args::InfoArgs;
use super::console::{duration, print_line, say, size};
use super::failure::Failure;
use super::scenes::{LoadCost, Loaded};
use super::summary::scene_memory;
use crate::accel::Geometry;
use crate::emitter::{Emitter, EmitterClass, EmitterModel};
use crate::scene::import::xml::Diagnostic;
use crate::scene::import::{Imported, View};
use crate::scene::{Object, Scene, SceneMemory};
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
    memory: SceneMemory,
    cost: LoadCost,
}

/// Loads a scene and tells what is in it.
///
/// # Errors
/// A file that cannot be read, or a scene that cannot be rendered.
pub(super) fn run(args: &InfoArgs) -> Result<(), Failure> {
    let Loaded { imported, cost } =
        args.scene
            .load(&args.file, args.json, args.tracer.accel.engine())?;
    let contents = Contents::of(&imported.scene, cost);
    if args.json {
        return print_line(&json_line(args, &imported, &contents).to_string());
    }
    for warning in &imported.warnings {
        say(&warning.to_string());
    }
    print_line(&table(args, &imported, &contents))
}

impl Contents {
    fn of(scene: &Scene, cost: LoadCost) -> Self {
        let placed = scene.instances().iter();
        let placed = placed.map(|instance| triangles(scene.objects_of(instance)));
        let of_class = |class| {
            let emitters = scene.lights().emitters().iter();
            emitters
                .filter(|emitter: &&Emitter| emitter.class() == class)
                .count()
        };
        Self {
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
            memory: scene.memory(),
            cost,
        }
    }

    /// Largest memory of the process while loading, in bytes, where the system tells.
    fn peak(&self) -> Option<u64> {
        self.cost.memory.map(|memory| memory.peak)
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
        "accel": args.tracer.accel.engine().name(),
        "memory_bytes": contents.peak(),
        "memory": scene_memory(contents.memory),
        "load_s": contents.cost.seconds,
        "build_s": contents.cost.build_seconds,
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
    rows.push(("accel", args.tracer.accel.engine().name().to_owned()));
    let peak = contents.peak().map_or_else(String::new, |bytes| {
        format!("; {} at most while loading", size(bytes))
    });
    let tree = size(contents.memory.tree.held);
    let held = size(contents.memory.held());
    rows.push((
        "memory",
        format!("{held}, of which {tree} for the search structure{peak}"),
    ));
    let build = duration(contents.cost.build_seconds);
    let load = duration(contents.cost.seconds);
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
