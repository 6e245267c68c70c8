//! A picture of the error.

use super::pixels::Subject;

/// Signed relative error of the luminance, `(I − R) / sqrt(R² + 0.01)`, as linear colours: white
/// where the image is right, red where it is too bright, blue where it is too dark, fully so from
/// `full_scale` on; grey where pixels do not count or are not finite.
///
/// - `full_scale`: positive.
pub fn heat_map(subject: &Subject<'_>, full_scale: f32) -> Vec<[f32; 3]> {
    let pairs = subject.image.colours.iter().zip(&subject.reference.colours);
    pairs
        .enumerate()
        .map(|(index, (image, reference))| {
            let (own, wanted) = (image.luminance(), reference.luminance());
            let error = (own - wanted) / (wanted * wanted + 0.01).sqrt() / full_scale;
            if error.is_nan() || !subject.counts(index) {
                return [0.2; 3];
            }
            let rest = 1.0 - error.abs().min(1.0);
            if error > 0.0 {
                [1.0, rest, rest]
            } else {
                [rest, rest, 1.0]
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;
    use crate::report::Pixels;

    #[test]
    fn colours_say_which_way_the_error_goes() {
        let row = |values: [f32; 4]| Pixels {
            width: 4,
            height: 1,
            colours: values.map(Rgb::grey).to_vec(),
        };
        let (image, reference) = (row([1.0, 9.0, 0.0, f32::NAN]), row([1.0; 4]));
        let subject = Subject {
            image: &image,
            reference: &reference,
            variance: None,
            reference_variance: None,
            counted: &[],
        };
        let map = heat_map(&subject, 0.5);
        assert_eq!(map[0], [1.0, 1.0, 1.0]);
        assert_eq!(map[1], [1.0, 0.0, 0.0]);
        assert_eq!(map[2], [0.0, 0.0, 1.0]);
        assert_eq!(map[3], [0.2; 3]);
    }
}
