//! The attributes of one XML element, with parameters substituted.

use roxmltree::Node;

use super::diagnostics::Diagnostics;
use super::parameters::Parameters;
use super::source::{Location, Locator};
use super::suggest::did_you_mean;

/// One attribute.
pub(super) struct Attribute {
    name: String,
    pub(super) value: String,
    /// Where its value begins.
    pub(super) location: Location,
}

/// The attributes of one element. What nobody takes is reported by [`Attributes::finish`].
pub(super) struct Attributes {
    pub(super) tag: String,
    pub(super) location: Location,
    /// True when an attribute could not be substituted: that has been reported.
    pub(super) is_broken: bool,
    left: Vec<Attribute>,
    asked: Vec<&'static str>,
}

impl Attributes {
    pub(super) fn new(
        node: Node<'_, '_>,
        locator: &Locator<'_>,
        parameters: &mut Parameters,
    ) -> Self {
        let mut attributes = Self {
            tag: node.tag_name().name().to_owned(),
            location: locator.locate(node.range().start),
            is_broken: false,
            left: Vec::new(),
            asked: Vec::new(),
        };
        for attribute in node.attributes() {
            let location = locator.locate(attribute.range_value().start);
            match parameters.substitute(attribute.value(), &location) {
                Some(value) => {
                    let name = attribute.name().to_owned();
                    attributes.left.push(Attribute {
                        name,
                        value,
                        location,
                    });
                }
                None => attributes.is_broken = true,
            }
        }
        attributes
    }

    /// Takes an attribute that may be absent.
    pub(super) fn take(&mut self, name: &'static str) -> Option<Attribute> {
        self.asked.push(name);
        let index = self
            .left
            .iter()
            .position(|attribute| attribute.name == name)?;
        Some(self.left.remove(index))
    }

    /// Takes an attribute that must be there; notes when it is not.
    pub(super) fn require(
        &mut self,
        name: &'static str,
        problems: &Diagnostics,
    ) -> Option<Attribute> {
        let found = self.take(name);
        if found.is_none() && !self.is_broken {
            self.is_broken = true;
            let left = self.left.iter().map(|attribute| attribute.name.as_str());
            let near = did_you_mean(name, left);
            let hint = near.replace("did you mean", "found").replace("?)", ")");
            problems.error(
                &self.location,
                format!("<{}> needs the attribute \"{name}\"{hint}", self.tag),
            );
        }
        found
    }

    /// Takes an attribute and reads it; notes a value that cannot be read.
    pub(super) fn take_as<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&str) -> Result<T, String>,
        problems: &Diagnostics,
    ) -> Option<T> {
        let attribute = self.take(name)?;
        let value = read(&attribute.value);
        value
            .map_err(|message| self.note_bad(&attribute.location, &message, problems))
            .ok()
    }

    /// Takes an attribute that must be there and reads it; notes what is wrong.
    pub(super) fn require_as<T>(
        &mut self,
        name: &'static str,
        read: impl FnOnce(&str) -> Result<T, String>,
        problems: &Diagnostics,
    ) -> Option<T> {
        let attribute = self.require(name, problems)?;
        let value = read(&attribute.value);
        value
            .map_err(|message| self.note_bad(&attribute.location, &message, problems))
            .ok()
    }

    /// Warns about what was not taken.
    pub(super) fn finish(self, problems: &Diagnostics) {
        if self.is_broken {
            return;
        }
        for attribute in &self.left {
            let hint = did_you_mean(&attribute.name, self.asked.iter().copied());
            problems.warning(
                &attribute.location,
                format!(
                    "unknown attribute \"{}\" of <{}>{hint}; ignored",
                    attribute.name, self.tag
                ),
            );
        }
    }

    fn note_bad(&mut self, location: &Location, message: &str, problems: &Diagnostics) {
        self.is_broken = true;
        problems.error(location, message);
    }
}
