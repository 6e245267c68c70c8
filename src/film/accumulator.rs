//! The passes of one layer, added up.

use rayon::prelude::*;

use super::{PassBuffer, Unit};

/// Sum of the passes of one layer, with the spread of its replicas where that is wanted.
///
/// A replica is a group of consecutive passes that is independent of all other groups. With `S_r`
/// the sum over the `n_r` passes of replica `r`, `S = Σ S_r`, `N = Σ n_r` and `R` replicas, the
/// variance of the mean `S / N` is estimated by `(Σ S_r²/n_r − S²/N) / ((R − 1) N)`, also when the
/// last replica is shorter than the others.
#[derive(Clone, Debug)]
pub struct Accumulator {
    unit: Unit,
    sums: Vec<i64>,
    spread: Option<Spread>,
    passes: u64,
    rejected: u64,
}

/// What the variance needs beside the sums.
#[derive(Clone, Debug)]
struct Spread {
    passes_per_replica: u32,
    /// Sums over the passes of the replica that is not complete yet, and their number.
    open: Vec<i64>,
    open_passes: u32,
    /// `Σ S_r² / n_r` over the complete replicas, in units of 2²⁴ squared steps.
    squares: Vec<i128>,
    replicas: u64,
}

/// Squares are stored in steps of two to this power.
const SQUARE_SHIFT: u32 = 24;

impl Accumulator {
    /// Makes an empty sum.
    ///
    /// - `values`: number of pixels times number of channels.
    /// - `passes_per_replica`: keeps the spread of replicas of this many passes; `None` keeps none.
    pub fn new(values: usize, unit: Unit, passes_per_replica: Option<u32>) -> Self {
        let spread = passes_per_replica.map(|passes_per_replica| Spread {
            passes_per_replica,
            open: vec![0; values],
            open_passes: 0,
            squares: vec![0; values],
            replicas: 0,
        });
        Self {
            unit,
            sums: vec![0; values],
            spread,
            passes: 0,
            rejected: 0,
        }
    }

    /// Memory of the sums, in bytes.
    ///
    /// - `values`: number of pixels times number of channels.
    /// - `has_spread`: whether the spread of replicas is kept.
    pub const fn memory(values: u64, has_spread: bool) -> u64 {
        let of_spread = size_of::<i64>() + size_of::<i128>();
        let bytes = size_of::<i64>() + if has_spread { of_spread } else { 0 };
        values * bytes as u64
    }

    /// Adds a pass, and empties its buffer.
    pub fn fold(&mut self, pass: &mut PassBuffer) {
        self.passes += 1;
        self.rejected += pass.take_rejected();
        let Some(spread) = &mut self.spread else {
            self.sums
                .par_iter_mut()
                .zip(pass.sums_mut())
                .for_each(|(sum, landed)| {
                    *sum = sum.saturating_add(std::mem::take(landed.get_mut()));
                });
            return;
        };
        let rows = self
            .sums
            .par_iter_mut()
            .zip(&mut spread.open)
            .zip(pass.sums_mut());
        rows.for_each(|((sum, open), landed)| {
            let landed = std::mem::take(landed.get_mut());
            *sum = sum.saturating_add(landed);
            *open = open.saturating_add(landed);
        });
        spread.open_passes += 1;
        if spread.open_passes == spread.passes_per_replica {
            spread.close();
        }
    }

    /// Number of passes added.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// Number of estimates that were not finite or out of range.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// The mean of the passes; zero before the first.
    pub fn mean(&self) -> Vec<f32> {
        let scale = self.unit.value() / self.passes.max(1) as f64;
        self.sums
            .par_iter()
            .map(|sum| (*sum as f64 * scale) as f32)
            .collect()
    }

    /// Whether the variance of the mean is known: not when no spread is kept or there are fewer than two
    /// replicas.
    pub fn has_variance(&self) -> bool {
        self.replicas().is_some_and(|replicas| replicas >= 2)
    }

    /// Estimated variance of [`Accumulator::mean`], or `None` where it is not known.
    pub fn variance_of_mean(&self) -> Option<Vec<f32>> {
        let values = (0..self.sums.len()).into_par_iter();
        self.has_variance().then(|| {
            values
                .map(|index| self.variance_of_mean_at(index))
                .collect()
        })
    }

    /// One value of [`Accumulator::variance_of_mean`]; zero where that is not known.
    pub fn variance_of_mean_at(&self, index: usize) -> f32 {
        let (Some(spread), Some(replicas)) = (&self.spread, self.replicas().filter(|r| *r >= 2))
        else {
            return 0.0;
        };
        let n = self.passes as f64;
        let unit_squared = self.unit.value() * self.unit.value();
        let scale = unit_squared / ((replicas - 1) as f64 * n);
        let square_step = (1_u64 << SQUARE_SHIFT) as f64;
        let sum = self.sums[index] as f64;
        let squares = spread.squares_with_open(index) as f64 * square_step;
        ((squares - sum * sum / n).max(0.0) * scale) as f32
    }

    /// Number of replicas, one that is not complete included.
    pub fn replicas(&self) -> Option<u64> {
        self.spread
            .as_ref()
            .map(|s| s.replicas + u64::from(s.open_passes > 0))
    }
}

impl Spread {
    /// The squares of a value, those of the open replica included.
    fn squares_with_open(&self, index: usize) -> i128 {
        let (squares, sum) = (self.squares[index], i128::from(self.open[index]));
        match self.open_passes {
            0 => squares,
            passes => squares + square(sum, passes),
        }
    }

    /// Ends the open replica.
    fn close(&mut self) {
        let passes = self.open_passes;
        self.squares
            .par_iter_mut()
            .zip(&mut self.open)
            .for_each(|(squares, open)| {
                let sum = i128::from(std::mem::take(open));
                *squares += square(sum, passes);
            });
        self.replicas += 1;
        self.open_passes = 0;
    }
}

/// What a replica of `passes` adds to the squares.
fn square(sum: i128, passes: u32) -> i128 {
    (sum * sum / i128::from(passes)) >> SQUARE_SHIFT
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Canvas, Filter, Window};
    use crate::math::Vec2;

    fn accumulate(values: &[f32], passes_per_replica: Option<u32>) -> Accumulator {
        let unit = Unit::for_magnitude(1.0);
        let mut pass = PassBuffer::new(Window::full(1, 1), 1, unit);
        let mut film = Accumulator::new(1, unit, passes_per_replica);
        for value in values {
            pass.add(&Filter::pixel_box(), Vec2::splat(0.5), [*value]);
            film.fold(&mut pass);
        }
        film
    }

    #[test]
    fn means_and_variances_are_those_of_the_textbook() {
        let film = accumulate(&[1.0, 2.0, 4.0, 5.0], Some(1));
        assert_eq!(film.mean(), [3.0]);
        // Sample variance 10/3 over 4 values.
        assert!((film.variance_of_mean().unwrap()[0] - 10.0 / 12.0).abs() < 1e-6);
    }

    #[test]
    fn replicas_group_passes() {
        // Replica means 1.5 and 4.5, weight two each, then a short one of 7.
        let film = accumulate(&[1.0, 2.0, 4.0, 5.0, 7.0], Some(2));
        assert_eq!(film.replicas(), Some(3));
        let mean = 19.0 / 5.0;
        let deviation = 2.0 * (1.5 - mean) * (1.5 - mean)
            + 2.0 * (4.5 - mean) * (4.5 - mean)
            + (7.0 - mean) * (7.0_f32 - mean);
        assert!((film.variance_of_mean().unwrap()[0] - deviation / 10.0).abs() < 1e-5);
    }

    #[test]
    fn variance_needs_two_replicas() {
        assert!(
            accumulate(&[1.0, 2.0], Some(2))
                .variance_of_mean()
                .is_none()
        );
        assert!(accumulate(&[1.0, 2.0], None).variance_of_mean().is_none());
        assert_eq!(accumulate(&[], Some(1)).mean(), [0.0]);
    }

    #[test]
    fn dark_pixels_keep_their_variance() {
        let film = accumulate(&[1e-4, 3e-4], Some(1));
        let variance = film.variance_of_mean().unwrap()[0];
        assert!((variance / 1e-8 - 1.0).abs() < 0.01, "{variance}");
    }
}
