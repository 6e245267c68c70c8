//! A glTF 2.0 file, text or binary, as a scene.
//!
//! Photometric units are taken as radiometric ones: a candela as 1 W·sr⁻¹, a lux as 1 W·m⁻², a nit as
//! 1 W·m⁻²·sr⁻¹. What the format has and this reader has not is told with a warning.

mod buffers;
mod materials;
mod meshes;
mod nodes;
mod ranges;
mod textures;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use gltf::Gltf;

use super::{Model, Surface};
use crate::image::Bitmap;
use crate::math::Mat4;
use crate::scene::GroupId;
use crate::scene::import::{ImportError, ImportOptions, Imported};
use crate::shape::mesh::MeshData;
use crate::texture::{MeshSurface, Texture};
use buffers::Buffers;

/// The extensions that are read.
const READ: [&str; 7] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_texture_transform",
];

/// A file under construction.
struct Asset<'g> {
    document: &'g gltf::Document,
    buffers: Buffers,
    /// By index; `None` for those that could not be read.
    images: HashMap<usize, Option<Arc<Bitmap>>>,
    /// By index of the material; `None` is the default one.
    surfaces: HashMap<Option<usize>, Surface>,
    /// How many nodes show a mesh.
    mesh_uses: HashMap<usize, usize>,
    /// Meshes that several nodes show.
    groups: HashMap<usize, Group>,
}

/// A mesh that several nodes show.
struct Group {
    /// What does not glow.
    id: Option<GroupId>,
    /// What does, with the index of its primitive.
    glowing: Vec<(MeshData, usize)>,
}

/// A mesh with colours of its own.
struct Carrier {
    surface: MeshSurface,
    colours: Texture,
}

/// Imports a glTF file; see [`crate::scene::import::import`].
pub(super) fn import(file: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let (mut model, bytes) = Model::open(file, options)?;
    match parsed(&bytes) {
        Ok(Gltf { document, blob }) => model.add_gltf(&document, blob),
        Err(message) => model.problems.error(&model.line(1), message),
    }
    model.finish()
}

/// Parses a file and checks what its parser takes for granted.
fn parsed(bytes: &[u8]) -> Result<Gltf, String> {
    let unsound = |error: gltf::Error| format!("not a sound glTF file: {error}");
    length_covers_its_header(bytes)?;
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(unsound)?;
    let json = document.into_json();
    version_is_read(&json.asset)?;
    nodes_are_a_forest(&json.nodes)?;
    for (mesh, of_mesh) in json.meshes.iter().enumerate() {
        for accessor in of_mesh
            .primitives
            .iter()
            .flat_map(|p| p.attributes.values())
        {
            if accessor.value() >= json.accessors.len() {
                let index = accessor.value();
                return Err(format!("mesh {mesh}: there is no accessor {index}"));
            }
        }
    }
    for (index, camera) in json.cameras.iter().enumerate() {
        if camera.perspective.is_none() && camera.orthographic.is_none() {
            return Err(format!(
                "camera {index} is neither perspective nor orthographic"
            ));
        }
    }
    let document = gltf::Document::from_json(json).map_err(unsound)?;
    Ok(Gltf { document, blob })
}

/// Refuses binary files that claim to be shorter than the header that says so, which gltf 1.4 takes from
/// their length unasked.
fn length_covers_its_header(bytes: &[u8]) -> Result<(), String> {
    const HEADER: u32 = 12;
    let (Some(b"glTF"), Some(length)) = (bytes.first_chunk(), bytes.get(8..12)) else {
        return Ok(());
    };
    let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]);
    if length < HEADER {
        return Err(format!(
            "not a sound glTF file: its header says that all of it has {length} bytes, expected \
             {HEADER} or more"
        ));
    }
    Ok(())
}

/// Refuses versions of the format other than 2.
fn version_is_read(asset: &gltf::json::Asset) -> Result<(), String> {
    let major = |version: &str| version.split('.').next() == Some("2");
    let least = asset.min_version.as_deref().unwrap_or("2.0");
    if major(&asset.version) && least == "2.0" {
        return Ok(());
    }
    let version = if major(&asset.version) {
        least
    } else {
        &asset.version
    };
    Err(format!(
        "found version {version:?} of glTF, expected \"2.0\""
    ))
}

/// Refuses nodes that are there more than once: a few lines could stand for more than fits memory.
fn nodes_are_a_forest(nodes: &[gltf::json::Node]) -> Result<(), String> {
    let mut parents = vec![None; nodes.len()];
    for (parent, node) in nodes.iter().enumerate() {
        for child in node.children.iter().flatten() {
            // Indices out of range are found later.
            let Some(known) = parents.get_mut(child.value()) else {
                continue;
            };
            if let Some(first) = known.replace(parent) {
                let child = child.value();
                return Err(format!(
                    "node {child} is a child of node {first} and again of node {parent}, expected one parent"
                ));
            }
        }
    }
    Ok(())
}

impl Model<'_> {
    fn add_gltf(&mut self, document: &gltf::Document, blob: Option<Vec<u8>>) {
        for extension in document.extensions_used() {
            if !READ.contains(&extension) {
                let message = format!("the extension {extension} is not read; ignored");
                self.problems.warning(&self.line(1), message);
            }
        }
        if document.animations().len() > 0 {
            let message = "animations are not read: all stands as at rest";
            self.problems.warning(&self.line(1), message);
        }
        self.note_ranges(document);
        let Some(buffers) = self.gltf_buffers(document, blob) else {
            return;
        };
        let mut mesh_uses = HashMap::new();
        for mesh in document.nodes().filter_map(|node| node.mesh()) {
            *mesh_uses.entry(mesh.index()).or_insert(0) += 1;
        }
        let mut asset = Asset {
            document,
            buffers,
            images: HashMap::new(),
            surfaces: HashMap::new(),
            mesh_uses,
            groups: HashMap::new(),
        };
        let scene = document
            .default_scene()
            .or_else(|| document.scenes().next());
        let Some(scene) = scene else {
            self.problems.error(&self.line(1), "the file has no scene");
            return;
        };
        for node in scene.nodes() {
            self.gltf_node(&mut asset, &node, Mat4::IDENTITY, 0);
        }
    }
}
