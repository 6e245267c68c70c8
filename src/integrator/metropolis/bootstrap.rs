//! Bootstrap sets, and the seeds that are drawn from them.

use std::ops::Range;

use crate::math::Vec2;

/// A stratification of the unit square into equal cells, one for each of a number of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::integrator) struct Cells {
    columns: u32,
    rows: u32,
}

impl Cells {
    /// About as many cells as asked for, at most; their sides are about as long on the image.
    ///
    /// - `count`: at least one.
    /// - `size`: width and height of the image.
    pub(in crate::integrator) fn new(count: u32, size: Vec2) -> Self {
        let aspect = f64::from(size.x / size.y);
        let columns = (f64::from(count) * aspect).sqrt().floor() as u32;
        let columns = columns.clamp(1, count);
        Self {
            columns,
            rows: count / columns,
        }
    }

    /// Number of cells.
    pub(in crate::integrator) fn count(self) -> u32 {
        self.columns * self.rows
    }

    /// Lower corner and size of a cell.
    pub(in crate::integrator) fn cell(self, index: u32) -> (Vec2, Vec2) {
        let size = Vec2::new(1.0 / self.columns as f32, 1.0 / self.rows as f32);
        let place = Vec2::new((index % self.columns) as f32, (index / self.columns) as f32);
        (place * size, size)
    }
}

/// Where a chain begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) struct Seed {
    /// Index of the bootstrap sample.
    pub(in crate::integrator) sample: u32,
    /// A number from zero to the sample's luminance: uniform, so that it chooses a part of the sample in
    /// proportion to that part's luminance.
    pub(in crate::integrator) within: f64,
}

/// The luminances of a bootstrap set, in blocks of samples.
pub(super) struct Bootstrap {
    /// Luminance of each sample.
    luminances: Vec<f64>,
    /// Sum of those before each block.
    before: Vec<f64>,
    total: f64,
}

/// Samples of a block, which is a unit of work.
pub(super) const BLOCK: u32 = 1024;

/// The samples of a block.
pub(super) fn block(index: u32, samples: u32) -> Range<u32> {
    index * BLOCK..((index + 1) * BLOCK).min(samples)
}

impl Bootstrap {
    /// Puts the blocks together: sums go by index, and do not know who made what.
    pub(super) fn new(blocks: impl Iterator<Item = Vec<f64>>) -> Self {
        let mut luminances = Vec::new();
        let mut before = Vec::new();
        let mut total = 0.0;
        for block in blocks {
            before.push(total);
            total += block.iter().sum::<f64>();
            luminances.extend(block);
        }
        Self {
            luminances,
            before,
            total,
        }
    }

    /// Mean luminance of the samples.
    pub(super) fn mean(&self) -> f64 {
        self.total / self.luminances.len().max(1) as f64
    }

    /// Seeds in proportion to luminance: every sample becomes as many as its share in the mean, rounded
    /// up or down (systematic resampling).
    ///
    /// - `u`: uniform in `[0, 1)`.
    ///
    /// Source: Veach 1997.
    pub(super) fn seeds(&self, count: u32, u: f64) -> Vec<Seed> {
        let mut seeds = Vec::with_capacity(count as usize);
        let step = self.total / f64::from(count);
        let mut next = u * step;
        for (block, before) in self.before.iter().enumerate() {
            let first = block * BLOCK as usize;
            let last = (first + BLOCK as usize).min(self.luminances.len());
            let mut sum = 0.0;
            for sample in first..last {
                let luminance = self.luminances[sample];
                // The same sums as in the totals: the last seed is not lost to rounding.
                while seeds.len() < count as usize && next < before + (sum + luminance) {
                    seeds.push(Seed {
                        sample: sample as u32,
                        within: (next - before - sum).clamp(0.0, luminance),
                    });
                    next = (seeds.len() as f64 + u) * step;
                }
                sum += luminance;
            }
        }
        seeds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_image() {
        for (count, size) in [(1, (3.0, 2.0)), (10, (1.0, 1.0)), (65_536, (640.0, 480.0))] {
            let cells = Cells::new(count, Vec2::from(size));
            assert!(cells.count() <= count && 2 * cells.count() >= count);
            let area = |index| {
                let (low, size) = cells.cell(index);
                assert!((low + size).max_element() < 1.0001);
                f64::from(size.x) * f64::from(size.y)
            };
            let sum: f64 = (0..cells.count()).map(area).sum();
            assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        }
    }

    #[test]
    fn seeds_go_by_luminance() {
        let luminances: Vec<f64> = (0..3000).map(|i| f64::from(i % 7) * 0.3).collect();
        let blocks = luminances.chunks(BLOCK as usize).map(<[f64]>::to_vec);
        let bootstrap = Bootstrap::new(blocks);
        let total: f64 = luminances.iter().sum();
        assert!((bootstrap.mean() - total / 3000.0).abs() < 1e-9);
        for u in [0.0, 0.3, 0.999_999] {
            for count in [1, 10, 5000] {
                let seeds = bootstrap.seeds(count, u);
                assert_eq!(seeds.len(), count as usize);
                let mut found = vec![0.0; luminances.len()];
                for seed in &seeds {
                    found[seed.sample as usize] += 1.0;
                    assert!(seed.within <= luminances[seed.sample as usize]);
                }
                for (found, luminance) in found.iter().zip(&luminances) {
                    let wanted = luminance / total * f64::from(count);
                    assert!((found - wanted).abs() < 1.0, "{found}, {wanted}");
                }
            }
        }
    }

    #[test]
    fn darkness_has_no_seeds() {
        let bootstrap = Bootstrap::new([vec![0.0; 10]].into_iter());
        assert_eq!(bootstrap.mean(), 0.0);
        assert!(bootstrap.seeds(5, 0.5).is_empty());
    }
}
