//! Shapes.

mod groups;

use std::path::Path;

use super::loader::Loader;
use super::mesh::serialized::SerializedFile;
use super::mesh::{ImportedMesh, MeshError, obj, ply};
use super::textures::Carrier;
use super::xml::{ElementId, ElementKind, ElementReader};
use crate::accel::{IndexBuffer, VertexBuffer};
use crate::math::{Transform, Vec2, Vec3};
use crate::scene::BsdfId;
use crate::shape::mesh::{MeshAttribute, MeshData};
use crate::shape::{self, Cylinder, Disk, Shape, ShapeError, Sphere, TriangleMesh};
use crate::texture::Texture;

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 10] = [
    "cube",
    "cylinder",
    "disk",
    "instance",
    "obj",
    "ply",
    "rectangle",
    "serialized",
    "shapegroup",
    "sphere",
];

/// A shape that is built but not yet in the scene.
struct Built {
    shape: Shape,
    bsdf: BsdfId,
    /// What its front emits, and the emitter that says so.
    emission: Option<(Texture, ElementId)>,
}

impl Loader<'_> {
    /// Builds a shape, a group of shapes or an instance, and adds it to the scene; what cannot be
    /// built is noted.
    pub(super) fn shape(&mut self, id: ElementId) {
        match self.tree[id].plugin.as_str() {
            "shapegroup" => {
                // Built with its first instance, or here if there is none: its problems count.
                self.group(id);
            }
            "instance" => self.instance(id),
            _ => {
                let Some(built) = self.single_shape(id) else {
                    return;
                };
                let radiance = built.emission.map(|(radiance, _)| radiance);
                match self.builder.add_shape(built.shape, built.bsdf, radiance) {
                    Ok(()) => self.shapes.push(id),
                    Err(error) => self.problems.error(self.location(id), error.to_string()),
                }
            }
        }
    }

    /// Builds a shape with its material and light; `None` after noting why there is none.
    fn single_shape(&mut self, id: ElementId) -> Option<Built> {
        let mut reader = self.reader(id);
        let bsdfs = reader.children(ElementKind::Bsdf);
        let emitter = reader.child(ElementKind::Emitter);
        self.media_of(&mut reader);
        if bsdfs.len() > 1 {
            reader.warning(
                "",
                "the shape holds several materials; the last one is used",
            );
        }
        self.area_lights.extend(emitter);
        let mut attributes = Vec::new();
        let mut built = match reader.plugin() {
            "sphere" => self.sphere(&mut reader),
            "disk" => self.disk(&mut reader),
            "cylinder" => self.cylinder(&mut reader),
            "rectangle" => self.primitive(&mut reader, shape::primitives::rectangle()),
            "cube" => self.primitive(&mut reader, shape::primitives::cube()),
            "obj" | "ply" | "serialized" => self.mesh_file(&mut reader, &mut attributes),
            _ => {
                self.unknown_plugin(id, KNOWN, "left out");
                return None;
            }
        };
        reader.finish();
        let mut parts = bsdfs.last().into_iter().chain(&emitter);
        if parts.any(|part| self.asks_for_attributes(*part)) {
            let shape = built.as_mut();
            self.carrier = shape.map(|shape| Carrier::new(shape, attributes));
        }
        let bsdf = match bsdfs.last() {
            Some(bsdf) => self.bsdf(*bsdf),
            None => self.default_bsdf(emitter.is_some()),
        };
        let emission = emitter.and_then(|emitter| Some((self.area_radiance(emitter)?, emitter)));
        self.carrier = None;
        let mut shape = built?;
        if let (Shape::TriangleMesh(mesh), true) =
            (&mut shape, self.needs_derivatives.contains(&bsdf))
        {
            mesh.follow_coordinates();
        }
        Some(Built {
            shape,
            bsdf,
            emission,
        })
    }

    fn sphere(&self, reader: &mut ElementReader<'_>) -> Option<Shape> {
        let to_world = reader.transform("to_world");
        let centre = reader.vector3("center").unwrap_or(Vec3::ZERO);
        let radius = reader.float("radius", 1.0);
        let mut sphere = self.sound(reader, Sphere::new(centre, radius, to_world.matrix()))?;
        if reader.boolean("flip_normals", false) {
            sphere.flip_normals();
        }
        Some(sphere.into())
    }

    fn disk(&self, reader: &mut ElementReader<'_>) -> Option<Shape> {
        let to_world = reader.transform("to_world");
        let mut disk = self.sound(reader, Disk::new(to_world.matrix()))?;
        if reader.boolean("flip_normals", false) {
            disk.flip_normals();
        }
        Some(disk.into())
    }

    fn cylinder(&self, reader: &mut ElementReader<'_>) -> Option<Shape> {
        let to_world = reader.transform("to_world");
        let start = reader.vector3("p0").unwrap_or(Vec3::ZERO);
        let end = reader.vector3("p1").unwrap_or(Vec3::Z);
        let radius = reader.float("radius", 1.0);
        let cylinder = Cylinder::new(start, end, radius, to_world.matrix());
        let mut cylinder = self.sound(reader, cylinder)?;
        if reader.boolean("flip_normals", false) {
            cylinder.flip_normals();
        }
        Some(cylinder.into())
    }

    /// Notes why a shape's numbers make no shape.
    fn sound<T>(&self, reader: &ElementReader<'_>, built: Result<T, ShapeError>) -> Option<T> {
        built
            .map_err(|error| reader.error("to_world", error.to_string()))
            .ok()
    }

    fn primitive(&self, reader: &mut ElementReader<'_>, data: MeshData) -> Option<Shape> {
        let to_world = reader.transform("to_world");
        let flip = reader.boolean("flip_normals", false);
        self.finish_mesh(reader, data, &to_world, flip)
    }

    /// Builds the mesh of a file.
    ///
    /// - `attributes`: takes those of the mesh.
    fn mesh_file(
        &mut self,
        reader: &mut ElementReader<'_>,
        attributes: &mut Vec<MeshAttribute>,
    ) -> Option<Shape> {
        let to_world = reader.transform("to_world");
        let flip = reader.boolean("flip_normals", false);
        let faceted = reader.boolean("face_normals", false);
        let crease = reader.optional_float("max_smooth_angle");
        let mesh = self.read_mesh(reader)?;
        for warning in &mesh.warnings {
            reader.warning("filename", warning);
        }
        let mut data = mesh.data;
        if faceted || mesh.face_normals {
            data.remove_normals();
        } else if let Some(angle) = crease {
            data.apply_max_smooth_angle(angle);
        } else if data.normals.is_none() {
            data.compute_vertex_normals();
        }
        *attributes = std::mem::take(&mut data.attributes);
        self.finish_mesh(reader, data, &to_world, flip)
    }

    fn read_mesh(&mut self, reader: &mut ElementReader<'_>) -> Option<ImportedMesh> {
        let plugin = reader.plugin();
        let flip_default = plugin == "obj";
        let flip_uv = reader.boolean("flip_tex_coords", flip_default);
        let index = reader.integer("shape_index", 0);
        let file = reader.file("filename")?;
        let location = reader.element().location.clone();
        if plugin == "serialized" {
            return self.serialized_mesh(&file, index, reader);
        }
        let bytes = self.read_bytes(&file, &location)?;
        let parsed = match plugin {
            "obj" => obj::parse(&bytes, flip_uv),
            _ => ply::parse(&bytes, flip_uv),
        };
        let noted = parsed.map_err(|problem| {
            reader.error("filename", format!("{}: {problem}", file.display()));
        });
        noted.ok()
    }

    fn serialized_mesh(
        &mut self,
        file: &Path,
        index: i64,
        reader: &ElementReader<'_>,
    ) -> Option<ImportedMesh> {
        let note = |error: MeshError| reader.error("filename", error.to_string());
        if !self.serialized.contains_key(file) {
            let bytes = self.read_bytes(file, &reader.element().location);
            let opened =
                bytes.and_then(|bytes| SerializedFile::open(file, bytes).map_err(note).ok());
            self.serialized.insert(file.to_owned(), opened);
        }
        let opened = self.serialized.get(file)?.as_ref()?;
        let Ok(index) = usize::try_from(index) else {
            reader.error(
                "shape_index",
                format!("\"shape_index\" is {index}, expected 0 or more"),
            );
            return None;
        };
        opened.mesh(index).map_err(note).ok()
    }

    fn finish_mesh(
        &self,
        reader: &ElementReader<'_>,
        mut data: MeshData,
        to_world: &Transform,
        flip: bool,
    ) -> Option<Shape> {
        data.transform(to_world.matrix());
        if flip {
            data.flip_normals();
        }
        if let Err(flaw) = data.validate() {
            reader.error("to_world", format!("after the transform, {flaw}"));
            return None;
        }
        let normals = data
            .normals
            .map(|list| list.into_iter().map(Vec3::from_array).collect());
        let uvs = data
            .uvs
            .map(|list| list.into_iter().map(Vec2::from_array).collect());
        let vertices = VertexBuffer::new(data.positions);
        let triangles = IndexBuffer::new(data.indices);
        Some(TriangleMesh::new(vertices, triangles, normals, uvs).into())
    }
}
