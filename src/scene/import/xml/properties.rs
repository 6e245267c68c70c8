//! Elements that hold one value: `<float>`, `<rgb>`, `<transform>`, …

use roxmltree::Node;

use crate::math::{Rgb, Vec3};

use super::attributes::{Attribute, Attributes};
use super::builder::{Builder, FileContext};
use super::colour::{self, Colour};
use super::names::Name;
use super::source::Location;
use super::suggest::did_you_mean;
use super::tree::{Property, PropertyValue, VectorValue};
use super::values::{self, shown};

/// Tags that hold a value.
pub(super) const TAGS: &[&str] = &[
    "boolean",
    "integer",
    "float",
    "string",
    "point",
    "vector",
    "transform",
    "animation",
    "rgb",
    "srgb",
    "spectrum",
    "blackbody",
];

/// Spectra that are written as an object of their own.
const SPECTRUM_TYPES: [&str; 5] = ["blackbody", "uniform", "regular", "irregular", "d65"];

impl Builder {
    /// Reads a property. Returns `None` when it has no name; other problems make it
    /// [`PropertyValue::Invalid`]. Both have been noted then.
    pub(super) fn property(
        &mut self,
        tag: &str,
        node: Node<'_, '_>,
        file: &FileContext<'_>,
    ) -> Option<Property> {
        let mut attributes = self.attributes(node, file);
        let name = attributes.require("name", &self.problems);
        let value = match tag {
            "transform" => self
                .transform(node, file)
                .map(|t| PropertyValue::Transform(Box::new(t))),
            "animation" => self.animation(node, file),
            "spectrum" => self
                .spectrum(&mut attributes, node, file)
                .map(PropertyValue::Colour),
            _ => self.plain_value(tag, &mut attributes, node, file),
        };
        // Some values are fine without what a broken attribute would have said, but not as meant.
        let value = value
            .filter(|_| !attributes.is_broken)
            .unwrap_or(PropertyValue::Invalid);
        let location = attributes.location.clone();
        attributes.finish(&self.problems);
        Some(Property {
            name: Name::new(name?.value),
            location,
            value,
        })
    }

    fn plain_value(
        &mut self,
        tag: &str,
        attributes: &mut Attributes,
        node: Node<'_, '_>,
        file: &FileContext<'_>,
    ) -> Option<PropertyValue> {
        if let Some(inner) = node.children().find(Node::is_element) {
            let location = file.locator.locate(inner.range().start);
            let inner = inner.tag_name().name();
            let message = format!("<{tag}> holds no <{inner}>; ignored");
            self.problems.warning(&location, message);
        }
        let problems = &self.problems;
        Some(match tag {
            "boolean" => {
                PropertyValue::Boolean(attributes.require_as("value", values::boolean, problems)?)
            }
            "integer" => {
                PropertyValue::Integer(attributes.require_as("value", values::integer, problems)?)
            }
            "float" => {
                PropertyValue::Float(attributes.require_as("value", values::float, problems)?)
            }
            "string" => PropertyValue::String(attributes.require("value", problems)?.value),
            "point" | "vector" => PropertyValue::Vector(self.vector(attributes)?),
            "rgb" => {
                PropertyValue::Colour(attributes.require_as("value", colour::rgb, problems)?)
            }
            "srgb" => {
                PropertyValue::Colour(attributes.require_as("value", colour::srgb, problems)?)
            }
            _ => PropertyValue::Colour(self.blackbody(attributes)?),
        })
    }

    /// `value` (two or three numbers), or x, y and z, where absent ones are zero.
    fn vector(&self, attributes: &mut Attributes) -> Option<VectorValue> {
        if let Some(whole) = attributes.take_as("value", values::vector, &self.problems) {
            return Some(whole);
        }
        let mut axis = |name| attributes.take_as(name, values::float, &self.problems);
        let (x, y, z) = (axis("x"), axis("y"), axis("z"));
        if x.is_none() && y.is_none() && z.is_none() && !attributes.is_broken {
            let message = format!("<{}> needs x, y and z, or a \"value\"", attributes.tag);
            self.problems.error(&attributes.location, message);
            return None;
        }
        let number = |axis: Option<f64>| axis.unwrap_or(0.0) as f32;
        let components = Vec3::new(number(x), number(y), number(z));
        Some(VectorValue {
            components,
            is_planar: z.is_none(),
        })
    }

    /// The first step of an `<animation>`: time stands still here.
    fn animation(&mut self, node: Node<'_, '_>, file: &FileContext<'_>) -> Option<PropertyValue> {
        let location = file.locator.locate(node.range().start);
        let mut steps = node
            .children()
            .filter(|inner| inner.tag_name().name() == "transform");
        let Some(first) = steps.next() else {
            self.problems
                .error(&location, "<animation> needs a <transform>");
            return None;
        };
        let message = "animation is not supported; its first transform is used";
        self.problems.warning(&location, message);
        self.transform(first, file)
            .map(|transform| PropertyValue::Transform(Box::new(transform)))
    }

    fn blackbody(&self, attributes: &mut Attributes) -> Option<Colour> {
        let kelvin = |text: &str| {
            let text = text.trim();
            values::float(text.strip_suffix(['K', 'k']).unwrap_or(text))
        };
        let temperature = attributes.require_as("temperature", kelvin, &self.problems);
        let scale = attributes
            .take_as("scale", values::float, &self.problems)
            .unwrap_or(1.0);
        self.glowing(temperature?, scale, &attributes.location)
    }

    fn glowing(&self, temperature: f64, scale: f64, location: &Location) -> Option<Colour> {
        if temperature > 0.0 && temperature.is_finite() && scale.is_finite() {
            return Some(Colour::Blackbody { temperature, scale });
        }
        let message = format!("found {temperature}, expected a temperature above 0 kelvin");
        self.problems.error(location, message);
        None
    }

    fn spectrum(
        &mut self,
        attributes: &mut Attributes,
        node: Node<'_, '_>,
        file: &FileContext<'_>,
    ) -> Option<Colour> {
        // `intent` told the first generation's RGB rendering what a triple means; ours knows by use.
        attributes.take("intent");
        if let Some(name) = attributes.take("filename") {
            return self.spectrum_file(&name);
        }
        if let Some(kind) = attributes.take("type") {
            return self.typed_spectrum(&kind, node, file);
        }
        let read = |text: &str| colour::spectrum(text, file.version);
        attributes.require_as("value", read, &self.problems)
    }

    fn spectrum_file(&self, name: &Attribute) -> Option<Colour> {
        let path = self
            .files
            .find_noted(&name.value, &name.location, &self.problems)?;
        let read = std::fs::read(&path).map_err(|reason| reason.to_string());
        let curve = read.and_then(|bytes| colour::spectrum_file(&super::syntax::decode(&bytes).0));
        let note = |reason| {
            self.problems
                .error(&name.location, format!("{}: {reason}", path.display()));
        };
        curve.map_err(note).ok()
    }

    /// A spectrum with values in elements of its own, as the second generation writes them.
    fn typed_spectrum(
        &mut self,
        kind: &Attribute,
        node: Node<'_, '_>,
        file: &FileContext<'_>,
    ) -> Option<Colour> {
        let inner = node.children().filter(Node::is_element);
        let inner = inner.filter_map(|inner| {
            let tag = inner.tag_name().name().to_ascii_lowercase();
            TAGS.contains(&tag.as_str())
                .then(|| self.property(&tag, inner, file))?
        });
        let parts = Parts(inner.collect());
        let number = |name, absent| parts.number(name).or(absent);
        let made = match kind.value.trim() {
            "blackbody" => {
                let temperature = number("temperature", None);
                let scale = number("scale", Some(1.0));
                temperature.zip(scale).map(|(temperature, scale)| {
                    self.glowing(temperature, scale, &kind.location)
                        .ok_or_else(String::new)
                })
            }
            "uniform" => number("value", Some(1.0)).map(|value| Ok(grey(value))),
            // In RGB the white of D65 is the white of Rec.709.
            "d65" => number("scale", Some(1.0)).map(|scale| Ok(grey(scale))),
            "irregular" => {
                let lists = parts.numbers("wavelengths").zip(parts.numbers("values"));
                lists.map(|(wavelengths, values)| colour::curve(&wavelengths?, &values?))
            }
            "regular" => {
                let range = number("wavelength_min", None).zip(number("wavelength_max", None));
                let lists = range.zip(parts.numbers("values"));
                lists.map(|((first, last), values)| regular(first, last, &values?))
            }
            other => {
                let hint = did_you_mean(other, SPECTRUM_TYPES);
                let message = format!("unknown spectrum {}{hint}", shown(other));
                self.problems
                    .unsupported(&kind.location, message, "ignored");
                return None;
            }
        };
        let incomplete = || Err(format!("spectrum {} lacks a value", shown(&kind.value)));
        let note = |message: String| {
            if !message.is_empty() {
                self.problems.error(&kind.location, message);
            }
        };
        made.unwrap_or_else(incomplete).map_err(note).ok()
    }
}

/// The values inside a spectrum.
struct Parts(Vec<Property>);

impl Parts {
    fn value(&self, name: &str) -> Option<&PropertyValue> {
        let found = self
            .0
            .iter()
            .rev()
            .find(|property| property.name.normalised == name);
        found.map(|property| &property.value)
    }

    fn number(&self, name: &str) -> Option<f64> {
        match self.value(name)? {
            PropertyValue::Float(number) => Some(*number),
            PropertyValue::Integer(number) => Some(*number as f64),
            _ => None,
        }
    }

    fn numbers(&self, name: &str) -> Option<Result<Vec<f64>, String>> {
        match self.value(name)? {
            PropertyValue::String(text) => Some(values::numbers(text)),
            _ => None,
        }
    }
}

fn grey(value: f64) -> Colour {
    Colour::Rgb(Rgb::grey(value as f32))
}

/// A curve with equal steps between its wavelengths.
fn regular(first: f64, last: f64, values: &[f64]) -> Result<Colour, String> {
    let steps = values.len().saturating_sub(1).max(1) as f64;
    let at = |i: usize| first + (last - first) * i as f64 / steps;
    let wavelengths: Vec<f64> = (0..values.len()).map(at).collect();
    colour::curve(&wavelengths, values)
}
