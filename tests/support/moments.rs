//! Mean and variance of values that come one by one.

/// Means of independent values.
#[derive(Clone, Copy, Default)]
pub(crate) struct Mean {
    pub(crate) sum: f64,
    squares: f64,
    count: f64,
}

impl Mean {
    pub(crate) fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
        self.count += 1.0;
    }

    pub(crate) fn mean(&self) -> f64 {
        self.sum / self.count
    }

    pub(crate) fn variance(&self) -> f64 {
        (self.squares / self.count - self.mean().powi(2)) / self.count
    }

    pub(crate) fn z_against(&self, other: &Self) -> f64 {
        (self.mean() - other.mean()) / (self.variance() + other.variance()).sqrt()
    }
}
