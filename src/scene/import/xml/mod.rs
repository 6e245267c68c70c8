//! The front end for Mitsuba scene files, versions 0.4 to 3.x: from XML text to a typed tree.
//!
//! Two stages. This module parses, substitutes `$name`, follows includes and refs, and types every
//! value; it knows the grammar of the format, but no plugin. Whoever builds a plugin asks its
//! [`ElementReader`] for properties by name; what nobody asked for is reported as unknown.
//!
//! All problems go into one [`Diagnostics`] and reading goes on, so that a user sees every mistake
//! of a file at once. The price: a tree may hold [`PropertyValue::Invalid`], which getters skip
//! silently because it has been reported.

mod attributes;
mod builder;
mod colour;
mod diagnostics;
mod directives;
mod element_reader;
mod files;
mod kinds;
mod names;
mod parameters;
mod properties;
mod references;
mod source;
mod suggest;
mod syntax;
mod transforms;
mod tree;
mod values;

#[cfg(test)]
mod tests;

pub use builder::{Document, ReadError, ReadOptions, read_file, read_string};
pub use colour::{Colour, ColourUse};
pub use diagnostics::{Diagnostic, Diagnostics, Severity, Strictness};
pub use element_reader::{ColourSource, ElementReader, NumberOrName, ScalarSource};
pub(super) use files::FileFinder;
pub use kinds::ElementKind;
pub use names::Name;
pub use source::{Location, Source};
pub use suggest::did_you_mean;
pub use tree::{
    Child, Element, ElementId, Property, PropertyValue, SceneTree, VectorValue, Version,
};
