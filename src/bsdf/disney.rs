//! What Disney's two materials share.

use std::f32::consts::FRAC_1_PI;

use super::fresnel::RelativeIor;
use crate::math::{Rgb, Vec2};

/// Schlick's weight of the reflectance at grazing incidence, `(1 − cos)⁵`.
///
/// Source: Burley 2012.
#[inline]
pub(super) fn schlick_weight(cos: f32) -> f32 {
    (1.0 - cos).clamp(0.0, 1.0).powi(5)
}

/// Schlick's reflectance, with the cosine on the side of the lesser index.
///
/// - `at_normal`: reflectance along the normal.
/// - `cos`: to the normal on the near side, in `[0, 1]`.
///
/// Source: Burley 2015 (the cosine of the refracted direction where light leaves the denser side).
#[inline]
pub(super) fn schlick(at_normal: Rgb, cos: f32, ior: RelativeIor) -> Rgb {
    let cos = if ior.ratio() > 1.0 {
        cos
    } else {
        ior.refract(cos).cos_refracted
    };
    at_normal + (Rgb::WHITE - at_normal) * schlick_weight(cos)
}

/// A colour made as bright as white; white where there is none.
///
/// Source: Burley 2012.
#[inline]
pub(super) fn hue(base: Rgb) -> Rgb {
    let luminance = base.luminance();
    if luminance > 0.0 {
        base / luminance
    } else {
        Rgb::WHITE
    }
}

/// Roughness along tangent and bitangent of the highlight.
///
/// - `roughness`, `anisotropic`: in `[0, 1]`.
///
/// Source: Burley 2012.
#[inline]
pub(super) fn alpha(roughness: f32, anisotropic: f32) -> Vec2 {
    let aspect = (1.0 - 0.9 * anisotropic).sqrt();
    let squared = roughness * roughness;
    Vec2::new(squared / aspect, squared * aspect).max(Vec2::splat(1e-3))
}

/// The matt part: diffuse reflection with its brightening at grazing angles, and sheen.
#[derive(Clone, Copy)]
pub(super) struct Matt {
    /// Colour of the diffuse part, times its share.
    pub(super) diffuse: Rgb,
    /// Colour of the sheen, times its share.
    pub(super) sheen: Rgb,
    pub(super) roughness: f32,
    pub(super) flatness: f32,
}

impl Matt {
    /// Value times the cosine of `wo`.
    ///
    /// - `cos_i`, `cos_o`: cosines of both directions, positive.
    /// - `cos_half`: cosine of half of the angle between the directions.
    ///
    /// Source: Burley 2012 (diffuse, sheen); Burley 2015 (flatness, as a flat subsurface lobe).
    #[inline]
    pub(super) fn value(&self, cos_i: f32, cos_o: f32, cos_half: f32) -> Rgb {
        let (weight_i, weight_o) = (schlick_weight(cos_i), schlick_weight(cos_o));
        let retro = 2.0 * self.roughness * cos_half * cos_half;
        let lambert = (1.0 - 0.5 * weight_i) * (1.0 - 0.5 * weight_o);
        let bright = retro * (weight_i + weight_o + weight_i * weight_o * (retro - 1.0));
        let darkening = |weight: f32| 1.0 + (0.5 * retro - 1.0) * weight;
        let both = darkening(weight_i) * darkening(weight_o);
        let flat = 1.25 * (both * (1.0 / (cos_i + cos_o) - 0.5) + 0.5);
        let steep = lambert + bright;
        let shape = steep + self.flatness * (flat - steep);
        (self.diffuse * (FRAC_1_PI * shape) + self.sheen * schlick_weight(cos_half)) * cos_o
    }

    /// How much it sends out, roughly: what samplers choose it by.
    #[inline]
    pub(super) fn importance(&self) -> f32 {
        self.diffuse.luminance() + 0.2 * self.sheen.luminance()
    }
}
