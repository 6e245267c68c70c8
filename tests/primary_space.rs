//! Steps in primary sample space: numbers stay uniform, move as far as they claim, and come back where a step
//! is not accepted.

use lumiflow::math::Vec2;
use lumiflow::math::statistics::{chi_square_p, sidak};
use lumiflow::mutation::{Move, PrimarySpace, SmallSteps};
use lumiflow::random::{Numbers, Purpose, Stream};

use crate::support::effort::{level, samples, seed};

/// Neither end lies at that of a cell of the histograms: rounding would put the longest steps into cells
/// where none is expected.
const STEPS: SmallSteps = SmallSteps {
    smallest: 1.0 / 64.0,
    largest: 0.26,
};

const UNIT: (Vec2, Vec2) = (Vec2::ZERO, Vec2::ONE);

fn stream(sample: u32) -> Stream {
    Stream::new(seed(61), Purpose::Check, 0, sample)
}

/// Number of cells of a histogram over the unit interval.
const CELLS: usize = 32;

fn cell(value: f64) -> usize {
    ((value * CELLS as f64) as usize).min(CELLS - 1)
}

/// Lets a chain go a few steps, accepting what `accepts` says, and then asks for a number.
fn number_after_steps(sample: u32, place: usize, accepts: impl Fn(f32) -> bool) -> f64 {
    let mut space = PrimarySpace::new(STEPS, stream(sample));
    space.begin(stream(2 * sample), UNIT);
    for _ in 0..6 {
        space.next_1d();
    }
    space.start_chain(stream(2 * sample + 1));
    for step in 0..8 {
        let is_large = space.random().next_f32() < 0.2;
        space.propose(is_large);
        let first = space.next_1d();
        // Some steps ask for more numbers than others.
        for _ in 0..1 + step % 5 {
            space.next_1d();
        }
        let is_accepted = accepts(first);
        space.settle(1.0, is_accepted);
    }
    space.propose(false);
    for _ in 0..place {
        space.next_1d();
    }
    f64::from(space.next_1d())
}

fn uniform_p(accepts: impl Fn(f32) -> bool + Copy, place: usize) -> f64 {
    let count = samples(40_000);
    let mut found = [0.0; CELLS];
    for sample in 0..count {
        found[cell(number_after_steps(sample, place, accepts))] += 1.0;
    }
    chi_square_p(&found, &[f64::from(count) / CELLS as f64; CELLS]).expect("enough numbers")
}

#[test]
fn numbers_stay_uniform() {
    let level = sidak(level(0.01), 4);
    // The first numbers, one that only some steps ask for, and one that none has asked for.
    for place in [0, 3, 5, 700] {
        let p = uniform_p(|_| true, place);
        assert!(p > level, "number {place}: p = {p:.1e}");
    }
    // Who accepts by what a number is does not keep it uniform: the test sees such things.
    assert!(uniform_p(|first| first < 0.7, 0) < 1e-6);
}

#[test]
fn steps_are_as_long_as_they_claim() {
    let count = samples(100_000);
    let mut found = [0.0; CELLS];
    for sample in 0..count {
        let mut space = PrimarySpace::new(STEPS, stream(sample));
        space.begin(stream(2 * sample), UNIT);
        let before = space.next_1d();
        space.start_chain(stream(2 * sample + 1));
        space.propose(false);
        let step = f64::from(space.next_1d() - before);
        // On the ring, from −½ to ½.
        found[cell(step + 0.5 - (step + 0.5).floor())] += 1.0;
    }
    let expected: Vec<f64> = (0..CELLS)
        .map(|index| {
            let fine = 1 << 12;
            let part = |i: i32| {
                let x = (index as f64 + (f64::from(i) + 0.5) / f64::from(fine)) / CELLS as f64;
                STEPS.density((x - 0.5).abs())
            };
            let sum: f64 = (0..fine).map(part).sum();
            f64::from(count) * sum / f64::from(fine) / CELLS as f64
        })
        .collect();
    let p = chi_square_p(&found, &expected).expect("enough numbers");
    assert!(p > level(0.01), "p = {p:.1e}");
    let flat = vec![f64::from(count) / CELLS as f64; CELLS];
    assert!(chi_square_p(&found, &flat).is_some_and(|p| p < 1e-6));
}

#[test]
fn what_is_not_accepted_is_forgotten() {
    let mut space = PrimarySpace::new(STEPS, stream(0));
    space.begin(stream(1), UNIT);
    let first: Vec<f32> = (0..9).map(|_| space.next_1d()).collect();
    space.start_chain(stream(2));
    // The state, as a step of no length would show it.
    let show = |space: &PrimarySpace| {
        let mut copy = space.clone();
        copy.propose(false);
        (0..9).map(|_| copy.next_1d()).collect::<Vec<f32>>()
    };
    let away = |a: &[f32], b: &[f32]| {
        let apart = |(a, b): (&f32, &f32)| {
            let d = (a - b).abs();
            d.min(1.0 - d)
        };
        a.iter().zip(b).map(apart).fold(0.0, f32::max)
    };
    for is_large in [false, true, false, true] {
        space.propose(is_large);
        for _ in 0..9 {
            space.next_1d();
        }
        space.settle(0.0, false);
        assert!(away(&first, &show(&space)) <= STEPS.largest * 1.001);
    }
    space.propose(true);
    let second: Vec<f32> = (0..9).map(|_| space.next_1d()).collect();
    space.settle(0.5, true);
    assert!(away(&second, &show(&space)) <= STEPS.largest * 1.001);
    assert!(away(&first, &second) > STEPS.largest);
    let large = space.statistics[Move::LargeStep.index()];
    assert_eq!((large.proposed, large.accepted), (3, 1));
}
