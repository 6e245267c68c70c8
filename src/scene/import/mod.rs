//! Readers of scene descriptions and meshes.
//!
//! [`import`] reads a Mitsuba scene file of any generation into an [`Imported`]: the scene, its
//! views, and what the file asks of the integrator. All problems of the file are reported at once.

mod bitmaps;
mod bsdfs;
mod emitters;
mod integrators;
mod loader;
mod media;
pub mod mesh;
mod model;
mod progress;
mod shapes;
mod shortage;
mod textures;
mod views;
pub mod xml;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::options::Options;
use super::{BuildError, Scene, SceneBuilder};
use crate::accel::{AccelError, Engine};
use crate::film::{Filter, Window};
use crate::random::SamplerKind;
use crate::sensor::Sensor;
use loader::Loader;
pub use media::{Medium, Phase};
pub use progress::{Progress, Stage};
pub use shortage::{Gauge, Shortage};
use xml::{Diagnostic, ElementKind, Location};

/// How to import a scene.
#[derive(Clone, Debug, Default)]
pub struct ImportOptions {
    /// Definitions, search paths and strictness.
    pub read: xml::ReadOptions,
    /// Replaces width and height of every film, in pixels.
    pub film_size: Option<(u32, u32)>,
    /// The tracer that finds what rays meet.
    pub engine: Engine,
    /// Who is told how far it has come.
    pub progress: Progress,
    /// How much memory there is.
    pub gauge: Gauge,
}

/// A scene file, imported.
#[derive(Debug)]
pub struct Imported {
    /// Everything that light can meet.
    pub scene: Scene,
    /// The sensors with their films, in the order of the file; at least one.
    pub views: Vec<View>,
    /// What the file asks of the integrator.
    pub integrator: IntegratorRequest,
    /// The media of the file, which are not rendered.
    pub media: Vec<Medium>,
    /// Warnings, in the order of the file.
    pub warnings: Vec<Diagnostic>,
    /// Hash of the file, all files that it uses, and the definitions from the command line.
    pub hash: u64,
}

/// A sensor with what it records on.
#[derive(Clone, Debug)]
pub struct View {
    /// The sensor.
    pub sensor: Sensor,
    /// Width and height of the full film, in pixels.
    pub film_size: (u32, u32),
    /// The part of the film that is rendered.
    pub window: Window,
    /// Reconstruction filter.
    pub filter: Filter,
    /// How samples are spread.
    pub sampler: SamplerKind,
    /// Samples a pixel.
    pub sample_count: u32,
    /// Whether the film has an alpha channel.
    pub alpha: bool,
    /// Whether the film stores half floats; otherwise floats.
    pub half: bool,
}

/// What a scene file asks of the integrator.
#[derive(Clone, Debug, Default)]
pub struct IntegratorRequest {
    /// Name of the innermost integrator, as the file has it; empty when the file has none.
    pub name: String,
    /// Where it stands.
    pub location: Option<Location>,
    /// Its options.
    pub options: Options,
    /// Where each option stands.
    pub option_locations: BTreeMap<String, Location>,
    /// Names of the layers that an `aov` integrator around it asks for, in the file's own words.
    pub aovs: Vec<String>,
    /// Whether a `moment` integrator stands around it.
    pub second_moment: bool,
}

/// Why a scene was not imported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The scene file cannot be read.
    #[error(transparent)]
    Read(#[from] xml::ReadError),
    /// The file has errors.
    #[error("{}", all_of(.0))]
    Scene(Vec<Diagnostic>),
    /// There is not enough memory.
    #[error("{}: {shortage}", file.display())]
    Memory {
        /// The scene's file.
        file: PathBuf,
        /// What it needs, and what there is.
        shortage: Box<Shortage>,
    },
}

impl ImportError {
    /// There is not enough memory for a scene.
    fn short(file: &Path, shortage: Shortage) -> Self {
        Self::Memory {
            file: file.to_owned(),
            shortage: Box::new(shortage),
        }
    }
}

/// The diagnostics, a line each.
fn all_of(diagnostics: &[Diagnostic]) -> String {
    diagnostics
        .iter()
        .map(Diagnostic::to_string)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Reads a Mitsuba scene file of any generation, or a model: a Wavefront OBJ file (`.obj`).
///
/// Lengths are taken as metres, angles in the file are degrees, colours are linear Rec.709. Relative
/// file names are looked up from the folder of the file that holds them.
///
/// # Errors
/// [`ImportError::Read`] when `file` cannot be read; [`ImportError::Scene`] with all problems of the
/// file, warnings included, in the order of the file; [`ImportError::Memory`] before memory runs out.
pub fn import(file: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    if let Some(import_model) = model::importer(file) {
        return import_model(file, options);
    }
    let document = xml::read_file(file, &options.read)?;
    let mut loader = Loader::new(&document.tree, &document.problems, options);
    let (views, integrator) = loader.load(options);
    let short = |shortage| ImportError::short(file, shortage);
    if let Some(shortage) = std::mem::take(&mut loader.memory).into_shortage() {
        return Err(short(shortage));
    }
    let hash = loader.hash();
    let media = std::mem::take(&mut loader.media);
    let media = media.into_iter().map(|(_, medium)| medium).collect();
    if !document.problems.has_errors() {
        check_memory(&loader.builder, &options.gauge).map_err(short)?;
    }
    let scene = match loader.finish() {
        Some(scene) if !document.problems.has_errors() => scene,
        _ => return Err(ImportError::Scene(document.problems.sorted())),
    };
    let warnings = document.problems.sorted();
    Ok(Imported {
        scene,
        views,
        integrator,
        media,
        warnings,
        hash,
    })
}

/// Whether there is memory to build a scene.
///
/// # Errors
/// [`Shortage::Building`] where it runs short.
fn check_memory(builder: &SceneBuilder, gauge: &Gauge) -> Result<(), Shortage> {
    let needed = builder.needed_memory();
    let checked = gauge.check(needed.tree.peak);
    checked.map_err(|available| Shortage::Building { needed, available })
}

impl Loader<'_> {
    /// Builds everything that stands in the scene element.
    fn load(&mut self, options: &ImportOptions) -> (Vec<View>, IntegratorRequest) {
        let root = self.tree.root();
        // A file that could not be read to its end lacks things that it may well have.
        let is_whole = !self.problems.has_errors();
        let mut reader = self.reader(root);
        self.take_tree_into_hash(options);
        self.read_bitmaps_ahead();
        // Materials that no shape uses are read, too: their problems count.
        for bsdf in reader.children(ElementKind::Bsdf) {
            self.bsdf(bsdf);
        }
        let shapes = reader.children(ElementKind::Shape);
        self.read_meshes_ahead(&shapes);
        for shape in shapes {
            self.shape(shape);
        }
        let used_in_shapes = self.area_lights.clone();
        for emitter in reader.children(ElementKind::Emitter) {
            if !used_in_shapes.contains(&emitter) {
                self.emitter(emitter);
            }
        }
        let sensors = reader.children(ElementKind::Sensor);
        if sensors.is_empty() && is_whole {
            self.problems
                .error(self.location(root), "the scene has no sensor");
        }
        let views = sensors
            .into_iter()
            .filter_map(|id| self.view(id, options.film_size))
            .collect();
        let integrator = reader.child(ElementKind::Integrator);
        let integrator = integrator.map(|id| self.integrator(id)).unwrap_or_default();
        self.media_of(&mut reader);
        // Textures, films and the like at the top are only there to be referred to.
        for kind in [
            ElementKind::Film,
            ElementKind::ReconstructionFilter,
            ElementKind::Sampler,
            ElementKind::Texture,
            ElementKind::Phase,
            ElementKind::Volume,
        ] {
            reader.children(kind);
        }
        reader.finish();
        (views, integrator)
    }

    /// Takes what the file says into the hash, parameters from the command line included.
    fn take_tree_into_hash(&self, options: &ImportOptions) {
        for id in self.tree.ids() {
            let element = &self.tree[id];
            let properties = element
                .properties
                .iter()
                .map(|p| (&p.name.normalised, &p.value));
            let properties: Vec<_> = properties.collect();
            let children: Vec<_> = element.children.iter().map(|child| child.element).collect();
            let text = format!(
                "{:?} {} {properties:?} {children:?}",
                element.kind, element.plugin
            );
            self.take_into_hash(text.as_bytes());
        }
        self.take_into_hash(format!("{:?}", options.film_size).as_bytes());
    }

    /// Builds the scene; `None` after noting why there is none.
    fn finish(self) -> Option<Scene> {
        if self.problems.has_errors() {
            return None;
        }
        // The tracer counts what stands in the world, then members of groups, then instances.
        let in_shapes = self.shapes.iter().chain(&self.members);
        let mut elements = in_shapes.chain(&self.instances);
        let mut culprit = |error: &BuildError| match error {
            BuildError::Accel(AccelError::Geometry { index, .. }) => elements.nth(*index),
            _ => None,
        };
        self.progress.tell(Stage::Building);
        let built = self.builder.build();
        self.progress.tell(Stage::Built);
        built
            .map_err(|error| {
                let element = culprit(&error).copied().unwrap_or(self.tree.root());
                let location = &self.tree[element].location;
                self.problems.error(location, error.to_string());
            })
            .ok()
    }
}
