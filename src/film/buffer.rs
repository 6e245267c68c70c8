//! One pass of one layer, in fixed point.

use std::cell::Cell;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering::Relaxed};

use super::{Filter, Window, pixel_of};
use crate::math::{Rgb, Vec2};

/// Value of one step of a layer's fixed-point numbers: a power of two.
///
/// It must be known before the first sample and derive from scene, options and seed alone, or merged
/// shards would not add up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit(f64);

impl Unit {
    /// The unit for values around `magnitude`: 2⁻³² of it. A single value can be sixteen million times
    /// as large before it is out of range.
    ///
    /// Zero, infinite or broken magnitudes count as one.
    pub fn for_magnitude(magnitude: f64) -> Self {
        let magnitude = if magnitude.is_normal() {
            magnitude.abs()
        } else {
            1.0
        };
        Self(2.0_f64.powi(magnitude.log2().ceil() as i32 - 32))
    }

    /// The value of one step.
    pub fn value(self) -> f64 {
        self.0
    }
}

/// What estimates can land on.
pub trait Canvas {
    /// Adds an estimate at a raster position to every pixel that the filter reaches.
    ///
    /// - `raster`: in pixels of the full film.
    /// - `values`: one a channel. If one is not finite or out of range, the estimate is counted as
    ///   rejected and adds nothing.
    fn add<const N: usize>(&self, filter: &Filter, raster: Vec2, values: [f32; N]);
}

/// Where the estimates of one pass land; shared by all threads.
#[derive(Debug)]
pub struct PassBuffer {
    window: Window,
    channels: usize,
    steps_per_one: f64,
    sums: Vec<AtomicI64>,
    rejected: AtomicU64,
}

impl PassBuffer {
    /// Makes an empty buffer.
    pub fn new(window: Window, channels: usize, unit: Unit) -> Self {
        let mut sums = Vec::new();
        sums.resize_with(window.pixel_count() * channels, AtomicI64::default);
        let steps_per_one = 1.0 / unit.value();
        Self {
            window,
            channels,
            steps_per_one,
            sums,
            rejected: AtomicU64::new(0),
        }
    }

    /// Memory of the sums, in bytes.
    ///
    /// - `values`: number of pixels times number of channels.
    pub const fn memory(values: u64) -> u64 {
        values * size_of::<AtomicI64>() as u64
    }

    /// An estimate in steps of the layer's numbers, before they are rounded.
    #[inline(always)]
    fn steps<const N: usize>(&self, values: [f32; N]) -> [f64; N] {
        debug_assert_eq!(N, self.channels, "one value a channel");
        values.map(|value| f64::from(value) * self.steps_per_one)
    }

    /// Works out what an estimate adds to the one pixel that it counts for, which may lie outside of the window, in
    /// steps; `None` where a filter spreads it over several, or it is too large for [`nearest`].
    ///
    /// - `raster`, `values`: as [`Canvas::add`] has them.
    ///
    /// What returns is in registers, and is added from there: in memory it would be read in other pieces than it was
    /// written in, and wait.
    #[inline(always)]
    pub(super) fn steps_on_pixel<const N: usize>(
        &self,
        filter: &Filter,
        raster: Vec2,
        values: [f32; N],
    ) -> Option<((i32, i32), [i64; N])> {
        let steps = self.steps(values);
        let is_small = steps.iter().all(|steps| steps.abs() < LARGEST_NEAREST);
        (is_small && filter.is_pixel_box()).then(|| (pixel_of(raster), steps.map(nearest)))
    }

    /// Works out what any estimate adds to which pixels, some of which may lie outside of the window, in
    /// steps. What is rejected is counted.
    ///
    /// - `raster`, `values`: as [`Canvas::add`] has them.
    #[inline(never)]
    pub(super) fn spread<const N: usize>(
        &self,
        filter: &Filter,
        raster: Vec2,
        values: [f32; N],
        mut add: impl FnMut((i32, i32), [i64; N]),
    ) {
        let steps = self.steps(values);
        if !steps.iter().all(|steps| steps.abs() < LARGEST_ESTIMATE) {
            self.rejected.fetch_add(1, Relaxed);
            return;
        }
        filter.for_each_pixel(raster, |x, y, weight| {
            let weight = f64::from(weight);
            add((x, y), steps.map(|steps| rounded(steps * weight)));
        });
    }

    /// Adds steps to a pixel of the full film, if it lies in the window.
    #[inline]
    pub(super) fn add_steps<const N: usize>(&self, pixel: (i32, i32), steps: [i64; N]) {
        for (sum, steps) in self.sums_at(pixel, N).iter().zip(steps) {
            sum.fetch_add(steps, Relaxed);
        }
    }

    /// The same where no other thread adds to that pixel in the meantime: its steps would be lost.
    #[inline]
    pub(super) fn add_steps_alone<const N: usize>(&self, pixel: (i32, i32), steps: [i64; N]) {
        for (sum, steps) in self.sums_at(pixel, N).iter().zip(steps) {
            sum.store(sum.load(Relaxed).wrapping_add(steps), Relaxed);
        }
    }

    /// The sums of a pixel of the full film; none outside of the window.
    ///
    /// - `channels`: how many there are.
    #[inline]
    fn sums_at(&self, (x, y): (i32, i32), channels: usize) -> &[AtomicI64] {
        match self.window.index_of(x, y) {
            Some(pixel) => &self.sums[pixel * channels..(pixel + 1) * channels],
            None => &[],
        }
    }

    /// Adds the sums of a part of the window, row by row.
    pub(super) fn add_sums(&self, part: Window, sums: &[Cell<i64>]) {
        let length = part.width as usize * self.channels;
        for (row, landed) in sums.chunks(length.max(1)).enumerate() {
            let left = (part.x - self.window.x) as usize;
            let above = (part.y - self.window.y) as usize + row;
            let first = (above * self.window.width as usize + left) * self.channels;
            for (sum, landed) in self.sums[first..first + length].iter().zip(landed) {
                if landed.get() != 0 {
                    sum.fetch_add(landed.get(), Relaxed);
                }
            }
        }
    }

    /// The window of the film.
    pub fn window(&self) -> Window {
        self.window
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Number of estimates that were not finite or out of range.
    pub fn rejected(&self) -> u64 {
        self.rejected.load(Relaxed)
    }

    /// Luminance of each pixel, of the first three channels.
    pub fn luminances(&mut self) -> Vec<f64> {
        let unit = 1.0 / self.steps_per_one;
        let weights = Rgb::LUMINANCE_WEIGHTS.to_array();
        let luminance = |pixel: &mut [AtomicI64]| {
            let channels = pixel.iter_mut().zip(weights);
            let sum: f64 = channels
                .map(|(sum, weight)| *sum.get_mut() as f64 * f64::from(weight))
                .sum();
            sum * unit
        };
        self.sums.chunks_mut(self.channels).map(luminance).collect()
    }

    /// The sums, for the accumulator to fold.
    pub(super) fn sums_mut(&mut self) -> &mut [AtomicI64] {
        &mut self.sums
    }

    /// Takes the number of rejected estimates and starts counting anew.
    pub(super) fn take_rejected(&mut self) -> u64 {
        std::mem::take(self.rejected.get_mut())
    }

    /// All sums added up.
    #[cfg(test)]
    pub(super) fn total(&self) -> i64 {
        self.sums.iter().map(|sum| sum.load(Relaxed)).sum()
    }

    /// Adds what has landed in another buffer of the same window and unit to the first channels.
    pub fn add_buffer(&mut self, other: &mut Self) {
        let (own, others) = (self.channels, other.channels);
        let rows = self.sums.chunks_mut(own).zip(other.sums.chunks_mut(others));
        for (sums, landed) in rows {
            for (sum, landed) in sums.iter_mut().zip(landed) {
                let sum = sum.get_mut();
                *sum = sum.saturating_add(*landed.get_mut());
            }
        }
    }

    /// Forgets what has landed.
    pub fn clear(&mut self) {
        for sum in &mut self.sums {
            *sum.get_mut() = 0;
        }
        *self.rejected.get_mut() = 0;
    }
}

impl Canvas for PassBuffer {
    #[inline]
    fn add<const N: usize>(&self, filter: &Filter, raster: Vec2, values: [f32; N]) {
        match self.steps_on_pixel(filter, raster, values) {
            Some((pixel, steps)) => self.add_steps(pixel, steps),
            None => self.spread(filter, raster, values, |pixel, steps| {
                self.add_steps(pixel, steps);
            }),
        }
    }
}

/// Largest size of one estimate, in steps: leaves room for 2⁷ such estimates on one pixel of a pass.
const LARGEST_ESTIMATE: f64 = (1_u64 << 56) as f64;

/// Rounds to the nearest integer, halves to even ones.
///
/// A step is a power of two, and an estimate and a weight have 24 bits each: numbers that [`nearest`] does not take are
/// whole.
#[inline(always)]
fn rounded(steps: f64) -> i64 {
    if steps.abs() < LARGEST_NEAREST {
        nearest(steps)
    } else {
        steps as i64
    }
}

/// What [`nearest`] rounds is smaller.
const LARGEST_NEAREST: f64 = (1_u64 << 51) as f64;

/// Rounds to the nearest integer, halves to even ones.
///
/// Numbers around one and a half times 2⁵² lie one apart, and next to each other as bits. No test for what an
/// integer cannot hold is needed, as there is where a number is converted.
#[inline(always)]
fn nearest(steps: f64) -> i64 {
    debug_assert!(steps.abs() < LARGEST_NEAREST);
    const ZERO: f64 = 1.5 * (1_u64 << 52) as f64;
    (steps + ZERO).to_bits() as i64 - ZERO.to_bits() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums(buffer: &mut PassBuffer) -> Vec<i64> {
        buffer.sums_mut().iter_mut().map(|s| *s.get_mut()).collect()
    }

    #[test]
    fn units_are_powers_of_two_around_the_magnitude() {
        assert_eq!(Unit::for_magnitude(1.0).value(), 2.0_f64.powi(-32));
        assert_eq!(Unit::for_magnitude(0.3).value(), 2.0_f64.powi(-33));
        for broken in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Unit::for_magnitude(broken), Unit::for_magnitude(1.0));
        }
    }

    /// All of a film.
    fn film(width: u32, height: u32) -> Window {
        Window {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    #[test]
    fn steps_are_rounded_to_the_nearest() {
        let most = LARGEST_NEAREST;
        for whole in [0.0, 1.0, 2.0, 7.0, 1e6, 4e9, most - 2.0] {
            for part in [0.0, 0.25, 0.499, 0.501, 0.75] {
                // Large numbers have no such parts.
                let steps: f64 = whole + part;
                for steps in [steps, -steps] {
                    assert_eq!(rounded(steps), steps.round_ties_even() as i64, "{steps}");
                }
            }
        }
        assert_eq!([0.5, 1.5, -0.5, -2.5].map(rounded), [0, 2, 0, -2]);
        for whole in [most, most + 16.0, 1e16, 7e16] {
            assert_eq!([whole, -whole].map(rounded), [whole as i64, -whole as i64]);
        }
    }

    #[test]
    fn wide_filters_spread_an_estimate_by_their_weights() {
        let window = film(5, 5);
        let gaussian = Filter::new(crate::film::FilterKind::Gaussian { stddev: 0.5 }).unwrap();
        let (place, value) = (Vec2::new(2.3, 1.9), 0.75);
        let mut buffer = PassBuffer::new(window, 1, Unit::for_magnitude(1.0));
        buffer.add(&gaussian, place, [value]);
        let mut expected = [0; 25];
        gaussian.for_each_pixel(place, |x, y, weight| {
            let steps = f64::from(weight) * f64::from(value) * 2.0_f64.powi(32);
            expected[(5 * y + x) as usize] = steps.round_ties_even() as i64;
        });
        assert!(expected.iter().filter(|steps| **steps > 1 << 20).count() > 9);
        assert_eq!(sums(&mut buffer), expected);
    }

    #[test]
    fn large_estimates_land_where_small_ones_do() {
        let window = film(2, 1);
        let mut buffer = PassBuffer::new(window, 3, Unit::for_magnitude(1.0));
        let filter = Filter::pixel_box();
        let large = 2.0_f32.powi(20);
        buffer.add(&filter, Vec2::new(1.5, 0.5), [1.0, -large, 2.0]);
        buffer.add(&filter, Vec2::new(0.5, 0.5), [1.0, f32::INFINITY, 2.0]);
        buffer.add(&filter, Vec2::new(0.5, 0.5), [0.0, 0.0, 2.0_f32.powi(24)]);
        assert_eq!(sums(&mut buffer), [0, 0, 0, 1 << 32, -(1 << 52), 1 << 33]);
        assert_eq!(buffer.rejected(), 2);
    }

    #[test]
    fn estimates_land_on_the_pixels_of_the_window_only() {
        let window = Window {
            x: 2,
            y: 1,
            width: 2,
            height: 2,
        };
        let mut buffer = PassBuffer::new(window, 1, Unit::for_magnitude(1.0));
        let filter = Filter::pixel_box();
        buffer.add(&filter, Vec2::new(3.5, 1.5), [1.0]);
        buffer.add(&filter, Vec2::new(1.99, 1.5), [1.0]);
        buffer.add(&filter, Vec2::new(-5.0, 1.5), [1.0]);
        buffer.add(&filter, Vec2::new(2.0, 3.0), [1.0]);
        buffer.add(&filter, Vec2::new(2.0, 2.0), [-0.5]);
        assert_eq!(sums(&mut buffer), [0, 1 << 32, -(1 << 31), 0]);
    }

    #[test]
    fn broken_estimates_are_counted_and_add_nothing() {
        let mut buffer = PassBuffer::new(Window::full(1, 1), 2, Unit::for_magnitude(1.0));
        let filter = Filter::pixel_box();
        for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
            buffer.add(&filter, Vec2::splat(0.5), [1.0, bad]);
        }
        assert_eq!(buffer.rejected(), 3);
        assert_eq!(sums(&mut buffer), [0, 0]);
    }
}
