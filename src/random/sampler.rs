//! Samplers: how the numbers of one pixel's samples spread over the unit cube.

use super::philox::{Purpose, Stream};
use crate::math::Vec2;
use crate::math::lanes::Vec4;

/// How the samples of a pixel are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    /// Each number on its own.
    Independent,
    /// Each pair (and each single) of a pixel's numbers is jittered over the cells of a grid.
    Stratified,
    /// Owen-scrambled Sobol' points.
    Sobol,
}

impl SamplerKind {
    /// Name in scene files and options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Stratified => "stratified",
            Self::Sobol => "sobol",
        }
    }

    /// Number of consecutive samples of a pixel that are spread against each other.
    ///
    /// Such a group is one replica: groups are independent of each other, so that error bars can be
    /// drawn from them. Longer groups would spread a little better and leave fewer replicas.
    pub const fn group(self) -> u32 {
        match self {
            Self::Independent => 1,
            Self::Stratified | Self::Sobol => 16,
        }
    }
}

/// Which sample of which pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelAddress {
    /// The render's seed.
    pub seed: u64,
    /// What the numbers are for.
    pub purpose: Purpose,
    /// Index of the pixel in its image.
    pub pixel: u32,
    /// Index of the sample in its pixel.
    pub sample: u32,
}

/// Uniform numbers that a sample is made of, handed out in the order of the asking.
pub trait Numbers {
    /// The next number, uniform in `[0, 1)`.
    fn next_1d(&mut self) -> f32;

    /// The next pair of numbers, uniform in the unit square.
    fn next_2d(&mut self) -> Vec2;

    /// Passes over a pair of numbers that nobody needs.
    #[inline]
    fn skip_2d(&mut self) {
        self.next_2d();
    }

    /// Tells that what is asked for from now on belongs to a vertex of a path: numbers that are kept
    /// then keep their meaning where the vertex before has used more or fewer of them.
    ///
    /// - `index`: of the vertex, from 1.
    #[inline]
    fn begin_vertex(&mut self, index: u32) {
        let _ = index;
    }
}

/// A sample's uniform numbers as they are written: in the order in which [`Numbers`] hands them out.
pub trait PrimarySample {
    /// The next number, in `[0, 1)`.
    fn put_1d(&mut self, number: f32);

    /// The next pair of numbers, in the unit square.
    #[inline]
    fn put_2d(&mut self, numbers: Vec2) {
        self.put_1d(numbers.x);
        self.put_1d(numbers.y);
    }

    /// Leaves the next pair of numbers open: any will do.
    fn skip_2d(&mut self);

    /// As [`Numbers::begin_vertex`].
    fn begin_vertex(&mut self, index: u32);
}

impl Numbers for Sampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        Sampler::next_1d(self)
    }

    #[inline]
    fn next_2d(&mut self) -> Vec2 {
        Sampler::next_2d(self)
    }
}

/// Hands out the uniform numbers of one sample of one pixel, in the order of the asking.
///
/// Low-discrepancy kinds serve the first [`Sampler::SPREAD_DIMENSIONS`] numbers; later ones, deep in
/// a path, are independent.
#[derive(Clone, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    stream: Stream,
    /// Place in the group, and the seed of the group's scrambles.
    index: u32,
    scramble: u32,
    dimension: u32,
}

/// Cells along each axis of the stratified grid: its square is the group.
const STRATA: u32 = 4;

impl Sampler {
    /// How many numbers of a sample are spread by the low-discrepancy kinds.
    pub const SPREAD_DIMENSIONS: u32 = 64;

    /// Opens the numbers of one sample.
    #[inline]
    pub fn new(kind: SamplerKind, address: PixelAddress) -> Self {
        let PixelAddress {
            seed,
            purpose,
            pixel,
            sample,
        } = address;
        let (index, scramble) = match kind {
            SamplerKind::Independent => (0, 0),
            SamplerKind::Stratified | SamplerKind::Sobol => {
                // The salt keeps the groups of two purposes apart.
                let salted = seed ^ (u64::from(purpose as u32) << 56);
                let group = Stream::new(salted, Purpose::Scramble, pixel, sample / kind.group());
                (sample % kind.group(), group.only_u32())
            }
        };
        Self {
            kind,
            stream: Stream::new(seed, purpose, pixel, sample),
            index,
            scramble,
            dimension: 0,
        }
    }

    /// The next number, uniform in `[0, 1)`.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        if self.kind == SamplerKind::Independent || self.dimension >= Self::SPREAD_DIMENSIONS {
            return self.stream.next_f32();
        }
        self.spread_1d()
    }

    /// The next pair of numbers, uniform in the unit square.
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        if self.kind == SamplerKind::Independent || self.dimension >= Self::SPREAD_DIMENSIONS {
            let x = self.stream.next_f32();
            return Vec2::new(x, self.stream.next_f32());
        }
        self.spread_2d()
    }

    /// The next two pairs of numbers, one after the other.
    #[inline]
    pub fn next_pairs(&mut self) -> Vec4 {
        if self.kind == SamplerKind::Independent || self.dimension >= Self::SPREAD_DIMENSIONS {
            return self.stream.next_vec4();
        }
        self.spread_pairs()
    }

    #[inline(never)]
    fn spread_pairs(&mut self) -> Vec4 {
        let (first, second) = (self.next_2d(), self.next_2d());
        Vec4::new(first.x, first.y, second.x, second.y)
    }

    fn spread_1d(&mut self) -> f32 {
        let dimension = self.dimension;
        self.dimension += 1;
        match self.kind {
            SamplerKind::Stratified => {
                let cell = permuted(self.index, self.scramble, dimension);
                (cell as f32 + self.stream.next_f32()) / (STRATA * STRATA) as f32
            }
            _ => sobol_burley::sample(self.index, dimension, self.scramble),
        }
    }

    fn spread_2d(&mut self) -> Vec2 {
        let dimension = self.dimension;
        self.dimension += 2;
        match self.kind {
            SamplerKind::Stratified => {
                let cell = permuted(self.index, self.scramble, dimension);
                let corner = Vec2::new((cell % STRATA) as f32, (cell / STRATA) as f32);
                let x = self.stream.next_f32();
                (corner + Vec2::new(x, self.stream.next_f32())) / STRATA as f32
            }
            _ => Vec2::new(
                sobol_burley::sample(self.index, dimension, self.scramble),
                sobol_burley::sample(self.index, dimension + 1, self.scramble),
            ),
        }
    }
}

/// A random permutation of `0..16`, one for each scramble and dimension.
///
/// A multiplication by an odd number, an offset and a shifted exclusive-or are each one-to-one on
/// four bits; three rounds of them with random constants make the permutation.
#[inline]
fn permuted(index: u32, scramble: u32, dimension: u32) -> u32 {
    const MASK: u32 = STRATA * STRATA - 1;
    let mut bits = scramble ^ dimension.wrapping_mul(0x9E37_79B9);
    let mut x = index;
    for _ in 0..3 {
        bits = bits.wrapping_mul(0x2C1B_3C6D);
        bits ^= bits >> 15;
        x = x.wrapping_mul((bits >> 8) | 1).wrapping_add(bits >> 20) & MASK;
        x ^= x >> 2;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [SamplerKind; 3] = [
        SamplerKind::Independent,
        SamplerKind::Stratified,
        SamplerKind::Sobol,
    ];

    fn sampler(kind: SamplerKind, pixel: u32, sample: u32) -> Sampler {
        Sampler::new(
            kind,
            PixelAddress {
                seed: 1,
                purpose: Purpose::Check,
                pixel,
                sample,
            },
        )
    }

    /// Variance, over pixels, of a group's estimate of ∫∫ xy.
    fn variance(kind: SamplerKind, skip: u32) -> f64 {
        let pixels = 2000;
        let estimates = (0..pixels).map(|pixel| {
            let sum: f64 = (0..16)
                .map(|sample| {
                    let mut s = sampler(kind, pixel, sample);
                    for _ in 0..skip {
                        s.next_1d();
                    }
                    let u = s.next_2d();
                    f64::from(u.x * u.y)
                })
                .sum();
            sum / 16.0
        });
        let (mut sum, mut squares) = (0.0, 0.0);
        for e in estimates {
            sum += e;
            squares += e * e;
        }
        let mean = sum / f64::from(pixels);
        assert!((mean - 0.25).abs() < 0.006, "{}: mean {mean}", kind.name());
        squares / f64::from(pixels) - mean * mean
    }

    #[test]
    fn spread_kinds_have_less_variance() {
        for skip in [0, 2, 12] {
            let independent = variance(SamplerKind::Independent, skip);
            assert!(variance(SamplerKind::Stratified, skip) < independent / 4.0);
            assert!(variance(SamplerKind::Sobol, skip) < independent / 8.0);
        }
        let deep = Sampler::SPREAD_DIMENSIONS;
        assert!(variance(SamplerKind::Sobol, deep) > 0.7 * variance(SamplerKind::Independent, 0));
    }

    #[test]
    fn a_group_visits_every_stratum_once() {
        for dimension in 0..40 {
            let mut seen = 0_u32;
            for index in 0..16 {
                seen |= 1 << permuted(index, 0x1234_5678 ^ (dimension * 77), dimension);
            }
            assert_eq!(seen, 0xFFFF);
        }
    }

    #[test]
    fn two_pairs_are_the_next_two() {
        for kind in KINDS {
            for skip in 0..7 {
                let mut together = sampler(kind, 3, 5);
                (0..skip).for_each(|_| _ = together.next_1d());
                let mut alone = together.clone();
                // Past the numbers that are spread.
                for _ in 0..Sampler::SPREAD_DIMENSIONS {
                    let (first, second) = (alone.next_2d(), alone.next_2d());
                    let pairs = together.next_pairs().to_array();
                    assert_eq!(pairs, [first.x, first.y, second.x, second.y]);
                }
            }
        }
    }

    #[test]
    fn groups_and_pixels_differ() {
        for kind in KINDS {
            let first = sampler(kind, 0, 0).next_2d();
            assert_ne!(first, sampler(kind, 1, 0).next_2d());
            assert_ne!(first, sampler(kind, 0, kind.group()).next_2d());
            assert_eq!(first, sampler(kind, 0, 0).next_2d());
        }
    }
}
