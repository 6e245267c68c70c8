//! FLIP: how different two pictures look when one flips between them.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, flip};

use super::pixels::{Pixels, Subject};
use crate::image::srgb_encode;

/// Mean FLIP error of the pixels that count: 0 for equal looks, 1 at most.
///
/// Looks at 8-bit sRGB pictures, as a monitor shows them, from the usual distance (67 pixels a
/// degree).
///
/// - `exposure`: in stops, for both images.
///
/// Source: Andersson et al. 2020.
pub fn mean_flip(subject: &Subject<'_>, exposure: f32) -> f64 {
    let reference = displayed(subject.reference, exposure);
    let image = displayed(subject.image, exposure);
    let errors = flip(reference, image, DEFAULT_PIXELS_PER_DEGREE).to_vec();
    let (mut sum, mut pixels) = (0.0, 0_u32);
    for index in subject.indices() {
        sum += f64::from(errors[index]);
        pixels += 1;
    }
    sum / f64::from(pixels)
}

fn displayed(pixels: &Pixels, exposure: f32) -> FlipImageRgb8 {
    let scale = exposure.exp2();
    let code = |value: f32| (srgb_encode((value * scale).clamp(0.0, 1.0)) * 255.0 + 0.5) as u8;
    let channels = pixels.colours.iter().flat_map(|c| c.to_array());
    let codes: Vec<u8> = channels.map(code).collect();
    FlipImageRgb8::with_data(pixels.width, pixels.height, &codes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    fn flat(value: f32) -> Pixels {
        Pixels {
            width: 32,
            height: 16,
            colours: vec![Rgb::grey(value); 32 * 16],
        }
    }

    fn flip_of(image: &Pixels, reference: &Pixels, exposure: f32, counted: &[bool]) -> f64 {
        let subject = Subject {
            image,
            reference,
            variance: None,
            reference_variance: None,
            counted,
        };
        mean_flip(&subject, exposure)
    }

    #[test]
    fn equal_images_do_not_flip_and_black_against_white_does_fully() {
        assert_eq!(flip_of(&flat(0.5), &flat(0.5), 0.0, &[]), 0.0);
        let most = flip_of(&flat(0.0), &flat(1.0), 0.0, &[]);
        assert!(most > 0.95 && most <= 1.0 + 1e-6, "{most}");
        let some = flip_of(&flat(0.45), &flat(0.5), 0.0, &[]);
        assert!(some > 0.01 && some < 0.2, "{some}");
    }

    #[test]
    fn what_the_monitor_cannot_show_does_not_count() {
        assert_eq!(flip_of(&flat(2.0), &flat(5.0), 0.0, &[]), 0.0);
        assert!(flip_of(&flat(2.0), &flat(5.0), -3.0, &[]) > 0.1);
    }

    #[test]
    fn masked_pixels_do_not_count() {
        let mut image = flat(0.5);
        for row in 0..16 {
            image.colours[row * 32..row * 32 + 8].fill(Rgb::WHITE);
        }
        let far: Vec<bool> = (0..32 * 16).map(|i| i % 32 >= 24).collect();
        let everywhere = flip_of(&image, &flat(0.5), 0.0, &[]);
        assert!(everywhere > 10.0 * flip_of(&image, &flat(0.5), 0.0, &far));
    }
}
