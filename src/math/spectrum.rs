//! From wavelengths to linear Rec.709: curves, blackbodies and the equal-energy white.
//!
//! Rendering is done in RGB, so every spectrum becomes three numbers once, when the scene is read.
//! The price is that dispersion and metamerism are lost.

use glam::{DMat3, DVec3};
use thiserror::Error;

use super::Rgb;
use super::cie::{FIRST_WAVELENGTH, LAST_WAVELENGTH, STEP, d65, observer};

/// CIE XYZ to linear Rec.709 with a D65 white, column by column.
const XYZ_TO_REC709: DMat3 = DMat3::from_cols(
    DVec3::new(3.240479, -0.969256, 0.055648),
    DVec3::new(-1.537150, 1.875991, -0.204043),
    DVec3::new(-0.498535, 0.041556, 1.057311),
);

/// A quantity given at some wavelengths: linear between them, zero outside the given range.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralCurve {
    samples: Vec<(f64, f64)>,
}

/// Why a list of pairs is no [`SpectralCurve`].
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SpectralCurveError {
    /// Fewer than two pairs were given.
    #[error("a curve needs at least two wavelengths")]
    TooShort,
    /// A wavelength does not lie above the one before it.
    #[error("wavelengths must increase, but {second} nm follows {first} nm")]
    NotIncreasing {
        /// The larger or equal wavelength that comes first, in nm.
        first: f64,
        /// The wavelength that follows it, in nm.
        second: f64,
    },
    /// A number is infinite or not a number.
    #[error("wavelengths and values must be finite")]
    NotFinite,
}

impl SpectralCurve {
    /// Makes a curve from pairs (wavelength in nm, value) with increasing wavelengths.
    ///
    /// # Errors
    /// Fewer than two pairs, wavelengths that do not increase, numbers that are not finite.
    pub fn new(samples: Vec<(f64, f64)>) -> Result<Self, SpectralCurveError> {
        if samples.len() < 2 {
            return Err(SpectralCurveError::TooShort);
        }
        if samples
            .iter()
            .any(|(wavelength, value)| !(wavelength.is_finite() && value.is_finite()))
        {
            return Err(SpectralCurveError::NotFinite);
        }
        for pair in samples.windows(2) {
            if pair[1].0 <= pair[0].0 {
                let (first, second) = (pair[0].0, pair[1].0);
                return Err(SpectralCurveError::NotIncreasing { first, second });
            }
        }
        Ok(Self { samples })
    }

    /// The value at `wavelength` nm.
    pub fn eval(&self, wavelength: f64) -> f64 {
        let after = self
            .samples
            .partition_point(|sample| sample.0 <= wavelength);
        let Some(&(start, low)) = after.checked_sub(1).and_then(|i| self.samples.get(i)) else {
            return 0.0;
        };
        match self.samples.get(after) {
            Some(&(end, high)) => low + (high - low) * (wavelength - start) / (end - start),
            None if wavelength == start => low,
            None => 0.0,
        }
    }

    /// The colour of a surface with this reflectance under D65, each channel in [0, 1].
    pub fn to_reflectance(&self) -> Rgb {
        self.to_index().clamp(0.0, 1.0)
    }

    /// The three numbers that stand for an index of refraction or an absorption.
    ///
    /// Weighted by D65 as a reflectance is, so that a constant stays what it is, but without an
    /// upper bound. Channels are at least 0: saturated curves lie outside Rec.709.
    pub fn to_index(&self) -> Rgb {
        let xyz = self.integrate(|wavelength| self.eval(wavelength) * d65(wavelength));
        let white = integrate(&table_grid(), d65);
        to_rec709(xyz / white.y).map(|channel| channel.max(0.0))
    }

    /// The colour of a light with this spectral radiance (or intensity, or power), unit kept.
    ///
    /// A constant of 1 has the luminance 1. Channels are at least 0.
    pub fn to_emission(&self) -> Rgb {
        let xyz = self.integrate(|wavelength| self.eval(wavelength)) / observer_integral();
        to_rec709(xyz).map(|channel| channel.max(0.0))
    }

    /// Integrates `f` against the observer over the part of the table that the curve covers.
    fn integrate(&self, f: impl Fn(f64) -> f64) -> DVec3 {
        let (first, last) = (self.samples[0].0, self.samples[self.samples.len() - 1].0);
        let (start, end) = (first.max(FIRST_WAVELENGTH), last.min(LAST_WAVELENGTH));
        let mut nodes = table_grid();
        nodes.extend(self.samples.iter().map(|sample| sample.0));
        nodes.extend([start, end]);
        nodes.retain(|wavelength| (start..=end).contains(wavelength));
        nodes.sort_by(f64::total_cmp);
        integrate(&nodes, f)
    }
}

/// The colour of a blackbody's radiance, in W·m⁻²·sr⁻¹·nm⁻¹ weighted as in
/// [`SpectralCurve::to_emission`].
///
/// - `temperature`: in kelvin, positive.
/// - `scale`: factor on the radiance, without unit.
pub fn blackbody(temperature: f64, scale: f64) -> Rgb {
    let xyz = integrate(&table_grid(), |wavelength| {
        scale * planck(wavelength, temperature)
    });
    to_rec709(xyz / observer_integral()).map(|channel| channel.max(0.0))
}

/// The colour of an equal-energy white light of value 1: XYZ = (1, 1, 1).
pub fn equal_energy_white() -> Rgb {
    to_rec709(DVec3::ONE)
}

/// Planck's law: spectral radiance in W·m⁻²·sr⁻¹·nm⁻¹ at `wavelength` nm and `temperature` K.
fn planck(wavelength: f64, temperature: f64) -> f64 {
    /// Planck's constant in J·s, the speed of light in m/s, Boltzmann's constant in J/K (exact SI).
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K: f64 = 1.380_649e-23;
    let metres = wavelength * 1e-9;
    let per_metre =
        2.0 * H * C * C / (metres.powi(5) * (H * C / (metres * K * temperature)).exp_m1());
    per_metre * 1e-9
}

/// The wavelengths of the CIE tables.
fn table_grid() -> Vec<f64> {
    (0..super::cie::ENTRIES)
        .map(|i| FIRST_WAVELENGTH + STEP * i as f64)
        .collect()
}

/// ∫ ȳ dλ, which makes a constant spectrum of 1 have Y = 1.
fn observer_integral() -> f64 {
    integrate(&table_grid(), |_| 1.0).y
}

/// ∫ f(λ) (x̄, ȳ, z̄) dλ by Simpson's rule between the sorted `nodes`.
///
/// The rule is exact for the product of observer, illuminant and curve when `nodes` holds the kinks
/// of all three: between kinks it is a cubic.
fn integrate(nodes: &[f64], f: impl Fn(f64) -> f64) -> DVec3 {
    let weighted = |wavelength| DVec3::from_array(observer(wavelength)) * f(wavelength);
    let simpson = |pair: &[f64]| {
        let (a, b) = (pair[0], pair[1]);
        (weighted(a) + 4.0 * weighted(0.5 * (a + b)) + weighted(b)) * ((b - a) / 6.0)
    };
    nodes.windows(2).map(simpson).sum()
}

fn to_rec709(xyz: DVec3) -> Rgb {
    Rgb((XYZ_TO_REC709 * xyz).as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(samples: &[(f64, f64)]) -> SpectralCurve {
        SpectralCurve::new(samples.to_vec()).unwrap()
    }

    /// `tolerance` is relative to the largest channel.
    fn assert_near(found: Rgb, expected: [f32; 3], tolerance: f32) {
        let expected = Rgb::from(expected);
        let error = (found - expected).map(f32::abs).max_channel();
        let allowed = tolerance * expected.max_channel();
        assert!(error <= allowed, "{found:?} is not {expected:?}");
    }

    #[test]
    fn constant_curves_are_grey_surfaces_and_equal_energy_lights() {
        let half = curve(&[(300.0, 0.5), (900.0, 0.5)]);
        assert_near(half.to_reflectance(), [0.5; 3], 2e-4);
        assert_near(
            half.to_emission() * 2.0,
            equal_energy_white().to_array(),
            3e-4,
        );
        assert_near(equal_energy_white(), [1.2048, 0.9483, 0.9089], 1e-4);
        assert!((half.to_emission().luminance() - 0.5).abs() < 1e-4);
    }

    #[test]
    fn curves_agree_with_another_renderer() {
        // Mitsuba 3.9.1, scalar_rgb: parameters of a diffuse BSDF and a constant emitter. Its sums
        // over 1000 points are about 1e-3 low.
        let surface = curve(&[(400.0, 0.1), (500.0, 0.5), (600.0, 0.7), (700.0, 0.2)]);
        assert_near(
            surface.to_reflectance(),
            [0.628604, 0.604581, 0.278625],
            1.5e-3,
        );
        let ramp = curve(&[(300.0, 0.2), (900.0, 0.9)]);
        assert_near(
            ramp.to_reflectance(),
            [0.598888, 0.482955, 0.363864],
            1.5e-3,
        );
        let light = curve(&[(400.0, 0.0), (500.0, 8.0), (600.0, 15.6), (700.0, 18.4)]);
        assert_near(light.to_emission(), [20.7108, 10.8546, 2.77115], 1.5e-3);
        let step = curve(&[
            (432.0, 0.031),
            (497.0, 0.025),
            (516.0, 0.541),
            (542.0, 0.939),
            (682.0, 0.381),
            (749.0, 0.217),
        ]);
        assert_near(step.to_reflectance(), [0.734188, 0.744576, 0.0], 1.5e-3);
        assert_near(step.to_emission(), [0.852287, 0.717267, 0.0], 1.5e-3);
        let eta = curve(&[(450.0, 0.5), (500.0, 1.0), (650.0, 2.0)]);
        assert_near(eta.to_index(), [1.71677, 1.33963, 0.258248], 1.5e-3);
    }

    #[test]
    fn colours_outside_rec709_are_clamped_and_only_reflectances_from_above() {
        let green = curve(&[(450.0, 0.0), (500.0, 1.0), (550.0, 0.0)]);
        assert_near(green.to_emission(), [0.0, 0.321426, 0.182099], 1.5e-3);
        assert_near(green.to_reflectance(), [0.0, 0.348769, 0.210188], 1.5e-3);
        let large = curve(&[(300.0, 3.0), (900.0, 3.0)]);
        assert_eq!(large.to_reflectance(), Rgb::WHITE);
        assert_near(large.to_index(), [3.0; 3], 2e-4);
    }

    #[test]
    fn outside_the_given_range_a_curve_is_zero() {
        let one = curve(&[(400.0, 1.0), (500.0, 3.0)]);
        assert_eq!(one.eval(399.9), 0.0);
        assert_eq!(one.eval(400.0), 1.0);
        assert_eq!(one.eval(450.0), 2.0);
        assert_eq!(one.eval(500.0), 3.0);
        assert_eq!(one.eval(500.1), 0.0);
        assert!(
            curve(&[(900.0, 1.0), (950.0, 1.0)])
                .to_emission()
                .is_black()
        );
    }

    #[test]
    fn bad_curves_are_refused() {
        let nan = SpectralCurve::new(vec![(400.0, f64::NAN), (500.0, 1.0)]);
        assert_eq!(nan, Err(SpectralCurveError::NotFinite));
        assert_eq!(
            SpectralCurve::new(vec![(400.0, 1.0)]),
            Err(SpectralCurveError::TooShort)
        );
        let back = SpectralCurve::new(vec![(500.0, 1.0), (400.0, 1.0)]).unwrap_err();
        assert_eq!(
            back.to_string(),
            "wavelengths must increase, but 400 nm follows 500 nm"
        );
    }

    #[test]
    fn blackbodies_follow_plancks_law() {
        // Peak of the Sun's photosphere, from Wien's law: 26.3 kW·m⁻²·sr⁻¹·nm⁻¹ at 501 nm, 5778 K.
        assert!((planck(501.5, 5778.0) / 26_374.0 - 1.0).abs() < 2e-3);
        // A blackbody is close to a Planck curve sampled every 10 nm.
        let samples = (0..=50).map(|i| 350.0 + 10.0 * f64::from(i));
        let sampled = curve(&samples.map(|w| (w, planck(w, 3000.0))).collect::<Vec<_>>());
        assert_near(
            blackbody(3000.0, 1.0),
            sampled.to_emission().to_array(),
            1e-3,
        );
        assert_near(
            blackbody(3000.0, 2.0),
            (2.0 * blackbody(3000.0, 1.0)).to_array(),
            1e-6,
        );
    }

    #[test]
    fn blackbodies_agree_with_another_renderer() {
        // Mitsuba 3.9.1, scalar_spectral: its `blackbody` at every nm, summed against the observer.
        for (temperature, expected) in [
            (2000.0, [16.0142, 4.11181, 0.130369]),
            (5000.0, [15263.05, 12082.59, 9592.567]),
            (10_000.0, [158_408.5, 180_718.0, 260_025.8]),
        ] {
            assert_near(blackbody(temperature, 1.0), expected, 2e-4);
        }
    }

    #[test]
    fn cold_blackbodies_are_dark_and_finite() {
        assert!(blackbody(1.0, 1.0).is_black());
        assert!(blackbody(1e5, 1.0).is_finite());
    }
}
