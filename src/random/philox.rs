//! The counter-based generator Philox4x32-10.

use crate::math::Vec2;
use crate::math::lanes::Vec4;

/// What a stream of random numbers is for: streams of two purposes never share a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Purpose {
    /// Paths that start at a pixel.
    Pixel = 1,
    /// The small render that fixes the unit of the film.
    FilmUnit = 2,
    /// Scrambles of low-discrepancy sequences.
    Scramble = 3,
    /// Tests and checks.
    Check = 4,
    /// The estimate of the energy that chains deposit at each step.
    DepositionEnergy = 5,
    /// Markov chains.
    Chain = 6,
    /// Samples of a layer of direct light.
    Direct = 7,
    /// How many members of a population a seed begins.
    Birth = 8,
    /// Which members of a population survive.
    Elimination = 9,
    /// Paths that start at a light.
    Light = 10,
    /// Rays that two tracers are compared on.
    Crosscheck = 11,
    /// Rays of beams without width, in a layer of direct light.
    Beam = 12,
    /// Samples from which the seeds of Metropolis sampling are drawn.
    Bootstrap = 16,
    /// Which of them become seeds.
    Resampling = 17,
}

/// A stream of uniform numbers at one address.
#[derive(Clone, Debug)]
pub struct Stream {
    key: [u32; 2],
    counter: [u32; 4],
    /// Four blocks: the processor makes them side by side.
    numbers: [u32; NUMBERS],
    used: u32,
}

/// Blocks that are made at a time.
const BLOCKS: usize = 4;

/// Numbers that are made at a time.
const NUMBERS: usize = 4 * BLOCKS;

impl Stream {
    /// Opens the stream of `(seed, purpose, index, sample)`.
    ///
    /// - `index`: pixel, chain or unit of work.
    /// - `sample`: which sample of it.
    ///
    /// A stream holds 2³⁴ numbers.
    #[inline]
    pub fn new(seed: u64, purpose: Purpose, index: u32, sample: u32) -> Self {
        // The purpose goes into the key: four counter words are taken by index, sample and draw.
        let low = seed as u32;
        let high = (seed >> 32) as u32 ^ (purpose as u32).wrapping_mul(0x9E37_79B9);
        Self {
            key: [low, high],
            counter: [0, 0, sample, index],
            numbers: [0; NUMBERS],
            used: NUMBERS as u32,
        }
    }

    /// The first number of a stream that has handed out none, where no other is needed: the numbers after it
    /// are not made.
    #[inline]
    pub fn only_u32(self) -> u32 {
        philox4x32_10(self.counter, self.key)[0]
    }

    /// The next number, uniform in `0..2³²`.
    #[inline(always)]
    pub fn next_u32(&mut self) -> u32 {
        if self.used == NUMBERS as u32 {
            self.refill();
        }
        let number = self.numbers[self.used as usize % NUMBERS];
        self.used += 1;
        number
    }

    /// Makes the next numbers.
    #[inline(never)]
    fn refill(&mut self) {
        let [draw, rest @ ..] = self.counter;
        // Word by word, so that the compiler makes the blocks with the same instructions.
        let mut words = [[0; BLOCKS]; 4];
        for block in 0..BLOCKS {
            let counter = [draw.wrapping_add(block as u32), rest[0], rest[1], rest[2]];
            let numbers = philox4x32_10(counter, self.key);
            for (word, number) in words.iter_mut().zip(numbers) {
                word[block] = number;
            }
        }
        for (index, number) in self.numbers.iter_mut().enumerate() {
            *number = words[index % 4][index / 4];
        }
        self.counter[0] = draw.wrapping_add(BLOCKS as u32);
        self.used = 0;
    }

    /// The next number, uniform in `[0, 1)` on a grid of 2⁻²⁴.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_f32(self.next_u32())
    }

    /// The next two numbers, uniform in the unit square.
    #[inline]
    pub fn next_vec2(&mut self) -> Vec2 {
        let x = self.next_f32();
        Vec2::new(x, self.next_f32())
    }

    /// The next four numbers, uniform in `[0, 1)`.
    #[inline]
    pub fn next_vec4(&mut self) -> Vec4 {
        let used = self.used as usize;
        if let Some(numbers) = self.numbers.get(used..used + 4) {
            self.used += 4;
            return Vec4::from_array([0, 1, 2, 3].map(|i| unit_f32(numbers[i])));
        }
        let (first, second) = (self.next_vec2(), self.next_vec2());
        Vec4::new(first.x, first.y, second.x, second.y)
    }
}

/// Maps the upper 24 bits of a number to `[0, 1)`.
#[inline]
pub(super) fn unit_f32(number: u32) -> f32 {
    (number >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Ten rounds of Philox on four 32-bit words.
///
/// Source: Salmon et al. 2011, Sec. 3.3.
#[inline(always)]
fn philox4x32_10(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIERS: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    for _ in 0..10 {
        let a = MULTIPLIERS[0] * u64::from(counter[0]);
        let b = MULTIPLIERS[1] * u64::from(counter[2]);
        counter = [
            (b >> 32) as u32 ^ counter[1] ^ key[0],
            b as u32,
            (a >> 32) as u32 ^ counter[3] ^ key[1],
            a as u32,
        ];
        key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
    }
    counter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_answers() {
        // The vectors that Salmon et al. publish with their Random123 library.
        let ones = u32::MAX;
        assert_eq!(
            philox4x32_10([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox4x32_10([ones; 4], [ones; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox4x32_10(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn a_stream_hands_out_block_after_block() {
        let mut stream = Stream::new(7, Purpose::Check, 3, 5);
        let key = stream.key;
        assert_eq!(stream.clone().only_u32(), stream.clone().next_u32());
        for block in 0..3 * BLOCKS as u32 {
            for number in philox4x32_10([block, 0, 5, 3], key) {
                assert_eq!(stream.next_u32(), number);
            }
        }
    }

    #[test]
    fn four_numbers_are_the_next_four() {
        for skipped in 0..NUMBERS {
            let mut stream = Stream::new(7, Purpose::Check, 3, 5);
            (0..skipped).for_each(|_| _ = stream.next_u32());
            let mut alone = stream.clone();
            for _ in 0..9 {
                let expected = [(); 4].map(|()| alone.next_f32());
                assert_eq!(stream.next_vec4().to_array(), expected);
            }
        }
    }

    #[test]
    fn every_part_of_the_address_matters() {
        let first = |seed, purpose, index, sample| {
            let mut stream = Stream::new(seed, purpose, index, sample);
            [
                stream.next_u32(),
                stream.next_u32(),
                stream.next_u32(),
                stream.next_u32(),
            ]
        };
        let base = first(7, Purpose::Pixel, 3, 5);
        assert_eq!(base, first(7, Purpose::Pixel, 3, 5));
        for other in [
            first(8, Purpose::Pixel, 3, 5),
            first(7 + (1 << 32), Purpose::Pixel, 3, 5),
            first(7, Purpose::Check, 3, 5),
            first(7, Purpose::Pixel, 4, 5),
            first(7, Purpose::Pixel, 3, 6),
            first(7, Purpose::Pixel, 5, 3),
        ] {
            assert_ne!(base, other);
        }
    }

    #[test]
    fn numbers_fill_the_unit_interval() {
        let mut stream = Stream::new(1, Purpose::Check, 0, 0);
        let n = 100_000;
        let mut bins = [0.0; 16];
        for _ in 0..n {
            let x = stream.next_f32();
            assert!((0.0..1.0).contains(&x));
            bins[(x * 16.0) as usize] += 1.0;
        }
        let expected = f64::from(n) / 16.0;
        let chi2: f64 = bins
            .iter()
            .map(|c: &f64| (c - expected).powi(2) / expected)
            .sum();
        assert!(chi2 < 37.7, "χ² of 15 degrees of freedom at 0.001: {chi2}");
        assert_eq!(unit_f32(u32::MAX), 1.0 - f32::EPSILON / 2.0);
    }
}
