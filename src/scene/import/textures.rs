//! Textures.

use std::sync::Arc;

use super::loader::Loader;
use super::xml::{ColourUse, ElementId, ElementKind, ElementReader, did_you_mean};
use crate::image::Transfer;
use crate::math::{Mat3, Rgb, Vec2, Vec3};
use crate::shape::Shape;
use crate::shape::mesh::{AttributeDomain, MeshAttribute};
use crate::texture::{
    self, Checkerboard, Filter, MeshSurface, OnMesh, Scaled, Texture, TextureModel, Wrap,
};

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 4] = ["bitmap", "checkerboard", "mesh_attribute", "scale"];

/// A shape of whose attributes a material asks.
pub(super) struct Carrier {
    /// Of a mesh.
    surface: Option<MeshSurface>,
    attributes: Vec<MeshAttribute>,
}

impl Carrier {
    /// Prepares a shape for textures that ask for its attributes.
    pub(super) fn new(shape: &mut Shape, attributes: Vec<MeshAttribute>) -> Self {
        let surface = match shape {
            Shape::TriangleMesh(mesh) => {
                mesh.use_chart();
                let uvs = mesh.uvs().map(Into::into);
                Some(MeshSurface::new(mesh.triangles().clone(), uvs))
            }
            _ => None,
        };
        Self {
            surface,
            attributes,
        }
    }
}

impl Loader<'_> {
    /// Builds a texture, or finds the one that was built before; `None` after noting why not.
    pub(super) fn texture(&mut self, id: ElementId) -> Option<Texture> {
        self.has_textures = true;
        match self.tree[id].plugin.as_str() {
            // Those below have been given their places.
            "scale" | "checkerboard" if self.carrier.is_some() => {
                let mut reader = self.reader(id);
                let built = match reader.plugin() {
                    "scale" => self.scaled(&mut reader),
                    _ => Some(self.checkerboard(&mut reader)),
                };
                reader.finish();
                return built;
            }
            "mesh_attribute" | "vertexcolors" => return self.mesh_attribute(id),
            _ => {}
        }
        let built = self.texture_by_uv(id)?;
        let carrier = self.carrier.as_ref();
        let surface = carrier.and_then(|carrier| carrier.surface.as_ref());
        Some(match surface {
            Some(surface) if !built.is_constant() => OnMesh::new(surface.clone(), built).into(),
            _ => built,
        })
    }

    /// [`Loader::texture`] for what depends on texture coordinates alone.
    fn texture_by_uv(&mut self, id: ElementId) -> Option<Texture> {
        if let Some(built) = self.textures.get(&id) {
            return built.clone();
        }
        let mut reader = self.reader(id);
        let built = match reader.plugin() {
            "bitmap" | "ldrtexture" | "exrtexture" => self.bitmap(&mut reader),
            "checkerboard" => Some(self.checkerboard(&mut reader)),
            "scale" => self.scaled(&mut reader),
            _ => {
                self.unknown_plugin(id, KNOWN, "a grey of 0.5 is used instead");
                return Some(0.5.into());
            }
        };
        reader.finish();
        self.textures.insert(id, built.clone());
        built
    }

    /// True where an element, or one inside of it, asks for attributes of the mesh that it is on.
    pub(super) fn asks_for_attributes(&self, id: ElementId) -> bool {
        let element = &self.tree[id];
        let is_one = matches!(element.plugin.as_str(), "mesh_attribute" | "vertexcolors");
        let mut children = element.children.iter();
        is_one || children.any(|child| self.asks_for_attributes(child.element))
    }

    fn mesh_attribute(&mut self, id: ElementId) -> Option<Texture> {
        let mut reader = self.reader(id);
        let name = match reader.plugin() {
            "vertexcolors" => Some("vertex_color"),
            _ => reader.required_string("name"),
        };
        let factor = reader.float("scale", 1.0);
        reader.finish();
        // A material that stands by itself is built for its problems alone.
        let (name, carrier) = (name?, self.carrier.as_ref()?);
        let found = carrier.attributes.iter().find(|found| found.name == name);
        let Some(attribute) = found else {
            let known = carrier.attributes.iter().map(|known| known.name.as_str());
            let message = match known.clone().count() {
                0 => format!("a shape without attributes has no \"{name}\""),
                _ => {
                    let hint = did_you_mean(name, known.clone());
                    let known = known.collect::<Vec<_>>().join(", ");
                    format!("the mesh has no attribute \"{name}\"{hint}; it has {known}")
                }
            };
            self.problems.error(self.location(id), message);
            return None;
        };
        let values = attribute.values.iter();
        let values = values.map(|value| Rgb(Vec3::from_array(*value)) * factor);
        let by_face = attribute.domain == AttributeDomain::Face;
        let surface = carrier.surface.clone()?;
        Some(texture::MeshAttribute::new(surface, values.collect(), by_face).into())
    }

    fn bitmap(&mut self, reader: &mut ElementReader<'_>) -> Option<Texture> {
        let file = reader.file("filename");
        let to_uv = self.to_uv(reader);
        let wraps = [
            ("repeat", Wrap::Repeat),
            ("mirror", Wrap::Mirror),
            ("clamp", Wrap::Clamp),
            ("zero", Wrap::Zero),
            ("black", Wrap::Zero),
            ("one", Wrap::One),
            ("white", Wrap::One),
        ];
        let wrap = reader.choice("wrap_mode", &wraps, Wrap::Repeat);
        // The first generation's finer filters only differ where a texture is seen from far away.
        let filters = [
            ("bilinear", Filter::Bilinear),
            ("nearest", Filter::Nearest),
            ("trilinear", Filter::Bilinear),
            ("ewa", Filter::Bilinear),
        ];
        let filter = reader.choice("filter_type", &filters, Filter::Bilinear);
        let raw = reader.boolean("raw", false);
        let gamma = reader.optional_float("gamma");
        reader.ignore(&["max_anisotropy", "cache", "format", "accel"]);
        let location = reader.element().location.clone();
        let bitmap = self.read_bitmap(&file?, &location)?;
        let as_if = |transfer| Arc::new(bitmap.as_ref().clone().with_transfer(transfer));
        let bitmap = match gamma {
            _ if raw && bitmap.is_srgb_encoded() => as_if(Transfer::Linear),
            _ if raw => bitmap,
            Some(gamma) if gamma > 0.0 => as_if(Transfer::Gamma(gamma)),
            _ => bitmap,
        };
        let texture = texture::Bitmap::new(bitmap, filter, wrap, to_uv);
        Some(Texture::Bitmap(texture))
    }

    fn checkerboard(&mut self, reader: &mut ElementReader<'_>) -> Texture {
        let to_uv = self.to_uv(reader);
        let fields = [("color0", 0.4), ("color1", 0.2)];
        let fields = fields.map(|(name, default)| self.reflectance(reader, name, default));
        let mut board = Checkerboard::new(fields, to_uv);
        if !self.tree.version().is_first_generation() {
            board = board.with_numbers_swapped();
        }
        let carrier = self.carrier.as_ref();
        let surface = carrier.and_then(|carrier| carrier.surface.clone());
        match surface {
            Some(surface) => board.on_mesh(surface).into(),
            None => board.into(),
        }
    }

    fn scaled(&mut self, reader: &mut ElementReader<'_>) -> Option<Texture> {
        let factor = reader.colour("scale", ColourUse::Index);
        let Some(nested) = reader.child(ElementKind::Texture) else {
            reader.error("", "texture \"scale\" holds no texture");
            return None;
        };
        let nested = self.texture(nested)?;
        Some(Scaled::new(nested, factor.unwrap_or(Rgb::WHITE)).into())
    }

    /// The map of texture coordinates: `to_uv`, or scales and offsets as the first generation has it.
    fn to_uv(&self, reader: &mut ElementReader<'_>) -> Mat3 {
        let map = reader.transform("to_uv").matrix();
        let both = reader.float("uvscale", 1.0);
        let scale = Vec2::new(reader.float("uscale", both), reader.float("vscale", both));
        let offset = Vec2::new(reader.float("uoffset", 0.0), reader.float("voffset", 0.0));
        let planar = Mat3::from_cols(
            map.x_axis.truncate().truncate().extend(0.0),
            map.y_axis.truncate().truncate().extend(0.0),
            map.w_axis.truncate().truncate().extend(1.0),
        );
        Mat3::from_translation(offset) * Mat3::from_scale(scale) * planar
    }
}
