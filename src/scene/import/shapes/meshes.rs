//! Meshes from files, which all processors read at once before shapes are built.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use xxhash_rust::xxh3::xxh3_64;

use super::super::loader::Loader;
use super::super::mesh::serialized::SerializedFile;
use super::super::mesh::{ImportedMesh, obj, ply};
use super::super::progress::Stage;
use super::super::shortage::MemoryWatch;
use super::super::xml::{ElementId, ElementKind, ElementReader};
use super::groups::HOLDERS;
use crate::math::Mat4;
use crate::shape::mesh::{MeshAttribute, MeshData};
use crate::shape::{Shape, ShapeModel, TriangleMesh};

/// What an element asks of a mesh file.
#[derive(Clone)]
pub(in crate::scene::import) struct MeshRequest {
    format: Format,
    file: PathBuf,
    flip_tex_coords: bool,
    faceted: bool,
    max_smooth_angle: Option<f32>,
    to_world: Mat4,
    flip_normals: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
    /// With the index of a shape.
    Serialized(usize),
}

/// A mesh with what its file says beside it.
pub(in crate::scene::import) struct LoadedMesh {
    mesh: TriangleMesh,
    attributes: Vec<MeshAttribute>,
    warnings: Vec<String>,
}

/// Why there is no mesh.
#[derive(Clone)]
pub(in crate::scene::import) enum MeshFault {
    /// The file cannot be read.
    Unreadable(String),
    /// There is no memory for the file, as the loader's watch has noted.
    NoMemory,
    /// Something is wrong with a property, or with what it names.
    Broken(&'static str, String),
}

/// What came of reading a mesh.
pub(in crate::scene::import) type MeshOutcome = Result<LoadedMesh, MeshFault>;

/// A file's bytes with their hash.
type Hashed<T> = (u64, T);

impl Loader<'_> {
    /// Reads the mesh files of shapes, and of the members of groups among them.
    pub(in crate::scene::import) fn read_meshes_ahead(&mut self, shapes: &[ElementId]) {
        let mut requests = Vec::new();
        for id in shapes {
            self.request_meshes(*id, &mut requests);
        }
        self.open_serialized_files(&requests);
        let (done, all) = (AtomicUsize::new(0), requests.len());
        let (serialized, progress, memory) = (&self.serialized, &self.progress, &self.memory);
        let engine = self.builder.engine();
        let read = requests.into_par_iter().map(|(id, request)| {
            let loaded = match request.format {
                Format::Serialized(index) => {
                    let file = serialized.get(&request.file);
                    (
                        0,
                        file.map_or_else(
                            || unread(&request.file),
                            |file| request.of_serialized(file, index),
                        ),
                    )
                }
                _ => request.read(memory),
            };
            if let (_, Ok(loaded)) = &loaded {
                memory.note(loaded.mesh.geometry().build_memory(engine));
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.tell(Stage::Read { done, all });
            (id, loaded)
        });
        let read: Vec<(ElementId, Hashed<MeshOutcome>)> = read.collect();
        for (id, (hash, outcome)) in read {
            self.take_into_hash(&hash.to_le_bytes());
            self.meshes.insert(id, outcome);
        }
    }

    /// Gathers what a shape, or the members of a group, ask of mesh files.
    fn request_meshes(&self, id: ElementId, requests: &mut Vec<(ElementId, MeshRequest)>) {
        match self.tree[id].plugin.as_str() {
            "obj" | "ply" | "serialized" => {
                let request = mesh_request(&mut self.reader(id));
                requests.extend(request.map(|request| (id, request)));
            }
            "shapegroup" | "merge" => {
                for member in self.reader(id).children(ElementKind::Shape) {
                    // Groups hold no groups; one that does is told of when it is built.
                    if !HOLDERS.contains(&self.tree[member].plugin.as_str()) {
                        self.request_meshes(member, requests);
                    }
                }
            }
            _ => {}
        }
    }

    /// Reads serialized files that are not yet there, and takes them into the scene's hash.
    fn open_serialized_files(&mut self, requests: &[(ElementId, MeshRequest)]) {
        let mut files = Vec::new();
        for (_, request) in requests {
            let is_serialized = matches!(request.format, Format::Serialized(_));
            let is_known = self.serialized.contains_key(&request.file);
            if is_serialized && !is_known && !files.contains(&request.file) {
                files.push(request.file.clone());
            }
        }
        let memory = &self.memory;
        let read = files.into_par_iter().map(|file| {
            let opened = read_file(&file, memory).and_then(|(hash, bytes)| {
                let opened = SerializedFile::open(&file, bytes);
                let opened = opened.map_err(|error| broken(error.to_string()))?;
                Ok((hash, opened))
            });
            (file, opened)
        });
        let read: Vec<(PathBuf, Result<Hashed<SerializedFile>, MeshFault>)> = read.collect();
        for (file, opened) in read {
            let opened = opened.map(|(hash, opened)| {
                self.take_into_hash(&hash.to_le_bytes());
                opened
            });
            self.serialized.insert(file, opened);
        }
    }

    /// Builds the mesh of a file, or finds the one that was read ahead; `None` after noting why there
    /// is none.
    ///
    /// - `attributes`: takes those of the mesh.
    pub(super) fn mesh_file(
        &mut self,
        id: ElementId,
        reader: &mut ElementReader<'_>,
        attributes: &mut Vec<MeshAttribute>,
    ) -> Option<Shape> {
        // Known where it was read ahead; asked again for what the element has beside it.
        mesh_request(reader)?;
        if !self.meshes.contains_key(&id) {
            // What several refs name is read for each.
            self.read_meshes_ahead(&[id]);
        }
        match self.meshes.remove(&id)? {
            Ok(loaded) => {
                for warning in &loaded.warnings {
                    reader.warning("filename", warning);
                }
                *attributes = loaded.attributes;
                Some(loaded.mesh.into())
            }
            Err(MeshFault::Unreadable(message)) => {
                let location = &reader.element().location;
                self.problems.unsupported(location, message, "left out");
                None
            }
            Err(MeshFault::NoMemory) => None,
            Err(MeshFault::Broken(property, message)) => {
                reader.error(property, message);
                None
            }
        }
    }
}

/// What an element asks of a mesh file; `None` after noting why it asks for none.
fn mesh_request(reader: &mut ElementReader<'_>) -> Option<MeshRequest> {
    let plugin = reader.plugin();
    let to_world = reader.transform("to_world").matrix();
    let flip_normals = reader.boolean("flip_normals", false);
    let faceted = reader.boolean("face_normals", false);
    let max_smooth_angle = reader.optional_float("max_smooth_angle");
    let flip_tex_coords = reader.boolean("flip_tex_coords", plugin == "obj");
    let index = reader.integer("shape_index", 0);
    let file = reader.file("filename")?;
    let format = match plugin {
        "obj" => Format::Obj,
        "ply" => Format::Ply,
        _ => {
            let Ok(index) = usize::try_from(index) else {
                let message = format!("\"shape_index\" is {index}, expected 0 or more");
                reader.error("shape_index", message);
                return None;
            };
            Format::Serialized(index)
        }
    };
    Some(MeshRequest {
        format,
        file,
        flip_tex_coords,
        faceted,
        max_smooth_angle,
        to_world,
        flip_normals,
    })
}

impl MeshRequest {
    /// Reads a file that holds one mesh.
    fn read(&self, memory: &MemoryWatch) -> Hashed<MeshOutcome> {
        let (hash, bytes) = match read_file(&self.file, memory) {
            Ok(read) => read,
            Err(fault) => return (0, Err(fault)),
        };
        let parsed = match self.format {
            Format::Obj => obj::parse(&bytes, self.flip_tex_coords),
            _ => ply::parse(&bytes, self.flip_tex_coords),
        };
        let file = self.file.display();
        let parsed = parsed.map_err(|problem| broken(format!("{file}: {problem}")));
        (hash, parsed.and_then(|mesh| self.finish(mesh)))
    }

    /// Takes a shape of a file that holds several.
    fn of_serialized(&self, file: &Result<SerializedFile, MeshFault>, index: usize) -> MeshOutcome {
        let mesh = file.as_ref().map_err(MeshFault::clone)?.mesh(index);
        self.finish(mesh.map_err(|error| broken(error.to_string()))?)
    }

    fn finish(&self, imported: ImportedMesh) -> MeshOutcome {
        let mut data = imported.data;
        if self.faceted || imported.face_normals {
            data.remove_normals();
        } else if let Some(angle) = self.max_smooth_angle {
            data.apply_max_smooth_angle(angle);
        } else if data.normals.is_none() {
            data.compute_vertex_normals();
        }
        let attributes = std::mem::take(&mut data.attributes);
        let mesh = placed(data, self.to_world, self.flip_normals);
        Ok(LoadedMesh {
            mesh: mesh.map_err(|message| MeshFault::Broken("to_world", message))?,
            attributes,
            warnings: imported.warnings,
        })
    }
}

/// A mesh where it stands in the world.
///
/// # Errors
/// What the transform makes unsound.
pub(super) fn placed(
    mut data: MeshData,
    to_world: Mat4,
    flip_normals: bool,
) -> Result<TriangleMesh, String> {
    data.transform(to_world);
    if flip_normals {
        data.flip_normals();
    }
    let validated = data.validate();
    validated.map_err(|flaw| format!("after the transform, {flaw}"))?;
    Ok(data.into())
}

fn read_file(file: &Path, memory: &MemoryWatch) -> Result<Hashed<Vec<u8>>, MeshFault> {
    if !memory.admits(file) {
        return Err(MeshFault::NoMemory);
    }
    let read = std::fs::read(file).map_err(|reason| {
        MeshFault::Unreadable(format!("cannot read {}: {reason}", file.display()))
    });
    read.map(|bytes| (xxh3_64(&bytes), bytes))
}

fn broken(message: String) -> MeshFault {
    MeshFault::Broken("filename", message)
}

fn unread(file: &Path) -> MeshOutcome {
    Err(MeshFault::Unreadable(format!(
        "cannot read {}",
        file.display()
    )))
}
