//! Materials.

use super::loader::Loader;
use super::xml::{
    ColourSource, ColourUse, ElementId, ElementKind, ElementReader, NumberOrName, ScalarSource,
    did_you_mean,
};
use crate::bsdf::{
    self, Bsdf, BsdfError, BumpMap, ComplexIor, Conductor, Dielectric, Diffuse, Mask,
    MicrofacetKind, Null, Plastic, RelativeIor, RoughConductor, RoughDielectric, RoughPlastic,
    Roughness, ThinDielectric, TwoSided,
};
use crate::math::Rgb;
use crate::scene::BsdfId;
use crate::texture::Texture;

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 13] = [
    "bumpmap",
    "conductor",
    "dielectric",
    "diffuse",
    "mask",
    "null",
    "plastic",
    "roughconductor",
    "roughdielectric",
    "roughplastic",
    "thindielectric",
    "twosided",
    "lambertian",
];

impl Loader<'_> {
    /// Builds a material, or finds the one that was built before.
    pub(super) fn bsdf(&mut self, id: ElementId) -> BsdfId {
        if let Some(built) = self.bsdfs.get(&id) {
            return *built;
        }
        self.follows_coordinates = false;
        let bsdf = self.build_bsdf(id);
        let built = self.builder.add_bsdf(bsdf);
        if self.follows_coordinates {
            self.needs_derivatives.insert(built);
        }
        self.bsdfs.insert(id, built);
        built
    }

    /// The material of shapes that name none: grey, or black for those that emit, as in Mitsuba.
    pub(super) fn default_bsdf(&mut self, emits: bool) -> BsdfId {
        let known = &mut self.default_bsdfs[usize::from(emits)];
        let reflectance = if emits { 0.0 } else { 0.5 };
        *known.get_or_insert_with(|| self.builder.add_bsdf(Diffuse::new(reflectance)))
    }

    fn build_bsdf(&mut self, id: ElementId) -> Bsdf {
        let mut reader = self.reader(id);
        let built = match reader.plugin() {
            "diffuse" | "lambertian" => {
                Ok(Diffuse::new(self.reflectance(&mut reader, "reflectance", 0.5)).into())
            }
            "twosided" => self.two_sided(&mut reader),
            "dielectric" => self.dielectric(&mut reader),
            "thindielectric" => self.thin_dielectric(&mut reader),
            "conductor" => self.conductor(&mut reader),
            "null" => Ok(Null.into()),
            "mask" => self.mask(&mut reader),
            "bumpmap" => Ok(self.bump_map(&mut reader)),
            "plastic" => self.plastic(&mut reader),
            "roughconductor" => self.rough_conductor(&mut reader),
            "roughdielectric" => self.rough_dielectric(&mut reader),
            "roughplastic" => self.rough_plastic(&mut reader),
            _ => return self.replaced_bsdf(id, reader),
        };
        let built = built.unwrap_or_else(|error| {
            self.problems.error(self.location(id), error.to_string());
            Diffuse::new(0.5).into()
        });
        reader.finish();
        built
    }

    /// What stands in for an unknown material: what it wraps, or a diffuse surface of its colour.
    fn replaced_bsdf(&mut self, id: ElementId, mut reader: ElementReader<'_>) -> Bsdf {
        let nested = reader.children(ElementKind::Bsdf);
        if let Some(nested) = nested.first() {
            self.unknown_plugin(id, KNOWN, "the material inside of it is used instead");
            return self.build_bsdf(*nested);
        }
        self.unknown_plugin(
            id,
            KNOWN,
            "a diffuse material of its colour is used instead",
        );
        let diffuse = ["reflectance", "diffuse_reflectance", "base_color"];
        let specular = ["specular_reflectance"];
        let mut sum = Rgb::BLACK;
        let mut found = false;
        for name in diffuse.iter().chain(&specular) {
            match reader.texture(name, ColourUse::Reflectance) {
                Some(ColourSource::Constant(colour)) => sum += colour,
                Some(ColourSource::Texture(texture)) => {
                    if let Some(texture) = self.texture(texture) {
                        return Diffuse::new(texture).into();
                    }
                }
                None => continue,
            }
            found = true;
        }
        Diffuse::new(if found {
            sum.clamp(0.0, 1.0)
        } else {
            Rgb::grey(0.5)
        })
        .into()
    }

    fn two_sided(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let nested = reader.children(ElementKind::Bsdf);
        let mut sides = nested
            .iter()
            .map(|id| self.build_bsdf(*id))
            .collect::<Vec<_>>()
            .into_iter();
        let Some(front) = sides.next() else {
            reader.error("", "bsdf \"twosided\" holds no material");
            return Ok(Diffuse::new(0.5).into());
        };
        let back = sides.next();
        if sides.next().is_some() {
            reader.error("", "bsdf \"twosided\" holds more than two materials");
        }
        Ok(TwoSided::new(front, back)?.into())
    }

    fn mask(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let opacity = self.reflectance(reader, "opacity", 0.5);
        Ok(Mask::new(opacity, self.only_nested(reader)).into())
    }

    fn bump_map(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let scale = reader.float("scale", 1.0);
        // The first generation's bumps do not shadow each other.
        let shadowing = !self.tree.version().is_first_generation();
        let shadowing = reader.boolean("use_shadowing_function", shadowing);
        if reader.boolean("flip_invalid_normals", false) {
            reader.warning(
                "flip_invalid_normals",
                "normals that lean away from the viewer are not flipped; they are black",
            );
        }
        let height = match reader.child(ElementKind::Texture) {
            Some(texture) => self.texture(texture),
            None => {
                reader.error("", "bsdf \"bumpmap\" holds no texture");
                None
            }
        };
        let nested = self.only_nested(reader);
        self.follows_coordinates = true;
        BumpMap::new(
            height.unwrap_or_else(|| 0.0.into()),
            scale,
            shadowing,
            nested,
        )
        .into()
    }

    /// The one material inside of another.
    fn only_nested(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        match reader.child(ElementKind::Bsdf) {
            Some(nested) => self.build_bsdf(nested),
            None => {
                let message = format!("{} holds no material", reader.element().title());
                reader.error("", message);
                Diffuse::new(0.5).into()
            }
        }
    }

    fn dielectric(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let ior = self.indices(reader, "bk7");
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        let transmittance = self.reflectance(reader, "specular_transmittance", 1.0);
        Ok(Dielectric::new(ior?, reflectance, transmittance).into())
    }

    fn thin_dielectric(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let ior = self.indices(reader, "bk7");
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        let transmittance = self.reflectance(reader, "specular_transmittance", 1.0);
        Ok(ThinDielectric::new(ior?, reflectance, transmittance).into())
    }

    fn conductor(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        Ok(Conductor::new(self.metal(reader), reflectance).into())
    }

    fn rough_conductor(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let roughness = self.roughness(reader);
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        Ok(RoughConductor::new(roughness, self.metal(reader), reflectance).into())
    }

    fn rough_dielectric(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let roughness = self.roughness(reader);
        let ior = self.indices(reader, "bk7");
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        let transmittance = self.reflectance(reader, "specular_transmittance", 1.0);
        Ok(RoughDielectric::new(roughness, ior?, reflectance, transmittance)?.into())
    }

    fn plastic(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let ior = self.indices(reader, "polypropylene");
        let diffuse = self.reflectance(reader, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(reader, "specular_reflectance", 1.0);
        let nonlinear = reader.boolean("nonlinear", false);
        Ok(Plastic::new(ior?, specular, diffuse, nonlinear).into())
    }

    fn rough_plastic(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let kind = self.distribution(reader);
        let alpha = reader.float("alpha", 0.1);
        let ior = self.indices(reader, "polypropylene");
        let diffuse = self.reflectance(reader, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(reader, "specular_reflectance", 1.0);
        let nonlinear = reader.boolean("nonlinear", false);
        Ok(RoughPlastic::new(kind, alpha, ior?, specular, diffuse, nonlinear).into())
    }

    /// Inner over outer index of refraction, by number or by name.
    fn indices(
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
    fn metal(&self, reader: &mut ElementReader<'_>) -> Option<ComplexIor> {
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
        let material = material.unwrap_or("Cu");
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

    fn distribution(&self, reader: &mut ElementReader<'_>) -> MicrofacetKind {
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

    fn roughness(&mut self, reader: &mut ElementReader<'_>) -> Roughness {
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
    fn reflectance(&mut self, reader: &mut ElementReader<'_>, name: &str, default: f32) -> Texture {
        match reader.texture(name, ColourUse::Reflectance) {
            Some(ColourSource::Constant(colour)) => colour.into(),
            Some(ColourSource::Texture(id)) => self.texture(id).unwrap_or_else(|| default.into()),
            None => default.into(),
        }
    }

    fn optional_scalar(&mut self, reader: &mut ElementReader<'_>, name: &str) -> Option<Texture> {
        match reader.scalar_texture(name)? {
            ScalarSource::Constant(value) => Some(value.into()),
            ScalarSource::Texture(id) => self.texture(id),
        }
    }
}
