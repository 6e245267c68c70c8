//! Curves as Mitsuba 3 has them: a control point on each line, blank lines between curves.

use super::{MeshProblem, Place};

/// Parses the text of a file of curves.
///
/// Each line has x, y, z and the radius; `#` begins a comment.
///
/// # Errors
/// [`MeshProblem::Syntax`] and `NotFinite` with line and column; `Truncated` for a file without a point.
pub fn parse(bytes: &[u8]) -> Result<Vec<Vec<[f32; 4]>>, MeshProblem> {
    let mut curves = Vec::new();
    let mut curve = Vec::new();
    let mut last = 0;
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        last = index + 1;
        let line = String::from_utf8_lossy(line);
        let is_comment = line.trim_start().starts_with('#');
        let text = line.split('#').next().unwrap_or_default().trim();
        if text.is_empty() {
            if !is_comment && !curve.is_empty() {
                curves.push(std::mem::take(&mut curve));
            }
            continue;
        }
        curve.push(control_point(last, &line, text)?);
    }
    if !curve.is_empty() {
        curves.push(curve);
    }
    if curves.is_empty() {
        return Err(MeshProblem::Truncated {
            place: Place::Line(last),
            expected: "a control point".to_owned(),
        });
    }
    Ok(curves)
}

/// Parses a line with a control point.
///
/// - `line`: all of it, and `text`, what stands in it before a comment.
fn control_point(number: usize, line: &str, text: &str) -> Result<[f32; 4], MeshProblem> {
    let place = |at: &str| {
        let before = (at.as_ptr() as usize).saturating_sub(line.as_ptr() as usize);
        let before = line.get(..before).unwrap_or_default();
        Place::Column(number, before.chars().count() + 1)
    };
    let syntax = |at: &str, message| MeshProblem::Syntax {
        place: place(at),
        message,
    };
    let words: Vec<&str> = text.split_whitespace().collect();
    let Ok(words) = <[&str; 4]>::try_from(words) else {
        let message = format!("found \"{text}\", expected x, y, z and a radius");
        return Err(syntax(text, message));
    };
    let mut point = [0.0_f32; 4];
    for (value, word) in point.iter_mut().zip(words) {
        let message = || format!("found \"{word}\", expected a number");
        *value = word.parse().map_err(|_| syntax(word, message()))?;
        if !value.is_finite() {
            return Err(MeshProblem::NotFinite {
                place: place(word),
                what: "a control point",
            });
        }
    }
    Ok(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blank_lines_part_curves() {
        let text = "# hairs\n0 0 0 .1\n1 0 0 .1 # thick\n\n\n2 0 0 0.5\r\n# between\n3 1 0 .5\n";
        let curves = parse(text.as_bytes()).unwrap();
        let first = vec![[0.0, 0.0, 0.0, 0.1], [1.0, 0.0, 0.0, 0.1]];
        assert_eq!(
            curves,
            [first, vec![[2.0, 0.0, 0.0, 0.5], [3.0, 1.0, 0.0, 0.5]]]
        );
    }

    #[test]
    fn broken_lines_are_told() {
        let message = |text: &str| parse(text.as_bytes()).unwrap_err().to_string();
        let expected = "line 2, column 2: found \"1 2 3\", expected x, y, z and a radius";
        assert_eq!(message("0 0 0 1\n 1 2 3\n"), expected);
        assert_eq!(
            message("0 0 0 inf"),
            "line 1, column 7: a control point is not a finite number"
        );
        let expected = "line 1, column 5: found \"x\", expected a number";
        assert_eq!(message("0 0 x 1"), expected);
        let expected = "line 2: the file ends where a control point should follow";
        assert_eq!(message("# nothing\n"), expected);
    }
}
