//! The map of the image that says how far paths seen there should move.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::Learning;
use crate::energy::{AcceptanceTally, kernel_weights};
use crate::math::Vec2;
use crate::mutation::RasterDomain;

/// How many mutations of the whole image's mean a cell starts from.
const PRIOR: f64 = 16.0;

/// Probabilities of the kernels in every cell, and what is being learnt about them.
///
/// What is learnt changes nothing until a new map is made of it.
#[derive(Debug)]
pub(super) struct KernelMap {
    domain: RasterDomain,
    cell: f32,
    columns: usize,
    kernels: usize,
    /// Probability of each kernel in each cell.
    weights: Vec<f32>,
    /// Mutations and steps of acceptance of each kernel in each cell.
    seen: Vec<[AtomicU64; 2]>,
}

impl KernelMap {
    /// A map that knows nothing.
    ///
    /// - `cell`: side of its cells in pixels.
    pub(super) fn new(domain: RasterDomain, cell: u32, kernels: usize) -> Self {
        let cell = cell as f32;
        let cells = ((domain.high - domain.low) / cell).ceil();
        let columns = cells.x as usize;
        let count = columns * cells.y as usize * kernels;
        let mut seen = Vec::new();
        seen.resize_with(count, Default::default);
        Self {
            domain,
            cell,
            columns,
            kernels,
            weights: vec![1.0 / kernels as f32; count],
            seen,
        }
    }

    /// Where a raster position's cell starts.
    #[inline]
    fn first(&self, raster: Vec2) -> usize {
        let cell = (raster - self.domain.low) / self.cell;
        (cell.y as usize * self.columns + cell.x as usize) * self.kernels
    }

    /// Probabilities of the kernels for a path that is seen at a raster position of the domain.
    #[inline]
    pub(super) fn weights(&self, raster: Vec2) -> &[f32] {
        &self.weights[self.first(raster)..][..self.kernels]
    }

    /// Learns from a mutation of a path that is seen at a raster position of the domain.
    #[inline]
    pub(super) fn learn(&self, raster: Vec2, kernel: usize, acceptance: f64) {
        let [count, steps] = &self.seen[self.first(raster) + kernel];
        count.fetch_add(1, Relaxed);
        steps.fetch_add(AcceptanceTally::in_steps(acceptance), Relaxed);
    }

    /// Brings the probabilities up to what was learnt.
    ///
    /// Differs: the published scheme learns for each path on its own, which is biased.
    ///
    /// Source: Lai et al. 2007, Secs. 4.3 and 7.
    ///
    /// - `radii`: of the kernels, in pixels.
    pub(super) fn adapt(&mut self, learning: Learning, radii: &[f32]) {
        let tallies: Vec<AcceptanceTally> = self
            .seen
            .iter_mut()
            .map(|[count, steps]| AcceptanceTally {
                count: *count.get_mut(),
                steps: *steps.get_mut(),
            })
            .collect();
        let mut whole = vec![AcceptanceTally::default(); self.kernels];
        for cell in tallies.chunks(self.kernels) {
            for (sum, tally) in whole.iter_mut().zip(cell) {
                sum.count += tally.count;
                sum.steps += tally.steps;
            }
        }
        let cells = tallies.chunks(self.kernels);
        for (weights, cell) in self.weights.chunks_mut(self.kernels).zip(cells) {
            let merit = |(kernel, tally): (usize, &AcceptanceTally)| {
                let mean = tally.mean((PRIOR, whole[kernel].mean((0.0, 0.0))));
                mean * learning.reach_of(radii[kernel])
            };
            let merits: Vec<f64> = cell.iter().enumerate().map(merit).collect();
            weights.copy_from_slice(&kernel_weights(&merits, learning.epsilon));
        }
    }
}

impl Learning {
    /// What a kernel's radius adds to its merit.
    pub(super) fn reach_of(&self, radius: f32) -> f64 {
        f64::from(radius).powf(self.reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEARNING: Learning = Learning {
        epsilon: 0.01,
        reach: 0.0,
    };

    fn map() -> KernelMap {
        let domain = RasterDomain {
            low: Vec2::new(-1.0, -1.0),
            high: Vec2::new(20.0, 9.0),
        };
        KernelMap::new(domain, 8, 2)
    }

    #[test]
    fn nothing_changes_until_it_is_told_to() {
        let mut map = map();
        let (here, there) = (Vec2::new(-1.0, 8.9), Vec2::new(19.9, -1.0));
        for _ in 0..10_000 {
            map.learn(here, 0, 0.9);
            map.learn(here, 1, 0.1);
        }
        assert_eq!(map.weights(here), [0.5, 0.5]);
        map.adapt(LEARNING, &[5.0, 10.0]);
        let weights = map.weights(here);
        assert!((weights[0] - 0.9).abs() < 0.01, "{weights:?}");
        // Where nothing was seen, the image's mean is all there is to go by.
        assert!((map.weights(there)[0] - 0.9).abs() < 0.01);
    }

    #[test]
    fn cells_differ_and_reach_counts() {
        let mut map = map();
        for _ in 0..10_000 {
            for (x, acceptances) in [(0.0, [0.5, 0.5]), (15.0, [0.8, 0.2])] {
                for (kernel, acceptance) in acceptances.into_iter().enumerate() {
                    map.learn(Vec2::new(x, 0.0), kernel, acceptance);
                }
            }
        }
        map.adapt(LEARNING, &[5.0, 10.0]);
        assert!((map.weights(Vec2::ZERO)[0] - 0.5).abs() < 0.01);
        assert!((map.weights(Vec2::new(15.0, 0.0))[0] - 0.8).abs() < 0.01);
        let learning = Learning {
            reach: 1.0,
            ..LEARNING
        };
        map.adapt(learning, &[5.0, 10.0]);
        assert!((map.weights(Vec2::ZERO)[0] - 1.0 / 3.0).abs() < 0.01);
    }
}
