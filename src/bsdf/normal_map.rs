//! A material whose normals a texture gives.

use std::sync::Arc;

use super::bent::{Bent, Lean};
use super::{
    Bsdf, BsdfModel, Conductor, Dielectric, Diffuse, Leaning, MicrofacetKind, RoughConductor,
    Roughness,
};
use crate::image::{self, Texels};
use crate::math::{Mat3, Vec3};
use crate::shape::SurfacePoint;
use crate::texture::{self, Filter, Texture, TextureModel, Wrap};

/// A material with the normals of a texture.
pub type NormalMap = Bent<Normals>;

/// Normals over a surface.
#[derive(Clone, Debug)]
pub struct Normals {
    normals: Texture,
}

impl NormalMap {
    /// Makes the material.
    ///
    /// - `normals`: colours that stand for normals in the shading frame: a channel of 0 means a part
    ///   of −1, and 1 means 1. They need not have the length one.
    /// - `nested`: the material with these normals.
    pub fn new(normals: impl Into<Texture>, leaning: Leaning, nested: impl Into<Bsdf>) -> Self {
        let normals = normals.into();
        Self::new_leaning(Normals { normals }, leaning, nested.into())
    }
}

impl Lean for Normals {
    fn examples() -> Vec<NormalMap> {
        let roughness = Roughness::new(MicrofacetKind::Ggx, 0.15, 0.4);
        let metal = RoughConductor::new(roughness, None, 0.9);
        let glass = Dielectric::examples().into_iter().take(1);
        let nested = [
            Bsdf::from(Diffuse::new(0.8)),
            metal.into(),
            Conductor::new(None, 0.9).into(),
        ];
        nested
            .into_iter()
            .chain(glass.map(Bsdf::from))
            .enumerate()
            .flat_map(|(number, nested)| {
                [false, true].map(|turning| {
                    let shadowing = (number % 2 == 0) != turning;
                    let leaning = Leaning { shadowing, turning };
                    NormalMap::new(example_normals(), leaning, nested.clone())
                })
            })
            .collect()
    }

    #[inline]
    fn normal(&self, at: &SurfacePoint) -> Vec3 {
        let colour = self.normals.colour(at.uv).0;
        (colour * 2.0 - 1.0).normalize_or(Vec3::Z)
    }
}

/// A few normals that lean this way and that.
fn example_normals() -> Texture {
    let colours = vec![
        0.5, 0.5, 1.0, 0.8, 0.4, 0.9, 0.3, 0.7, 0.8, 0.6, 0.2, 0.9, 0.45, 0.65, 0.95, 0.7, 0.7, 0.8,
    ];
    let image = image::Bitmap::new(3, 2, 3, Texels::Float(colours)).expect("3 × 2 colours");
    let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
    texture::Bitmap::new(Arc::new(image), filter, wrap, Mat3::IDENTITY).into()
}
