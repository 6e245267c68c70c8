//! Where on the image chains should be more often than it is bright.

use crate::film::PassBuffer;
use crate::math::Vec2;
use crate::mutation::RasterDomain;

/// Weights of places on the image, by which the target of chains is multiplied and what they deposit divided.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::integrator) struct Importance {
    low: Vec2,
    /// Side of a cell in pixels.
    cell: f32,
    columns: usize,
    weights: Vec<f64>,
}

impl Importance {
    /// The same weight everywhere.
    pub(super) fn flat(domain: &RasterDomain) -> Self {
        Self {
            low: domain.low,
            cell: f32::INFINITY,
            columns: 1,
            weights: vec![1.0],
        }
    }

    /// The weight of a raster position; beyond the map, that of the nearest cell.
    #[inline]
    pub(in crate::integrator) fn at(&self, raster: Vec2) -> f64 {
        if self.weights.len() == 1 {
            return self.weights[0];
        }
        let rows = self.weights.len() / self.columns;
        let place = ((raster - self.low) / self.cell).max(Vec2::ZERO);
        let column = (place.x as usize).min(self.columns - 1);
        let row = (place.y as usize).min(rows - 1);
        self.weights[row * self.columns + column]
    }
}

/// Passes after which a map starts from nothing again: a render can be shared out by so many.
const PASSES_OF_MAP: u32 = 64;

/// Sides of cells in pixels: that of the first map, and the smallest.
const CELLS: (u32, u32) = (32, 4);

/// How many times more or less often than it is bright a place is visited, at most.
const FARTHEST: f64 = 8.0;

/// Light that counts as dark, as a part of the mean over the image.
const DARK: f64 = 0.05;

/// Learns weights from the noise of passes, stage by stage.
///
/// The passes of a stage share one map. From their spread follows the next one, with cells of half
/// the size; a stage is twice as long as the one before. With `v` the variance of a pixel of a pass, `w` its weight and
/// `I` its light, chains that visit it more often make `v w` of it whatever `w` is; so that `w = v w / I²` makes
/// relative noise the same everywhere.
///
/// Differs: every pass begins new chains with seeds that are drawn by its own weights, so that no stage has a startup
/// bias.
///
/// Source: van Antwerpen 2011, Sec. 6.7; Hoberock & Hart 2010.
pub(super) struct NoiseMap {
    domain: RasterDomain,
    importance: Importance,
    stage: u32,
    passes: u32,
    /// Of each pixel: sums of the luminance of the stage's passes, and of its square.
    sums: Vec<[f64; 2]>,
}

impl NoiseMap {
    /// A map that knows nothing.
    pub(super) fn new(domain: RasterDomain) -> Self {
        Self {
            importance: Importance::flat(&domain),
            domain,
            stage: 0,
            passes: 0,
            sums: Vec::new(),
        }
    }

    /// The weights for a pass.
    pub(super) fn for_pass(&mut self, pass: u32) -> Importance {
        if pass % PASSES_OF_MAP == 0 {
            *self = Self::new(self.domain);
        }
        self.importance.clone()
    }

    /// Takes note of what has landed in a pass.
    pub(super) fn observe(&mut self, landed: &mut PassBuffer) {
        let luminances = landed.luminances();
        self.sums.resize(luminances.len(), [0.0; 2]);
        for (sums, luminance) in self.sums.iter_mut().zip(&luminances) {
            sums[0] += luminance;
            sums[1] += luminance * luminance;
        }
        self.passes += 1;
        if self.passes >= 2 << self.stage.saturating_sub(1) {
            let window = landed.window();
            let low = Vec2::new(window.x as f32, window.y as f32);
            self.importance = self.next(low, window.width as usize);
            self.stage += 1;
            self.passes = 0;
            self.sums.clear();
        }
    }

    /// The map that follows from the noise of a stage.
    fn next(&self, low: Vec2, width: usize) -> Importance {
        let cell = (CELLS.0 >> self.stage.min(8)).max(CELLS.1) as usize;
        let (columns, rows) = (
            width.div_ceil(cell),
            (self.sums.len() / width).div_ceil(cell),
        );
        let count = f64::from(self.passes);
        // Of each cell: number of pixels, their light, and their variance times weight.
        let mut cells = vec![[0.0; 3]; columns * rows];
        let mut total = 0.0;
        for (index, [sum, squares]) in self.sums.iter().enumerate() {
            let (x, y) = (index % width, index / width);
            let mean = sum / count;
            let variance = (squares / count - mean * mean).max(0.0);
            let weight = self
                .importance
                .at(low + Vec2::new(x as f32, y as f32) + 0.5);
            let cell = &mut cells[y / cell * columns + x / cell];
            cell[0] += 1.0;
            cell[1] += mean;
            cell[2] += variance * weight;
            total += mean;
        }
        let dark = DARK * total / self.sums.len() as f64;
        let wanted = |[pixels, light, noise]: [f64; 3]| {
            let light = light / pixels + dark;
            noise / pixels / (light * light)
        };
        let mut weights: Vec<f64> = cells.into_iter().map(wanted).collect();
        normalise(&mut weights);
        Importance {
            low,
            cell: cell as f32,
            columns,
            weights,
        }
    }
}

/// Scales weights to a mean of one, and limits them.
fn normalise(weights: &mut [f64]) {
    let sum: f64 = weights.iter().filter(|weight| weight.is_finite()).sum();
    let mean = sum / weights.len() as f64;
    for weight in weights {
        let scaled = *weight / mean;
        *weight = if scaled.is_finite() {
            scaled.clamp(1.0 / FARTHEST, FARTHEST)
        } else {
            1.0
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Canvas, Filter, Unit, Window};

    #[test]
    fn noise_draws_chains() {
        let window = Window::full(64, 32);
        let domain = RasterDomain {
            low: Vec2::ZERO,
            high: Vec2::new(64.0, 32.0),
        };
        let mut map = NoiseMap::new(domain);
        let mut buffer = PassBuffer::new(window, 3, Unit::for_magnitude(1.0));
        for pass in 0..2 {
            assert_eq!(map.for_pass(pass).at(Vec2::ZERO), 1.0);
            for x in 0..64 {
                for y in 0..32 {
                    // The same light everywhere; on the right, it varies twice as much.
                    let spread = if x < 32 { 0.1 } else { 0.2 };
                    let value = if (x + y + pass) % 2 == 0 {
                        1.0 + spread
                    } else {
                        1.0 - spread
                    };
                    let place = Vec2::new(x as f32, y as f32) + 0.5;
                    buffer.add(&Filter::pixel_box(), place, [value; 3]);
                }
            }
            map.observe(&mut buffer);
            buffer.clear();
        }
        let weights = map.for_pass(2);
        let [left, right] = [10.0, 50.0].map(|x| weights.at(Vec2::new(x, 10.0)));
        assert!((right / left - 4.0).abs() < 0.01, "{left}, {right}");
        assert_eq!(weights.at(Vec2::splat(-9.0)), left);
        assert_eq!(map.for_pass(PASSES_OF_MAP).at(Vec2::ZERO), 1.0);
    }
}
