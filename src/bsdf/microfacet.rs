//! Rough surfaces as many small mirrors: the distribution of their normals, and its masking.
//!
//! Masking and shadowing are taken as independent, `G = G₁(wi)·G₁(wo)`, as Mitsuba does: pictures
//! can be compared. The price is a little more energy lost at grazing angles than with the
//! height-correlated form.

use std::f32::consts::{FRAC_2_SQRT_PI, PI, TAU};

use super::Local;
use crate::math::error_function::{erf_and_gauss, erf_inverse};
use crate::math::warp::turn;
use crate::math::{Vec2, Vec3};
use crate::texture::{Texture, TextureModel};

const FRAC_1_SQRT_PI: f32 = FRAC_2_SQRT_PI / 2.0;

/// How the normals of the small mirrors are distributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MicrofacetKind {
    /// Gaussian slopes.
    Beckmann,
    /// Trowbridge and Reitz's: a sharp peak with long tails.
    Ggx,
}

/// The roughness of a surface, which may vary over it and with the direction.
#[derive(Clone, Debug)]
pub struct Roughness {
    kind: MicrofacetKind,
    alpha_u: Texture,
    alpha_v: Texture,
}

impl Roughness {
    /// Makes a roughness.
    ///
    /// - `alpha_u`, `alpha_v`: roughness along tangent and bitangent; values below 1e-4 count as
    ///   1e-4, which is a mirror to the eye.
    pub fn new(
        kind: MicrofacetKind,
        alpha_u: impl Into<Texture>,
        alpha_v: impl Into<Texture>,
    ) -> Self {
        Self {
            kind,
            alpha_u: alpha_u.into(),
            alpha_v: alpha_v.into(),
        }
    }

    /// Makes a roughness that is the same along all directions of the surface.
    pub fn isotropic(kind: MicrofacetKind, alpha: impl Into<Texture>) -> Self {
        let alpha = alpha.into();
        Self::new(kind, alpha.clone(), alpha)
    }

    /// The distribution at one point.
    #[inline]
    pub fn at(&self, uv: Vec2) -> Microfacets {
        let alpha = Vec2::new(self.alpha_u.value(uv), self.alpha_v.value(uv));
        Microfacets::new(self.kind, alpha)
    }
}

/// The small mirrors at one point of a surface.
///
/// All directions are those of the upper hemisphere; callers below the surface turn them over.
#[derive(Clone, Copy, Debug)]
pub struct Microfacets {
    kind: MicrofacetKind,
    alpha: Vec2,
}

impl Microfacets {
    /// Makes the distribution; see [`Roughness::new`] for the range of `alpha`.
    #[inline]
    pub fn new(kind: MicrofacetKind, alpha: Vec2) -> Self {
        Self {
            kind,
            alpha: alpha.max(Vec2::splat(1e-4)),
        }
    }

    /// Roughness along tangent and bitangent.
    #[inline]
    pub fn alpha(&self) -> Vec2 {
        self.alpha
    }

    /// Area of mirrors with normal `m`, per solid angle and area of the surface, in 1/sr.
    ///
    /// Source: Walter 2007; with two roughnesses Heitz 2014.
    #[inline]
    pub fn normal_density(&self, m: Local) -> f32 {
        // Nearer to the horizon Beckmann's exponential is zero, and its divisor may be, too.
        const LEAST_COSINE: f32 = 1e-5;
        if m.0.z < LEAST_COSINE {
            return 0.0;
        }
        let z2 = m.0.z * m.0.z;
        let slope2 = (m.0.truncate() / self.alpha).length_squared();
        let scale = PI * self.alpha.x * self.alpha.y;
        match self.kind {
            MicrofacetKind::Beckmann => (-slope2 / z2).exp() / (scale * z2 * z2),
            MicrofacetKind::Ggx => {
                let sum = slope2 + z2;
                1.0 / (scale * sum * sum)
            }
        }
    }

    /// Share of the mirrors facing `v` that other mirrors do not hide, `G₁(v)`, in `[0, 1]`.
    ///
    /// Source: Heitz 2014; for Beckmann the exact form, not the rational approximation.
    #[inline]
    pub fn masking(&self, v: Local) -> f32 {
        let z = v.0.z;
        if z <= 0.0 {
            return 0.0;
        }
        let stretched2 = (v.0.truncate() * self.alpha).length_squared();
        match self.kind {
            MicrofacetKind::Beckmann => {
                let a = z / stretched2.sqrt();
                let (erf, gauss) = erf_and_gauss(a);
                2.0 / (1.0 + erf + gauss * FRAC_1_SQRT_PI / a)
            }
            MicrofacetKind::Ggx => 2.0 * z / (z + (z * z + stretched2).sqrt()),
        }
    }

    /// Density of [`Microfacets::sample_visible`], in 1/sr of normals.
    ///
    /// Source: Heitz 2014 (distribution of visible normals).
    #[inline]
    pub fn visible_density(&self, wi: Local, m: Local) -> f32 {
        4.0 * wi.0.dot(m.0).max(0.0) * self.reflected_density(wi, m)
    }

    /// Density in 1/sr of the direction that the sampled mirror `m` reflects `wi` into.
    ///
    /// Source: Walter 2007 (Jacobian of reflection).
    #[inline]
    pub fn reflected_density(&self, wi: Local, m: Local) -> f32 {
        self.masking(wi) * self.normal_density(m) / (4.0 * wi.0.z)
    }

    /// Samples the normal of a mirror in proportion to its area as seen from `wi`.
    ///
    /// - `wi`: above the surface; `u`: uniform in `[0, 1)²`.
    #[inline]
    pub fn sample_visible(&self, wi: Local, u: Vec2) -> Local {
        // Stretching by the roughness turns the surface into one of roughness one.
        let stretched = Vec3::new(wi.0.x * self.alpha.x, wi.0.y * self.alpha.y, wi.0.z).normalize();
        let normal = match self.kind {
            MicrofacetKind::Beckmann => sample_visible_beckmann(stretched, u),
            MicrofacetKind::Ggx => sample_visible_ggx(stretched, u),
        };
        let normal = Vec3::new(normal.x * self.alpha.x, normal.y * self.alpha.y, normal.z);
        Local(normal.normalize())
    }
}

impl Microfacets {
    /// Undoes [`Microfacets::sample_visible`].
    ///
    /// - `m`: a normal that is seen from `wi`, both above the surface.
    pub fn invert_visible(&self, wi: Local, m: Local) -> Vec2 {
        let stretched = Vec3::new(wi.0.x * self.alpha.x, wi.0.y * self.alpha.y, wi.0.z).normalize();
        let normal = Vec3::new(m.0.x / self.alpha.x, m.0.y / self.alpha.y, m.0.z);
        match self.kind {
            MicrofacetKind::Beckmann => invert_visible_beckmann(stretched, normal),
            MicrofacetKind::Ggx => invert_visible_ggx(stretched, normal.normalize()),
        }
    }
}

/// Turns both directions over where the first comes from below.
#[inline]
pub(super) fn from_above(wi: Local, wo: Local) -> (Local, Local) {
    if wi.cos() >= 0.0 {
        (wi, wo)
    } else {
        (wi.flipped(), wo.flipped())
    }
}

/// The direction that a mirror with normal `m` reflects `wi` into.
#[inline]
pub(super) fn mirrored_at(wi: Local, m: Local) -> Local {
    Local(m.0 * (2.0 * wi.0.dot(m.0)) - wi.0)
}

/// The normal of the mirror that reflects `wi` into `wo`, and its cosine to both of them.
///
/// Both are above the surface. Half the length of their sum has more digits at grazing angles than
/// a scalar product with the normal, and is the same for both, to the bit.
#[inline]
pub(super) fn halfway(wi: Local, wo: Local) -> (Local, f32) {
    let sum = wi.0 + wo.0;
    let length = sum.length();
    (Local(sum / length), (0.5 * length).min(1.0))
}

/// Samples a normal of GGX with roughness one that is seen from `wi`; not normalised.
///
/// The mirrors form a hemisphere, which reflects the directions of a spherical cap back to `wi`.
///
/// Source: Dupuy & Benyoub 2023.
#[inline]
fn sample_visible_ggx(wi: Vec3, u: Vec2) -> Vec3 {
    // Height above the cap's rim, kept apart from the rim: their sum would cancel.
    let height = (1.0 - u.y) * (1.0 + wi.z);
    let z = height - wi.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    Vec3::new(wi.x + radius * cos, wi.y + radius * sin, height)
}

/// Undoes [`sample_visible_ggx`] for a unit normal.
fn invert_visible_ggx(wi: Vec3, normal: Vec3) -> Vec2 {
    let sum = normal * (2.0 * wi.dot(normal));
    Vec2::new(turn((sum - wi).truncate()), 1.0 - sum.z / (1.0 + wi.z))
}

/// Samples a normal of Beckmann with roughness one that is seen from `wi`; not normalised.
///
/// Source: Jakob 2014 (improved sampling of visible normals).
fn sample_visible_beckmann(wi: Vec3, u: Vec2) -> Vec3 {
    let sin = wi.truncate().length();
    let along = visible_slope_beckmann(wi.z, sin, u.x);
    let across = erf_inverse(2.0 * u.y - 1.0);
    let azimuth = if sin > 0.0 {
        wi.truncate() / sin
    } else {
        Vec2::X
    };
    // The normal's horizontal part is minus the slope.
    let slope = azimuth * along + azimuth.perp() * across;
    Vec3::new(-slope.x, -slope.y, 1.0)
}

/// Undoes [`sample_visible_beckmann`].
fn invert_visible_beckmann(wi: Vec3, normal: Vec3) -> Vec2 {
    let sin = wi.truncate().length();
    let azimuth = if sin > 0.0 {
        wi.truncate() / sin
    } else {
        Vec2::X
    };
    let slope = -normal.truncate() / normal.z;
    let error_function = |x: f32| {
        let (erf, gauss) = erf_and_gauss(x.abs());
        (erf.copysign(x), gauss)
    };
    let (along, gauss) = error_function(slope.dot(azimuth));
    let (across, _) = error_function(slope.dot(azimuth.perp()));
    // The distribution function that `visible_slope_beckmann` inverts.
    let scaled_tan = sin / wi.z * FRAC_1_SQRT_PI;
    let (highest, least_gauss) = erf_and_gauss(wi.z / sin);
    let total = 1.0 + highest + scaled_tan * least_gauss;
    let below = 1.0 + along + scaled_tan * gauss;
    Vec2::new(below / total, 0.5 * (1.0 + across))
}

/// Samples the slope, along the azimuth of the direction that looks at them, of visible mirrors.
///
/// Slopes `x ≤ cot θ` are visible, with a distribution function in proportion to
/// `1 + erf(x) + tan θ · exp(−x²)/√π`. It is inverted in `b = erf(x)`, where it is nearly linear.
///
/// - `cos`, `sin`: of the angle θ between direction and normal, `cos > 0`.
///
/// Source: Jakob 2014. Differs: the start of Newton's method, for which the bracket makes up.
fn visible_slope_beckmann(cos: f32, sin: f32, u: f32) -> f32 {
    let tan = sin / cos;
    let scaled_tan = tan * FRAC_1_SQRT_PI;
    let (highest, gauss) = erf_and_gauss(cos / sin);
    let total = 1.0 + highest + scaled_tan * gauss;
    let (mut low, mut high) = (-1.0, highest);
    // At normal incidence the function is linear in b, at grazing angles nearly a square.
    let mut b = highest - (1.0 + highest) * (1.0 - u).powf(1.0 - 0.55 * sin);
    let mut x = 0.0;
    for _ in 0..12 {
        if !(b > low && b < high) {
            b = 0.5 * (low + high);
        }
        x = erf_inverse(b);
        let excess = 1.0 + b + scaled_tan * (-x * x).exp() - u * total;
        if excess.abs() < 1e-6 * total {
            break;
        }
        if excess > 0.0 {
            high = b;
        } else {
            low = b;
        }
        b -= excess / (1.0 - x * tan);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::quadrature::gauss_legendre;

    const KINDS: [MicrofacetKind; 2] = [MicrofacetKind::Beckmann, MicrofacetKind::Ggx];

    fn direction(cos: f32, azimuth: f32) -> Local {
        let sin = (1.0 - cos * cos).sqrt();
        Local::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
    }

    /// Integral over the upper hemisphere.
    fn hemisphere_integral(f: impl Fn(Local) -> f32) -> f64 {
        let azimuths = 256;
        let mut sum = 0.0;
        for (t, weight) in gauss_legendre(128) {
            // Nodes crowd towards the normal, where smooth surfaces have their peak.
            let drop = t.powi(4);
            for i in 0..azimuths {
                let azimuth = (i as f32 + 0.5) / azimuths as f32 * TAU;
                let m = direction((1.0 - drop) as f32, azimuth);
                sum += weight * 4.0 * t.powi(3) * f64::from(f(m));
            }
        }
        sum * std::f64::consts::TAU / f64::from(azimuths)
    }

    #[test]
    fn mirrors_cover_the_surface_once() {
        for kind in KINDS {
            for alpha in [Vec2::splat(0.1), Vec2::splat(0.7), Vec2::new(0.2, 0.5)] {
                let facets = Microfacets::new(kind, alpha);
                let area = hemisphere_integral(|m| facets.normal_density(m) * m.cos());
                assert!((area - 1.0).abs() < 2e-4, "{facets:?}: {area}");
            }
        }
    }

    #[test]
    fn visible_mirrors_fill_the_view() {
        for kind in KINDS {
            for alpha in [Vec2::splat(0.3), Vec2::new(0.2, 0.5)] {
                let facets = Microfacets::new(kind, alpha);
                for cos in [1.0, 0.8, 0.4, 0.1] {
                    let wi = direction(cos, 0.7);
                    let area = hemisphere_integral(|m| facets.visible_density(wi, m));
                    assert!((area - 1.0).abs() < 2e-3, "{facets:?} {cos}: {area}");
                }
            }
        }
    }

    #[test]
    fn sampled_slopes_follow_the_distribution_function() {
        for cos in [1.0_f64, 0.9, 0.3, 0.03, 1e-3] {
            let sin = (1.0 - cos * cos).sqrt();
            let function = |x: f64| {
                1.0 + statrs::function::erf::erf(x)
                    + sin / cos * (-x * x).exp() / std::f64::consts::PI.sqrt()
            };
            let total = if sin > 0.0 { function(cos / sin) } else { 2.0 };
            for i in 0..1000 {
                let u = (i as f32 + 0.5) / 1000.0;
                let x = visible_slope_beckmann(cos as f32, sin as f32, u);
                let back = function(f64::from(x)) / total;
                assert!((back - f64::from(u)).abs() < 5e-6, "{cos} {u}: {back}");
            }
        }
    }

    #[test]
    fn samples_stay_finite_in_the_corners() {
        for kind in KINDS {
            for alpha in [1e-4, 0.5] {
                let facets = Microfacets::new(kind, Vec2::splat(alpha));
                for wi in [
                    Local::NORMAL,
                    direction(1e-3, 2.0),
                    Local::new(1.0, 0.0, 1e-6),
                ] {
                    for u in [Vec2::ZERO, Vec2::splat(1.0 - 6e-8), Vec2::new(0.0, 0.5)] {
                        let m = facets.sample_visible(wi, u);
                        assert!(
                            m.0.is_normalized() && m.cos() >= 0.0,
                            "{facets:?} {wi:?} {u}"
                        );
                    }
                }
            }
        }
    }
}
