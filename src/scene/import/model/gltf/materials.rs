//! Materials of a glTF file as ours.

use gltf::material::AlphaMode;

use super::super::materials::scaled;
use super::super::{LEANING, MadeSurface, Model};
use super::textures::Part;
use super::{Asset, Carrier};
use crate::bsdf::{
    Bsdf, BsdfError, Diffuse, Mask, NormalMap, Principled, PrincipledParameters, PrincipledThin,
    PrincipledThinParameters, RelativeIor, TwoSided,
};
use crate::math::{Rgb, Vec3};
use crate::texture::{Product, Texture, TextureModel};

/// Indices below this one reflect next to nothing, and cannot be told from none.
const LEAST_IOR: f32 = 1.001;

impl Model<'_> {
    /// Makes a material.
    ///
    /// - `carrier`: the mesh whose colours it shows.
    pub(super) fn gltf_surface<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        material: &gltf::Material<'g>,
        carrier: Option<&Carrier>,
    ) -> MadeSurface {
        let base = self.base_colour(asset, material, carrier);
        if material.unlit() {
            return MadeSurface {
                bsdf: self.with_holes(asset, material, carrier, Diffuse::new(0.0).into()),
                radiance: Some(base),
                follows_coordinates: false,
            };
        }
        let radiance = self.gltf_emission(asset, material, carrier);
        let made = self.gltf_scattering(asset, material, carrier, base);
        let bsdf = made.unwrap_or_else(|error| {
            let index = material.index().unwrap_or_default();
            let message = format!("material {index}: {error}");
            self.problems.error(&self.line(1), message);
            Diffuse::new(0.5).into()
        });
        MadeSurface {
            bsdf: self.with_holes(asset, material, carrier, bsdf),
            radiance,
            follows_coordinates: true,
        }
    }

    /// Base colour: factor, picture and the mesh's own colours, multiplied.
    fn base_colour<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        material: &gltf::Material<'g>,
        carrier: Option<&Carrier>,
    ) -> Texture {
        let pbr = material.pbr_metallic_roughness();
        let [r, g, b, _] = pbr.base_color_factor();
        let factor = Rgb::new(r, g, b).clamp(0.0, 1.0);
        let picture = pbr.base_color_texture();
        let base = self.gltf_times(asset, (picture, Part::Colour), carrier, factor);
        match carrier {
            Some(carrier) => Product::new(base, carrier.colours.clone()).into(),
            None => base,
        }
    }

    /// A part of a picture times a factor; the factor alone without a picture.
    fn gltf_times<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        (picture, part): (Option<gltf::texture::Info<'g>>, Part),
        carrier: Option<&Carrier>,
        factor: Rgb,
    ) -> Texture {
        let picture = picture.and_then(|info| self.gltf_texture(asset, info, part, carrier));
        picture.map_or_else(|| factor.into(), |picture| scaled(picture, factor))
    }

    fn gltf_emission<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        material: &gltf::Material<'g>,
        carrier: Option<&Carrier>,
    ) -> Option<Texture> {
        let strength = material.emissive_strength().unwrap_or(1.0).max(0.0);
        let factor = Rgb(Vec3::from_array(material.emissive_factor()).max(Vec3::ZERO)) * strength;
        if factor.is_black() {
            return None;
        }
        let picture = material.emissive_texture();
        let emission = self.gltf_times(asset, (picture, Part::Colour), carrier, factor);
        // Many exporters write a factor of one beside a picture that is black.
        (!emission.mean().is_black()).then_some(emission)
    }

    fn gltf_scattering<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        material: &gltf::Material<'g>,
        carrier: Option<&Carrier>,
        base: Texture,
    ) -> Result<Bsdf, BsdfError> {
        let pbr = material.pbr_metallic_roughness();
        let mut channel = |model: &mut Self, info, index, factor: f32| -> Texture {
            let factor = Rgb::grey(factor.clamp(0.0, 1.0));
            model.gltf_times(asset, (info, Part::Channel(index)), carrier, factor)
        };
        let both = || pbr.metallic_roughness_texture();
        let roughness = channel(self, both(), 1, pbr.roughness_factor());
        let metallic = channel(self, both(), 2, pbr.metallic_factor());
        let transmission = material.transmission();
        let spec_trans = match &transmission {
            Some(glass) => {
                let factor = glass.transmission_factor();
                channel(self, glass.transmission_texture(), 0, factor)
            }
            None => 0.0.into(),
        };
        let ior = RelativeIor::new(material.ior().unwrap_or(1.5).max(LEAST_IOR), 1.0)?;
        let is_glass = !spec_trans.is_zero();
        let is_thick = material
            .volume()
            .is_some_and(|volume| volume.thickness_factor() > 0.0);
        let bsdf: Bsdf = if is_glass && !is_thick {
            let mut parameters = PrincipledThinParameters::new(base, ior);
            parameters.roughness = roughness;
            parameters.spec_trans = spec_trans;
            PrincipledThin::new(parameters).into()
        } else {
            let mut parameters = PrincipledParameters::new(base, ior);
            parameters.roughness = roughness;
            parameters.metallic = metallic;
            parameters.spec_trans = spec_trans;
            Principled::new(parameters)?.into()
        };
        let bsdf = self.with_normals(asset, material, carrier, bsdf);
        if is_glass {
            return Ok(bsdf);
        }
        Ok(TwoSided::new(bsdf, None)?.into())
    }

    fn with_normals<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        material: &gltf::Material<'g>,
        carrier: Option<&Carrier>,
        nested: Bsdf,
    ) -> Bsdf {
        let Some(normals) = material.normal_texture() else {
            return nested;
        };
        let part = Part::Normals(normals.scale());
        match self.gltf_texture(asset, normals, part, carrier) {
            Some(texture) => NormalMap::new(texture, LEANING, nested).into(),
            None => nested,
        }
    }

    fn with_holes<'g>(
        &mut self,
        asset: &mut Asset<'g>,
        material: &gltf::Material<'g>,
        carrier: Option<&Carrier>,
        nested: Bsdf,
    ) -> Bsdf {
        let pbr = material.pbr_metallic_roughness();
        let factor = pbr.base_color_factor()[3].clamp(0.0, 1.0);
        let cutoff = material.alpha_cutoff().unwrap_or(0.5);
        let (part, plain) = match material.alpha_mode() {
            AlphaMode::Opaque => return nested,
            AlphaMode::Blend => (Part::Channel(3), factor),
            AlphaMode::Mask => {
                let least = if factor > 0.0 {
                    cutoff / factor
                } else {
                    f32::INFINITY
                };
                (
                    Part::AlphaAbove(least),
                    f32::from(u8::from(factor >= cutoff)),
                )
            }
        };
        let picture = pbr.base_color_texture();
        let picture = picture.and_then(|info| self.gltf_texture(asset, info, part, carrier));
        match picture {
            Some(opacity) if part == Part::Channel(3) => {
                Mask::new(scaled(opacity, Rgb::grey(factor)), nested).into()
            }
            Some(opacity) => Mask::new(opacity, nested).into(),
            None if plain < 1.0 => Mask::new(plain, nested).into(),
            None => nested,
        }
    }
}
