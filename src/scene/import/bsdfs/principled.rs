//! Disney's materials.

use crate::bsdf::{
    Bsdf, BsdfError, Principled, PrincipledParameters, PrincipledThin, PrincipledThinParameters,
    RelativeIor,
};
use crate::scene::import::loader::Loader;
use crate::scene::import::xml::ElementReader;

/// How often Mitsuba samples each part; here that follows from the material.
const SAMPLING_RATES: [&str; 6] = [
    "diffuse_reflectance_sampling_rate",
    "main_specular_sampling_rate",
    "clearcoat_sampling_rate",
    "specular_reflectance_sampling_rate",
    "specular_transmittance_sampling_rate",
    "diffuse_transmittance_sampling_rate",
];

impl Loader<'_> {
    pub(super) fn principled(&mut self, reader: &mut ElementReader<'_>) -> Result<Bsdf, BsdfError> {
        reader.ignore(&SAMPLING_RATES);
        self.follows_coordinates = true;
        let spec_trans = self.scalar(reader, "spec_trans", 0.0);
        let mut eta = self.eta(reader);
        let is_matched = (eta - 1.0).abs() < 1e-3;
        if is_matched && !spec_trans.is_zero() {
            // As Mitsuba does; a rough boundary needs two indices that differ.
            eta = 1.001;
        }
        let parameters = PrincipledParameters {
            base_color: self.reflectance(reader, "base_color", 0.5),
            roughness: self.scalar(reader, "roughness", 0.5),
            anisotropic: self.scalar(reader, "anisotropic", 0.0),
            metallic: self.scalar(reader, "metallic", 0.0),
            spec_trans,
            spec_tint: self.scalar(reader, "spec_tint", 0.0),
            sheen: self.scalar(reader, "sheen", 0.0),
            sheen_tint: self.scalar(reader, "sheen_tint", 0.0),
            flatness: self.scalar(reader, "flatness", 0.0),
            clearcoat: self.scalar(reader, "clearcoat", 0.0),
            clearcoat_gloss: self.scalar(reader, "clearcoat_gloss", 0.0),
            ior: RelativeIor::new(eta, 1.0)?,
        };
        Ok(Principled::new(parameters)?.into())
    }

    pub(super) fn principled_thin(
        &mut self,
        reader: &mut ElementReader<'_>,
    ) -> Result<Bsdf, BsdfError> {
        reader.ignore(&SAMPLING_RATES);
        self.follows_coordinates = true;
        let parameters = PrincipledThinParameters {
            base_color: self.reflectance(reader, "base_color", 0.5),
            roughness: self.scalar(reader, "roughness", 0.5),
            anisotropic: self.scalar(reader, "anisotropic", 0.0),
            spec_trans: self.scalar(reader, "spec_trans", 0.0),
            spec_tint: self.scalar(reader, "spec_tint", 0.0),
            sheen: self.scalar(reader, "sheen", 0.0),
            sheen_tint: self.scalar(reader, "sheen_tint", 0.0),
            flatness: self.scalar(reader, "flatness", 0.0),
            diff_trans: self.scalar(reader, "diff_trans", 0.0),
            ior: RelativeIor::new(reader.float("eta", 1.5), 1.0)?,
        };
        Ok(PrincipledThin::new(parameters).into())
    }

    /// The index of refraction, given as such or by the reflectance along the normal: `specular` is
    /// its share of 8 %.
    fn eta(&self, reader: &mut ElementReader<'_>) -> f32 {
        let specular = reader.optional_float("specular");
        let eta = reader.optional_float("eta");
        if let (Some(_), Some(_)) = (specular, eta) {
            reader.error("specular", "\"eta\" says already what \"specular\" says");
        }
        let from_specular = |specular: f32| {
            if !(0.0..=1.0).contains(&specular) {
                let message = format!("\"specular\" is {specular}, expected 0 to 1");
                reader.error("specular", message);
            }
            2.0 / (1.0 - (0.08 * specular.clamp(0.0, 1.0)).sqrt()) - 1.0
        };
        eta.unwrap_or_else(|| from_specular(specular.unwrap_or(0.5)))
    }
}
