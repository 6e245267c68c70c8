//! Materials.

mod nesting;
mod principled;
mod values;

use super::loader::Loader;
use super::xml::{ElementId, ElementReader};
use crate::bsdf::{
    Bsdf, BsdfError, Conductor, Dielectric, Diffuse, DiffuseTransmitter, Null, Phong, Plastic,
    RoughConductor, RoughDielectric, RoughDiffuse, RoughPlastic, ThinDielectric, Ward, WardKind,
};
use crate::scene::BsdfId;

/// The plugins that are read, for "did you mean".
const KNOWN: [&str; 24] = [
    "blendbsdf",
    "bumpmap",
    "coating",
    "conductor",
    "dielectric",
    "difftrans",
    "diffuse",
    "lambertian",
    "mask",
    "mixturebsdf",
    "normalmap",
    "null",
    "phong",
    "plastic",
    "principled",
    "principledthin",
    "roughcoating",
    "roughconductor",
    "roughdielectric",
    "roughdiffuse",
    "roughplastic",
    "thindielectric",
    "twosided",
    "ward",
];

impl Loader<'_> {
    /// Builds a material, or finds the one that was built before.
    pub(super) fn bsdf(&mut self, id: ElementId) -> BsdfId {
        // What a mesh carries belongs to its own copy of the material.
        let is_shared = self.carrier.is_none();
        if let (true, Some(built)) = (is_shared, self.bsdfs.get(&id)) {
            return *built;
        }
        (self.follows_coordinates, self.has_textures) = (false, false);
        let bsdf = self.build_bsdf(id);
        let built = self.builder.add_bsdf(bsdf);
        if self.follows_coordinates {
            self.needs_derivatives.insert(built);
        }
        if self.has_textures {
            self.textured.insert(built);
        }
        if is_shared {
            self.bsdfs.insert(id, built);
        }
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
            "roughdiffuse" => Ok(self.rough_diffuse(&mut reader)),
            "difftrans" => {
                let transmittance = self.reflectance(&mut reader, "transmittance", 0.5);
                Ok(DiffuseTransmitter::new(transmittance).into())
            }
            "twosided" => self.two_sided(&mut reader),
            "dielectric" => self.dielectric(&mut reader),
            "thindielectric" => self.thin_dielectric(&mut reader),
            "conductor" => self.conductor(&mut reader),
            "null" => Ok(Null.into()),
            "mask" => self.mask(&mut reader),
            "bumpmap" => Ok(self.bump_map(&mut reader)),
            "normalmap" => Ok(self.normal_map(&mut reader)),
            "blendbsdf" => Ok(self.blend(&mut reader)),
            "mixturebsdf" => self.mixture(&mut reader),
            "coating" => self.coating(&mut reader),
            "roughcoating" => self.rough_coating(&mut reader),
            "phong" => Ok(self.phong(&mut reader)),
            "ward" => Ok(self.ward(&mut reader)),
            "principled" => self.principled(&mut reader),
            "principledthin" => self.principled_thin(&mut reader),
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

    fn rough_diffuse(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let reflectance = self.reflectance(reader, "reflectance", 0.5);
        let alpha = self.scalar(reader, "alpha", 0.2);
        let qualitative = reader.boolean("use_fast_approx", false);
        RoughDiffuse::new(reflectance, alpha, qualitative).into()
    }

    fn phong(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let exponent = self.scalar(reader, "exponent", 30.0);
        let specular = self.reflectance(reader, "specular_reflectance", 0.2);
        let diffuse = self.reflectance(reader, "diffuse_reflectance", 0.5);
        Phong::new(exponent, specular, diffuse).into()
    }

    fn ward(&mut self, reader: &mut ElementReader<'_>) -> Bsdf {
        let kinds = [
            ("balanced", WardKind::Balanced),
            ("ward", WardKind::Original),
            ("ward-duer", WardKind::Duer),
        ];
        let kind = reader.choice("variant", &kinds, WardKind::Balanced);
        let alpha = ["alpha_u", "alpha_v"].map(|name| self.scalar(reader, name, 0.1));
        let specular = self.reflectance(reader, "specular_reflectance", 0.2);
        let diffuse = self.reflectance(reader, "diffuse_reflectance", 0.5);
        self.follows_coordinates = true;
        Ward::new(kind, alpha, specular, diffuse).into()
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
        let alpha = self.scalar(reader, "alpha", 0.1);
        let ior = self.indices(reader, "polypropylene");
        let diffuse = self.reflectance(reader, "diffuse_reflectance", 0.5);
        let specular = self.reflectance(reader, "specular_reflectance", 1.0);
        let nonlinear = reader.boolean("nonlinear", false);
        Ok(RoughPlastic::new(kind, alpha, ior?, specular, diffuse, nonlinear).into())
    }
}
