//! The pool of raster positions where new paths start.

use crate::integrator::camera::SampledWindow;

/// Side of the squares whose pixels are handed out together, as a power of two.
const NEIGHBOURHOOD: i32 = 4;

/// The pixels of one batch, each once, in an order that covers the whole image evenly at any time.
///
/// Every batch is a sample of the whole image by itself: what a map has learnt from others before it does not
/// favour any part. Places inside of pixels, and the numbers of the paths behind them, are those of the
/// sampler, so that they are spread over a whole replica.
///
/// Source: Lai et al. 2007, Sec. 4.1.
#[derive(Clone, Debug)]
pub(super) struct Pool {
    window: SampledWindow,
    count: u64,
    stride: u64,
    taken: u64,
}

impl Pool {
    /// A full pool.
    pub(super) fn new(window: SampledWindow) -> Self {
        let count = u64::from(window.width) * u64::from(window.height);
        Self {
            window,
            count,
            stride: golden_stride(count),
            taken: 0,
        }
    }

    /// Takes some positions out: pixels of the full film or its border.
    ///
    /// - `wanted`: how many; fewer are taken where fewer are left.
    pub(super) fn take(&mut self, wanted: usize) -> Vec<(i32, i32)> {
        let end = self.count.min(self.taken + wanted as u64);
        let positions = (self.taken..end).map(|number| {
            let place = number * self.stride % self.count;
            let width = u64::from(self.window.width);
            let (column, row) = ((place % width) as i32, (place / width) as i32);
            (self.window.x + column, self.window.y + row)
        });
        let mut positions: Vec<_> = positions.collect();
        self.taken = end;
        // What is close on the image is close in memory: paths that are handled in turn should be neighbours.
        positions.sort_by_key(|(x, y)| (y >> NEIGHBOURHOOD, x >> NEIGHBOURHOOD));
        positions
    }

    /// Whether positions are left.
    pub(super) fn has_more(&self) -> bool {
        self.taken < self.count
    }
}

/// A step near the golden section of `count` that visits every one of `count` places in a circle.
fn golden_stride(count: u64) -> u64 {
    let start = ((count as f64 * 0.618_033_988_749_895) as u64).max(1);
    (start..)
        .find(|stride| greatest_common_divisor(*stride, count.max(1)) == 1)
        .unwrap_or(1)
}

fn greatest_common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 {
        a
    } else {
        greatest_common_divisor(b, a % b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_pixel_is_taken_once_and_evenly() {
        for (width, height) in [(1, 1), (16, 16), (37, 23), (64, 1)] {
            let window = SampledWindow {
                x: -2,
                y: 3,
                width,
                height,
            };
            let mut pool = Pool::new(window);
            let half = pool.take((width * height / 2) as usize);
            let top = half
                .iter()
                .filter(|(_, y)| *y < 3 + height as i32 / 2)
                .count();
            assert!((top as f64 - half.len() as f64 / 2.0).abs() <= 1.0 + f64::from(width) / 2.0);
            let mut all = half;
            all.extend(pool.take(usize::MAX / 2));
            assert!(pool.take(1).is_empty());
            let count = all.len();
            let all: BTreeSet<_> = all.into_iter().collect();
            assert_eq!(all.len(), count);
            assert_eq!(count, (width * height) as usize);
            assert!(!pool.has_more());
            assert!(all.contains(&(-2, 3)));
        }
    }
}
