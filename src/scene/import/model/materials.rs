//! Materials of MTL libraries as ours.

use std::sync::Arc;

use super::mtl::{Map, MapKind, Material};
use super::{LEANING, MadeSurface, Model, line_of};
use crate::bsdf::{
    Bsdf, BsdfError, BumpMap, Conductor, Dielectric, Diffuse, Mask, MicrofacetKind, NormalMap,
    Phong, Principled, PrincipledParameters, RelativeIor, RoughConductor, Roughness, TwoSided,
};
use crate::image::Transfer;
use crate::math::{Mat3, Rgb, Vec2};
use crate::scene::import::xml::Source;
use crate::texture::{self, Filter, Scaled, Texture, Wrap};

/// From here on a highlight is a mirror image.
const MIRROR_EXPONENT: f32 = 10_000.0;

impl Model<'_> {
    /// Makes the material of a library.
    ///
    /// - `library`: the file that it stands in.
    pub(super) fn mtl_surface(
        &mut self,
        material: &Material,
        library: &Arc<Source>,
    ) -> MadeSurface {
        let location = line_of(library, material.line);
        let radiance = self.emission(material, library);
        let bumps = material
            .map(MapKind::Bump)
            .or(material.map(MapKind::Normal));
        let follows_coordinates = bumps.is_some() || material.roughness.is_some();
        let bsdf = self.scattering(material, library).unwrap_or_else(|error| {
            let message = format!("material \"{}\": {error}", material.name);
            self.problems.error(&location, message);
            Diffuse::new(0.5).into()
        });
        MadeSurface {
            bsdf,
            radiance,
            follows_coordinates,
        }
    }

    fn emission(&mut self, material: &Material, library: &Arc<Source>) -> Option<Texture> {
        let map = material.map(MapKind::Emission);
        let picture = map.and_then(|map| self.picture(map, library, Transfer::Srgb));
        match picture {
            // Programs that write a map often leave the colour out.
            Some(picture) if material.emission.is_black() => Some(picture),
            Some(picture) => Some(scaled(picture, material.emission)),
            None if material.emission.is_black() => None,
            None => Some(material.emission.into()),
        }
    }

    fn scattering(
        &mut self,
        material: &Material,
        library: &Arc<Source>,
    ) -> Result<Bsdf, BsdfError> {
        // 4, 6, 7 and 9 are the models with glass.
        let is_glass = matches!(material.model, 4 | 6 | 7 | 9);
        if is_glass {
            let ior = RelativeIor::new(material.ior.unwrap_or(1.5), 1.0)?;
            let glass = Dielectric::new(ior, 1.0, material.transmission);
            return Ok(self.bent(glass.into(), material, library));
        }
        let opaque = self.opaque(material, library)?;
        let opaque = self.bent(opaque, material, library);
        let sided = TwoSided::new(opaque, None)?.into();
        let map = material.map(MapKind::Opacity);
        let picture = map.and_then(|map| self.picture(map, library, Transfer::Linear));
        Ok(match picture {
            Some(picture) => {
                let opacity = scaled(picture, Rgb::grey(material.opacity));
                Mask::new(opacity, sided).into()
            }
            None if material.opacity < 1.0 => Mask::new(material.opacity, sided).into(),
            None => sided,
        })
    }

    /// The material without glass and holes, as its front shows it.
    fn opaque(&mut self, material: &Material, library: &Arc<Source>) -> Result<Bsdf, BsdfError> {
        let map = material.map(MapKind::Diffuse);
        let picture = map.and_then(|map| self.picture(map, library, Transfer::Srgb));
        let has_picture = picture.is_some();
        let base = match (picture, material.diffuse) {
            // Many exporters write black beside a picture, and mean the picture.
            (Some(picture), None) => picture,
            (Some(picture), Some(colour)) if colour.is_black() => picture,
            (Some(picture), Some(colour)) => scaled(picture, colour),
            (None, colour) => colour.unwrap_or(Rgb::grey(0.5)).into(),
        };
        if material.roughness.is_some() || material.metallic.is_some() {
            let given = material.ior.unwrap_or(1.5);
            let ior = if given > 1.0 { given } else { 1.5 };
            if ior != given {
                let name = &material.name;
                let message = format!(
                    "material \"{name}\": Ni is {given}, expected more than 1; 1.5 is used"
                );
                self.problems
                    .replacement(&line_of(library, material.line), message);
            }
            let ior = RelativeIor::new(ior, 1.0)?;
            let mut parameters = PrincipledParameters::new(base, ior);
            parameters.roughness = material.roughness.unwrap_or(0.5).into();
            parameters.metallic = material.metallic.unwrap_or(0.0).into();
            return Ok(Principled::new(parameters)?.into());
        }
        let map = material.map(MapKind::Specular);
        let picture = map.and_then(|map| self.picture(map, library, Transfer::Srgb));
        let colour = material.specular;
        let is_matt = material.model < 2 || (colour.is_black() && picture.is_none());
        if is_matt {
            return Ok(Diffuse::new(base).into());
        }
        let specular = match picture {
            Some(picture) if colour.is_black() => picture,
            Some(picture) => scaled(picture, colour),
            None => colour.into(),
        };
        let is_metal = material.diffuse.is_some_and(Rgb::is_black) && !has_picture;
        let is_mirror = matches!(material.model, 3 | 5) || material.exponent >= MIRROR_EXPONENT;
        Ok(match (is_metal, is_mirror) {
            (true, true) => Conductor::new(None, specular).into(),
            (true, false) => {
                // Where Beckmann's and Phong's highlights are equally wide.
                let alpha = (2.0 / (material.exponent + 2.0)).sqrt();
                let roughness = Roughness::isotropic(MicrofacetKind::Beckmann, alpha);
                RoughConductor::new(roughness, None, specular).into()
            }
            (false, _) => Phong::new(material.exponent, specular, base).into(),
        })
    }

    /// A material with the bumps or normals of its picture.
    fn bent(&mut self, nested: Bsdf, material: &Material, library: &Arc<Source>) -> Bsdf {
        let pictured = |model: &mut Self, kind| {
            let map = material.map(kind)?;
            let picture = model.picture(map, library, Transfer::Linear)?;
            Some((picture, map.height))
        };
        if let Some((normals, _)) = pictured(self, MapKind::Normal) {
            return NormalMap::new(normals, LEANING, nested).into();
        }
        match pictured(self, MapKind::Bump) {
            Some((height, scale)) => BumpMap::new(height, scale, LEANING, nested).into(),
            None => nested,
        }
    }

    /// A picture as a texture; `None` after noting why there is none.
    fn picture(&mut self, map: &Map, library: &Arc<Source>, transfer: Transfer) -> Option<Texture> {
        let image = self.image_named(&map.file, &line_of(library, map.line))?;
        let is_codes = image.is_srgb_encoded();
        let image = match transfer {
            Transfer::Linear if is_codes => {
                Arc::new(image.as_ref().clone().with_transfer(Transfer::Linear))
            }
            _ => image,
        };
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        // `v` is counted from the bottom in the file, and the options act on that.
        let flip = Mat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 1.0]);
        let moved = Mat3::from_translation(map.offset) * Mat3::from_scale(map.scale);
        let is_plain = map.offset == Vec2::ZERO && map.scale == Vec2::ONE;
        let to_uv = if is_plain {
            Mat3::IDENTITY
        } else {
            flip * moved * flip
        };
        Some(texture::Bitmap::new(image, Filter::Bilinear, wrap, to_uv).into())
    }
}

/// A texture times a colour.
pub(super) fn scaled(texture: Texture, factor: Rgb) -> Texture {
    if factor == Rgb::WHITE {
        texture
    } else {
        Scaled::new(texture, factor).into()
    }
}
