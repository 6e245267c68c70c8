//! The table behind an environment map.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::EmitterError;
use crate::image::Bitmap;
use crate::math::distribution::PiecewiseConstant2d;
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3, warp};

/// Weight of the uniform parts, over the row's and over the map's mean luminance.
const UNIFORM_PART: f32 = 1.0 / 128.0;

/// The picture and what is needed to sample it, in the emitter's frame.
#[derive(Debug)]
pub(super) struct Map {
    image: Arc<Bitmap>,
    /// `None` for a black picture.
    cells: Option<PiecewiseConstant2d>,
    /// Luminance that is added to all corners of a cell, by row of cells.
    uniform: Vec<f32>,
    /// Cosine to the pole of the rows' borders: one more than there are rows of cells.
    cosines: Vec<f64>,
    /// ∫ luminance dω, in W·m⁻².
    pub(super) integral: f64,
}

/// The cell of a direction, and where it lies inside of it.
pub(super) struct Place {
    /// Left column of texels and upper row of texels.
    cell: [usize; 2],
    /// Part of the way to the next column.
    across: f32,
    /// Part of the way to the next row by angle, as lookups interpolate.
    down_by_angle: f32,
    /// Part of the way to the next row by cosine, as samples are spread.
    down_by_cosine: f32,
}

impl Map {
    pub(super) fn new(image: Arc<Bitmap>) -> Result<Self, EmitterError> {
        let (width, height) = (image.width(), image.height());
        let rows = (height - 1).max(1) as usize;
        let cosines = (0..=rows)
            .map(|row| (PI * row as f64 / rows as f64).cos())
            .collect();
        let mut map = Self {
            image,
            cells: None,
            uniform: Vec::new(),
            cosines,
            integral: 0.0,
        };
        let sums = (0..height)
            .map(|y| map.row_sum(y))
            .collect::<Result<Vec<f64>, _>>()?;
        let means = |row: usize| {
            let below = (row + 1).min(sums.len() - 1);
            (sums[row] + sums[below]) / (2.0 * f64::from(width))
        };
        map.integral = TAU
            * (0..sums.len())
                .map(|y| sums[y] / f64::from(width) * map.row_weight(y))
                .sum::<f64>();
        let mean = map.integral / (4.0 * PI);
        map.uniform = (0..rows)
            .map(|row| UNIFORM_PART * (means(row) + mean) as f32)
            .collect();
        map.cells = map.tabulate();
        Ok(map)
    }

    /// Sum of the luminances of a row of texels.
    fn row_sum(&self, y: u32) -> Result<f64, EmitterError> {
        let mut sum = 0.0;
        for x in 0..self.image.width() {
            if !self.image.rgb(x, y).is_finite() {
                return Err(EmitterError::BadTexel { x, y });
            }
            sum += f64::from(self.texel(x as usize, y as usize).luminance());
        }
        Ok(sum)
    }

    /// ∫ sin θ dθ over the rows that a row of texels reaches, weighted as lookups interpolate.
    fn row_weight(&self, y: usize) -> f64 {
        let last = self.cosines.len() - 1;
        if self.image.height() == 1 {
            return 2.0;
        }
        let step = PI / last as f64;
        if y == 0 || y == last {
            1.0 - step.sin() / step
        } else {
            2.0 * (step * y as f64).sin() * (1.0 - step.cos()) / step
        }
    }

    fn tabulate(&self) -> Option<PiecewiseConstant2d> {
        let width = self.image.width() as usize;
        let luminances = |y: usize| -> Vec<f32> {
            let row = y.min(self.image.height() as usize - 1);
            (0..width).map(|x| self.texel(x, row).luminance()).collect()
        };
        let mut below = luminances(0);
        PiecewiseConstant2d::from_rows(self.uniform.len(), |row| {
            let above = std::mem::replace(&mut below, luminances(row + 1));
            let columns = above.iter().zip(&below).map(|(a, b)| f64::from(a + b));
            let next = columns.clone().cycle().skip(1);
            let uniform = 4.0 * f64::from(self.uniform[row]);
            let size = self.cosines[row] - self.cosines[row + 1];
            columns
                .zip(next)
                .map(|(left, right)| (left + right + uniform) * size)
                .collect()
        })
    }

    #[inline]
    fn texel(&self, x: usize, y: usize) -> Rgb {
        let colour = self.image.rgb(x as u32, y as u32);
        Rgb(colour.0.max(Vec3::ZERO))
    }

    /// The four texels around a cell: upper left, upper right, lower left, lower right.
    #[inline]
    fn corners(&self, [column, row]: [usize; 2]) -> [Rgb; 4] {
        let right = (column + 1) % self.image.width() as usize;
        let below = (row + 1).min(self.image.height() as usize - 1);
        [(column, row), (right, row), (column, below), (right, below)]
            .map(|(x, y)| self.texel(x, y))
    }

    /// What the density inside a cell is in proportion to, at its corners.
    #[inline]
    fn corner_weights(&self, cell: [usize; 2]) -> [f32; 4] {
        let row = cell[1];
        let [a, b, c, d] = self
            .corners(cell)
            .map(|c| c.luminance() + self.uniform[row]);
        if row == 0 || row + 1 == self.uniform.len() {
            // Beside a pole, the middle by angle is far from that by cosine.
            let (left, right) = (0.5 * (a + c), 0.5 * (b + d));
            return [left, right, left, right];
        }
        [a, b, c, d]
    }

    /// Solid angle of the cells of a row, in sr.
    #[inline]
    fn cell_size(&self, row: usize) -> f64 {
        let width = f64::from(self.image.width());
        TAU / width * (self.cosines[row] - self.cosines[row + 1])
    }

    /// Where a unit direction of the emitter's frame lies.
    #[inline]
    pub(super) fn place(&self, local: Vec3) -> Place {
        let width = self.image.width() as usize;
        let rows = self.uniform.len();
        let local = local.as_dvec3();
        let turn = local.x.atan2(-local.z) / TAU;
        let x = (turn * width as f64 - 0.5).rem_euclid(width as f64);
        let column = (x as usize).min(width - 1);
        // Not from the cosine: that says little about angles near the poles.
        let angle = local.x.hypot(local.z).atan2(local.y);
        let y = angle * rows as f64 / PI;
        let row = (y as usize).min(rows - 1);
        let (top, bottom) = (self.cosines[row], self.cosines[row + 1]);
        let down_by_cosine = (top - angle.cos()) / (top - bottom);
        Place {
            cell: [column, row],
            across: (x - column as f64) as f32,
            down_by_angle: (y - row as f64) as f32,
            down_by_cosine: down_by_cosine.clamp(0.0, 1.0) as f32,
        }
    }

    #[inline]
    pub(super) fn radiance(&self, place: &Place) -> Rgb {
        let [a, b, c, d] = self.corners(place.cell);
        let (x, y) = (place.across, place.down_by_angle);
        let above = a * (1.0 - x) + b * x;
        let below = c * (1.0 - x) + d * x;
        above * (1.0 - y) + below * y
    }

    /// A unit direction of the emitter's frame; `None` for a black picture.
    #[inline]
    pub(super) fn sample(&self, u: Vec2) -> Option<Vec3> {
        let choice = self.cells.as_ref()?.sample_cell(u);
        let inside = warp::bilinear(
            choice.remainder,
            self.corner_weights([choice.column, choice.row]),
        );
        let width = f64::from(self.image.width());
        let turn = (choice.column as f64 + 0.5 + f64::from(inside.x)) / width;
        let (top, bottom) = (self.cosines[choice.row], self.cosines[choice.row + 1]);
        let cos = top + (bottom - top) * f64::from(inside.y);
        let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
        let (x, z) = (TAU * turn).sin_cos();
        Some(glam::DVec3::new(sin * x, cos, -sin * z).as_vec3())
    }

    /// Undoes [`Map::sample`].
    pub(super) fn invert(&self, local: Vec3) -> Option<Vec2> {
        let place = self.place(local);
        let inside = Vec2::new(place.across, place.down_by_cosine);
        let remainder = warp::bilinear_inverse(inside, self.corner_weights(place.cell));
        self.cells.as_ref()?.invert_cell(place.cell, remainder)
    }

    #[inline]
    pub(super) fn density(&self, place: &Place) -> SolidAngleDensity {
        let Some(cells) = &self.cells else {
            return SolidAngleDensity::ZERO;
        };
        let [column, row] = place.cell;
        let inside = Vec2::new(place.across, place.down_by_cosine);
        let probability = cells.cell_probability(column, row);
        let within = warp::bilinear_density(inside, self.corner_weights(place.cell));
        SolidAngleDensity(probability * within / self.cell_size(row) as f32)
    }
}
