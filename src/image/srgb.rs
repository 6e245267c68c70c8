//! The transfer function of sRGB.

/// Encodes a linear value for an sRGB display.
///
/// - `linear`: 0 is black and 1 the display's white. Values outside [0, 1] are continued, not
///   limited: negative ones along the straight part, those above 1 along the power.
///
/// Returns the encoded value, 0 to 1 for 0 to 1. NaN stays NaN.
///
/// Computed in double precision, so that the last bit of a system's `pow` does not show.
///
/// Source: IEC 61966-2-1:1999.
pub fn srgb_encode(linear: f32) -> f32 {
    let linear = f64::from(linear);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    encoded as f32
}

/// Decodes a value that was encoded for an sRGB display: the inverse of [`srgb_encode`].
///
/// - `encoded`: 0 to 1; other values are continued as [`srgb_encode`] does.
///
/// Returns the linear value, 0 to 1 for 0 to 1. NaN stays NaN.
///
/// Source: IEC 61966-2-1:1999.
pub fn srgb_decode(encoded: f32) -> f32 {
    let encoded = f64::from(encoded);
    let linear = if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    };
    linear as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        assert_eq!(srgb_encode(0.0), 0.0);
        assert_eq!(srgb_encode(1.0), 1.0);
        assert_eq!(srgb_decode(1.0), 1.0);
        // 8-bit middle grey of photographers: 18 % is code 118.
        assert_eq!((srgb_encode(0.18) * 255.0).round(), 118.0);
        assert!((srgb_decode(0.5) - 0.214_041_14).abs() < 1e-7);
        assert!((srgb_encode(0.001) - 0.01292).abs() < 1e-7);
    }

    #[test]
    fn decoding_inverts_encoding() {
        for code in 0..=255_u8 {
            let encoded = f32::from(code) / 255.0;
            let again = srgb_encode(srgb_decode(encoded));
            assert!((again - encoded).abs() < 1e-6, "{code}: {again}");
        }
        for value in [-0.5, 2.0, 1e-6, 30.0] {
            let again = srgb_decode(srgb_encode(value));
            assert!(
                (again - value).abs() < 1e-6 * value.abs().max(1.0),
                "{value}: {again}"
            );
        }
        assert!(srgb_encode(f32::NAN).is_nan());
    }
}
