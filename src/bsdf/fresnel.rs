//! Fresnel's equations for unpolarised light, and refraction.

use super::quadrature::gauss_legendre;
use super::{BsdfError, Local};
use crate::math::{Rgb, Vec3};

/// The index of refraction on the far side of a boundary over that on the near side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeIor {
    ratio: f32,
    inverse: f32,
}

/// What becomes of light at a smooth boundary.
#[derive(Clone, Copy, Debug)]
pub struct Refraction {
    /// Share of power that is reflected, in `[0, 1]`; one under total internal reflection.
    pub reflectance: f32,
    /// Cosine of the refracted direction to the normal on its own side, positive; zero under
    /// total internal reflection.
    pub cos_refracted: f32,
}

impl RelativeIor {
    /// Makes the ratio of a material's inside over its outside.
    ///
    /// - `interior`, `exterior`: indices of refraction, positive; the outside is where the normal
    ///   points to.
    ///
    /// # Errors
    /// [`BsdfError::IndexOfRefraction`] when one is not positive and finite, or their ratio is not.
    pub fn new(interior: f32, exterior: f32) -> Result<Self, BsdfError> {
        let ratio = interior / exterior;
        for index in [interior, exterior, ratio, 1.0 / ratio] {
            if !(index > 0.0 && index.is_finite()) {
                return Err(BsdfError::IndexOfRefraction(index));
            }
        }
        Ok(Self {
            ratio,
            inverse: 1.0 / ratio,
        })
    }

    /// Index on the far side over that on the near side.
    #[inline]
    pub fn ratio(self) -> f32 {
        self.ratio
    }

    /// Index on the near side over that on the far side.
    #[inline]
    pub fn inverse(self) -> f32 {
        self.inverse
    }

    /// The ratio as it is met from the side that a direction of cosine `cos` lies on.
    #[inline]
    pub fn seen_from(self, cos: f32) -> Self {
        if cos >= 0.0 {
            self
        } else {
            Self {
                ratio: self.inverse,
                inverse: self.ratio,
            }
        }
    }

    /// Reflectance and refracted angle of light that arrives from the near side.
    ///
    /// - `cos`: cosine to the normal on the near side, in `[0, 1]`.
    ///
    /// Source: Fresnel's equations; Snell's law as `cos²θ_t = ((η² − 1) + cos²θ_i) / η²`, which
    /// unlike `1 − sin²θ_i / η²` is exact for `η = 1` at grazing angles.
    #[inline]
    pub fn refract(self, cos: f32) -> Refraction {
        let eta = self.ratio;
        let scaled = (eta - 1.0) * (eta + 1.0) + cos * cos;
        if scaled <= 0.0 {
            return Refraction {
                reflectance: 1.0,
                cos_refracted: 0.0,
            };
        }
        let cos_refracted = (scaled.sqrt() * self.inverse).min(1.0);
        let s = (cos - eta * cos_refracted) / (cos + eta * cos_refracted);
        let p = (eta * cos - cos_refracted) / (eta * cos + cos_refracted);
        Refraction {
            reflectance: 0.5 * (s * s + p * p),
            cos_refracted,
        }
    }

    /// Share of power that passes a smooth boundary between two directions that refract into each
    /// other.
    ///
    /// The same as `1 − reflectance`, but exact where nearly nothing passes and the same from both
    /// sides: near the critical angle, Snell's law gives one cosine too few digits to find the other.
    ///
    /// - `cos`, `cos_refracted`: cosines to the normal on the near and the far side, positive.
    ///
    /// Source: Fresnel's equations.
    #[inline]
    pub fn transmittance(self, cos: f32, cos_refracted: f32) -> f32 {
        let s = cos + self.ratio * cos_refracted;
        let p = self.ratio * cos + cos_refracted;
        2.0 * self.ratio * cos * cos_refracted * (1.0 / (s * s) + 1.0 / (p * p))
    }

    /// Bends a direction through a boundary with normal `normal`, on whose side `wi` lies.
    ///
    /// - `cos`: `wi · normal`, positive; `cos_refracted`: as [`RelativeIor::refract`] gives it.
    #[inline]
    pub fn bend(self, wi: Local, normal: Local, cos: f32, cos_refracted: f32) -> Local {
        Local(normal.0 * (cos * self.inverse - cos_refracted) - wi.0 * self.inverse)
    }

    /// Share of perfectly diffuse light from the near side that the boundary reflects.
    ///
    /// By quadrature for `η ≥ 1`. For `η < 1` through the étendue of what passes:
    /// `1 − R(η) = η² (1 − R(1/η))`.
    pub fn diffuse_reflectance(self) -> f32 {
        if self.ratio < 1.0 {
            let passed = 1.0 - self.seen_from(-1.0).diffuse_reflectance();
            return 1.0 - self.ratio * self.ratio * passed;
        }
        // ∫ F(μ) 2μ dμ over [0, 1], with μ = t² because F is steep near μ = 0.
        let sum: f64 = gauss_legendre(64)
            .into_iter()
            .map(|(t, weight)| {
                let reflectance = self.refract((t * t) as f32).reflectance;
                weight * 4.0 * t.powi(3) * f64::from(reflectance)
            })
            .sum();
        sum as f32
    }
}

/// Complex index of refraction of a conductor, over the real index of the outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexIor {
    /// Real part, per channel.
    pub eta: Rgb,
    /// Absorption, the positive imaginary part, per channel.
    pub k: Rgb,
}

impl ComplexIor {
    /// Reflectance of each channel.
    ///
    /// - `cos`: cosine to the normal, in `[0, 1]`.
    ///
    /// Source: Fresnel's equations with a complex index, in the form without complex numbers.
    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        let cos2 = cos * cos;
        let sin2 = (1.0 - cos2).max(0.0);
        let (eta, k) = (self.eta.0, self.k.0);
        let difference = eta * eta - k * k - Vec3::splat(sin2);
        // |η_t cos θ_t|², and twice its real part times cos θ_i.
        let norm = (difference * difference + 4.0 * eta * eta * k * k).map(f32::sqrt);
        let mixed = (2.0 * cos) * (0.5 * (norm + difference)).max(Vec3::ZERO).map(f32::sqrt);
        let s = (norm + cos2 - mixed) / (norm + cos2 + mixed);
        let (a, b) = (norm * cos2 + sin2 * sin2, mixed * sin2);
        let p = s * (a - b) / (a + b);
        Rgb(0.5 * (s + p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ior(ratio: f32) -> RelativeIor {
        RelativeIor::new(ratio, 1.0).unwrap()
    }

    #[test]
    fn bad_indices_are_refused() {
        for (interior, exterior) in [
            (0.0, 1.0),
            (1.5, 0.0),
            (-1.5, -1.0),
            (f32::NAN, 1.0),
            (f32::INFINITY, 1.0),
            (1e38, 1e-38),
        ] {
            assert!(RelativeIor::new(interior, exterior).is_err());
        }
    }

    #[test]
    fn glass_reflects_what_the_textbooks_say() {
        assert!((ior(1.5).refract(1.0).reflectance - 0.04).abs() < 1e-7);
        assert_eq!(ior(1.5).refract(0.0).reflectance, 1.0);
        // Brewster's angle: tan θ = η, half of the s-polarised reflectance is left.
        let brewster = (1.0_f32 / (1.0 + 1.5 * 1.5)).sqrt();
        let s = (1.0_f32 - 1.5 * 1.5) / (1.0 + 1.5 * 1.5);
        assert!((ior(1.5).refract(brewster).reflectance - 0.5 * s * s).abs() < 1e-6);
    }

    #[test]
    fn light_comes_back_on_its_way_and_is_reflected_alike() {
        for ratio in [0.5_f32, 0.999, 1.0, 1.001, 1.5, 2.4] {
            for i in 0..=100 {
                let there = ior(ratio).refract(i as f32 / 100.0);
                // Near the critical angle the reflectance is too steep to compare.
                if there.cos_refracted > 0.1 && i > 10 {
                    let back = ior(1.0 / ratio).refract(there.cos_refracted);
                    assert!((there.reflectance - back.reflectance).abs() < 2e-4);
                    assert!((back.cos_refracted - i as f32 / 100.0).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn what_is_not_reflected_passes_from_either_side() {
        for ratio in [0.5_f32, 0.999, 1.0, 1.05, 2.4] {
            for i in 1..=100 {
                let cos = i as f32 / 100.0;
                let refraction = ior(ratio).refract(cos);
                let passed = ior(ratio).transmittance(cos, refraction.cos_refracted);
                assert!((passed - (1.0 - refraction.reflectance)).abs() < 1e-6);
                let back = ior(1.0 / ratio).transmittance(refraction.cos_refracted, cos);
                assert!((back - passed).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn what_passes_near_the_critical_angle_has_all_its_digits() {
        let (ratio, refracted) = (1.0_f32 / 2.4, 2e-3_f32);
        let (eta, cos_o) = (f64::from(ratio), f64::from(refracted));
        let cos_i = (1.0 - eta * eta * (1.0 - cos_o * cos_o)).sqrt();
        let (s, p) = (cos_i + eta * cos_o, eta * cos_i + cos_o);
        let exact = 2.0 * eta * cos_i * cos_o * (1.0 / (s * s) + 1.0 / (p * p));
        let error = |passed: f32| (f64::from(passed) / exact - 1.0).abs();
        let cos = cos_i as f32;
        assert!(error(ior(ratio).transmittance(cos, refracted)) < 1e-6);
        // What makes the other form useless here.
        assert!(error(1.0 - ior(ratio).refract(cos).reflectance) > 1e-3);
    }

    #[test]
    fn matched_indices_reflect_nothing_even_at_grazing_angles() {
        for cos in [1e-6, 1e-4, 0.5, 1.0] {
            let refraction = ior(1.0).refract(cos);
            assert!(refraction.reflectance < 1e-12);
            assert_eq!(refraction.cos_refracted, cos);
        }
        assert!(ior(1.0).diffuse_reflectance() < 1e-6);
    }

    #[test]
    fn total_internal_reflection_starts_at_the_critical_angle() {
        let critical = (1.0_f32 - (1.0_f32 / 1.5).powi(2)).sqrt();
        assert!(
            ior(1.5)
                .seen_from(-1.0)
                .refract(critical * 1.001)
                .reflectance
                < 1.0
        );
        assert_eq!(
            ior(1.5)
                .seen_from(-1.0)
                .refract(critical * 0.999)
                .reflectance,
            1.0
        );
    }

    #[test]
    fn diffuse_reflectance_agrees_with_brute_force() {
        for ratio in [0.4, 1.0 / 1.5, 0.99, 1.01, 1.5, 3.0] {
            let n = 1_000_000;
            let brute: f64 = (0..n)
                .map(|i| {
                    let cos = (f64::from(i) + 0.5) / f64::from(n);
                    2.0 * cos * f64::from(ior(ratio).refract(cos as f32).reflectance)
                })
                .sum::<f64>()
                / f64::from(n);
            let found = f64::from(ior(ratio).diffuse_reflectance());
            assert!((found - brute).abs() < 2e-6, "{ratio}: {found} {brute}");
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        let metal = ComplexIor {
            eta: Rgb::new(1.5, 2.0, 1.2),
            k: Rgb::BLACK,
        };
        for i in 0..=20 {
            let cos = i as f32 / 20.0;
            let reflectance = metal.reflectance(cos);
            for channel in 0..3 {
                let glass = ior(metal.eta[channel]).refract(cos).reflectance;
                assert!((reflectance[channel] - glass).abs() < 1e-5);
            }
        }
    }
}
