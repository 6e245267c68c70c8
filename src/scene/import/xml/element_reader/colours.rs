//! Colours and numbers, and the textures that may stand in their place.

use super::super::colour::{Colour, ColourUse};
use super::super::kinds::ElementKind;
use super::super::tree::{ElementId, PropertyValue};
use super::ElementReader;
use crate::math::Rgb;

/// A colour or the texture that stands in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColourSource {
    /// The same everywhere.
    Constant(Rgb),
    /// An element of kind [`ElementKind::Texture`].
    Texture(ElementId),
}

/// A number or the texture that stands in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScalarSource {
    /// The same everywhere.
    Constant(f32),
    /// An element of kind [`ElementKind::Texture`].
    Texture(ElementId),
}

impl<'a> ElementReader<'a> {
    /// A colour, if there is one. A float is a grey; a number out of range is clamped with a
    /// warning.
    pub fn colour(&mut self, name: &str, wanted: ColourUse) -> Option<Rgb> {
        let resolved = self.value(name, "a colour", |value| match value {
            PropertyValue::Colour(colour) => Some(colour.resolve(wanted)),
            PropertyValue::Float(number) => Some(Rgb::grey(*number as f32)),
            PropertyValue::Integer(number) => Some(Rgb::grey(*number as f32)),
            _ => None,
        })?;
        let (high, range) = match wanted {
            ColourUse::Reflectance => (1.0, "outside 0 to 1"),
            ColourUse::Emission | ColourUse::Index => (f32::INFINITY, "negative"),
        };
        let clamped = resolved.clamp(0.0, high);
        if clamped != resolved {
            let [r, g, b] = resolved.to_array();
            let message = format!("\"{name}\" is {r}, {g}, {b}, which is {range}; clamped");
            self.problems.warning(&self.location_of(name), message);
        }
        Some(clamped)
    }

    /// A spectrum as the file writes it, for plugins that need more than a triple.
    pub fn symbolic_colour(&mut self, name: &str) -> Option<&'a Colour> {
        self.value(name, "a colour", |value| match value {
            PropertyValue::Colour(colour) => Some(colour),
            _ => None,
        })
    }

    /// A colour or a texture called `name`, if there is one.
    pub fn texture(&mut self, name: &str, wanted: ColourUse) -> Option<ColourSource> {
        match self.child_named(name, ElementKind::Texture) {
            Some(texture) => Some(ColourSource::Texture(texture)),
            None => self.colour(name, wanted).map(ColourSource::Constant),
        }
    }

    /// A number or a texture called `name`, if there is one.
    pub fn scalar_texture(&mut self, name: &str) -> Option<ScalarSource> {
        match self.child_named(name, ElementKind::Texture) {
            Some(texture) => Some(ScalarSource::Texture(texture)),
            None => self.optional_float(name).map(ScalarSource::Constant),
        }
    }
}
