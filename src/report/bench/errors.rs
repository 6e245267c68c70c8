//! The errors that a bench keeps of an image.

use crate::report::{Comparison, Subject, compare, mean_flip};

/// How far an image is from its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Mean squared difference over pixels and channels.
    pub mse: f64,
    /// Mean squared difference of luminance over pixels.
    pub luminance_mse: f64,
    /// Mean of `(I − R)² / (R² + 0.01)`.
    pub relative_mse: f64,
    /// Share of `relative_mse` that is the reference's own noise, where that is known.
    pub reference_noise: Option<f64>,
    /// Mean luminance of the image over that of the reference.
    pub mean_ratio: f64,
    /// Mean FLIP error.
    pub flip: f64,
}

impl Errors {
    /// Measures the pixels that count.
    ///
    /// - `exposure`: in stops, at which FLIP looks at both images.
    pub fn of(subject: &Subject<'_>, exposure: f32) -> Self {
        Self::new(&compare(subject), mean_flip(subject, exposure))
    }

    /// - `flip`: mean FLIP error.
    pub(super) fn new(found: &Comparison, flip: f64) -> Self {
        Self {
            mse: found.mse,
            luminance_mse: found.luminance_mse,
            relative_mse: found.relative_mse,
            reference_noise: found.reference_noise,
            mean_ratio: found.ratios[0].value,
            flip,
        }
    }

    /// The relative error without the reference's own noise, where that is known.
    pub fn corrected_relative_mse(&self) -> Option<f64> {
        self.reference_noise.map(|noise| self.relative_mse - noise)
    }
}
