//! Shapes.

mod groups;
mod meshes;

use super::loader::Loader;
use super::mesh::curves;
use super::textures::Carrier;
use super::xml::{ElementId, ElementKind, ElementReader};
use crate::accel::CurveBasis;
use crate::math::Vec3;
use crate::scene::BsdfId;
use crate::shape::mesh::MeshData;
use crate::shape::{self, Curves, Cylinder, Disk, Shape, ShapeError, Sphere};
use crate::texture::{Texture, TextureModel};

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 13] = [
    "bsplinecurve",
    "cube",
    "cylinder",
    "disk",
    "instance",
    "linearcurve",
    "merge",
    "obj",
    "ply",
    "rectangle",
    "serialized",
    "shapegroup",
    "sphere",
];

pub(super) use meshes::{MeshFault, MeshOutcome};

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
            "merge" => self.merged(id),
            _ => {
                let Some(mut built) = self.single_shape(id) else {
                    return;
                };
                self.omit_coordinates(&mut built, false);
                let radiance = built.emission.map(|(radiance, _)| radiance);
                match self.builder.add_shape(built.shape, built.bsdf, radiance) {
                    Ok(()) => self.shapes.push(id),
                    Err(error) => self.problems.error(self.location(id), error.to_string()),
                }
            }
        }
    }

    /// Lets a shape leave out the coordinates for which neither its material nor its light asks.
    ///
    /// - `in_group`: whether instances place its points; those of spheres are then no longer in the sphere's own
    ///   space, which knows them by nothing else.
    fn omit_coordinates(&self, built: &mut Built, in_group: bool) {
        let light = built.emission.as_ref();
        let asks = light.is_some_and(|(radiance, _)| !radiance.is_constant())
            || self.textured.contains(&built.bsdf)
            || self.needs_derivatives.contains(&built.bsdf);
        match &mut built.shape {
            Shape::TriangleMesh(mesh) if !asks => mesh.omit_coordinates(),
            Shape::Sphere(sphere) if !asks && !in_group => sphere.omit_coordinates(),
            _ => {}
        }
    }

    /// Builds a shape with its material and light; `None` after noting why there is none.
    fn single_shape(&mut self, id: ElementId) -> Option<Built> {
        let mut reader = self.reader(id);
        let bsdfs = reader.children(ElementKind::Bsdf);
        let emitter = reader.child(ElementKind::Emitter);
        reader.ignore(&["silhouette_sampling_weight"]);
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
            "bsplinecurve" => self.curves(&mut reader, CurveBasis::BSpline),
            "linearcurve" => self.curves(&mut reader, CurveBasis::Linear),
            "obj" | "ply" | "serialized" => self.mesh_file(id, &mut reader, &mut attributes),
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
        if let (Some(Shape::Curves(_)), Some(emitter)) = (&built, emitter) {
            let message = "curves cannot emit light";
            self.problems.error(self.location(emitter), message);
            return None;
        }
        let emission = emitter.and_then(|emitter| Some((self.area_radiance(emitter)?, emitter)));
        self.carrier = None;
        let mut shape = built?;
        match (&mut shape, self.needs_derivatives.contains(&bsdf)) {
            (Shape::TriangleMesh(mesh), true) => mesh.follow_coordinates(),
            (Shape::Sphere(sphere), false) => sphere.ignore_coordinates(),
            _ => {}
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

    fn curves(&self, reader: &mut ElementReader<'_>, basis: CurveBasis) -> Option<Shape> {
        let to_world = reader.transform("to_world");
        let flip = reader.boolean("flip_normals", false);
        // How silhouettes are sampled when scenes are differentiated.
        reader.ignore(&["silhouette_sampling_weight"]);
        let file = reader.file("filename")?;
        let bytes = self.read_bytes(&file, &reader.element().location)?;
        let parsed = curves::parse(&bytes).map_err(|problem| problem.to_string());
        let made = parsed.and_then(|curves| {
            let made = Curves::new(basis, &curves, to_world.matrix());
            made.map_err(|error| error.to_string())
        });
        let noted = made.map_err(|message| {
            reader.error("filename", format!("{}: {message}", file.display()));
        });
        let mut made = noted.ok()?;
        if flip {
            made.flip_normals();
        }
        Some(made.into())
    }

    /// Notes why a shape's numbers make no shape.
    fn sound<T>(&self, reader: &ElementReader<'_>, built: Result<T, ShapeError>) -> Option<T> {
        built
            .map_err(|error| reader.error("to_world", error.to_string()))
            .ok()
    }

    fn primitive(&self, reader: &mut ElementReader<'_>, data: MeshData) -> Option<Shape> {
        let to_world = reader.transform("to_world").matrix();
        let flip = reader.boolean("flip_normals", false);
        let placed = meshes::placed(data, to_world, flip);
        let noted = placed.map_err(|message| reader.error("to_world", message));
        Some(noted.ok()?.into())
    }
}
