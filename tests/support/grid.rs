//! Histograms of two coordinates.

use lumiflow::math::statistics::chi_square_p;

/// Cells along each of two coordinates.
const CELLS: usize = 12;
/// Points along each side of a cell in integrals over it.
const POINTS: usize = 24;

/// A rectangle of two coordinates, cut into cells.
pub(crate) struct Grid {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
}

impl Grid {
    /// Cell of a point; the last one is outside.
    fn cell(&self, point: [f64; 2]) -> usize {
        let place = |axis: usize| {
            let size = self.high[axis] - self.low[axis];
            let place = (point[axis] - self.low[axis]) / size * CELLS as f64;
            (0.0..CELLS as f64)
                .contains(&place)
                .then_some(place as usize)
        };
        match (place(0), place(1)) {
            (Some(x), Some(y)) => y * CELLS + x,
            _ => CELLS * CELLS,
        }
    }

    /// Integral of a density over each cell, and what is left to one.
    fn integrals(&self, density: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        let steps = (CELLS * POINTS) as f64;
        let size = [0, 1].map(|axis| (self.high[axis] - self.low[axis]) / steps);
        let mut integrals = vec![0.0; CELLS * CELLS + 1];
        for y in 0..CELLS * POINTS {
            for x in 0..CELLS * POINTS {
                let at = [
                    self.low[0] + (x as f64 + 0.5) * size[0],
                    self.low[1] + (y as f64 + 0.5) * size[1],
                ];
                integrals[self.cell(at)] += density(at) * size[0] * size[1];
            }
        }
        integrals[CELLS * CELLS] = 1.0 - integrals.iter().sum::<f64>();
        integrals
    }

    /// Chance that points come from a density.
    pub(crate) fn p(
        &self,
        count: u32,
        mut point: impl FnMut() -> Option<[f64; 2]>,
        density: impl Fn([f64; 2]) -> f64,
    ) -> f64 {
        let mut observed = vec![0.0; CELLS * CELLS + 1];
        let mut made = 0.0;
        for point in (0..count).filter_map(|_| point()) {
            observed[self.cell(point)] += 1.0;
            made += 1.0;
        }
        let expected = self.integrals(density);
        assert!(expected[CELLS * CELLS].abs() < 2e-3, "the density is one");
        let expected: Vec<f64> = expected.iter().map(|e| e.max(1e-9) * made).collect();
        chi_square_p(&observed, &expected).unwrap_or(1.0)
    }
}
