//! How bright the sun is, seen through the air.

use crate::math::{Rgb, SpectralCurve};

/// Radius of the sun as seen from the Earth, in degrees.
pub const SUN_RADIUS: f32 = 0.2665;

/// Radiance of the sun above the air at 380, 390, … 750 nm, in 100 W·m⁻²·sr⁻¹·nm⁻¹.
const ABOVE_THE_AIR: [f64; 38] = [
    165.5, 162.3, 211.2, 258.8, 258.2, 242.3, 267.6, 296.6, 305.4, 300.6, 306.6, 288.3, 287.1,
    278.2, 271.0, 272.3, 263.6, 255.0, 250.6, 253.1, 253.5, 251.3, 246.3, 241.7, 236.8, 232.1,
    228.2, 223.4, 219.7, 215.3, 211.0, 207.3, 202.4, 198.7, 194.3, 190.7, 186.3, 182.6,
];

/// Absorption by ozone in 1/cm, from 355 nm.
const OZONE: [(f64, f64); 53] = [
    (355.0, 0.0),
    (445.0, 0.003),
    (450.0, 0.003),
    (455.0, 0.004),
    (460.0, 0.006),
    (465.0, 0.008),
    (470.0, 0.009),
    (475.0, 0.012),
    (480.0, 0.014),
    (485.0, 0.017),
    (490.0, 0.021),
    (495.0, 0.025),
    (500.0, 0.03),
    (505.0, 0.035),
    (510.0, 0.04),
    (515.0, 0.045),
    (520.0, 0.048),
    (525.0, 0.057),
    (530.0, 0.063),
    (535.0, 0.07),
    (540.0, 0.075),
    (545.0, 0.08),
    (550.0, 0.085),
    (555.0, 0.095),
    (560.0, 0.103),
    (565.0, 0.11),
    (570.0, 0.12),
    (575.0, 0.122),
    (580.0, 0.12),
    (585.0, 0.118),
    (590.0, 0.115),
    (595.0, 0.12),
    (600.0, 0.125),
    (605.0, 0.13),
    (610.0, 0.12),
    (620.0, 0.105),
    (630.0, 0.09),
    (640.0, 0.079),
    (650.0, 0.067),
    (660.0, 0.057),
    (670.0, 0.048),
    (680.0, 0.036),
    (690.0, 0.028),
    (700.0, 0.023),
    (710.0, 0.018),
    (720.0, 0.014),
    (730.0, 0.011),
    (740.0, 0.01),
    (750.0, 0.009),
    (760.0, 0.007),
    (770.0, 0.004),
    (780.0, 0.0),
    (790.0, 0.0),
];

/// Absorption by water vapour in 1/cm. Mixed gases absorb beyond 759 nm only, where the sun's table
/// has ended.
const WATER_VAPOUR: [(f64, f64); 8] = [
    (689.0, 0.0),
    (690.0, 0.016),
    (700.0, 0.024),
    (710.0, 0.0125),
    (720.0, 1.0),
    (730.0, 0.87),
    (740.0, 0.061),
    (750.0, 0.001),
];

/// Radiance of the sun's disk, through the air of the model: see [`SpectralCurve::to_emission`].
///
/// - `elevation`: of the sun above the horizon, in radians, not negative.
/// - `turbidity`: of the air; 2 is clear, 10 is hazy.
///
/// Source: Preetham, Shirley & Smits 1999, Appendix A.1 and Table 2.
pub(super) fn sun_radiance(elevation: f64, turbidity: f64) -> Rgb {
    let from_zenith = 90.0 - elevation.to_degrees();
    let cos = elevation.sin();
    // Air on the light's way, in thicknesses of the atmosphere.
    let mass = 1.0 / (cos + 0.15 * (93.885 - from_zenith).powf(-1.253));
    let (Ok(ozone), Ok(vapour)) = (
        SpectralCurve::new(OZONE.to_vec()),
        SpectralCurve::new(WATER_VAPOUR.to_vec()),
    ) else {
        unreachable!("the tables are in order")
    };
    let aerosol = 0.046_083_658 * turbidity - 0.045_860_259;
    let samples = ABOVE_THE_AIR.iter().enumerate().map(|(index, above)| {
        let wavelength = 380.0 + 10.0 * index as f64;
        let micrometres = wavelength / 1000.0;
        let rayleigh = 0.008_735 * micrometres.powf(-4.08) * mass;
        let dust = aerosol * micrometres.powf(-1.3) * mass;
        let ozone = ozone.eval(wavelength) * 0.35 * mass;
        let water: f64 = vapour.eval(wavelength) * 2.0 * mass;
        let water = 0.2385 * water / (1.0 + 20.07 * water).powf(0.45);
        let transmitted = (-(rayleigh + dust + ozone + water)).exp();
        (wavelength, 100.0 * above * transmitted)
    });
    match SpectralCurve::new(samples.collect()) {
        Ok(curve) => curve.to_emission(),
        Err(_) => unreachable!("wavelengths increase"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_high_sun_in_clear_air_gives_about_the_sunlight_that_is_measured() {
        let radiance = sun_radiance(std::f64::consts::FRAC_PI_2, 2.0);
        // Lux on a surface that faces it: 683 lm/W times ∫ȳ = 106.86 nm, times the solid angle.
        let solid_angle = 2.0 * std::f64::consts::PI * (1.0 - 0.2665_f64.to_radians().cos());
        let lux = f64::from(radiance.luminance()) * 683.0 * 106.86 * solid_angle;
        assert!((90_000.0..130_000.0).contains(&lux), "{lux}");
    }

    #[test]
    fn a_low_sun_is_dark_and_red() {
        let [high, low] = [1.0, 0.05].map(|elevation| sun_radiance(elevation, 3.0));
        assert!(low.luminance() < 0.3 * high.luminance());
        assert!(low.0.x / low.0.z > 3.0 * high.0.x / high.0.z);
        let hazy = sun_radiance(1.0, 8.0);
        assert!(hazy.luminance() < 0.7 * high.luminance());
    }
}
