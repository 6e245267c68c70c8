//! Curves as Mitsuba 3 has them: a control point on each line, blank lines between curves.

use super::{MeshProblem, Place};

/// Parses the text of a file of curves.
///
/// Each line has x, y, z and the radius; `#` begins a comment.
///
/// # Errors
/// [`MeshProblem::Syntax`] and `NotFinite` with the line; `Truncated` for a file without a point.
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
        curve.push(control_point(last, text)?);
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

fn control_point(line: usize, text: &str) -> Result<[f32; 4], MeshProblem> {
    let place = Place::Line(line);
    let numbers: Vec<Option<f32>> = text.split_whitespace().map(|w| w.parse().ok()).collect();
    let [Some(x), Some(y), Some(z), Some(radius)] = numbers[..] else {
        return Err(MeshProblem::Syntax {
            place,
            message: format!("found \"{text}\", expected x, y, z and a radius"),
        });
    };
    let point = [x, y, z, radius];
    if !point.iter().all(|number| number.is_finite()) {
        let what = "a control point";
        return Err(MeshProblem::NotFinite { place, what });
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
        let expected = "line 2: found \"1 2 3\", expected x, y, z and a radius";
        assert_eq!(message("0 0 0 1\n1 2 3\n"), expected);
        assert_eq!(
            message("0 0 0 inf"),
            "line 1: a control point is not a finite number"
        );
        let expected = "line 2: the file ends where a control point should follow";
        assert_eq!(message("# nothing\n"), expected);
    }
}
