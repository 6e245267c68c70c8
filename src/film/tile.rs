//! A part of a pass that one thread keeps to itself for a while.

use std::cell::Cell;

use super::buffer::Canvas;
use super::{Filter, PassBuffer, Window};
use crate::math::Vec2;

/// A rectangle of a [`PassBuffer`] into which one thread adds without the others, until it is dropped.
///
/// Sums are integers: those that it keeps and hands over at the end are those of estimates that land in the
/// buffer one by one. What lands beside the rectangle goes to the buffer at once.
#[derive(Debug)]
pub struct Tile<'b> {
    buffer: &'b PassBuffer,
    /// In pixels of the full film.
    window: Window,
    /// Sums that are kept; `None` where nobody else adds to those of the buffer.
    kept: Option<Box<[Cell<i64>]>>,
}

impl<'b> Tile<'b> {
    /// Makes a tile of a buffer.
    ///
    /// - `low`, `high`: lower corner, and the upper one, which does not belong to it, in pixels of the full film;
    ///   they may lie beyond the buffer's window.
    /// - `is_sole`: whether nobody else lets anything land in the rectangle before the tile is dropped.
    pub fn new(
        buffer: &'b PassBuffer,
        (low, high): ((i32, i32), (i32, i32)),
        is_sole: bool,
    ) -> Self {
        let film = buffer.window();
        let clip = |low: i32, high: i32, first: u32, count: u32| {
            let end = first + count;
            let low = u32::try_from(low).unwrap_or(0).clamp(first, end);
            let high = u32::try_from(high).unwrap_or(0).clamp(low, end);
            (low, high - low)
        };
        let (x, width) = clip(low.0, high.0, film.x, film.width);
        let (y, height) = clip(low.1, high.1, film.y, film.height);
        let window = Window {
            x,
            y,
            width,
            height,
        };
        let count = window.pixel_count() * buffer.channels();
        let kept = (!is_sole).then(|| vec![Cell::new(0); count].into_boxed_slice());
        Self {
            buffer,
            window,
            kept,
        }
    }
}

impl Canvas for Tile<'_> {
    #[inline]
    fn add<const N: usize>(&self, filter: &Filter, raster: Vec2, values: [f32; N]) {
        match self.buffer.steps_on_pixel(filter, raster, values) {
            Some((pixel, steps)) => self.add_steps(pixel, steps),
            None => self.buffer.spread(filter, raster, values, |pixel, steps| {
                self.add_steps(pixel, steps);
            }),
        }
    }
}

impl Tile<'_> {
    /// Adds steps to a pixel of the full film, if it lies in the buffer's window.
    #[inline(always)]
    fn add_steps<const N: usize>(&self, (x, y): (i32, i32), steps: [i64; N]) {
        let Some(pixel) = self.window.index_of(x, y) else {
            return self.buffer.add_steps((x, y), steps);
        };
        let Some(kept) = &self.kept else {
            return self.buffer.add_steps_alone((x, y), steps);
        };
        let sums = &kept[pixel * N..(pixel + 1) * N];
        for (sum, steps) in sums.iter().zip(steps) {
            sum.set(sum.get().wrapping_add(steps));
        }
    }
}

impl Drop for Tile<'_> {
    fn drop(&mut self) {
        if let Some(kept) = &self.kept {
            self.buffer.add_sums(self.window, kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilterKind, Unit};

    /// A window whose edges a tile and a filter reach over.
    const WINDOW: Window = Window {
        x: 3,
        y: 2,
        width: 9,
        height: 7,
    };

    fn buffer() -> PassBuffer {
        PassBuffer::new(WINDOW, 3, Unit::for_magnitude(1.0))
    }

    fn sums(mut buffer: PassBuffer) -> Vec<i64> {
        buffer.sums_mut().iter_mut().map(|s| *s.get_mut()).collect()
    }

    /// Estimates in the tile, beside it, on its edges and beyond the film.
    fn land(on: &impl Canvas, filter: &Filter) {
        for index in 0..200 {
            let place = Vec2::new((index * 7 % 31) as f32, (index * 11 % 23) as f32) * 0.5 - 1.0;
            on.add(filter, place, [0.1, index as f32, -0.7]);
        }
        // One that is rejected, and one that is large.
        on.add(filter, Vec2::splat(5.5), [f32::NAN, 1.0, 1.0]);
        on.add(filter, Vec2::splat(5.5), [1.0, -2.0_f32.powi(20), 0.5]);
    }

    #[test]
    fn what_lands_on_a_tile_is_what_lands_on_the_buffer() {
        let filters = [
            Filter::pixel_box(),
            Filter::new(FilterKind::Gaussian { stddev: 0.5 }).unwrap(),
        ];
        for filter in filters {
            for corners in [
                ((4, 3), (8, 6)),
                ((-9, 5), (6, 90)),
                ((40, 40), (50, 50)),
                ((6, 6), (2, 2)),
            ] {
                let (at_once, by_tile) = (buffer(), buffer());
                land(&at_once, &filter);
                let tile = Tile::new(&by_tile, corners, false);
                land(&tile, &filter);
                drop(tile);
                assert_eq!(at_once.rejected(), 1);
                assert_eq!(by_tile.rejected(), 1);
                assert_eq!(sums(by_tile), sums(at_once), "{corners:?}");
            }
        }
    }

    #[test]
    fn sole_tiles_and_others_add_to_what_is_there() {
        let filter = Filter::pixel_box();
        let expected = buffer();
        let by_tiles = buffer();
        for is_sole in [true, false, true] {
            land(&expected, &filter);
            let tile = Tile::new(&by_tiles, ((4, 3), (8, 6)), is_sole);
            land(&tile, &filter);
        }
        assert_eq!(sums(by_tiles), sums(expected));
    }

    #[test]
    fn nothing_of_a_tile_is_in_the_buffer_before_it_is_dropped() {
        let by_tile = buffer();
        let tile = Tile::new(&by_tile, ((4, 3), (8, 6)), false);
        tile.add(&Filter::pixel_box(), Vec2::splat(5.5), [1.0; 3]);
        assert_eq!(by_tile.total(), 0);
        drop(tile);
        assert_eq!(by_tile.total(), 3 << 32);
    }
}
