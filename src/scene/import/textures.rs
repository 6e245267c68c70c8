//! Textures.

use std::path::Path;
use std::sync::Arc;

use super::loader::Loader;
use super::xml::{ColourUse, ElementId, ElementKind, ElementReader, Location};
use crate::image::{self, Bitmap, Transfer};
use crate::math::{Mat3, Rgb, Vec2};
use crate::texture::{self, Checkerboard, Filter, Scaled, Texture, Wrap};

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 3] = ["bitmap", "checkerboard", "scale"];

impl Loader<'_> {
    /// Builds a texture, or finds the one that was built before; `None` after noting why not.
    pub(super) fn texture(&mut self, id: ElementId) -> Option<Texture> {
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

    fn bitmap(&self, reader: &mut ElementReader<'_>) -> Option<Texture> {
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
        reader.ignore(&["max_anisotropy", "cache", "format"]);
        let location = reader.element().location.clone();
        let bitmap = self.read_bitmap(&file?, &location)?;
        let bitmap = match gamma {
            _ if raw => bitmap.with_transfer(Transfer::Linear),
            Some(gamma) if gamma > 0.0 => bitmap.with_transfer(Transfer::Gamma(gamma)),
            _ => bitmap,
        };
        let texture = texture::Bitmap::new(Arc::new(bitmap), filter, wrap, to_uv);
        Some(Texture::Bitmap(texture))
    }

    fn checkerboard(&self, reader: &mut ElementReader<'_>) -> Texture {
        let to_uv = self.to_uv(reader);
        let mut colour = |name, default| {
            reader
                .colour(name, ColourUse::Reflectance)
                .unwrap_or(Rgb::grey(default))
        };
        let (first, second) = (colour("color0", 0.4), colour("color1", 0.2));
        Texture::Checkerboard(Checkerboard::new([first, second], to_uv))
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

    /// Reads an image file, and takes it into the scene's hash.
    pub(super) fn read_bitmap(&self, file: &Path, location: &Location) -> Option<Bitmap> {
        self.read_bytes(file, location)?;
        match image::read_bitmap(file) {
            Ok(bitmap) => Some(bitmap),
            Err(error) => {
                self.problems
                    .unsupported(location, error.to_string(), "left out");
                None
            }
        }
    }
}
