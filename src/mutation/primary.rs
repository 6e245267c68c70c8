//! Primary sample space: a sample as the list of its uniform numbers, which are moved instead of the path.
//!
//! Numbers come into being when they are first asked for, and are moved only then. What is asked for
//! beyond the kept numbers is drawn anew for every proposal, which is a move of its own: an independent one.

use super::{Move, MoveStatistics};
use crate::math::Vec2;
use crate::random::{Numbers, PrimarySample, Stream};

/// Numbers for the raster position and the lens, or for the start of a ray of light.
const BEFORE_VERTICES: usize = 8;

/// Numbers kept for each vertex: more than the path tracer takes.
const PER_VERTEX: usize = 8;

/// How far small steps go.
///
/// Source: Kelemen et al. 2002.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallSteps {
    /// Smallest distance, positive.
    pub smallest: f32,
    /// Largest distance, less than one half.
    pub largest: f32,
}

impl SmallSteps {
    /// A number after a step: the logarithm of the distance is uniform, and the interval a ring.
    ///
    /// - `value`: in `[0, 1)`.
    #[inline]
    pub fn step(self, value: f32, random: &mut Stream) -> f32 {
        let bits = random.next_u32();
        // The lowest bit is none of those that the distance is made of.
        let u = (bits >> 8) as f32 * (1.0 / 16_777_216.0);
        let distance = self.largest * (-(self.largest / self.smallest).ln() * u).exp();
        let mut moved = if bits & 1 == 0 {
            value + distance
        } else {
            value - distance
        };
        if moved < 0.0 {
            moved += 1.0;
        }
        if moved >= 1.0 {
            moved -= 1.0;
        }
        moved
    }

    /// Density of a step's length.
    pub fn density(self, distance: f64) -> f64 {
        let (low, high) = (f64::from(self.smallest), f64::from(self.largest));
        if (low..=high).contains(&distance) {
            0.5 / (distance * (high / low).ln())
        } else {
            0.0
        }
    }
}

/// A number, and the time of its last change.
#[derive(Clone, Copy, Debug, Default)]
struct Coordinate {
    value: f32,
    time: u32,
}

/// A chain's place in primary sample space.
///
/// All memory is here: nothing is allocated while a chain runs.
///
/// Source: Kelemen et al. 2002; van Antwerpen 2011, Sec. 6.6.
#[derive(Clone, Debug)]
pub struct PrimarySpace {
    steps: SmallSteps,
    coordinates: Vec<Coordinate>,
    /// What the proposal has changed, with what it was.
    changed: Vec<(usize, Coordinate)>,
    random: Stream,
    /// Of the proposal under way.
    time: u32,
    /// Of the last large step that was accepted, or the beginning.
    last_large: u32,
    is_large: bool,
    /// The next number.
    place: usize,
    /// What became of the steps.
    pub statistics: MoveStatistics,
}

impl PrimarySpace {
    /// Vertices whose numbers are kept.
    pub const VERTICES: usize = 64;

    /// Makes a place for chains.
    ///
    /// - `random`: the numbers of the first sample.
    pub fn new(steps: SmallSteps, random: Stream) -> Self {
        let capacity = BEFORE_VERTICES + Self::VERTICES * PER_VERTEX;
        Self {
            steps,
            coordinates: vec![Coordinate::default(); capacity],
            changed: Vec::with_capacity(capacity),
            random,
            time: 1,
            last_large: 1,
            is_large: true,
            place: 0,
            statistics: MoveStatistics::default(),
        }
    }

    /// Begins a sample that has nothing of those before it.
    ///
    /// - `random`: what its numbers are drawn from.
    /// - `cell`: lower corner and size of the part of the unit square where its first two numbers are.
    pub fn begin(&mut self, random: Stream, cell: (Vec2, Vec2)) {
        self.random = random;
        self.time += 1;
        self.last_large = self.time;
        self.is_large = true;
        self.changed.clear();
        self.place = 0;
        let corner = cell.0 + cell.1 * self.random.next_vec2();
        for (coordinate, value) in self.coordinates.iter_mut().zip(corner.to_array()) {
            *coordinate = Coordinate {
                // Rounding may reach the upper end, which belongs to the next cell.
                value: value.min(1.0 - f32::EPSILON),
                time: self.time,
            };
        }
    }

    /// Makes the sample begun the first of a chain.
    ///
    /// - `random`: the numbers of the chain.
    pub fn start_chain(&mut self, random: Stream) {
        self.random = random;
        self.changed.clear();
        self.time += 1;
    }

    /// The numbers of decisions.
    #[inline]
    pub fn random(&mut self) -> &mut Stream {
        &mut self.random
    }

    /// Begins a proposal: the numbers asked for from now on are its.
    #[inline]
    pub fn propose(&mut self, is_large: bool) {
        self.is_large = is_large;
        self.place = 0;
    }

    /// Makes the proposal the current state, or forgets it.
    #[inline]
    pub fn settle(&mut self, acceptance: f64, is_accepted: bool) {
        let step = if self.is_large {
            Move::LargeStep
        } else {
            Move::SmallStep
        };
        let statistics = &mut self.statistics[step.index()];
        statistics.propose(acceptance);
        if is_accepted {
            statistics.accepted += 1;
            if self.is_large {
                self.last_large = self.time;
            }
            self.time += 1;
        } else {
            for (index, before) in self.changed.iter().rev() {
                self.coordinates[*index] = *before;
            }
        }
        self.changed.clear();
    }

    /// The proposal's number at a place.
    #[inline]
    fn coordinate(&mut self, index: usize) -> f32 {
        let Some(coordinate) = self.coordinates.get_mut(index) else {
            return self.random.next_f32();
        };
        if coordinate.time == self.time {
            return coordinate.value;
        }
        if self.is_large {
            self.changed.push((index, *coordinate));
            coordinate.value = self.random.next_f32();
        } else {
            if coordinate.time < self.last_large {
                coordinate.value = self.random.next_f32();
                coordinate.time = self.last_large;
            }
            // The steps since, which nobody has asked for.
            while coordinate.time + 1 < self.time {
                coordinate.value = self.steps.step(coordinate.value, &mut self.random);
                coordinate.time += 1;
            }
            self.changed.push((index, *coordinate));
            coordinate.value = self.steps.step(coordinate.value, &mut self.random);
        }
        coordinate.time = self.time;
        coordinate.value
    }
}

impl Numbers for PrimarySpace {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        let place = self.place;
        self.place += 1;
        self.coordinate(place)
    }

    #[inline]
    fn next_2d(&mut self) -> Vec2 {
        let x = self.next_1d();
        Vec2::new(x, self.next_1d())
    }

    #[inline]
    fn skip_2d(&mut self) {
        self.place += 2;
    }

    #[inline]
    fn begin_vertex(&mut self, index: u32) {
        self.place = BEFORE_VERTICES + PER_VERTEX * (index as usize - 1);
    }
}

/// Numbers of the sample begun, or of the proposal; those left open are drawn when they are asked for.
impl PrimarySample for PrimarySpace {
    #[inline]
    fn put_1d(&mut self, number: f32) {
        let time = self.time;
        if let Some(coordinate) = self.coordinates.get_mut(self.place) {
            self.changed.push((self.place, *coordinate));
            *coordinate = Coordinate {
                value: number,
                time,
            };
        }
        self.place += 1;
    }

    #[inline]
    fn skip_2d(&mut self) {
        self.place += 2;
    }

    #[inline]
    fn begin_vertex(&mut self, index: u32) {
        Numbers::begin_vertex(self, index);
    }
}
