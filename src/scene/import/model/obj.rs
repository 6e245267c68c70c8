//! A Wavefront OBJ file with its material libraries as a scene.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use super::{MadeSurface, Model, mtl};
use crate::bsdf::{Diffuse, TwoSided};
use crate::scene::import::mesh::obj::{self, ObjModel};
use crate::scene::import::xml::{Location, Source, did_you_mean};
use crate::scene::import::{ImportError, ImportOptions, Imported};

/// Imports an OBJ file; see [`crate::scene::import::import`].
pub(super) fn import(file: &Path, options: &ImportOptions) -> Result<Imported, ImportError> {
    let (mut model, bytes) = Model::open(file, options)?;
    match obj::parse_model(&bytes, true) {
        Ok(parsed) => model.add_obj(parsed),
        Err(problem) => {
            let text = problem.to_string();
            let line = problem.line();
            let prefix = line.map_or_else(String::new, |line| format!("line {line}: "));
            let message = text.strip_prefix(&prefix).unwrap_or(&text);
            model
                .problems
                .error(&model.line(line.unwrap_or(1)), message);
        }
    }
    model.finish()
}

/// The materials of all libraries, each with the file that it stands in.
type Libraries = HashMap<String, (mtl::Material, Arc<Source>)>;

impl Model<'_> {
    fn add_obj(&mut self, parsed: ObjModel) {
        let place = self.line(1);
        for warning in &parsed.mesh.warnings {
            self.problems.warning(&place, warning.as_str());
        }
        let mut data = parsed.mesh.data;
        if data.normals.is_none() {
            data.compute_vertex_normals();
        }
        let libraries = self.libraries(&parsed.libraries);
        let mut triangles = vec![Vec::new(); parsed.materials.len() + 1];
        for (piece, material) in parsed.pieces {
            // Without a material comes last.
            triangles[material.unwrap_or(parsed.materials.len())].extend(piece);
        }
        for (index, triangles) in triangles.into_iter().enumerate() {
            if triangles.is_empty() {
                continue;
            }
            let named = parsed.materials.get(index);
            let line = named.map_or(1, |(line, _)| *line);
            let name = named.map(|(_, name)| name.as_str());
            let made = self.obj_surface(name, line, &libraries);
            let surface = self.add_surface(made);
            let place = self.line(line);
            self.add_mesh(data.part(triangles).into(), &surface, &place);
        }
    }

    /// Reads the libraries that a file names.
    fn libraries(&mut self, names: &[(usize, String)]) -> Libraries {
        let mut libraries = HashMap::new();
        for (index, (line, name)) in names.iter().enumerate() {
            let place = self.line(*line);
            let Some(file) = self.files.find_noted(name, &place, &self.problems) else {
                continue;
            };
            let bytes = match std::fs::read(&file) {
                Ok(bytes) => bytes,
                Err(reason) => {
                    let message = format!("cannot read {}: {reason}", file.display());
                    self.problems.unsupported(&place, message, "left out");
                    continue;
                }
            };
            self.take_into_hash(&bytes);
            let source = Arc::new(Source {
                path: file,
                order: index + 1,
            });
            let (materials, complaints) = mtl::parse(&bytes);
            for complaint in complaints {
                let column = u32::try_from(complaint.column).unwrap_or(u32::MAX);
                let line = super::line_of(&source, complaint.line);
                let place = Location { column, ..line };
                if complaint.is_error {
                    self.problems.error(&place, complaint.message);
                } else {
                    self.problems.warning(&place, complaint.message);
                }
            }
            for material in materials {
                let entry = libraries.entry(material.name.clone());
                entry.or_insert_with(|| (material, Arc::clone(&source)));
            }
        }
        libraries
    }

    /// The material of a name; grey without one.
    fn obj_surface(&mut self, name: Option<&str>, line: usize, known: &Libraries) -> MadeSurface {
        if let Some(name) = name {
            if let Some((material, library)) = known.get(name) {
                return self.mtl_surface(material, library);
            }
            let mut names: Vec<&str> = known.keys().map(String::as_str).collect();
            names.sort_unstable();
            let hint = did_you_mean(name, names);
            let message = format!("no library has the material \"{name}\"{hint}; it is grey");
            self.problems.replacement(&self.line(line), message);
        }
        let grey = TwoSided::new(Diffuse::new(0.5), None);
        MadeSurface {
            bsdf: grey.expect("diffuse surfaces are opaque").into(),
            radiance: None,
            follows_coordinates: false,
        }
    }
}
