//! The typed tree that a scene file becomes.

use std::fmt;
use std::ops::Index;
use std::path::PathBuf;

use crate::math::{Transform, Vec3};

use super::colour::Colour;
use super::diagnostics::Diagnostics;
use super::element_reader::ElementReader;
use super::files::FileFinder;
use super::kinds::ElementKind;
use super::names::Name;
use super::source::Location;

/// The version of the format that a file declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// 0 for the first generation, 2 and 3 for the second.
    pub major: u32,
    /// Second number.
    pub minor: u32,
    /// Third number.
    pub patch: u32,
}

impl Version {
    /// What a file without a version is read as.
    pub const LATEST: Self = Self {
        major: 3,
        minor: 0,
        patch: 0,
    };

    /// Reads `3`, `0.6` or `2.1.0`.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut numbers = text.trim().split('.').map(str::parse);
        let mut next = || numbers.next().unwrap_or(Ok(0)).ok();
        let version = Self {
            major: next()?,
            minor: next()?,
            patch: next()?,
        };
        numbers.next().is_none().then_some(version)
    }

    /// True for the first generation of the format (0.x), whose conventions differ.
    pub fn is_first_generation(self) -> bool {
        self.major < 2
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

/// An object of a [`SceneTree`]. Two references to one object have the same id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId(pub(super) u32);

/// One object of the file: a shape, a BSDF, …
#[derive(Clone, Debug)]
pub struct Element {
    /// What it is.
    pub kind: ElementKind,
    /// Its plugin in lower case, such as `diffuse`; empty for the scene.
    pub plugin: String,
    /// The name by which refs find it.
    pub id: Option<String>,
    /// Where it stands.
    pub location: Location,
    /// Its values, in the order of the file, each name once.
    pub properties: Vec<Property>,
    /// The objects inside it, refs included, in the order of the file.
    pub children: Vec<Child>,
}

impl Element {
    /// How messages call it: `bsdf "diffuse"`.
    pub fn title(&self) -> String {
        match self.kind {
            ElementKind::Scene => "the scene".to_owned(),
            kind => format!("{kind} \"{}\"", self.plugin),
        }
    }
}

/// A named value of an [`Element`].
#[derive(Clone, Debug)]
pub struct Property {
    /// Its name.
    pub name: Name,
    /// Where it stands.
    pub location: Location,
    /// Its value.
    pub value: PropertyValue,
}

/// A typed value.
#[derive(Clone, Debug, PartialEq)]
pub enum PropertyValue {
    /// `<boolean>`
    Boolean(bool),
    /// `<integer>`
    Integer(i64),
    /// `<float>`
    Float(f64),
    /// `<string>`
    String(String),
    /// `<point>` and `<vector>`
    Vector(VectorValue),
    /// `<transform>`
    Transform(Box<Transform>),
    /// `<rgb>`, `<srgb>`, `<spectrum>` and `<blackbody>`
    Colour(Colour),
    /// A value that could not be read and was reported.
    Invalid,
}

impl PropertyValue {
    /// What messages call a value of this type.
    pub(super) fn type_name(&self) -> &'static str {
        match self {
            Self::Boolean(_) => "a boolean",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a float",
            Self::String(_) => "a string",
            Self::Vector(_) => "a vector",
            Self::Transform(_) => "a transform",
            Self::Colour(_) => "a colour",
            Self::Invalid => "an invalid value",
        }
    }
}

/// A `<point>` or `<vector>` of two or three numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorValue {
    /// The numbers; missing ones are zero.
    pub components: Vec3,
    /// True when the file gives x and y only.
    pub is_planar: bool,
}

/// An object inside another.
#[derive(Clone, Debug)]
pub struct Child {
    /// The name of the slot it fills, if any.
    pub name: Option<Name>,
    /// Where it, or the ref to it, stands.
    pub location: Location,
    /// The object.
    pub element: ElementId,
}

/// All objects of a scene file and the files it includes. Free of cycles: an object is never inside
/// itself.
#[derive(Debug)]
pub struct SceneTree {
    pub(super) elements: Vec<Element>,
    pub(super) version: Version,
    pub(super) files: FileFinder,
}

impl SceneTree {
    /// The `<scene>` itself.
    pub fn root(&self) -> ElementId {
        ElementId(0)
    }

    /// The version that the root file declares.
    pub fn version(&self) -> Version {
        self.version
    }

    /// All objects in the order of the files, used or not.
    pub fn ids(&self) -> impl Iterator<Item = ElementId> + use<> {
        (0..self.elements.len() as u32).map(ElementId)
    }

    /// Starts reading the properties of `element`.
    pub fn reader<'a>(
        &'a self,
        element: ElementId,
        problems: &'a Diagnostics,
    ) -> ElementReader<'a> {
        ElementReader::new(self, element, problems)
    }

    /// Finds the file that `name` means at `location`; [`ElementReader::file`] is the usual way.
    ///
    /// Returns `None` after noting that it is missing. Another letter case than the disk's is a
    /// warning.
    pub fn find_file(
        &self,
        name: &str,
        location: &Location,
        problems: &Diagnostics,
    ) -> Option<PathBuf> {
        self.files.find_noted(name, location, problems)
    }
}

impl Index<ElementId> for SceneTree {
    type Output = Element;

    fn index(&self, id: ElementId) -> &Element {
        &self.elements[id.0 as usize]
    }
}
