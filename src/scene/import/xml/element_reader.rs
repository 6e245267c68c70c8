//! Typed access to one element, which remembers what was asked for.

mod children;
mod colours;

use std::path::PathBuf;

use crate::math::{Transform, Vec2, Vec3};

use super::diagnostics::Diagnostics;
use super::source::Location;
use super::suggest::did_you_mean;
use super::tree::{Element, ElementId, Property, PropertyValue, SceneTree};
use super::values::shown;

pub use colours::{ColourSource, ScalarSource};

/// A number, or a name that stands for one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NumberOrName<'a> {
    /// The number itself.
    Number(f32),
    /// The name of a substance, say.
    Name(&'a str),
}

/// Reads the properties and children of one element by name.
///
/// Names are in snake case. Getters note values of the wrong type and then behave as if the
/// property were absent. What no getter asked for is reported by [`ElementReader::finish`].
#[derive(Debug)]
pub struct ElementReader<'a> {
    tree: &'a SceneTree,
    element: &'a Element,
    problems: &'a Diagnostics,
    /// All names that were asked for: what "did you mean" can offer.
    asked: Vec<String>,
    used_properties: Vec<bool>,
    used_children: Vec<bool>,
}

impl<'a> ElementReader<'a> {
    pub(super) fn new(tree: &'a SceneTree, id: ElementId, problems: &'a Diagnostics) -> Self {
        let element = &tree[id];
        Self {
            tree,
            element,
            problems,
            asked: Vec::new(),
            used_properties: vec![false; element.properties.len()],
            used_children: vec![false; element.children.len()],
        }
    }

    /// The element itself.
    pub fn element(&self) -> &'a Element {
        self.element
    }

    /// The tree it is part of.
    pub fn tree(&self) -> &'a SceneTree {
        self.tree
    }

    /// Its plugin, in lower case.
    pub fn plugin(&self) -> &'a str {
        &self.element.plugin
    }

    /// True when the file gives a value of this name.
    pub fn has(&self, name: &str) -> bool {
        self.position(name).is_some()
    }

    /// A number, or `default`.
    pub fn float(&mut self, name: &str, default: f32) -> f32 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A number, if there is one.
    pub fn optional_float(&mut self, name: &str) -> Option<f32> {
        self.value(name, "a float", |value| match value {
            PropertyValue::Float(number) => Some(*number as f32),
            PropertyValue::Integer(number) => Some(*number as f32),
            _ => None,
        })
    }

    /// A number; its absence is an error.
    pub fn required_float(&mut self, name: &str) -> Option<f32> {
        self.note_absence(name);
        self.optional_float(name)
    }

    /// A number or a name that stands for one, if there is either.
    pub fn number_or_name(&mut self, name: &str) -> Option<NumberOrName<'a>> {
        self.value(name, "a float or a string", |value| match value {
            PropertyValue::Float(number) => Some(NumberOrName::Number(*number as f32)),
            PropertyValue::Integer(number) => Some(NumberOrName::Number(*number as f32)),
            PropertyValue::String(text) => Some(NumberOrName::Name(text)),
            _ => None,
        })
    }

    /// A whole number, or `default`.
    pub fn integer(&mut self, name: &str, default: i64) -> i64 {
        self.optional_integer(name).unwrap_or(default)
    }

    /// A whole number, if there is one. A float without a fraction is one too.
    pub fn optional_integer(&mut self, name: &str) -> Option<i64> {
        self.value(name, "an integer", |value| match value {
            PropertyValue::Integer(number) => Some(*number),
            PropertyValue::Float(number) if number.fract() == 0.0 => Some(*number as i64),
            _ => None,
        })
    }

    /// True or false, or `default`.
    pub fn boolean(&mut self, name: &str, default: bool) -> bool {
        self.optional_boolean(name).unwrap_or(default)
    }

    /// True or false, if it is said.
    pub fn optional_boolean(&mut self, name: &str) -> Option<bool> {
        self.value(name, "a boolean", |value| match value {
            PropertyValue::Boolean(flag) => Some(*flag),
            _ => None,
        })
    }

    /// A text, or `default`.
    pub fn string(&mut self, name: &str, default: &'a str) -> &'a str {
        self.optional_string(name).unwrap_or(default)
    }

    /// A text, if there is one.
    pub fn optional_string(&mut self, name: &str) -> Option<&'a str> {
        self.value(name, "a string", |value| match value {
            PropertyValue::String(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// A text; its absence is an error.
    pub fn required_string(&mut self, name: &str) -> Option<&'a str> {
        self.note_absence(name);
        self.optional_string(name)
    }

    /// One of `options`, ignoring letter case; `default` when absent. Another text is an error.
    pub fn choice<T: Clone>(&mut self, name: &str, options: &[(&str, T)], default: T) -> T {
        let Some(found) = self.optional_string(name) else {
            return default;
        };
        let word = found.trim();
        if let Some(option) = options
            .iter()
            .find(|option| option.0.eq_ignore_ascii_case(word))
        {
            return option.1.clone();
        }
        let words: Vec<&str> = options.iter().map(|option| option.0).collect();
        let hint = did_you_mean(word, words.iter().copied());
        let message = format!(
            "found {}, expected {}{hint}",
            shown(found),
            words.join(", ")
        );
        self.problems
            .error(&self.location_of(name), format!("\"{name}\": {message}"));
        default
    }

    /// A point or vector of three numbers, if there is one.
    pub fn vector3(&mut self, name: &str) -> Option<Vec3> {
        self.value(name, "a vector", |value| match value {
            PropertyValue::Vector(vector) => Some(vector.components),
            _ => None,
        })
    }

    /// A point or vector of two numbers, if there is one.
    pub fn vector2(&mut self, name: &str) -> Option<Vec2> {
        self.value(name, "a vector of two numbers", |value| match value {
            PropertyValue::Vector(vector) if vector.is_planar || vector.components.z == 0.0 => {
                Some(vector.components.truncate())
            }
            _ => None,
        })
    }

    /// A transform; the identity when absent.
    pub fn transform(&mut self, name: &str) -> Transform {
        self.optional_transform(name).unwrap_or_default()
    }

    /// A transform, if there is one.
    pub fn optional_transform(&mut self, name: &str) -> Option<Transform> {
        self.value(name, "a transform", |value| match value {
            PropertyValue::Transform(transform) => Some(**transform),
            _ => None,
        })
    }

    /// The file that a text property names, found on disk; absent or missing ones are errors.
    pub fn file(&mut self, name: &str) -> Option<PathBuf> {
        self.note_absence(name);
        self.optional_file(name)
    }

    /// The file that a text property names, found on disk; a missing one is an error.
    pub fn optional_file(&mut self, name: &str) -> Option<PathBuf> {
        let file = self.optional_string(name)?;
        self.tree
            .find_file(file, &self.location_of(name), self.problems)
    }

    /// Accepts properties that have no effect here, so that [`ElementReader::finish`] is silent.
    pub fn ignore(&mut self, names: &[&str]) {
        for name in names {
            self.find(name);
        }
    }

    /// Notes an error about the property `name`, or about the element when it is absent.
    pub fn error(&self, name: &str, message: impl Into<String>) {
        self.problems.error(&self.location_of(name), message);
    }

    /// Notes a warning about the property `name`, or about the element when it is absent.
    pub fn warning(&self, name: &str, message: impl Into<String>) {
        self.problems.warning(&self.location_of(name), message);
    }

    /// Notes that something stands in for what the property `name` says.
    pub fn replacement(&self, name: &str, message: impl Into<String>) {
        self.problems.replacement(&self.location_of(name), message);
    }

    /// Warns about every property and child that nobody asked for.
    pub fn finish(self) {
        let candidates = || self.asked.iter().map(String::as_str);
        let title = self.element.title();
        let unknown = |name: &str, location: &Location| {
            let hint = did_you_mean(name, candidates());
            let message = format!("unknown property \"{name}\" of {title}{hint}; ignored");
            self.problems.warning(location, message);
        };
        for (property, used) in self.element.properties.iter().zip(&self.used_properties) {
            if !used {
                unknown(&property.name.written, &property.location);
            }
        }
        for (child, used) in self.element.children.iter().zip(&self.used_children) {
            match &child.name {
                _ if *used => {}
                Some(name) if self.asked.contains(&name.normalised) => {
                    let kind = self.tree[child.element].kind;
                    let message =
                        format!("\"{}\" of {title} takes no {kind}; ignored", name.written);
                    self.problems.warning(&child.location, message);
                }
                Some(name) => unknown(&name.written, &child.location),
                None => {
                    let inner = self.tree[child.element].title();
                    let message = format!("{title} makes no use of {inner}; ignored");
                    self.problems.warning(&child.location, message);
                }
            }
        }
    }

    fn ask(&mut self, name: &str) {
        if !self.asked.iter().any(|asked| asked == name) {
            self.asked.push(name.to_owned());
        }
    }

    /// Finds a property and marks it as used.
    fn find(&mut self, name: &str) -> Option<&'a Property> {
        self.ask(name);
        let index = self.position(name)?;
        self.used_properties[index] = true;
        Some(&self.element.properties[index])
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.element
            .properties
            .iter()
            .position(|property| property.name.normalised == name)
    }

    /// Finds a property and reads it; notes a value that `read` does not take.
    fn value<T>(
        &mut self,
        name: &str,
        expected: &str,
        read: impl FnOnce(&'a PropertyValue) -> Option<T>,
    ) -> Option<T> {
        let property = self.find(name)?;
        let value = read(&property.value);
        if value.is_none() && property.value != PropertyValue::Invalid {
            let (written, found) = (&property.name.written, property.value.type_name());
            let message = format!("\"{written}\" is {found}, expected {expected}");
            self.problems.error(&property.location, message);
        }
        value
    }

    fn note_absence(&mut self, name: &str) {
        if self.find(name).is_none() {
            let message = format!("{} needs the property \"{name}\"", self.element.title());
            self.problems.error(&self.element.location, message);
        }
    }

    /// Where the property stands, or the element when it is absent.
    fn location_of(&self, name: &str) -> Location {
        let found = self
            .position(name)
            .map(|index| &self.element.properties[index].location);
        found.unwrap_or(&self.element.location).clone()
    }
}
