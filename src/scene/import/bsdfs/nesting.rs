//! Materials that hold others.

use super::KNOWN;
use crate::bsdf::{
    Bsdf, BsdfError, BumpMap, Coating, Diffuse, Leaning, Mask, Mixture, NormalMap, RoughCoating,
    TwoSided,
};
use crate::math::Rgb;
use crate::scene::import::loader::Loader;
use crate::scene::import::xml::{ColourSource, ColourUse, ElementId, ElementKind, ElementReader};
use crate::texture::{Texture, TextureModel};

/// Coats a material: of two-sided ones each side, since a coat has one side only.
fn on_each_side(
    nested: Bsdf,
    coat: impl Fn(Bsdf) -> Result<Bsdf, BsdfError>,
) -> Result<Bsdf, BsdfError> {
    match nested {
        Bsdf::TwoSided(sides) => Ok(sides.map(coat)?.into()),
        other => coat(other),
    }
}

impl Loader<'_> {
    /// What stands in for an unknown material: what it wraps, or a diffuse surface of its colour.
    pub(super) fn replaced_bsdf(&mut self, id: ElementId, mut reader: ElementReader<'_>) -> Bsdf {
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

    pub(super) fn two_sided(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
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

    pub(super) fn mask(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let opacity = self.reflectance(reader, "opacity", 0.5);
        // A number in Mitsuba 3, where a colour has one opacity a channel here.
        Ok(Mask::new(opacity.of_numbers(), self.only_nested(reader)).into())
    }

    pub(super) fn bump_map(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let scale = reader.float("scale", 1.0);
        let leaning = self.leaning(reader);
        let height = self.only_texture(reader).unwrap_or_else(|| 0.0.into());
        BumpMap::new(height, scale, leaning, self.only_nested(reader)).into()
    }

    pub(super) fn normal_map(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let leaning = self.leaning(reader);
        let straight = || Rgb::new(0.5, 0.5, 1.0).into();
        let normals = self.only_texture(reader).unwrap_or_else(straight);
        NormalMap::new(normals, leaning, self.only_nested(reader)).into()
    }

    /// What materials with leaning normals share.
    fn leaning(&mut self, reader: &mut ElementReader<'_>) -> Leaning {
        self.follows_coordinates = true;
        // The first generation knows neither.
        let default = !self.tree.version().is_first_generation();
        Leaning {
            shadowing: reader.boolean("use_shadowing_function", default),
            turning: reader.boolean("flip_invalid_normals", default),
        }
    }

    /// The one texture inside of a material.
    fn only_texture(&mut self, reader: &mut ElementReader<'_>) -> Option<Texture> {
        let Some(texture) = reader.child(ElementKind::Texture) else {
            let message = format!("{} holds no texture", reader.element().title());
            reader.error("", message);
            return None;
        };
        self.texture(texture)
    }

    pub(super) fn coating(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let ior = self.indices(reader, "bk7");
        let (thickness, absorption) = self.varnish(reader);
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        let (ior, nested) = (ior?, self.only_nested(reader));
        on_each_side(nested, |nested| {
            let (absorption, reflectance) = (absorption.clone(), reflectance.clone());
            Ok(Coating::new(ior, thickness, absorption, reflectance, nested)?.into())
        })
    }

    pub(super) fn rough_coating(
        &mut self,
        reader: &mut ElementReader<'_>,
    ) -> Result<Bsdf, BsdfError> {
        let roughness = (self.distribution(reader), self.scalar(reader, "alpha", 0.1));
        let ior = self.indices(reader, "bk7");
        let (thickness, absorption) = self.varnish(reader);
        let reflectance = self.reflectance(reader, "specular_reflectance", 1.0);
        let (ior, nested) = (ior?, self.only_nested(reader));
        on_each_side(nested, |nested| {
            let (roughness, reflectance) = (roughness.clone(), reflectance.clone());
            let absorption = absorption.clone();
            let coated =
                RoughCoating::new(roughness, ior, thickness, absorption, reflectance, nested);
            Ok(coated?.into())
        })
    }

    /// Thickness and absorption of a coat.
    fn varnish(&mut self, reader: &mut ElementReader<'_>) -> (f32, Texture) {
        let thickness = reader.float("thickness", 1.0);
        if thickness < 0.0 {
            reader.error("thickness", "a coat cannot be thinner than nothing");
        }
        let absorption = self.colour_of(reader, "sigma_a", ColourUse::Index, 0.0);
        (thickness.max(0.0), absorption)
    }

    pub(super) fn blend(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let weight = self.scalar(reader, "weight", 0.5);
        let [first, second] = reader.children(ElementKind::Bsdf)[..] else {
            let message = format!("{} needs two materials", reader.element().title());
            reader.error("", message);
            return Diffuse::new(0.5).into();
        };
        Mixture::blend(weight, self.build_bsdf(first), self.build_bsdf(second)).into()
    }

    pub(super) fn mixture(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        let nested = reader.children(ElementKind::Bsdf);
        let text = reader.required_string("weights").unwrap_or_default();
        let words = text.split([',', ' ']).filter(|word| !word.is_empty());
        let weights: Vec<f32> = words.clone().filter_map(|word| word.parse().ok()).collect();
        if weights.len() != nested.len() || weights.len() != words.count() {
            let message = format!(
                "found \"{text}\", expected one number for each of {} materials",
                nested.len()
            );
            reader.error("weights", message);
            return Ok(Diffuse::new(0.5).into());
        }
        let sum: f32 = weights.iter().sum();
        if sum > 1.0 + 1e-4 {
            let message = format!("the weights add up to {sum}; they are scaled down to 1");
            reader.warning("weights", message);
        }
        let parts = nested.into_iter().zip(weights);
        let parts = parts.map(|(id, weight)| (weight / sum.max(1.0), self.build_bsdf(id)));
        Ok(Mixture::new(parts.collect::<Vec<_>>())?.into())
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
}
