//! Tables for people.

/// How the cells of a column stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// A table in Markdown whose columns are aligned in the source, too.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    sides: Vec<Side>,
    /// The first is the head.
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Starts a table.
    ///
    /// - `texts`: heads of the first columns, whose cells stand on the left.
    /// - `numbers`: heads of the others, on the right.
    pub(super) fn new(texts: &[&str], numbers: &[&str]) -> Self {
        let mut sides = vec![Side::Left; texts.len()];
        sides.resize(texts.len() + numbers.len(), Side::Right);
        let head = texts.iter().chain(numbers);
        Self {
            sides,
            rows: vec![head.map(|name| escaped(name)).collect()],
        }
    }

    /// Adds a row; cells that are missing stay empty.
    pub(super) fn push(&mut self, cells: &[String]) {
        let mut cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        cells.resize(self.sides.len(), String::new());
        self.rows.push(cells);
    }

    /// The lines of the table.
    pub(super) fn lines(&self) -> Vec<String> {
        // The line under the head needs three characters.
        let width = |column: usize| {
            let widths = self.rows.iter().map(|row| row[column].chars().count());
            widths.max().unwrap_or(0).max(3)
        };
        let widths: Vec<usize> = (0..self.sides.len()).map(width).collect();
        let columns = || widths.iter().zip(&self.sides);
        let mut lines: Vec<String> = self
            .rows
            .iter()
            .map(|row| {
                let cells = row.iter().zip(columns());
                joined(cells.map(|(cell, (&width, side))| match side {
                    Side::Left => format!("{cell:<width$}"),
                    Side::Right => format!("{cell:>width$}"),
                }))
            })
            .collect();
        let rule = joined(columns().map(|(width, side)| match side {
            Side::Left => "-".repeat(*width),
            Side::Right => "-".repeat(width - 1) + ":",
        }));
        lines.insert(1, rule);
        lines
    }
}

fn joined(cells: impl Iterator<Item = String>) -> String {
    let cells: Vec<String> = cells.collect();
    format!("| {} |", cells.join(" | "))
}

/// A text that does not end its cell.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

/// A number of three digits, `–` where there is none.
pub fn three_digits(value: f64) -> String {
    let size = value.abs();
    if value.is_nan() {
        "–".to_owned()
    } else if size == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e5).contains(&size) {
        format!("{value:.2e}")
    } else {
        let whole_digits = size.log10().floor() as i32;
        let decimals = usize::try_from(2 - whole_digits).unwrap_or(0);
        format!("{value:.decimals$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_under_each_other() {
        let mut table = Table::new(&["scene"], &["± s", "n"]);
        table.push(&["box".to_owned(), "1.5".to_owned(), "2".to_owned()]);
        table.push(&["a|b".to_owned()]);
        let expected = [
            "| scene | ± s |   n |",
            "| ----- | --: | --: |",
            "| box   | 1.5 |   2 |",
            "| a\\|b  |     |     |",
        ];
        assert_eq!(table.lines(), expected);
    }

    #[test]
    fn numbers_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.00"),
            (12.345, "12.3"),
            (0.012_345, "0.0123"),
            (-0.5, "-0.500"),
            (1234.5, "1234"),
            (1.5e-5, "1.50e-5"),
            (2.5e9, "2.50e9"),
            (f64::NAN, "–"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(three_digits(value), text);
        }
    }
}
