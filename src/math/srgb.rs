//! The sRGB transfer function.

/// Linear value of one sRGB-encoded channel.
///
/// `encoded` is in [0, 1]; values outside are continued by the same formula (the linear part below
/// zero), so that the function is increasing everywhere.
///
/// Source: IEC 61966-2-1:1999.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_and_the_middle_are_right() {
        assert_eq!(srgb_to_linear(0.0), 0.0);
        assert_eq!(srgb_to_linear(1.0), 1.0);
        assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-5);
        assert!((srgb_to_linear(0.04045) - srgb_to_linear(0.040_451)).abs() < 1e-6);
    }
}
