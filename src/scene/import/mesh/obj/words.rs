//! The words of a line.

use crate::scene::import::mesh::{MeshProblem, Place};

/// What follows a keyword, blanks inside of it included.
pub(super) fn name(line: &[u8], keyword: &[u8]) -> String {
    let rest = line.trim_ascii_start().get(keyword.len()..);
    String::from_utf8_lossy(rest.unwrap_or_default().trim_ascii()).into_owned()
}

/// Reads up to three numbers, of which `required` must be there; the others are 0 if missing.
pub(super) fn numbers<'a>(
    line: usize,
    keyword: &str,
    mut words: impl Iterator<Item = &'a [u8]>,
    required: usize,
) -> Result<[f32; 3], MeshProblem> {
    let syntax = |message| MeshProblem::Syntax {
        place: Place::Line(line),
        message,
    };
    let mut values = [0.; 3];
    for (found, value) in values.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            if found >= required {
                break;
            }
            return Err(syntax(format!(
                "{keyword} has {found} of {required} numbers"
            )));
        };
        let parsed = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse().ok());
        *value =
            parsed.ok_or_else(|| syntax(format!("\"{}\" is not a number", word.escape_ascii())))?;
    }
    Ok(values)
}

/// The colour after a position: just three more numbers. What else stands there is read over, a weight
/// for example.
pub(super) fn colour<'a>(words: impl Iterator<Item = &'a [u8]>) -> Option<[f32; 3]> {
    let mut values = [0.; 3];
    let mut count = 0;
    for word in words {
        let value: f32 = std::str::from_utf8(word).ok()?.parse().ok()?;
        *values.get_mut(count).filter(|_| value.is_finite())? = value;
        count += 1;
    }
    (count == 3).then_some(values)
}

pub(super) fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}
