//! Scenes that are no Mitsuba files: models of other programs.
//!
//! What such a file does not say is made up, with a note: a camera that sees all of it, and light from
//! everywhere.

mod gltf;
mod images;
mod materials;
mod mtl;
mod obj;
mod view;

use std::path::Path;
use std::sync::Arc;

use xxhash_rust::xxh3::Xxh3;

use super::xml::{Diagnostics, FileFinder, Location, ReadError, Source};
use super::{ImportError, ImportOptions, Imported, IntegratorRequest, Stage, View};
use crate::bsdf::{Bsdf, Leaning};
use crate::emitter::Constant;
use crate::math::Rgb;
use crate::scene::{BsdfId, SceneBuilder};
use crate::shape::TriangleMesh;
use crate::texture::Texture;
use images::Images;

/// Imports a file; see [`super::import`].
type Importer = fn(&Path, &ImportOptions) -> Result<Imported, ImportError>;

/// The importer of a file that is no Mitsuba scene, by its extension.
pub(super) fn importer(file: &Path) -> Option<Importer> {
    let extension = file.extension()?.to_str()?.to_lowercase();
    match extension.as_str() {
        "obj" => Some(obj::import),
        "gltf" | "glb" => Some(gltf::import),
        _ => None,
    }
}

/// How bumps and normals of pictures lean: no eye sees a black rim.
const LEANING: Leaning = Leaning {
    shadowing: true,
    turning: true,
};

/// A material, and how meshes must be made for it.
#[derive(Clone)]
struct Surface {
    bsdf: BsdfId,
    /// What its front emits.
    radiance: Option<Texture>,
    follows_coordinates: bool,
}

/// A model under construction.
struct Model<'o> {
    options: &'o ImportOptions,
    problems: Diagnostics,
    builder: SceneBuilder,
    files: FileFinder,
    images: Images,
    views: Vec<View>,
    has_light: bool,
    hash: Xxh3,
    source: Arc<Source>,
}

impl<'o> Model<'o> {
    /// Starts a model, with the bytes of its file.
    ///
    /// # Errors
    /// [`ReadError::Io`] for a file that cannot be read, [`ImportError::Memory`] for one that there is no
    /// memory for.
    fn open(file: &Path, options: &'o ImportOptions) -> Result<(Self, Vec<u8>), ImportError> {
        let admitted = options.gauge.check_file(file, 0);
        admitted.map_err(|shortage| ImportError::short(file, shortage))?;
        let bytes = std::fs::read(file).map_err(|reason| ReadError::Io {
            path: file.to_owned(),
            reason,
        })?;
        let source = Source {
            path: file.to_owned(),
            order: 0,
        };
        let mut model = Self {
            options,
            problems: Diagnostics::new(options.read.strictness),
            builder: SceneBuilder::new(),
            files: FileFinder::new(source.folder(), &options.read.search_paths),
            images: Images::default(),
            views: Vec::new(),
            has_light: false,
            hash: Xxh3::new(),
            source: Arc::new(source),
        };
        model.builder.trace_with(options.engine);
        model.take_into_hash(&bytes);
        model.take_into_hash(format!("{:?}", options.film_size).as_bytes());
        for (name, _) in &options.read.definitions {
            let message = format!("the scene has no parameter \"{name}\"");
            model.problems.warning(&model.line(1), message);
        }
        Ok((model, bytes))
    }

    /// A line of the model's file.
    fn line(&self, line: usize) -> Location {
        line_of(&self.source, line)
    }

    /// Takes bytes that shape the picture into the hash.
    fn take_into_hash(&mut self, bytes: &[u8]) {
        // The length keeps one long file apart from two short ones.
        self.hash.update(&(bytes.len() as u64).to_le_bytes());
        self.hash.update(bytes);
    }

    /// Adds a mesh with its material; one that is flat or empty cannot glow, with a warning.
    fn add_mesh(&mut self, mut mesh: TriangleMesh, surface: &Surface, location: &Location) {
        if surface.follows_coordinates {
            mesh.follow_coordinates();
        }
        let radiance = surface.radiance.clone();
        self.has_light |= radiance.is_some();
        let added = self.builder.add_shape(mesh, surface.bsdf, radiance);
        if let Err(error) = added {
            self.problems.warning(location, error.to_string());
        }
    }

    /// Adds a material.
    fn add_surface(&mut self, made: MadeSurface) -> Surface {
        Surface {
            bsdf: self.builder.add_bsdf(made.bsdf),
            radiance: made.radiance,
            follows_coordinates: made.follows_coordinates,
        }
    }

    /// Builds the scene, with a camera and light where there are none.
    ///
    /// # Errors
    /// [`ImportError::Scene`] when a problem is an error, [`ImportError::Memory`] before memory runs out.
    fn finish(mut self) -> Result<Imported, ImportError> {
        let place = self.line(1);
        if !self.has_light {
            self.builder.add_emitter(Constant::new(Rgb::WHITE));
            let message = "the file has no light; white light from everywhere is used";
            self.problems.note(&place, message);
        }
        if self.problems.has_errors() {
            return Err(ImportError::Scene(self.problems.sorted()));
        }
        let file = &self.source.path;
        let checked = super::check_memory(&self.builder, &self.options.gauge);
        checked.map_err(|shortage| ImportError::short(file, shortage))?;
        self.options.progress.tell(Stage::Building);
        let built = self.builder.build();
        self.options.progress.tell(Stage::Built);
        let scene = match built {
            Ok(scene) => scene,
            Err(error) => {
                self.problems.error(&place, error.to_string());
                return Err(ImportError::Scene(self.problems.sorted()));
            }
        };
        if self.views.is_empty() {
            let made = view::of_all(&scene, self.options.film_size);
            match made {
                Ok(view) => self.views.push(view),
                Err(error) => self.problems.error(&place, error.to_string()),
            }
            let message = "the file has no camera; one that sees all of it is used";
            self.problems.note(&place, message);
        }
        if self.problems.has_errors() {
            return Err(ImportError::Scene(self.problems.sorted()));
        }
        Ok(Imported {
            scene,
            views: self.views,
            integrator: IntegratorRequest::default(),
            media: Vec::new(),
            warnings: self.problems.sorted(),
            hash: self.hash.digest(),
        })
    }
}

/// A material that is not yet in a scene.
struct MadeSurface {
    bsdf: Bsdf,
    radiance: Option<Texture>,
    follows_coordinates: bool,
}

/// What is wrong with a number that is not from 0 to `most`.
fn range(most: f32) -> &'static str {
    if most.is_finite() {
        "which is outside 0 to 1"
    } else {
        "which is negative"
    }
}

/// A line of a file.
fn line_of(source: &Arc<Source>, line: usize) -> Location {
    Location {
        source: Arc::clone(source),
        line: u32::try_from(line).unwrap_or(u32::MAX),
        column: 1,
    }
}
