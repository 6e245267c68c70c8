//! Where camera samples lie, and the random numbers that belong to them.

use super::pixel::PixelSettings;
use crate::film::{PassBuffer, Tile};
use crate::math::{Vec2, warp};
use crate::random::{PixelAddress, Purpose, Sampler};
use crate::sensor::{CameraRay, Sensor, SensorModel};

/// Pixels along each side of a unit of work.
const BLOCK: u32 = 16;

/// Pixel index of the stream that moves the grid of a pass: no pixel has it.
const GRID: u32 = u32::MAX;

/// The pixels that get samples: a window and the filter's border around it, which may reach beyond the
/// film's edges.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampledWindow {
    /// Left column, in pixels of the full film.
    pub(super) x: i32,
    /// Top row.
    pub(super) y: i32,
    /// Columns.
    pub(super) width: u32,
    /// Rows.
    pub(super) height: u32,
}

impl SampledWindow {
    /// The pixels whose samples count for the window of a render.
    pub(super) fn new(settings: &PixelSettings) -> Self {
        let border = settings.filter.border();
        let window = settings.window;
        Self {
            x: window.x as i32 - border as i32,
            y: window.y as i32 - border as i32,
            width: window.width + 2 * border,
            height: window.height + 2 * border,
        }
    }

    /// Lower and upper corner of the raster positions of samples, in pixels of the full film.
    pub(super) fn corners(&self) -> (Vec2, Vec2) {
        let low = Vec2::new(self.x as f32, self.y as f32);
        (low, low + Vec2::new(self.width as f32, self.height as f32))
    }

    /// True for pixels that get samples.
    #[inline]
    pub(super) fn contains(&self, (x, y): (i32, i32)) -> bool {
        let (column, row) = (x - self.x, y - self.y);
        (0..self.width as i32).contains(&column) && (0..self.height as i32).contains(&row)
    }

    /// Number of units of work: squares of pixels.
    pub(super) fn unit_count(&self) -> u32 {
        self.width.div_ceil(BLOCK) * self.height.div_ceil(BLOCK)
    }

    /// The block of pixels of a unit of work.
    pub(super) fn block(&self, unit: u32) -> Block {
        let columns = self.width.div_ceil(BLOCK);
        let (left, top) = ((unit % columns) * BLOCK, (unit / columns) * BLOCK);
        let right = (left + BLOCK).min(self.width);
        let bottom = (top + BLOCK).min(self.height);
        Block {
            low: (self.x + left as i32, self.y + top as i32),
            high: (self.x + right as i32, self.y + bottom as i32),
        }
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Left column and top row, in pixels of the full film.
    low: (i32, i32),
    /// Those behind the last ones.
    high: (i32, i32),
}

impl Block {
    /// The pixels, row by row.
    pub(super) fn pixels(self) -> impl ExactSizeIterator<Item = (i32, i32)> {
        let ((left, top), (right, bottom)) = (self.low, self.high);
        let (mut x, mut y) = (left, top);
        (0..(right - left) * (bottom - top)).map(move |_| {
            let pixel = (x, y);
            x += 1;
            if x == right {
                (x, y) = (left, y + 1);
            }
            pixel
        })
    }

    /// A tile of a buffer: the block with pixels around it.
    ///
    /// - `is_sole`: as [`Tile::new`] has it.
    pub(super) fn tile<'b>(&self, buffer: &'b PassBuffer, around: u32, is_sole: bool) -> Tile<'b> {
        let around = around as i32;
        let low = (self.low.0 - around, self.low.1 - around);
        let high = (self.high.0 + around, self.high.1 + around);
        Tile::new(buffer, (low, high), is_sole)
    }
}

/// A camera sample: a place on the film, and the numbers for what follows.
pub(super) struct CameraSample {
    /// In pixels of the full film.
    pub(super) raster: Vec2,
    /// The ray through it.
    pub(super) ray: CameraRay,
    /// Numbers not yet used.
    pub(super) sampler: Sampler,
}

impl CameraSample {
    /// Makes the sample of a pixel.
    ///
    /// - `x`, `y`: pixel of the full film or its border.
    /// - `sample`: which one of the pixel.
    #[inline]
    pub(super) fn of_pixel(
        sensor: &Sensor,
        settings: &PixelSettings,
        (x, y): (i32, i32),
        purpose: Purpose,
        sample: u32,
    ) -> Self {
        let address = PixelAddress {
            seed: settings.seed,
            purpose,
            pixel: pixel_index(settings, x, y),
            sample,
        };
        let mut sampler = Sampler::new(settings.sampler, address);
        let offset = offset_in_pixel(settings, purpose, sample, &mut sampler);
        let corner = Vec2::new(x as f32, y as f32);
        let raster = warp::stretch(offset, corner, corner + 1.0);
        let ray = sensor.sample_ray(raster, sampler.next_2d());
        Self {
            raster,
            ray,
            sampler,
        }
    }
}

/// Index of a pixel in the full film with the filter's border around it.
pub(super) fn pixel_index(settings: &PixelSettings, x: i32, y: i32) -> u32 {
    let border = settings.filter.border();
    let column = x.wrapping_add_unsigned(border) as u32;
    let row = y.wrapping_add_unsigned(border) as u32;
    let stride = settings.film_size.0 + 2 * border;
    row.wrapping_mul(stride).wrapping_add(column)
}

/// Place of a camera sample in its pixel.
///
/// A filter that spreads samples over several pixels sees one grid a pass, moved as a whole: the
/// weights that a pixel collects then add up to one in every pass, so that flat areas have no grain.
#[inline]
fn offset_in_pixel(
    settings: &PixelSettings,
    purpose: Purpose,
    sample: u32,
    sampler: &mut Sampler,
) -> Vec2 {
    let own = sampler.next_2d();
    if settings.filter.is_pixel_box() {
        return own;
    }
    let address = PixelAddress {
        seed: settings.seed,
        purpose,
        pixel: GRID,
        sample,
    };
    Sampler::new(settings.sampler, address).next_2d()
}

/// Mean luminance of 4096 camera samples all over the film: any rough value serves what it is for, if only
/// all windows of a film have the same.
///
/// - `luminance`: of the sample of a cell of a grid, given as for [`sample_of_film`].
pub(super) fn mean_over_film(mut luminance: impl FnMut((u32, u32)) -> f64) -> f64 {
    const SIDE: u32 = 64;
    let luminances = (0..SIDE * SIDE).map(|index| luminance((index, SIDE)));
    luminances.filter(|l| l.is_finite()).sum::<f64>() / f64::from(SIDE * SIDE)
}

/// A camera sample of a small estimate all over the film, with numbers of its own.
///
/// - `index`: of `side * side` samples, one in each cell of a grid over the film.
pub(super) fn sample_of_film(
    sensor: &Sensor,
    settings: &PixelSettings,
    purpose: Purpose,
    (index, side): (u32, u32),
) -> CameraSample {
    let address = PixelAddress {
        seed: settings.seed,
        purpose,
        pixel: index,
        sample: 0,
    };
    let mut sampler = Sampler::new(crate::random::SamplerKind::Independent, address);
    let cell = Vec2::new((index % side) as f32, (index / side) as f32);
    let place = (cell + sampler.next_2d()) / side as f32;
    let (width, height) = settings.film_size;
    let raster = place * Vec2::new(width as f32, height as f32);
    let ray = sensor.sample_ray(raster, sampler.next_2d());
    CameraSample {
        raster,
        ray,
        sampler,
    }
}
