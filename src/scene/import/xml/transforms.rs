//! `<transform>`: a chain of maps, applied in the order written.

use glam::{DMat3, DMat4, DVec3};
use roxmltree::Node;

use crate::math::{Transform, TransformError};

use super::attributes::Attributes;
use super::builder::{Builder, FileContext};
use super::suggest::did_you_mean;
use super::values;

const TAGS: [&str; 5] = ["translate", "rotate", "scale", "lookat", "matrix"];

impl Builder {
    /// Reads the children of a `<transform>`; `None` when one of them is wrong.
    pub(super) fn transform(
        &mut self,
        node: Node<'_, '_>,
        file: &FileContext<'_>,
    ) -> Option<Transform> {
        let mut whole = Some(Transform::IDENTITY);
        for inner in node.children().filter(Node::is_element) {
            let mut attributes = self.attributes(inner, file);
            let tag = attributes.tag.to_ascii_lowercase();
            if !TAGS.contains(&tag.as_str()) {
                let hint = did_you_mean(&attributes.tag, TAGS);
                let message = format!(
                    "unknown element <{}> in a transform{hint}; ignored",
                    attributes.tag
                );
                self.problems.warning(&attributes.location, message);
                continue;
            }
            let factor = self.factor(&tag, &mut attributes);
            attributes.finish(&self.problems);
            whole = whole.zip(factor).map(|(whole, factor)| whole.then(&factor));
        }
        whole
    }

    fn factor(&self, tag: &str, attributes: &mut Attributes) -> Option<Transform> {
        let made = match tag {
            "translate" => Transform::translate(self.axes(attributes, 0.0)?),
            "scale" => Transform::scale(self.axes(attributes, 1.0)?),
            "rotate" => {
                let axis = self.axes(attributes, 0.0);
                let angle = attributes.require_as("angle", values::float, &self.problems);
                Transform::rotate(axis?, angle?)
            }
            "lookat" => {
                let origin = attributes.require_as("origin", values::three, &self.problems);
                let target = attributes.require_as("target", values::three, &self.problems);
                let up = attributes.take_as("up", values::three, &self.problems);
                if attributes.is_broken {
                    return None;
                }
                Transform::look_at(origin?.into(), target?.into(), up.map(DVec3::from))
            }
            _ => {
                let matrix = attributes.require_as("value", matrix, &self.problems);
                Transform::from_matrix(matrix?)
            }
        };
        made.map_err(|error| self.note_unusable(tag, error, attributes))
            .ok()
    }

    /// `value` (one number for all axes, or three), or x, y and z, where absent ones are `absent`.
    fn axes(&self, attributes: &mut Attributes, absent: f64) -> Option<DVec3> {
        let all = attributes.take_as("value", values::three, &self.problems);
        let base = all.unwrap_or([absent; 3]);
        let mut axis = |name, base| {
            let number = attributes.take_as(name, values::float, &self.problems);
            number.unwrap_or(base)
        };
        let axes = DVec3::new(axis("x", base[0]), axis("y", base[1]), axis("z", base[2]));
        (!attributes.is_broken).then_some(axes)
    }

    fn note_unusable(&self, tag: &str, error: TransformError, attributes: &Attributes) {
        self.problems
            .error(&attributes.location, format!("<{tag}>: {error}"));
    }
}

/// Reads 16 numbers, or 9 for the linear part, row by row.
fn matrix(text: &str) -> Result<DMat4, String> {
    let list = values::numbers(text)?;
    if let Ok(rows) = <&[f64; 16]>::try_from(&list[..]) {
        Ok(DMat4::from_cols_array(rows).transpose())
    } else if let Ok(rows) = <&[f64; 9]>::try_from(&list[..]) {
        Ok(DMat4::from_mat3(DMat3::from_cols_array(rows).transpose()))
    } else {
        Err(values::wrong_count(text, list.len(), "16 or 9"))
    }
}
