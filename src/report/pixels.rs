//! Two images, cut and masked alike.

use crate::math::Rgb;

/// Linear colours with their size.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rows from the top down.
    pub colours: Vec<Rgb>,
}

impl Pixels {
    /// Cuts a part out; `None` when it reaches beyond the edges.
    pub fn crop(&self, x: u32, y: u32, width: u32, height: u32) -> Option<Self> {
        let right = x.checked_add(width).filter(|right| *right <= self.width)?;
        let bottom = y.checked_add(height).filter(|b| *b <= self.height)?;
        let rows = (y..bottom).map(|row| row as usize * self.width as usize);
        let colours = rows
            .flat_map(|start| &self.colours[start + x as usize..start + right as usize])
            .copied()
            .collect();
        Some(Self {
            width,
            height,
            colours,
        })
    }
}

/// What is compared: all parts have one size.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'p> {
    /// The image to judge.
    pub image: &'p Pixels,
    /// What it should be.
    pub reference: &'p Pixels,
    /// Variance of the image's pixels.
    pub variance: Option<&'p Pixels>,
    /// Variance of the reference's pixels.
    pub reference_variance: Option<&'p Pixels>,
    /// True for the pixels that count; empty when all do.
    pub counted: &'p [bool],
}

impl Subject<'_> {
    /// Number of pixels that count and have an infinite channel or one that is not a number.
    ///
    /// - `pixels`: image or reference.
    pub fn not_finite(&self, pixels: &Pixels) -> usize {
        let broken = |index: &usize| !pixels.colours[*index].is_finite();
        self.indices().filter(broken).count()
    }

    /// Indices of the pixels that count.
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.image.colours.len()).filter(|index| self.counts(*index))
    }

    /// Whether a pixel counts.
    pub(super) fn counts(&self, index: usize) -> bool {
        self.counted.get(index).copied().unwrap_or(true)
    }

    /// Variance of the difference of image and reference at a pixel; `None` unless both are known.
    pub(super) fn variance_of_difference(&self, index: usize) -> Option<Rgb> {
        let (own, other) = (self.variance?, self.reference_variance?);
        Some(own.colours[index] + other.colours[index])
    }
}

/// Number of quantities that are tested: luminance, red, green and blue.
pub(super) const QUANTITIES: usize = 4;

/// Luminance and channels of a colour.
pub(super) fn quantities(colour: Rgb) -> [f64; QUANTITIES] {
    let [r, g, b] = colour.to_array().map(f64::from);
    [f64::from(colour.luminance()), r, g, b]
}

/// Variances of luminance and channels.
///
/// The noise of the channels of a pixel goes together, as that of a grey scene does wholly; this
/// takes it as going together, which gives the largest variance that luminance can have: tests of
/// luminance then err on the side of acceptance.
pub(super) fn variances(channels: Rgb) -> [f64; QUANTITIES] {
    let [r, g, b] = channels.to_array().map(|v| f64::from(v).max(0.0));
    let weights = Rgb::LUMINANCE_WEIGHTS.to_array().map(f64::from);
    let deviation = weights[0] * r.sqrt() + weights[1] * g.sqrt() + weights[2] * b.sqrt();
    [deviation * deviation, r, g, b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cutting_keeps_rows_together() {
        let colours = (0..12_u8).map(|v| Rgb::grey(f32::from(v))).collect();
        let pixels = Pixels {
            width: 4,
            height: 3,
            colours,
        };
        let part = pixels.crop(1, 1, 2, 2).unwrap();
        let values: Vec<f32> = part.colours.iter().map(|c| c.r()).collect();
        assert_eq!(values, [5.0, 6.0, 9.0, 10.0]);
        assert!(pixels.crop(3, 0, 2, 1).is_none());
        assert!(pixels.crop(u32::MAX, 0, 2, 1).is_none());
    }

    #[test]
    fn luminance_of_grey_noise_has_the_variance_of_a_channel() {
        let [luminance, r, ..] = variances(Rgb::grey(4.0));
        assert!((luminance - r).abs() < 1e-5, "{luminance}");
    }
}
