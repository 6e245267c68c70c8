//! What the readers of several materials share: indices, roughness, colours.

use crate::bsdf::{self, BsdfError, ComplexIor, MicrofacetKind, RelativeIor, Roughness};
use crate::math::Rgb;
use crate::scene::import::loader::Loader;
use crate::scene::import::xml::{
    ColourSource, ColourUse, ElementReader, NumberOrName, ScalarSource, did_you_mean,
};
use crate::texture::Texture;

impl Loader<'_> {
    /// Inner over outer index of refraction, by number or by name.
    pub(super) fn indices(
        &self,
        reader: &mut ElementReader<'_>,
        interior: &'static str,
    ) -> Result<RelativeIor, BsdfError> {
        let inner = self.index(reader, "int_ior", interior);
        RelativeIor::new(inner, self.index(reader, "ext_ior", "air"))
    }

    fn index(&self, reader: &mut ElementReader<'_>, name: &str, default: &'static str) -> f32 {
        let named = match reader.number_or_name(name) {
            Some(NumberOrName::Number(number)) => return number,
            Some(NumberOrName::Name(named)) => named,
            None => default,
        };
        bsdf::ior(named).unwrap_or_else(|| {
            let hint = did_you_mean(named, bsdf::ior_names());
            reader.error(name, format!("unknown substance \"{named}\"{hint}"));
            1.0
        })
    }

    /// Complex index of a metal relative to its surroundings; `None` for a perfect mirror.
    pub(super) fn metal(&self, reader: &mut ElementReader<'_>) -> Option<ComplexIor> {
        let exterior = self.index(reader, "ext_eta", "air");
        let given = reader.colour("eta", ColourUse::Index);
        let absorption = reader.colour("k", ColourUse::Index);
        let material = reader.optional_string("material");
        if given.is_some() || absorption.is_some() {
            let eta = given.unwrap_or(Rgb::BLACK);
            let k = absorption.unwrap_or(Rgb::WHITE);
            return Some(ComplexIor {
                eta: eta / exterior,
                k: k / exterior,
            });
        }
        // A mirror in the later generation, copper in the first.
        let default = if self.tree.version().is_first_generation() {
            "Cu"
        } else {
            "none"
        };
        let material = material.unwrap_or(default);
        if material.eq_ignore_ascii_case("none") {
            return None;
        }
        let Some((eta, k)) = bsdf::conductor(material) else {
            let hint = did_you_mean(material, bsdf::conductor_names());
            reader.error("material", format!("unknown material \"{material}\"{hint}"));
            return None;
        };
        Some(ComplexIor {
            eta: eta / exterior,
            k: k / exterior,
        })
    }

    pub(super) fn distribution(&self, reader: &mut ElementReader<'_>) -> MicrofacetKind {
        // Visible normals are always sampled: it is the better technique, and the same material.
        reader.ignore(&["sample_visible"]);
        let kinds = [
            ("beckmann", MicrofacetKind::Beckmann),
            ("ggx", MicrofacetKind::Ggx),
            // Retired in both generations; the documentation names Beckmann as its likeness.
            ("phong", MicrofacetKind::Beckmann),
            ("as", MicrofacetKind::Beckmann),
        ];
        let kind = reader.choice("distribution", &kinds, MicrofacetKind::Beckmann);
        if matches!(reader.string("distribution", ""), "phong" | "as") {
            reader.replacement(
                "distribution",
                "this distribution is not known; \"beckmann\" is used instead",
            );
        }
        kind
    }

    pub(super) fn roughness(&mut self, reader: &mut ElementReader<'_>) -> Roughness {
        let kind = self.distribution(reader);
        let alpha = self.optional_scalar(reader, "alpha");
        let along = self.optional_scalar(reader, "alpha_u");
        let across = self.optional_scalar(reader, "alpha_v");
        match (along, across) {
            (None, None) => Roughness::isotropic(kind, alpha.unwrap_or_else(|| 0.1.into())),
            (along, across) => {
                let other = || alpha.clone().unwrap_or_else(|| 0.1.into());
                self.follows_coordinates = true;
                Roughness::new(
                    kind,
                    along.unwrap_or_else(other),
                    across.unwrap_or_else(other),
                )
            }
        }
    }

    /// A colour or texture of values from 0 to 1.
    pub(in crate::scene::import) fn reflectance(
        &mut self,
        reader: &mut ElementReader<'_>,
        name: &str,
        default: f32,
    ) -> Texture {
        self.colour_of(reader, name, ColourUse::Reflectance, default)
    }

    /// A colour or texture; `default` is grey.
    pub(super) fn colour_of(
        &mut self,
        reader: &mut ElementReader<'_>,
        name: &str,
        wanted: ColourUse,
        default: f32,
    ) -> Texture {
        match reader.texture(name, wanted) {
            Some(ColourSource::Constant(colour)) => colour.into(),
            Some(ColourSource::Texture(id)) => self.texture(id).unwrap_or_else(|| default.into()),
            None => default.into(),
        }
    }

    /// A number or texture of numbers.
    pub(super) fn scalar(
        &mut self,
        reader: &mut ElementReader<'_>,
        name: &str,
        default: f32,
    ) -> Texture {
        let given = self.optional_scalar(reader, name);
        given.unwrap_or_else(|| default.into())
    }

    pub(super) fn optional_scalar(
        &mut self,
        reader: &mut ElementReader<'_>,
        name: &str,
    ) -> Option<Texture> {
        match reader.scalar_texture(name)? {
            ScalarSource::Constant(value) => Some(value.into()),
            ScalarSource::Texture(id) => self.texture(id),
        }
    }
}
