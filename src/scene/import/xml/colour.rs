//! Colours as files write them, and what they become in each use.

use crate::math::{Rgb, SpectralCurve, blackbody, equal_energy_white, srgb_to_linear};

use super::tree::Version;
use super::values;

/// A colour of a scene file, kept as written until its use is known.
#[derive(Clone, Debug, PartialEq)]
pub enum Colour {
    /// Linear Rec.709.
    Rgb(Rgb),
    /// A spectrum with one value for all wavelengths.
    Uniform {
        /// The value.
        value: f64,
        /// The version of the file, which says what white such a light has.
        version: Version,
    },
    /// Values at some wavelengths.
    Curve(SpectralCurve),
    /// A glowing body.
    Blackbody {
        /// In kelvin.
        temperature: f64,
        /// Factor on the radiance.
        scale: f64,
    },
}

/// What a colour is for, which decides how a spectrum turns into three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourUse {
    /// A fraction of the light, in [0, 1], seen under D65.
    Reflectance,
    /// Radiance, intensity or power, at least 0.
    Emission,
    /// An index of refraction, an absorption or another number without an upper bound.
    Index,
}

impl Colour {
    /// The linear Rec.709 triple for this use.
    ///
    /// Triples and single numbers come out as written, so that a caller can say that one was out of
    /// range; spectra are clamped to what the use allows. In files of version 2 and later a light
    /// with one value for all wavelengths has the equal-energy white, in older ones it is grey.
    pub fn resolve(&self, wanted: ColourUse) -> Rgb {
        match self {
            Self::Rgb(rgb) => *rgb,
            Self::Uniform { value, version } => {
                let grey = Rgb::grey(*value as f32);
                if wanted == ColourUse::Emission && !version.is_first_generation() {
                    grey * equal_energy_white()
                } else {
                    grey
                }
            }
            Self::Curve(curve) => match wanted {
                ColourUse::Reflectance => curve.to_reflectance(),
                ColourUse::Emission => curve.to_emission(),
                ColourUse::Index => curve.to_index(),
            },
            Self::Blackbody { temperature, scale } => blackbody(*temperature, *scale),
        }
    }
}

/// Reads an `<rgb>`: linear numbers, or `#rrggbb`, which is always sRGB-encoded.
pub(super) fn rgb(text: &str) -> Result<Colour, String> {
    match text.trim().strip_prefix('#') {
        Some(digits) => hexadecimal(digits).ok_or_else(|| bad_hexadecimal(text)),
        None => Ok(Colour::Rgb(triple(text)?)),
    }
}

/// Reads an `<srgb>`: encoded numbers or `#rrggbb`.
pub(super) fn srgb(text: &str) -> Result<Colour, String> {
    match text.trim().strip_prefix('#') {
        Some(digits) => hexadecimal(digits).ok_or_else(|| bad_hexadecimal(text)),
        None => Ok(Colour::Rgb(triple(text)?.map(srgb_to_linear))),
    }
}

/// Reads the value of a `<spectrum>`: one number, three numbers, or pairs `nm:value`.
pub(super) fn spectrum(text: &str, version: Version) -> Result<Colour, String> {
    if text.contains(':') {
        return Ok(Colour::Curve(pairs(text)?));
    }
    let list = values::numbers(text)?;
    match list[..] {
        [value] => Ok(Colour::Uniform { value, version }),
        [_, _, _] => Ok(Colour::Rgb(triple(text)?)),
        _ => Err(values::wrong_count(
            text,
            list.len(),
            "1, 3, or pairs \"wavelength:value\"",
        )),
    }
}

/// Reads the text of an `.spd` file: a wavelength and a value on each line, `#` begins a comment.
pub(super) fn spectrum_file(text: &str) -> Result<Colour, String> {
    let mut samples = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("").trim();
        let in_line = |message: String| format!("line {}: {message}", index + 1);
        match values::numbers(line).map_err(in_line)?[..] {
            [] => {}
            [wavelength, value] => samples.push((wavelength, value)),
            ref list => return Err(in_line(values::wrong_count(line, list.len(), "2"))),
        }
    }
    SpectralCurve::new(samples)
        .map(Colour::Curve)
        .map_err(|error| error.to_string())
}

/// Makes a curve from equally long lists of wavelengths (nm) and values.
pub(super) fn curve(wavelengths: &[f64], values: &[f64]) -> Result<Colour, String> {
    if wavelengths.len() != values.len() {
        let (left, right) = (wavelengths.len(), values.len());
        return Err(format!(
            "found {left} wavelengths and {right} values, expected as many"
        ));
    }
    let samples = wavelengths
        .iter()
        .copied()
        .zip(values.iter().copied())
        .collect();
    SpectralCurve::new(samples)
        .map(Colour::Curve)
        .map_err(|error| error.to_string())
}

fn pairs(text: &str) -> Result<SpectralCurve, String> {
    // "400 : 0.1" is one pair as well: blanks around a colon do not separate.
    let joined = text.split(':').map(str::trim).collect::<Vec<_>>().join(":");
    let pair = |word: &str| match word.split_once(':') {
        Some((wavelength, value)) => Ok((values::float(wavelength)?, values::float(value)?)),
        None => Err(format!(
            "found {}, expected \"wavelength:value\"",
            values::shown(word)
        )),
    };
    let samples = values::words(&joined)
        .map(pair)
        .collect::<Result<_, String>>()?;
    SpectralCurve::new(samples).map_err(|error| error.to_string())
}

fn triple(text: &str) -> Result<Rgb, String> {
    let [r, g, b] = values::three(text)?;
    if [r, g, b].iter().all(|channel| channel.is_finite()) {
        Ok(Rgb::new(r as f32, g as f32, b as f32))
    } else {
        Err(format!(
            "found {}, expected finite numbers",
            values::shown(text)
        ))
    }
}

fn hexadecimal(digits: &str) -> Option<Colour> {
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let channel = |i: usize| {
        let byte = u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok()?;
        Some(srgb_to_linear(f32::from(byte) / 255.0))
    };
    Some(Colour::Rgb(Rgb::new(channel(0)?, channel(1)?, channel(2)?)))
}

fn bad_hexadecimal(text: &str) -> String {
    format!(
        "found {}, expected three numbers or \"#rrggbb\"",
        values::shown(text)
    )
}
