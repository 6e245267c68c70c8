//! How much of every function of a path flows along with the energy that mutations move.

use super::factors::{Factors, NAMES};

/// Differences below this one may be rounding, which depends on the end that a path was made from.
const ROUNDING: f64 = 2e-3;

/// The flow that one kind of mutation has made.
pub(crate) struct Flow {
    pub(crate) proposals: u64,
    sample: Factors,
    sums: Factors,
    squares: Factors,
}

impl Default for Flow {
    fn default() -> Self {
        Self {
            proposals: 0,
            sample: [0.0; NAMES.len()],
            sums: [0.0; NAMES.len()],
            squares: [0.0; NAMES.len()],
        }
    }
}

impl Flow {
    /// Counts energy that goes from one path to another.
    pub(crate) fn add(&mut self, energy: f64, from: &Factors, to: &Factors) {
        self.proposals += 1;
        for (sum, (from, to)) in self.sample.iter_mut().zip(from.iter().zip(to)) {
            let difference = (to - from).clamp(-3.0, 3.0);
            if difference.abs() > ROUNDING {
                *sum += energy * difference;
            }
        }
    }

    /// Ends a sample: samples are independent, the paths of one are not.
    pub(crate) fn end_sample(&mut self) {
        for (index, value) in self.sample.iter_mut().enumerate() {
            self.sums[index] += *value;
            self.squares[index] += *value * *value;
            *value = 0.0;
        }
    }

    /// For each function that varied, its mean in standard errors.
    pub(crate) fn z(&self, count: u32) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let count = f64::from(count);
        let largest = self.squares.iter().copied().fold(0.0, f64::max);
        NAMES.into_iter().enumerate().filter_map(move |(i, name)| {
            let (sum, square) = (self.sums[i], self.squares[i]);
            let deviation = (square - sum * sum / count).max(0.0).sqrt();
            // What rounding at total reflection does to a constant is no flow.
            (square > 1e-5 * largest).then(|| (name, sum / deviation))
        })
    }

    /// The function that is farthest out.
    pub(crate) fn worst(&self, count: u32) -> (&'static str, f64) {
        self.z(count)
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
            .unwrap_or(("nothing", 0.0))
    }
}
