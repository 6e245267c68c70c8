//! From XML text to a [`SceneTree`]: files, includes, parameters, objects.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roxmltree::{Node, ParsingOptions};
use thiserror::Error;

use super::attributes::Attributes;
use super::diagnostics::{Diagnostics, Strictness};
use super::files::FileFinder;
use super::kinds::ElementKind;
use super::names::Name;
use super::parameters::Parameters;
use super::properties;
use super::references::{DraftChild, Ids, Target};
use super::source::{Location, Locator, Source};
use super::suggest::did_you_mean;
use super::syntax;
use super::tree::{Element, ElementId, Property, SceneTree, Version};
use super::values::shown;

/// Objects or files nested deeper than this are refused, so that no reader of the tree runs out of
/// stack.
pub(super) const DEEPEST: usize = 100;

/// Materials and textures that hold more objects than this are refused, each counted as often as it is
/// referred to: they are copied as often, so a few lines of refs to refs could fill all memory.
pub(super) const MOST_PARTS: usize = 10_000;

/// How to read a scene.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Values of `$name` that win over `<default>` (`-D name=value`).
    pub definitions: Vec<(String, String)>,
    /// Further folders to look for files in (`-a`).
    pub search_paths: Vec<PathBuf>,
    /// How severely problems are judged.
    pub strictness: Strictness,
}

/// A scene that was read, with everything that was wrong with it.
#[derive(Debug)]
pub struct Document {
    /// The objects.
    pub tree: SceneTree,
    /// The problems so far; whoever builds objects from the tree adds to them.
    pub problems: Diagnostics,
}

/// Why there is nothing to read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The scene file does not exist or is not readable.
    #[error("cannot read {}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
}

/// Reads a scene file of version 0.4 to 3.x and what it includes.
///
/// # Errors
/// Only a `file` that cannot be read. Everything else is in [`Document::problems`].
pub fn read_file(file: &Path, options: &ReadOptions) -> Result<Document, ReadError> {
    match std::fs::read(file) {
        Ok(bytes) => Ok(Builder::new(file, options).build(file, &bytes)),
        Err(reason) => Err(ReadError::Io {
            path: file.to_path_buf(),
            reason,
        }),
    }
}

/// Reads a scene from `text` as if it stood in the file `name`.
pub fn read_string(name: &str, text: &str, options: &ReadOptions) -> Document {
    let file = Path::new(name);
    Builder::new(file, options).build(file, text.as_bytes())
}

/// The state of reading.
pub(super) struct Builder {
    pub(super) problems: Diagnostics,
    pub(super) parameters: Parameters,
    pub(super) files: FileFinder,
    pub(super) elements: Vec<Element>,
    /// The children of each element before refs are resolved.
    pub(super) drafts: Vec<Vec<DraftChild>>,
    pub(super) ids: Ids,
    /// The files being read, outermost first: as shown, and as the disk knows them.
    pub(super) open: Vec<(PathBuf, PathBuf)>,
    sources: usize,
}

/// The file an XML node stands in.
pub(super) struct FileContext<'t> {
    pub(super) locator: Locator<'t>,
    pub(super) version: Version,
}

impl Builder {
    fn new(file: &Path, options: &ReadOptions) -> Self {
        let folder = file.parent().unwrap_or(Path::new(""));
        Self {
            problems: Diagnostics::new(options.strictness),
            parameters: Parameters::new(&options.definitions),
            files: FileFinder::new(folder, &options.search_paths),
            elements: Vec::new(),
            drafts: Vec::new(),
            ids: Ids::default(),
            open: Vec::new(),
            sources: 0,
        }
    }

    fn build(mut self, file: &Path, bytes: &[u8]) -> Document {
        let source = Arc::new(Source {
            path: file.to_path_buf(),
            order: 0,
        });
        let root = self.add(Element {
            kind: ElementKind::Scene,
            plugin: String::new(),
            id: None,
            location: Location {
                source,
                line: 1,
                column: 1,
            },
            properties: Vec::new(),
            children: Vec::new(),
        });
        let version = self
            .read_source(file, bytes, root, None)
            .unwrap_or(Version::LATEST);
        self.parameters.report(&self.problems);
        self.resolve_references();
        let Self {
            elements,
            files,
            problems,
            ..
        } = self;
        Document {
            tree: SceneTree {
                elements,
                version,
                files,
            },
            problems,
        }
    }

    /// Reads one file into `parent`. Returns its version, `None` when it is not readable as XML.
    pub(super) fn read_source(
        &mut self,
        file: &Path,
        bytes: &[u8],
        parent: ElementId,
        inherited: Option<Version>,
    ) -> Option<Version> {
        let source = Arc::new(Source {
            path: file.to_path_buf(),
            order: self.sources,
        });
        self.sources += 1;
        if let Some(format) = syntax::other_format(bytes) {
            let start = Locator::new(source, "").locate(0);
            self.problems
                .error(&start, format!("found {format}, expected a scene as XML"));
            return None;
        }
        let (text, is_utf8) = syntax::decode(bytes);
        let locator = Locator::new(source, &text);
        if !is_utf8 {
            self.problems
                .warning(&locator.locate(0), "the file is not UTF-8; read as Latin-1");
        }
        let options = ParsingOptions {
            allow_dtd: true,
            ..ParsingOptions::default()
        };
        let document = match roxmltree::Document::parse_with_options(&text, options) {
            Ok(document) => document,
            Err(error) => {
                let (location, message) = syntax::explain(&error, &locator);
                self.problems.error(&location, message);
                return None;
            }
        };
        let canonical = file.canonicalize().unwrap_or_else(|_| file.to_path_buf());
        self.open.push((file.to_path_buf(), canonical));
        let node = document.root_element();
        let mut context = FileContext {
            locator,
            version: inherited.unwrap_or(Version::LATEST),
        };
        if node.tag_name().name().eq_ignore_ascii_case("scene") {
            context.version = self.scene_version(node, &context, inherited);
            if inherited.is_none() {
                self.elements[0].location = context.locator.locate(node.range().start);
            }
            self.children(node, parent, &context, 1);
        } else if inherited.is_some() {
            self.child(node, parent, &context, 1);
        } else {
            let found = node.tag_name().name();
            let location = context.locator.locate(node.range().start);
            self.problems
                .error(&location, format!("found <{found}>, expected <scene>"));
        }
        self.open.pop();
        Some(context.version)
    }

    fn scene_version(
        &mut self,
        node: Node<'_, '_>,
        file: &FileContext<'_>,
        inherited: Option<Version>,
    ) -> Version {
        let mut attributes = self.attributes(node, file);
        let read = |text: &str| {
            let version = Version::parse(text);
            version.ok_or_else(|| format!("found {}, expected a version like 3.0.0", shown(text)))
        };
        let found = attributes.take_as("version", read, &self.problems);
        let location = &attributes.location;
        if let Some(version) = found.filter(|version| version.major > Version::LATEST.major) {
            let message = format!("version {version} is newer than {}", Version::LATEST);
            self.problems.warning(location, message);
        } else if found.is_none() && inherited.is_none() && !attributes.is_broken {
            let message = format!("the scene gives no version; read as {}", Version::LATEST);
            self.problems.warning(location, message);
        }
        attributes.finish(&self.problems);
        found.or(inherited).unwrap_or(Version::LATEST)
    }

    /// The attributes of `node` with parameters substituted.
    pub(super) fn attributes(&mut self, node: Node<'_, '_>, file: &FileContext<'_>) -> Attributes {
        Attributes::new(node, &file.locator, &mut self.parameters)
    }

    /// Reads everything inside `node` into `parent`.
    fn children(
        &mut self,
        node: Node<'_, '_>,
        parent: ElementId,
        file: &FileContext<'_>,
        depth: usize,
    ) {
        for inner in node.children() {
            if inner.is_element() {
                self.child(inner, parent, file, depth);
            } else if let Some(text) = inner
                .text()
                .filter(|text| inner.is_text() && !is_blank(text))
            {
                let blank = text.len() - text.trim_start().len();
                let location = file.locator.locate(inner.range().start + blank);
                let message = format!("stray text {}; ignored", shown(text.trim()));
                self.problems.warning(&location, message);
            }
        }
    }

    /// Reads one element into `parent`.
    fn child(
        &mut self,
        node: Node<'_, '_>,
        parent: ElementId,
        file: &FileContext<'_>,
        depth: usize,
    ) {
        let location = file.locator.locate(node.range().start);
        if depth > DEEPEST {
            let message = format!("elements are nested more than {DEEPEST} deep");
            return self.problems.error(&location, message);
        }
        let tag = node.tag_name().name().to_ascii_lowercase();
        match tag.as_str() {
            "default" => self.default(node, file),
            "include" => self.include(node, parent, file),
            "path" => self.path(node, file),
            "alias" => self.alias(node, file),
            "ref" => self.reference(node, parent, file),
            tag if properties::TAGS.contains(&tag) => {
                if let Some(property) = self.property(tag, node, file) {
                    self.claim_name(parent, &property.name, &property.location);
                    self.elements[parent.0 as usize].properties.push(property);
                }
            }
            tag => match ElementKind::from_tag(tag) {
                Some(kind) if kind != ElementKind::Scene => {
                    self.object(kind, node, parent, file, depth);
                }
                _ => {
                    let written = node.tag_name().name();
                    let known = ElementKind::tags().chain(properties::TAGS.iter().copied());
                    let known = known.chain(["default", "include", "path", "alias", "ref"]);
                    let hint = did_you_mean(written, known.filter(|known| *known != "scene"));
                    let message = format!("unknown element <{written}>{hint}; ignored");
                    self.problems.warning(&location, message);
                }
            },
        }
    }

    fn object(
        &mut self,
        kind: ElementKind,
        node: Node<'_, '_>,
        parent: ElementId,
        file: &FileContext<'_>,
        depth: usize,
    ) {
        let mut attributes = self.attributes(node, file);
        let plugin = attributes.require("type", &self.problems);
        let id = attributes.take("id");
        let name = attributes.take("name").map(|name| Name::new(name.value));
        let location = attributes.location.clone();
        attributes.finish(&self.problems);
        let element = self.add(Element {
            kind,
            plugin: plugin
                .as_ref()
                .map_or_else(String::new, |p| p.value.trim().to_lowercase()),
            id: id.as_ref().map(|id| id.value.clone()),
            location: location.clone(),
            properties: Vec::new(),
            children: Vec::new(),
        });
        let target = plugin.map(|_| element);
        if let Some(id) = id {
            self.declare(&id.value, target, &location);
        }
        self.children(node, element, file, depth + 1);
        // An object whose type is missing has been reported; nothing can be built from it.
        let Some(element) = target else { return };
        let holder = &self.elements[parent.0 as usize];
        if !holder.kind.allowed_children().contains(&kind) {
            let message = format!("{} holds no {kind}; ignored", holder.title());
            return self.problems.warning(&location, message);
        }
        let is_value = matches!(kind, ElementKind::Texture | ElementKind::Volume);
        if let Some(name) = name.as_ref().filter(|_| is_value) {
            self.claim_name(parent, name, &location);
        }
        let child = DraftChild {
            name,
            location,
            target: Target::Element(element),
        };
        self.drafts[parent.0 as usize].push(child);
    }

    fn add(&mut self, element: Element) -> ElementId {
        let id = ElementId(self.elements.len() as u32);
        self.elements.push(element);
        self.drafts.push(Vec::new());
        id
    }

    /// Makes room for a value called `name`: of two with one name the last one counts.
    fn claim_name(&mut self, parent: ElementId, name: &Name, location: &Location) {
        let same = |other: &Name| other.normalised == name.normalised;
        let properties: &mut Vec<Property> = &mut self.elements[parent.0 as usize].properties;
        let children = &mut self.drafts[parent.0 as usize];
        let before = properties.len() + children.len();
        properties.retain(|property| !same(&property.name));
        children.retain(|child| !child.name.as_ref().is_some_and(same));
        if properties.len() + children.len() < before {
            let message = format!("\"{}\" is given twice; the last one counts", name.written);
            self.problems.warning(location, message);
        }
    }
}

fn is_blank(text: &str) -> bool {
    text.trim().is_empty()
}
