//! The numbers of a row that are no positions, normals, texture coordinates or indices.

use super::MeshProblem;
use super::body::Body;
use super::header::{Element, Kind, Scalar};
use crate::math::srgb_to_linear;
use crate::shape::mesh::{AttributeDomain, MeshAttribute};

/// Reads attributes row by row.
#[derive(Default)]
pub(super) struct Columns {
    pub(super) attributes: Vec<MeshAttribute>,
    /// For each property of a row, where it goes; `None` for those that are read over.
    places: Vec<Option<Place>>,
    /// A value of each attribute: the row that is being read.
    row: Vec<[f32; 3]>,
}

#[derive(Clone, Copy)]
struct Place {
    attribute: usize,
    /// `None` for a number alone, which is grey.
    channel: Option<usize>,
    is_colour: bool,
}

impl Columns {
    /// Sorts the properties of an element into attributes.
    ///
    /// - `is_known`: properties that mean something else.
    /// - `warnings`: takes those that make no attribute.
    pub(super) fn of(
        element: &Element,
        domain: AttributeDomain,
        is_known: impl Fn(&str) -> bool,
        warnings: &mut Vec<String>,
    ) -> Self {
        let mut columns = Self::default();
        let properties = element.properties.iter();
        let names = properties.map(|property| match property.kind {
            Kind::Scalar(_) if !is_known(&property.name) => name(&property.name, domain),
            _ => None,
        });
        let names: Vec<Option<String>> = names.collect();
        for (index, name) in names.iter().enumerate() {
            let place = name.as_ref().and_then(|name| {
                let count = |names: &[Option<String>]| {
                    let same = names.iter().flatten();
                    same.filter(|other| *other == name).count()
                };
                let channel = match count(&names) {
                    1 => None,
                    3 => Some(count(&names[..index])),
                    found => {
                        if count(&names[..index]) == 0 {
                            warnings.push(format!(
                                "{name} has {found} numbers, expected 1 or 3; ignored"
                            ));
                        }
                        return None;
                    }
                };
                Some(Place {
                    attribute: columns.find_or_add(name, domain),
                    channel,
                    is_colour: name.ends_with("_color"),
                })
            });
            columns.places.push(place);
        }
        columns
    }

    fn find_or_add(&mut self, name: &str, domain: AttributeDomain) -> usize {
        let known = self.attributes.iter().position(|known| known.name == name);
        known.unwrap_or_else(|| {
            self.row.push([0.0; 3]);
            self.attributes.push(MeshAttribute {
                name: name.to_owned(),
                domain,
                values: Vec::new(),
            });
            self.attributes.len() - 1
        })
    }

    /// Reads a property of a row, or reads over it.
    pub(super) fn read(
        &mut self,
        body: &mut Body<'_>,
        property: usize,
        kind: Kind,
    ) -> Result<(), MeshProblem> {
        let place = self.places.get(property).copied().flatten();
        let (Kind::Scalar(scalar), Some(place)) = (kind, place) else {
            return body.skip(kind);
        };
        let mut value = body.scalar(scalar)? as f32;
        if let (true, Some(most)) = (place.is_colour, largest(scalar)) {
            value = srgb_to_linear(value / most);
        }
        if !value.is_finite() {
            return Err(body.not_finite("an attribute"));
        }
        let row = &mut self.row[place.attribute];
        match place.channel {
            Some(channel) => row[channel] = value,
            None => *row = [value; 3],
        }
        Ok(())
    }

    /// Takes the row over, so many times.
    pub(super) fn push(&mut self, times: usize) {
        for (attribute, value) in self.attributes.iter_mut().zip(&self.row) {
            let values = std::iter::repeat_n(*value, times);
            attribute.values.extend(values);
        }
    }
}

/// The attribute that a property is a part of, by the names that Mitsuba 3 gives.
fn name(property: &str, domain: AttributeDomain) -> Option<String> {
    let prefix = match domain {
        AttributeDomain::Vertex => "vertex",
        AttributeDomain::Face => "face",
    };
    if matches!(property, "r" | "g" | "b" | "red" | "green" | "blue") {
        return Some(format!("{prefix}_color"));
    }
    let (stem, part) = property.rsplit_once('_')?;
    match part {
        "r" | "g" | "b" => Some(format!("{prefix}_{stem}_color")),
        "x" | "y" | "z" | "0" | "1" | "2" | "3" => Some(format!("{prefix}_{stem}")),
        _ => None,
    }
}

/// What stands for 1 in the whole numbers of colours.
fn largest(scalar: Scalar) -> Option<f32> {
    match scalar {
        Scalar::I8 | Scalar::U8 => Some(255.0),
        Scalar::I16 | Scalar::U16 => Some(65_535.0),
        Scalar::I32 | Scalar::U32 => Some(4_294_967_295.0),
        Scalar::F32 | Scalar::F64 => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::import::mesh::ImportedMesh;
    use crate::scene::import::mesh::ply::parse;

    /// A text file of a quad and a triangle.
    fn file(
        of_vertices: &str,
        of_faces: &str,
        values: [&str; 5],
        faces: [&str; 2],
    ) -> ImportedMesh {
        let corners = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "2 0 0"];
        let vertices = corners.iter().zip(values);
        let vertices = vertices.map(|(corner, value)| format!("{corner} {value}\n"));
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
             property float z\n{of_vertices}element face 2\n{of_faces}\
             property list uchar int vertex_indices\nend_header\n{}{} 4 0 1 2 3\n{} 3 1 4 2\n",
            vertices.collect::<String>(),
            faces[0],
            faces[1],
        );
        parse(text.as_bytes(), false).unwrap()
    }

    fn attribute(mesh: &ImportedMesh, name: &str) -> Vec<[f32; 3]> {
        let named = |attribute: &&MeshAttribute| attribute.name == name;
        let found = mesh.data.attributes.iter().find(named);
        found.expect(name).values.clone()
    }

    /// The names are those that Mitsuba 3.9.1 gives to the same properties.
    #[test]
    fn numbers_become_attributes_by_their_names() {
        let floats = |names: &[&str]| -> String {
            let lines = names.iter().map(|name| format!("property float {name}\n"));
            lines.collect()
        };
        let of_vertices = floats(&["r", "g", "b", "heat_1", "dye_r", "dye_g", "dye_b", "age"]);
        let of_faces = floats(&["flow_x", "flow_y", "flow_z", "pair_0", "pair_1"]);
        let values = [1, 2, 3, 4, 5].map(|i| format!("0.{i} 0 1 {i} 7 8 9 0"));
        let values = values.each_ref().map(String::as_str);
        let mesh = file(&of_vertices, &of_faces, values, ["1 2 3 0 0", "4 5 6 0 0"]);
        assert_eq!(attribute(&mesh, "vertex_color")[3], [0.4, 0.0, 1.0]);
        assert_eq!(attribute(&mesh, "vertex_heat")[1], [2.0; 3]);
        assert_eq!(attribute(&mesh, "vertex_dye_color")[0], [7.0, 8.0, 9.0]);
        // Both triangles of the quad have its value.
        let flow = [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        assert_eq!(attribute(&mesh, "face_flow"), flow);
        assert_eq!(mesh.data.attributes.len(), 4);
        let ignored = "face_pair has 2 numbers, expected 1 or 3; ignored";
        assert_eq!(mesh.warnings, [ignored]);
    }

    #[test]
    fn whole_numbers_of_colours_are_srgb() {
        let of_vertices = "property uchar red\nproperty uchar green\nproperty uchar blue\n\
                           property uchar alpha\nproperty uchar part_0\n";
        let mesh = file(of_vertices, "", ["255 128 0 9 7"; 5], ["", ""]);
        let [r, g, b] = attribute(&mesh, "vertex_color")[4];
        assert!(r == 1.0 && (g - 0.215_86).abs() < 1e-4 && b == 0.0, "{g}");
        assert_eq!(attribute(&mesh, "vertex_part")[2], [7.0; 3]);
    }
}
