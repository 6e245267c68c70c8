//! Text of one attribute to a value. Errors are messages without a place: found, expected.

use super::tree::VectorValue;
use crate::math::Vec3;

/// Text of an attribute as messages show it: quoted, and cut where it is long.
pub(super) fn shown(text: &str) -> String {
    const LONGEST: usize = 40;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("\"{}…\"", &text[..end]),
        None => format!("\"{text}\""),
    }
}

/// Reads `true`, `false` (in any case), `1` or `0`.
pub(super) fn boolean(text: &str) -> Result<bool, String> {
    match text.trim().to_ascii_lowercase().as_str() {
        "true" | "1" => Ok(true),
        "false" | "0" => Ok(false),
        _ => Err(format!("found {}, expected true or false", shown(text))),
    }
}

/// Reads a whole number.
pub(super) fn integer(text: &str) -> Result<i64, String> {
    text.trim()
        .parse()
        .map_err(|_| format!("found {}, expected an integer", shown(text)))
}

/// Reads a number; infinity is one, `nan` is not.
pub(super) fn float(text: &str) -> Result<f64, String> {
    let number = text
        .trim()
        .parse::<f64>()
        .ok()
        .filter(|number| !number.is_nan());
    number.ok_or_else(|| format!("found {}, expected a number", shown(text)))
}

/// Reads numbers that are separated by blanks or commas.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    words(text).map(float).collect()
}

/// The parts of `text` between blanks and commas.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace())
        .filter(|word| !word.is_empty())
}

/// The message for a list of the wrong length.
pub(super) fn wrong_count(text: &str, found: usize, expected: &str) -> String {
    let plural = if found == 1 { "number" } else { "numbers" };
    format!(
        "found {found} {plural} in {}, expected {expected}",
        shown(text)
    )
}

/// Reads three numbers, or one that stands for all three.
pub(super) fn three(text: &str) -> Result<[f64; 3], String> {
    let list = numbers(text)?;
    match list[..] {
        [all] => Ok([all; 3]),
        [a, b, c] => Ok([a, b, c]),
        _ => Err(wrong_count(text, list.len(), "3")),
    }
}

/// Reads a point or vector of two or three numbers; one number stands for all three.
pub(super) fn vector(text: &str) -> Result<VectorValue, String> {
    let list = numbers(text)?;
    let (x, y, z) = match list[..] {
        [all] => (all, all, all),
        [x, y] => (x, y, 0.0),
        [x, y, z] => (x, y, z),
        _ => return Err(wrong_count(text, list.len(), "2 or 3")),
    };
    let components = Vec3::new(x as f32, y as f32, z as f32);
    Ok(VectorValue {
        components,
        is_planar: list.len() == 2,
    })
}
