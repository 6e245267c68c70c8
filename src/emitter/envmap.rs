//! Light from a picture of all directions.
//!
//! Directions are sampled in proportion to the luminance that a lookup interpolates, cell by cell
//! between texel centres, and uniformly in the cosine to the pole: the density in solid angle has no
//! factor that grows towards the poles. A small uniform part keeps the density positive everywhere;
//! its price is one sample in sixty-five. The table takes 4 bytes a texel.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample,
    SceneBounds,
};
use crate::image::{Bitmap, Texels};
use crate::math::distribution::PiecewiseConstant2d;
use crate::math::{Mat3, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3, rotation_part, warp};
use crate::shape::SurfacePoint;

/// Weight of the uniform parts, over the row's and over the map's mean luminance.
const UNIFORM_PART: f32 = 1.0 / 128.0;

/// An environment from a latitude-longitude picture; clones share it.
///
/// In the emitter's frame, a unit direction `d` looks up u = atan2(d.x, −d.z)/2π and
/// v = acos(d.y)/π. Texel centres lie at half integers of the width; the first and the last row lie
/// on the poles.
#[derive(Clone, Debug)]
pub struct Envmap {
    map: Arc<Map>,
    /// From the emitter's frame to the world's, orthonormal.
    axes: Mat3,
    scale: f32,
    bounds: SceneBounds,
}

impl Envmap {
    /// Makes the light.
    ///
    /// - `image`: radiance in W·m⁻²·sr⁻¹; alpha is ignored, negative values count as zero.
    /// - `to_world`: only its rotation and mirrors count.
    /// - `scale`: multiplies the radiance; not negative.
    ///
    /// # Errors
    /// [`EmitterError::BadTexel`] where the picture holds an infinite value or not a number,
    /// [`EmitterError::BadScale`], [`EmitterError::Singular`].
    pub fn new(image: Arc<Bitmap>, to_world: Mat4, scale: f32) -> Result<Self, EmitterError> {
        let axes = rotation_part(to_world).ok_or(EmitterError::Singular)?;
        if !(scale >= 0.0 && scale.is_finite()) {
            return Err(EmitterError::BadScale);
        }
        Ok(Self {
            map: Arc::new(Map::new(image)?),
            axes,
            scale,
            bounds: SceneBounds::UNIT,
        })
    }

    /// Samples a unit direction, be it dark there or not; `None` for a black picture.
    #[inline]
    pub(super) fn sample_direction(&self, u: Vec2) -> Option<Vec3> {
        Some((self.axes * self.map.sample(u)?).normalize())
    }
}

impl EmitterModel for Envmap {
    fn examples() -> Vec<Self> {
        let smooth = |x: u16, y: u16| f32::from((x * 3 + y * 5) % 7) * 0.2;
        let sun = |x: u16, y: u16| if (x, y) == (3, 1) { 500.0 } else { 0.1 };
        let dark = |x: u16, y: u16| {
            if (4..7).contains(&x) && y > 2 {
                2.0
            } else {
                0.0
            }
        };
        let picture = |width: u16, height: u16, grey: &dyn Fn(u16, u16) -> f32| {
            let texels = (0..height)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .flat_map(|(x, y)| [grey(x, y), grey(x, y) * 0.5, 0.2 * grey(y, x)])
                .collect();
            let bitmap = Bitmap::new(width.into(), height.into(), 3, Texels::Float(texels))?;
            let to_world = Mat4::from_rotation_z(0.6) * Mat4::from_rotation_x(1.0);
            Self::new(Arc::new(bitmap), to_world, 1.5).ok()
        };
        [
            picture(12, 7, &smooth),
            picture(16, 8, &sun),
            picture(10, 6, &dark),
            picture(1, 1, &|_, _| 0.7),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Environment
    }

    fn set_scene_bounds(&mut self, bounds: SceneBounds) {
        self.bounds = bounds;
    }

    /// What enters the sphere around the scene.
    fn power(&self) -> f64 {
        let cross_section = PI * f64::from(self.bounds.radius).powi(2);
        cross_section * self.map.integral * f64::from(self.scale)
    }

    #[inline]
    fn influence(&self, _from: Vec3) -> f32 {
        // A quarter of the sphere's integral: the mean over all ways that a surface can face.
        0.25 * self.map.integral as f32 * self.scale
    }

    #[inline]
    fn environment_radiance(&self, toward: Vec3) -> Rgb {
        let place = self.map.place(self.axes.transpose() * toward);
        self.map.radiance(&place) * self.scale
    }

    #[inline(never)]
    fn sample_toward(&self, _from: Vec3, u: Vec2) -> Option<EmitterSample> {
        let direction = self.sample_direction(u)?;
        let place = self.map.place(self.axes.transpose() * direction);
        let radiance = self.map.radiance(&place) * self.scale;
        if radiance.is_black() {
            return None;
        }
        Some(EmitterSample {
            direction,
            target: None,
            radiance,
            density: self.map.density(&place),
            is_dirac: false,
            surface: None,
        })
    }

    #[inline]
    fn environment_density(&self, toward: Vec3) -> SolidAngleDensity {
        let place = self.map.place(self.axes.transpose() * toward);
        self.map.density(&place)
    }

    #[inline]
    fn sample_emission(&self, u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        let sample = self.sample_toward(self.bounds.centre, u_direction)?;
        Some(EmittedRay::from_infinity(&sample, self.bounds, u_point))
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity {
        EmissionDensity {
            point: self.bounds.disk_density(),
            direction: self.environment_density(-direction),
        }
    }
}

/// The picture and what is needed to sample it, in the emitter's frame.
#[derive(Debug)]
struct Map {
    image: Arc<Bitmap>,
    /// `None` for a black picture.
    cells: Option<PiecewiseConstant2d>,
    /// Luminance that is added to all corners of a cell, by row of cells.
    uniform: Vec<f32>,
    /// Cosine to the pole of the rows' borders: one more than there are rows of cells.
    cosines: Vec<f64>,
    /// ∫ luminance dω, in W·m⁻².
    integral: f64,
}

/// The cell of a direction, and where it lies inside of it.
struct Place {
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
    fn new(image: Arc<Bitmap>) -> Result<Self, EmitterError> {
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
    fn place(&self, local: Vec3) -> Place {
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
    fn radiance(&self, place: &Place) -> Rgb {
        let [a, b, c, d] = self.corners(place.cell);
        let (x, y) = (place.across, place.down_by_angle);
        let above = a * (1.0 - x) + b * x;
        let below = c * (1.0 - x) + d * x;
        above * (1.0 - y) + below * y
    }

    /// A unit direction of the emitter's frame; `None` for a black picture.
    #[inline]
    fn sample(&self, u: Vec2) -> Option<Vec3> {
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

    #[inline]
    fn density(&self, place: &Place) -> SolidAngleDensity {
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

#[cfg(test)]
mod tests;
