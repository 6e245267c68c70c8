//! How far an image is from a reference, in numbers.

use super::pixels::{QUANTITIES, Subject, quantities, variances};
use crate::math::Rgb;

/// Added to squared reference values, so that dark pixels do not rule the relative error.
const RELATIVE_FLOOR: f64 = 0.01;

/// A ratio of two means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Mean of the image over mean of the reference.
    pub value: f64,
    /// Its standard error, where the variances of both images are known.
    pub standard_error: Option<f64>,
}

/// How far an image is from a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Pixels that counted.
    pub pixels: usize,
    /// Mean squared difference over pixels and channels.
    pub mse: f64,
    /// Mean squared difference of luminance over pixels.
    ///
    /// Source: Lai et al. 2007 (`Err`).
    pub luminance_mse: f64,
    /// Mean of `(I − R)² / (R² + 0.01)`.
    pub relative_mse: f64,
    /// Share of `relative_mse` that is the reference's own noise, mean of `Var R / (R² + 0.01)`;
    /// known where the reference's variance is.
    pub reference_noise: Option<f64>,
    /// Ratios of the means of luminance, red, green and blue.
    pub ratios: [Ratio; QUANTITIES],
}

impl Comparison {
    /// The relative error without the reference's own noise, where that is known.
    pub fn corrected_relative_mse(&self) -> Option<f64> {
        self.reference_noise.map(|noise| self.relative_mse - noise)
    }
}

/// Compares the pixels that count.
///
/// Values that are not finite make the results not finite. Without any pixel, all results are NaN.
pub fn compare(subject: &Subject<'_>) -> Comparison {
    let mut sums = Sums::default();
    for index in subject.indices() {
        sums.add(subject, index);
    }
    let values = sums.pixels as f64 * 3.0;
    let has_reference_variance = subject.reference_variance.is_some();
    let both = subject.variance.is_some() && has_reference_variance;
    Comparison {
        pixels: sums.pixels,
        mse: sums.squared / values,
        luminance_mse: sums.luminance_squared / sums.pixels as f64,
        relative_mse: sums.relative / values,
        reference_noise: has_reference_variance.then(|| sums.reference_noise / values),
        ratios: std::array::from_fn(|quantity| sums.ratio(quantity, both)),
    }
}

#[derive(Default)]
struct Sums {
    pixels: usize,
    squared: f64,
    luminance_squared: f64,
    relative: f64,
    reference_noise: f64,
    image: [f64; QUANTITIES],
    reference: [f64; QUANTITIES],
    image_variance: [f64; QUANTITIES],
    reference_variance: [f64; QUANTITIES],
}

impl Sums {
    fn add(&mut self, subject: &Subject<'_>, index: usize) {
        let (own, other) = (
            subject.image.colours[index],
            subject.reference.colours[index],
        );
        let at = |pixels: Option<&super::Pixels>| pixels.map_or(Rgb::BLACK, |p| p.colours[index]);
        let reference_variance = at(subject.reference_variance);
        self.pixels += 1;
        for channel in 0..3 {
            let reference = f64::from(other[channel]);
            let difference = f64::from(own[channel]) - reference;
            let scale = reference * reference + RELATIVE_FLOOR;
            self.squared += difference * difference;
            self.relative += difference * difference / scale;
            self.reference_noise += f64::from(reference_variance[channel]) / scale;
        }
        let (of_image, of_reference) = (quantities(own), quantities(other));
        self.luminance_squared += (of_image[0] - of_reference[0]).powi(2);
        accumulate(&mut self.image, of_image);
        accumulate(&mut self.reference, of_reference);
        accumulate(&mut self.image_variance, variances(at(subject.variance)));
        accumulate(&mut self.reference_variance, variances(reference_variance));
    }

    /// Ratio of the sums of one quantity; its error to first order in those of the sums.
    fn ratio(&self, quantity: usize, with_error: bool) -> Ratio {
        let (image, reference) = (self.image[quantity], self.reference[quantity]);
        let value = image / reference;
        let own = self.image_variance[quantity] / (reference * reference);
        let other = self.reference_variance[quantity] / (reference * reference);
        let standard_error = (own + value * value * other).sqrt();
        Ratio {
            value,
            standard_error: with_error.then_some(standard_error),
        }
    }
}

fn accumulate(sums: &mut [f64; QUANTITIES], values: [f64; QUANTITIES]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Pixels;

    fn row(colours: &[Rgb]) -> Pixels {
        Pixels {
            width: colours.len() as u32,
            height: 1,
            colours: colours.to_vec(),
        }
    }

    fn subject<'p>(image: &'p Pixels, reference: &'p Pixels) -> Subject<'p> {
        Subject {
            image,
            reference,
            variance: None,
            reference_variance: None,
            counted: &[],
        }
    }

    #[test]
    fn errors_are_those_computed_by_hand() {
        let image = row(&[Rgb::new(1.0, 2.0, 3.0), Rgb::BLACK]);
        let reference = row(&[Rgb::new(1.0, 1.0, 1.0), Rgb::grey(0.3)]);
        let found = compare(&subject(&image, &reference));
        assert!((found.mse - (1.0 + 4.0 + 3.0 * 0.09) / 6.0).abs() < 1e-6);
        let relative = (1.0 / 1.01 + 4.0 / 1.01 + 3.0 * 0.09 / 0.1) / 6.0;
        assert!((found.relative_mse - relative).abs() < 1e-6, "{found:?}");
        let luminance = Rgb::new(0.0, 1.0, 2.0).luminance();
        let squared = (f64::from(luminance).powi(2) + 0.09) / 2.0;
        assert!((found.luminance_mse - squared).abs() < 1e-6, "{found:?}");
        assert!((found.ratios[1].value - 1.0 / 1.3).abs() < 1e-6);
        assert_eq!(found.reference_noise, None);
        assert_eq!(found.ratios[0].standard_error, None);
    }

    #[test]
    fn noise_of_the_reference_and_errors_of_ratios_come_from_the_variances() {
        let (image, reference) = (row(&[Rgb::grey(2.0); 4]), row(&[Rgb::grey(1.0); 4]));
        let (own, other) = (row(&[Rgb::grey(0.04); 4]), row(&[Rgb::grey(0.01); 4]));
        let mut subject = subject(&image, &reference);
        subject.variance = Some(&own);
        subject.reference_variance = Some(&other);
        let found = compare(&subject);
        let noise = found.reference_noise.unwrap();
        assert!((noise - 0.01 / 1.01).abs() < 1e-8);
        let corrected = found.corrected_relative_mse().unwrap();
        assert!((corrected - (1.0 - 0.01) / 1.01).abs() < 1e-7);
        // Means 2 and 1 with variances 0.04/4 and 0.01/4: ratio 2 ± sqrt(0.01 + 4 · 0.0025).
        let error = found.ratios[2].standard_error.unwrap();
        assert!((error - 0.02_f64.sqrt()).abs() < 1e-6, "{error}");
    }

    #[test]
    fn masked_pixels_do_not_count() {
        let image = row(&[Rgb::grey(1.0), Rgb::grey(f32::NAN)]);
        let reference = row(&[Rgb::grey(1.0), Rgb::grey(7.0)]);
        let mut subject = subject(&image, &reference);
        assert!(compare(&subject).mse.is_nan());
        subject.counted = &[true, false];
        let found = compare(&subject);
        assert_eq!((found.mse, found.pixels), (0.0, 1));
        assert_eq!(found.ratios[0].value, 1.0);
    }
}
