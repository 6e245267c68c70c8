//! A material on bumps that a texture describes.

use std::sync::Arc;

use super::bent::{Bent, Lean};
use super::{
    Bsdf, BsdfModel, Conductor, Dielectric, Diffuse, Leaning, Mask, MicrofacetKind, Plastic,
    RoughConductor, RoughDielectric, Roughness, TwoSided,
};
use crate::image::{self, Texels};
use crate::math::{Mat3, Vec2, Vec3};
use crate::shape::SurfacePoint;
use crate::texture::{self, Filter, Texture, TextureModel, Wrap};

/// A material whose normal leans as if a texture raised the surface.
pub type BumpMap = Bent<Heights>;

/// Heights over a surface.
#[derive(Clone, Debug)]
pub struct Heights {
    height: Texture,
    /// Metres for each unit of `height`.
    scale: f32,
}

impl BumpMap {
    /// Makes the material.
    ///
    /// - `height`: how far the surface is raised along its normal.
    /// - `scale`: metres for each unit of `height`.
    /// - `nested`: the material of the bumps.
    pub fn new(
        height: impl Into<Texture>,
        scale: f32,
        leaning: Leaning,
        nested: impl Into<Bsdf>,
    ) -> Self {
        let height = height.into();
        Self::new_leaning(Heights { height, scale }, leaning, nested.into())
    }
}

impl Lean for Heights {
    fn examples() -> Vec<BumpMap> {
        let bumps = example_heights;
        let rough = |along, across| Roughness::new(MicrofacetKind::Ggx, along, across);
        let metal = || RoughConductor::new(rough(0.15, 0.4), None, 0.9);
        let glass = Dielectric::examples().into_iter().take(1);
        let coat = Plastic::examples().into_iter().take(1);
        let rough_glass = RoughDielectric::examples().into_iter().take(1);
        let two_sided = TwoSided::new(metal(), Some(Diffuse::new(0.6).into()));
        let nested = [
            Bsdf::from(Conductor::new(None, 0.9)),
            metal().into(),
            Mask::new(0.6, Diffuse::new(0.7)).into(),
        ];
        let nested = nested
            .into_iter()
            .chain(glass.map(Bsdf::from))
            .chain(coat.map(Bsdf::from))
            .chain(rough_glass.map(Bsdf::from))
            .chain(two_sided.ok().map(Bsdf::from));
        let leaning = |shadowing, turning| Leaning { shadowing, turning };
        let diffuse = [(0.6, false), (1.5, false), (1.5, true)].map(|(scale, turning)| {
            BumpMap::new(bumps(), scale, leaning(true, turning), Diffuse::new(0.8))
        });
        let flat = BumpMap::new(0.5, 1.0, leaning(true, true), Diffuse::new(0.8));
        let nested = nested.enumerate().map(|(number, nested)| {
            BumpMap::new(bumps(), 0.3, leaning(number % 2 == 0, number > 2), nested)
        });
        diffuse.into_iter().chain(nested).chain([flat]).collect()
    }

    /// `n − ∇h`, made unit.
    ///
    /// Source: Blinn 1978.
    #[inline]
    fn normal(&self, at: &SurfacePoint) -> Vec3 {
        let by_uv = self.height.gradient(at.uv) * self.scale;
        let slope = at.gradient(by_uv).unwrap_or(Vec2::ZERO);
        (-slope).extend(1.0).normalize_or(Vec3::Z)
    }
}

/// A few uneven heights.
fn example_heights() -> Texture {
    let heights = vec![0.1, 0.25, 0.4, 0.35, 0.8, 0.2];
    let image = image::Bitmap::new(3, 2, 1, Texels::Float(heights)).expect("3 × 2 heights");
    let (filter, wrap) = (Filter::Bilinear, Wrap::Repeat);
    texture::Bitmap::new(Arc::new(image), filter, wrap, Mat3::IDENTITY).into()
}
