//! What smooth and rough plastic share: a diffuse base under a coat of varnish.

use super::fresnel::RelativeIor;
use crate::math::{Rgb, Vec2};
use crate::texture::{Texture, TextureModel};

/// A diffuse base, the tints of base and coat, and how a sampler chooses between the two.
#[derive(Clone, Debug)]
pub(super) struct CoatedBase {
    pub(super) ior: RelativeIor,
    pub(super) specular_reflectance: Texture,
    diffuse_reflectance: Texture,
    nonlinear: bool,
    /// Mean tint of the coat over the sum of both means.
    specular_preference: f32,
}

impl CoatedBase {
    pub(super) fn new(
        ior: RelativeIor,
        specular_reflectance: Texture,
        diffuse_reflectance: Texture,
        nonlinear: bool,
    ) -> Self {
        let specular = specular_reflectance.mean().mean();
        let sum = specular + diffuse_reflectance.mean().mean();
        Self {
            ior,
            specular_reflectance,
            diffuse_reflectance,
            nonlinear,
            specular_preference: if sum > 0.0 { specular / sum } else { 0.5 },
        }
    }

    /// Reflectance of the base with all reflections between it and the coat, times `η⁻²`.
    ///
    /// Times the coat's transmittance on the way in and on the way out, over π, it is the value of
    /// the diffuse lobe. The factor `η⁻²` is the radiance's; a path that enters and leaves again
    /// has it once for either transport.
    ///
    /// Each round trip multiplies by `ρ·R`; nonlinear sums `Σ(ρR)ⁿ`, linear keeps the colour of one
    /// reflection and sums `ΣRⁿ`.
    ///
    /// - `inner_reflectance`: `R`, what the coat reflects of the base's own light.
    #[inline]
    pub(super) fn base(&self, uv: Vec2, inner_reflectance: f32) -> Rgb {
        let reflectance = self.diffuse_reflectance.colour(uv);
        let returned = if self.nonlinear {
            reflectance * inner_reflectance
        } else {
            Rgb::grey(inner_reflectance)
        };
        let inverse = self.ior.inverse();
        reflectance / (Rgb::WHITE - returned) * (inverse * inverse)
    }

    /// Probability of sampling the coat's reflection, where the coat reflects the share
    /// `reflectance` of what comes from `wi`.
    #[inline]
    pub(super) fn specular_choice(&self, reflectance: f32) -> f32 {
        let specular = reflectance * self.specular_preference;
        let diffuse = (1.0 - reflectance) * (1.0 - self.specular_preference);
        let sum = specular + diffuse;
        if sum > 0.0 { specular / sum } else { 0.0 }
    }

    /// Mean over all directions of what base and coat reflect, for a smooth coat.
    pub(super) fn albedo(&self, uv: Vec2, inner_reflectance: f32) -> Rgb {
        let reflected = self.ior.diffuse_reflectance();
        let eta = self.ior.ratio();
        // What diffuse light leaves of the base: in (1 − R), and out η² (1 − R_int) = 1 − R.
        let passed = (1.0 - reflected) * (1.0 - inner_reflectance) * eta * eta;
        self.specular_reflectance.colour(uv) * reflected + self.base(uv, inner_reflectance) * passed
    }
}
