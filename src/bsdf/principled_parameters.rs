//! What Disney's two materials are made of.

use super::fresnel::RelativeIor;
use crate::texture::Texture;

/// What a [`super::Principled`] material is made of; all numbers lie in `[0, 1]`.
#[derive(Clone, Debug)]
pub struct PrincipledParameters {
    /// Colour of the diffuse part, of metal, and of what goes through (its root, each time).
    pub base_color: Texture,
    /// Root of the microfacets' roughness.
    pub roughness: Texture,
    /// How much longer the highlight is across the tangent than along it.
    pub anisotropic: Texture,
    /// Share of metal.
    pub metallic: Texture,
    /// Share of glass in what is no metal.
    pub spec_trans: Texture,
    /// How much of the base's hue the highlight of what is no metal has.
    pub spec_tint: Texture,
    /// Strength of a lobe at grazing angles, as of cloth.
    pub sheen: Texture,
    /// How much of the base's hue the sheen has.
    pub sheen_tint: Texture,
    /// How much the diffuse part looks like subsurface scattering.
    pub flatness: Texture,
    /// Strength of a second, white highlight.
    pub clearcoat: Texture,
    /// How sharp the second highlight is.
    pub clearcoat_gloss: Texture,
    /// Index of the inside over that of the outside.
    pub ior: RelativeIor,
}

impl PrincipledParameters {
    /// A matt body of one colour, with a roughness of a half and nothing else.
    pub fn new(base_color: impl Into<Texture>, ior: RelativeIor) -> Self {
        let nothing = || Texture::from(0.0);
        Self {
            base_color: base_color.into(),
            roughness: 0.5.into(),
            anisotropic: nothing(),
            metallic: nothing(),
            spec_trans: nothing(),
            spec_tint: nothing(),
            sheen: nothing(),
            sheen_tint: nothing(),
            flatness: nothing(),
            clearcoat: nothing(),
            clearcoat_gloss: nothing(),
            ior,
        }
    }
}

/// What a [`super::PrincipledThin`] material is made of; numbers lie in `[0, 1]` where nothing else is said.
#[derive(Clone, Debug)]
pub struct PrincipledThinParameters {
    /// Colour of the diffuse part and of what goes through.
    pub base_color: Texture,
    /// Root of the microfacets' roughness.
    pub roughness: Texture,
    /// How much longer the highlight is across the tangent than along it.
    pub anisotropic: Texture,
    /// Share of glass.
    pub spec_trans: Texture,
    /// How much of the base's hue the highlight has.
    pub spec_tint: Texture,
    /// Strength of a lobe at grazing angles, as of cloth.
    pub sheen: Texture,
    /// How much of the base's hue the sheen has.
    pub sheen_tint: Texture,
    /// How much the diffuse part looks like subsurface scattering.
    pub flatness: Texture,
    /// How much of the diffuse part goes through: 0 none of it, 2 all of it.
    pub diff_trans: Texture,
    /// Index of the sheet over that of what is on either side.
    pub ior: RelativeIor,
}

impl PrincipledThinParameters {
    /// A matt sheet of one colour, with a roughness of a half and nothing else.
    pub fn new(base_color: impl Into<Texture>, ior: RelativeIor) -> Self {
        let nothing = || Texture::from(0.0);
        Self {
            base_color: base_color.into(),
            roughness: 0.5.into(),
            anisotropic: nothing(),
            spec_trans: nothing(),
            spec_tint: nothing(),
            sheen: nothing(),
            sheen_tint: nothing(),
            flatness: nothing(),
            diff_trans: nothing(),
            ior,
        }
    }
}
