//! What tests of materials claim, and how near two values are.

use lumiflow::bsdf::BsdfSample;
use lumiflow::math::Rgb;

/// Outcome of a check; the text says what is wrong.
pub(crate) type Outcome = Result<(), String>;

pub(crate) fn close(a: Rgb, b: Rgb, tolerance: f32) -> bool {
    (a - b).0.abs().max_element() <= tolerance * a.0.abs().max(b.0.abs()).max_element()
}

/// Whether a sample has this value, up to rounding.
///
/// Where a coat lets hardly anything through, a value goes with the square of a cosine that was turned
/// into a bump's frame and back: what that rounds is small beside a sample's usual weight, which is one.
pub(crate) fn agree(sample: &BsdfSample, value: Rgb) -> bool {
    let rounding = 1e-6 * sample.density;
    let off = (sample.value - value).0.abs().max_element();
    close(sample.value, value, 1e-4) || off <= rounding
}

pub(crate) fn claim(holds: bool, text: impl FnOnce() -> String) -> Outcome {
    if holds { Ok(()) } else { Err(text()) }
}
