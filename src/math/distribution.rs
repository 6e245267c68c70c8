//! Discrete and piecewise-constant distributions.

use super::warp::ONE_MINUS_EPSILON;
use super::{Vec2, warp};

/// A distribution over `0..n`, in proportion to given weights.
#[derive(Clone, Debug)]
pub struct Discrete {
    /// `cumulative[i]` is the probability of an index below `i`; `n + 1` entries, the last is 1.
    cumulative: Vec<f32>,
    total: f64,
}

/// What [`Discrete::sample`] chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The chosen index.
    pub index: usize,
    /// Its probability.
    pub probability: f32,
    /// What is left of the uniform number, again uniform in `[0, 1)`.
    pub remainder: f32,
}

impl Discrete {
    /// Makes the distribution; `None` when no weight is positive, or one is negative or not finite.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        let valid = weights.iter().all(|w| *w >= 0.0) && total > 0.0 && total.is_finite();
        valid.then(|| {
            let mut sum = 0.0;
            let mut cumulative = Vec::with_capacity(weights.len() + 1);
            cumulative.push(0.0);
            for weight in weights {
                sum += weight;
                cumulative.push((sum / total) as f32);
            }
            // Rounding must not leave a gap above the last index that can be chosen.
            let last = weights.iter().rposition(|w| *w > 0.0).unwrap_or(0);
            cumulative[last + 1..].fill(1.0);
            Self { cumulative, total }
        })
    }

    /// Number of indices.
    pub fn len(&self) -> usize {
        self.cumulative.len() - 1
    }

    /// True when there is no index; [`Discrete::new`] never makes such a distribution.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory of its table, in bytes.
    pub fn memory(&self) -> usize {
        size_of_val(self.cumulative.as_slice())
    }

    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Probability of an index.
    #[inline]
    pub fn probability(&self, index: usize) -> f32 {
        self.cumulative[index + 1] - self.cumulative[index]
    }

    /// Chooses an index by a number `u`, uniform in `[0, 1)`.
    #[inline]
    pub fn sample(&self, u: f32) -> Choice {
        let index = self.cumulative[1..]
            .partition_point(|c| *c <= u)
            .min(self.len() - 1);
        let probability = self.probability(index);
        let remainder = ((u - self.cumulative[index]) / probability).min(ONE_MINUS_EPSILON);
        Choice {
            index,
            probability,
            remainder,
        }
    }

    /// Undoes [`Discrete::sample`]; `None` for an index that is never chosen.
    pub fn invert(&self, index: usize, remainder: f32) -> Option<f32> {
        let (low, high) = (self.cumulative[index], self.cumulative[index + 1]);
        (low < high).then(|| warp::within(remainder, low, high))
    }
}

/// A density on the unit square that is constant on each cell of a regular grid.
#[derive(Clone, Debug)]
pub struct PiecewiseConstant2d {
    rows: Discrete,
    columns: Vec<Option<Discrete>>,
}

/// What [`PiecewiseConstant2d::sample_cell`] chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellChoice {
    /// Column of the cell.
    pub column: usize,
    /// Row of the cell.
    pub row: usize,
    /// Probability of the cell.
    pub probability: f32,
    /// What is left of the uniform numbers, again uniform in `[0, 1)²`.
    pub remainder: Vec2,
}

impl PiecewiseConstant2d {
    /// Makes the density from one weight a cell, row by row; `None` as in [`Discrete::new`].
    pub fn new(weights: &[f64], width: usize) -> Option<Self> {
        Self::from_rows(weights.len() / width, |row| {
            weights[row * width..(row + 1) * width].to_vec()
        })
    }

    /// Makes the density from rows of one weight a cell; `None` as in [`Discrete::new`].
    ///
    /// Only one row of weights is in memory at a time: a density keeps 4 bytes a cell.
    ///
    /// - `row`: is asked once for each of `0..height`, in order; all rows are of one length.
    pub fn from_rows(height: usize, mut row: impl FnMut(usize) -> Vec<f64>) -> Option<Self> {
        let mut sums = Vec::with_capacity(height);
        let mut columns = Vec::with_capacity(height);
        for index in 0..height {
            let weights = row(index);
            sums.push(weights.iter().sum::<f64>());
            columns.push(Discrete::new(&weights));
        }
        let rows = Discrete::new(&sums)?;
        Some(Self { rows, columns })
    }

    /// Chooses a cell by two numbers, uniform in `[0, 1)`.
    #[inline]
    pub fn sample_cell(&self, u: Vec2) -> CellChoice {
        let row = self.rows.sample(u.y);
        let Some(columns) = &self.columns[row.index] else {
            unreachable!("a row without weight has probability zero");
        };
        let column = columns.sample(u.x);
        CellChoice {
            column: column.index,
            row: row.index,
            probability: row.probability * column.probability,
            remainder: Vec2::new(column.remainder, row.remainder),
        }
    }

    /// Probability of a cell.
    #[inline]
    pub fn cell_probability(&self, column: usize, row: usize) -> f32 {
        let Some(columns) = &self.columns[row] else {
            return 0.0;
        };
        self.rows.probability(row) * columns.probability(column)
    }

    /// Samples a point of the unit square; also returns its density.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let choice = self.sample_cell(u);
        let width = self.columns[choice.row].as_ref().map_or(0, Discrete::len);
        let size = Vec2::new(width as f32, self.rows.len() as f32);
        let cell = Vec2::new(choice.column as f32, choice.row as f32);
        let point = ((cell + choice.remainder) / size).min(Vec2::splat(ONE_MINUS_EPSILON));
        (point, choice.probability * size.x * size.y)
    }

    /// Density at a point of the unit square.
    #[inline]
    pub fn density(&self, point: Vec2) -> f32 {
        let (row, _) = cell(point.y, self.rows.len());
        let Some(columns) = &self.columns[row] else {
            return 0.0;
        };
        let (column, _) = cell(point.x, columns.len());
        let cells = (columns.len() * self.rows.len()) as f32;
        self.cell_probability(column, row) * cells
    }

    /// Undoes [`PiecewiseConstant2d::sample`] where the density is positive.
    pub fn invert(&self, point: Vec2) -> Option<Vec2> {
        let (row, v) = cell(point.y, self.rows.len());
        let columns = self.columns[row].as_ref()?;
        let (column, u) = cell(point.x, columns.len());
        self.invert_cell([column, row], Vec2::new(u, v))
    }

    /// Undoes [`PiecewiseConstant2d::sample_cell`]; `None` for a cell that is never chosen.
    ///
    /// - `cell`: column and row.
    pub fn invert_cell(&self, [column, row]: [usize; 2], remainder: Vec2) -> Option<Vec2> {
        let columns = self.columns[row].as_ref()?;
        Some(Vec2::new(
            columns.invert(column, remainder.x)?,
            self.rows.invert(row, remainder.y)?,
        ))
    }
}

/// The cell of `0..count` that holds `x` in `[0, 1)`, and the place inside of it.
#[inline]
fn cell(x: f32, count: usize) -> (usize, f32) {
    let scaled = x * count as f32;
    let index = (scaled as usize).min(count - 1);
    (index, scaled - index as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_follow_the_weights() {
        let d = Discrete::new(&[1.0, 0.0, 3.0, 0.0]).unwrap();
        assert_eq!(
            [0, 1, 2, 3].map(|i| d.probability(i)),
            [0.25, 0.0, 0.75, 0.0]
        );
        assert_eq!(d.sample(0.0).index, 0);
        assert_eq!(d.sample(0.25).index, 2);
        assert_eq!(d.sample(ONE_MINUS_EPSILON).index, 2);
        assert!((d.sample(0.625).remainder - 0.5).abs() < 1e-6);
        assert_eq!(d.invert(2, 0.5), Some(0.625));
        assert_eq!(d.invert(1, 0.5), None);
    }

    #[test]
    fn numbers_found_choose_the_same_index() {
        let weights: Vec<f64> = (0..300).map(|i| f64::from(i * 7919 % 101)).collect();
        let d = Discrete::new(&weights).unwrap();
        for index in (0..300).filter(|i| weights[*i] > 0.0) {
            for remainder in [0.0, 0.3, ONE_MINUS_EPSILON, 1.0] {
                let u = d.invert(index, remainder).unwrap();
                assert_eq!(d.sample(u).index, index);
            }
        }
    }

    #[test]
    fn weights_that_make_no_distribution_are_refused() {
        for weights in [&[][..], &[0.0], &[-1.0, 2.0], &[f64::NAN], &[f64::INFINITY]] {
            assert!(Discrete::new(weights).is_none(), "{weights:?}");
        }
    }

    #[test]
    fn cells_are_hit_in_proportion_and_report_their_density() {
        let weights = [1.0, 2.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 4.0];
        let d = PiecewiseConstant2d::new(&weights, 3).unwrap();
        let n = 200;
        let mut counts = [0.0; 9];
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let (p, density) = d.sample(u);
            assert!((d.density(p) - density).abs() < 1e-5 * density);
            assert!((d.invert(p).unwrap() - u).abs().max_element() < 1e-5);
            counts[(p.y * 3.0) as usize * 3 + (p.x * 3.0) as usize] += 1.0;
        }
        for (count, weight) in counts.iter().zip(weights) {
            assert!((count / f64::from(n * n) - weight / 12.0).abs() < 0.01);
        }
    }
}
