//! What the readers of all kinds of elements share.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use xxhash_rust::xxh3::Xxh3;

use super::bitmaps::Outcome;
use super::media::Medium;
use super::mesh::serialized::SerializedFile;
use super::shapes::{MeshFault, MeshOutcome};
use super::shortage::MemoryWatch;
use super::textures::Carrier;
use super::xml::{Diagnostics, ElementId, ElementReader, Location, SceneTree, did_you_mean};
use super::{ImportOptions, Progress};
use crate::image::Bitmap;
use crate::scene::{BsdfId, GroupId, SceneBuilder};
use crate::texture::Texture;

/// The state of building a scene from its tree.
///
/// Objects that several others refer to are built once.
pub(super) struct Loader<'t> {
    pub(super) tree: &'t SceneTree,
    pub(super) problems: &'t Diagnostics,
    pub(super) builder: SceneBuilder,
    /// Where the shapes, the members of groups and the instances of the builder come from, in their
    /// order.
    pub(super) shapes: Vec<ElementId>,
    pub(super) members: Vec<ElementId>,
    pub(super) instances: Vec<ElementId>,
    /// The groups that were built; `None` for one without shapes.
    pub(super) groups: HashMap<ElementId, Option<GroupId>>,
    pub(super) bsdfs: HashMap<ElementId, BsdfId>,
    pub(super) textures: HashMap<ElementId, Option<Texture>>,
    /// Serialized files by name, and the meshes of elements that were read ahead.
    pub(super) serialized: HashMap<PathBuf, Result<SerializedFile, MeshFault>>,
    pub(super) meshes: HashMap<ElementId, MeshOutcome>,
    pub(super) progress: Progress,
    pub(super) memory: MemoryWatch,
    /// Pictures by file, as decoded; those that were read ahead and wait for their use.
    pub(super) bitmaps: HashMap<PathBuf, Option<Arc<Bitmap>>>,
    pub(super) decoded: HashMap<PathBuf, Outcome>,
    /// The material of shapes that name none.
    pub(super) default_bsdfs: [Option<BsdfId>; 2],
    /// The light that surrounds the scene.
    pub(super) environment: Option<ElementId>,
    /// The emitters that stand inside shapes, or that shapes refer to.
    pub(super) area_lights: HashSet<ElementId>,
    /// The media that were read.
    pub(super) media: Vec<(ElementId, Medium)>,
    /// Whether the material under construction asks how positions change with texture coordinates,
    /// and those that do.
    pub(super) follows_coordinates: bool,
    pub(super) needs_derivatives: HashSet<BsdfId>,
    /// Whether the material under construction has textures, and those that do.
    pub(super) has_textures: bool,
    pub(super) textured: HashSet<BsdfId>,
    /// The mesh that the material under construction is for, where that asks for its attributes.
    pub(super) carrier: Option<Carrier>,
    hash: RefCell<Xxh3>,
}

impl<'t> Loader<'t> {
    pub(super) fn new(
        tree: &'t SceneTree,
        problems: &'t Diagnostics,
        options: &ImportOptions,
    ) -> Self {
        let mut builder = SceneBuilder::new();
        builder.trace_with(options.engine);
        Self {
            tree,
            problems,
            builder,
            shapes: Vec::new(),
            members: Vec::new(),
            instances: Vec::new(),
            groups: HashMap::new(),
            bsdfs: HashMap::new(),
            textures: HashMap::new(),
            serialized: HashMap::new(),
            meshes: HashMap::new(),
            progress: options.progress.clone(),
            memory: MemoryWatch::new(options.gauge.clone()),
            bitmaps: HashMap::new(),
            decoded: HashMap::new(),
            default_bsdfs: [None; 2],
            environment: None,
            area_lights: HashSet::new(),
            media: Vec::new(),
            follows_coordinates: false,
            needs_derivatives: HashSet::new(),
            has_textures: false,
            textured: HashSet::new(),
            carrier: None,
            hash: RefCell::new(Xxh3::new()),
        }
    }

    /// Starts reading an element.
    pub(super) fn reader(&self, id: ElementId) -> ElementReader<'t> {
        self.tree.reader(id, self.problems)
    }

    /// Where an element stands.
    pub(super) fn location(&self, id: ElementId) -> &'t Location {
        &self.tree[id].location
    }

    /// Reads a file that the scene uses, and takes it into the scene's hash; a file that cannot be
    /// read, or that there is no memory for, is noted.
    pub(super) fn read_bytes(&self, file: &Path, location: &Location) -> Option<Vec<u8>> {
        if !self.memory.admits(file) {
            return None;
        }
        match std::fs::read(file) {
            Ok(bytes) => {
                self.take_into_hash(&bytes);
                Some(bytes)
            }
            Err(reason) => {
                let message = format!("cannot read {}: {reason}", file.display());
                self.problems.unsupported(location, message, "left out");
                None
            }
        }
    }

    /// Takes bytes that shape the picture into the scene's hash.
    pub(super) fn take_into_hash(&self, bytes: &[u8]) {
        let mut hash = self.hash.borrow_mut();
        // The length keeps one long file apart from two short ones.
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    }

    /// The hash of all that was taken into it.
    pub(super) fn hash(&self) -> u64 {
        self.hash.borrow().digest()
    }

    /// Notes a plugin that this reader does not know.
    ///
    /// - `known`: the plugins it knows, for "did you mean".
    /// - `instead`: what happens under `--lenient`.
    pub(super) fn unknown_plugin<'k>(
        &self,
        id: ElementId,
        known: impl IntoIterator<Item = &'k str>,
        instead: &str,
    ) {
        let element = &self.tree[id];
        let hint = did_you_mean(&element.plugin, known);
        let message = format!("unknown {}{hint}", element.title());
        self.problems
            .unsupported(&element.location, message, instead);
    }
}
