//! Where camera samples lie, and the random numbers that belong to them.

use glam::Vec4Swizzles;

use super::pixel::PixelSettings;
use crate::film::{PassBuffer, Tile};
use crate::math::lanes::Vec4;
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
        let mut sampler = sampler_of_pixel(settings, (x, y), purpose, sample);
        let own = sampler.next_2d();
        let offset = offset_of_pass(settings, purpose, sample).unwrap_or(own);
        let raster = raster_in_pixel((x, y), offset);
        let ray = sensor.sample_ray(raster, sampler.next_2d());
        Self {
            raster,
            ray,
            sampler,
        }
    }
}

/// Camera samples of many pixels, one after the other in each part.
pub(super) struct CameraSamples {
    /// In pixels of the full film.
    pub(super) rasters: Vec<Vec2>,
    /// The rays through them.
    pub(super) rays: Vec<CameraRay>,
    /// Numbers not yet used.
    pub(super) samplers: Vec<Sampler>,
}

impl CameraSamples {
    /// What [`CameraSample::of_pixel`] makes of each pixel of a block, for [`Purpose::Pixel`].
    ///
    /// - `sample`: which one of each pixel.
    ///
    /// Part by part, so that no ray waits for its own numbers: the processor makes those of several pixels, and then
    /// several rays, side by side.
    pub(super) fn of_block(
        sensor: &Sensor,
        settings: &PixelSettings,
        block: Block,
        sample: u32,
    ) -> Self {
        let purpose = Purpose::Pixel;
        let sampler = |pixel| sampler_of_pixel(settings, pixel, purpose, sample);
        let mut samplers: Vec<_> = block.pixels().map(sampler).collect();
        let numbers: Vec<_> = samplers.iter_mut().map(Sampler::next_pairs).collect();
        let of_pass = offset_of_pass(settings, purpose, sample);
        let raster =
            |(pixel, own): ((i32, i32), &Vec4)| raster_in_pixel(pixel, of_pass.unwrap_or(own.xy()));
        let rasters: Vec<_> = block.pixels().zip(&numbers).map(raster).collect();
        let ray = |(raster, numbers): (&Vec2, &Vec4)| sensor.sample_ray(*raster, numbers.zw());
        Self {
            rays: rasters.iter().zip(&numbers).map(ray).collect(),
            rasters,
            samplers,
        }
    }
}

/// The numbers of a camera sample of a pixel.
///
/// - `sample`: which one of the pixel.
#[inline]
fn sampler_of_pixel(
    settings: &PixelSettings,
    (x, y): (i32, i32),
    purpose: Purpose,
    sample: u32,
) -> Sampler {
    let address = PixelAddress {
        seed: settings.seed,
        purpose,
        pixel: pixel_index(settings, x, y),
        sample,
    };
    Sampler::new(settings.sampler, address)
}

/// Index of a pixel in the full film with the filter's border around it.
pub(super) fn pixel_index(settings: &PixelSettings, x: i32, y: i32) -> u32 {
    let border = settings.filter.border();
    let column = x.wrapping_add_unsigned(border) as u32;
    let row = y.wrapping_add_unsigned(border) as u32;
    let stride = settings.film_size.0 + 2 * border;
    row.wrapping_mul(stride).wrapping_add(column)
}

/// Place of a pass's camera samples in their pixels; `None` where each has its own.
///
/// A filter that spreads samples over several pixels sees one grid a pass, moved as a whole: the
/// weights that a pixel collects then add up to one in every pass, so that flat areas have no grain.
#[inline]
fn offset_of_pass(settings: &PixelSettings, purpose: Purpose, sample: u32) -> Option<Vec2> {
    if settings.filter.is_pixel_box() {
        return None;
    }
    let address = PixelAddress {
        seed: settings.seed,
        purpose,
        pixel: GRID,
        sample,
    };
    Some(Sampler::new(settings.sampler, address).next_2d())
}

/// Raster position at an offset from the corner of a pixel.
#[inline]
fn raster_in_pixel((x, y): (i32, i32), offset: Vec2) -> Vec2 {
    let corner = Vec2::new(x as f32, y as f32);
    warp::stretch(offset, corner, corner + 1.0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Filter, FilterKind, Window};
    use crate::math::{Mat4, Vec3};
    use crate::random::SamplerKind;
    use crate::sensor::{FieldOfViewAxis, PerspectiveSettings, ThinLens};

    fn settings(filter: Filter, sampler: SamplerKind) -> PixelSettings {
        PixelSettings {
            seed: 11,
            film_size: (40, 30),
            window: Window {
                x: 5,
                y: 3,
                width: 35,
                height: 20,
            },
            filter,
            sampler,
            alpha: false,
            second_moment: false,
            aovs: Vec::new(),
            own_layers: Vec::new(),
        }
    }

    /// A camera whose lens shows which numbers it is given.
    fn sensor() -> Sensor {
        let pinhole = PerspectiveSettings {
            to_world: Mat4::from_translation(Vec3::new(0.3, -0.2, 1.0)),
            field_of_view: 50.0,
            axis: FieldOfViewAxis::X,
            near: 0.1,
            far: 100.0,
            principal_point_offset: Vec2::ZERO,
            film_size: (40, 30),
        };
        ThinLens::new(pinhole, 0.5, 3.0).unwrap().into()
    }

    #[test]
    fn samples_of_a_block_are_those_of_its_pixels_and_go_on_as_they_do() {
        let (sensor, gaussian) = (sensor(), FilterKind::Gaussian { stddev: 0.5 });
        let filters = [Filter::pixel_box(), Filter::new(gaussian).unwrap()];
        let kinds = [
            SamplerKind::Independent,
            SamplerKind::Stratified,
            SamplerKind::Sobol,
        ];
        for (filter, kind) in filters
            .iter()
            .flat_map(|filter| kinds.map(|kind| (filter, kind)))
        {
            let settings = settings(*filter, kind);
            let sampled = SampledWindow::new(&settings);
            for (unit, pass) in [(0, 0), (1, 21), (sampled.unit_count() - 1, 3)] {
                let block = sampled.block(unit);
                let mut all = CameraSamples::of_block(&sensor, &settings, block, pass);
                assert_eq!(all.rasters.len(), block.pixels().len());
                for (index, pixel) in block.pixels().enumerate() {
                    let mut alone =
                        CameraSample::of_pixel(&sensor, &settings, pixel, Purpose::Pixel, pass);
                    assert_eq!(all.rasters[index], alone.raster);
                    assert_eq!(all.rays[index], alone.ray);
                    assert_eq!(all.samplers[index].next_1d(), alone.sampler.next_1d());
                }
            }
        }
    }
}
