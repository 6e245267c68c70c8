//! Samples whose numbers are kept, to be used again.

use lumiflow::math::Vec2;
use lumiflow::mutation::{PrimarySpace, SmallSteps};
use lumiflow::path::{Bidirection, Bidirectional, Connection, PathSpace, camera_sample};
use lumiflow::random::{Numbers, Purpose, Stream};

use super::seeds::IMAGE;
use super::stages::SIDE;

/// The numbers of a sample on the eye's and on the light's side.
pub(crate) struct Sample([PrimarySpace; 2]);

impl Sample {
    pub(crate) fn new() -> Self {
        let steps = SmallSteps {
            smallest: 0.001,
            largest: 0.01,
        };
        let new = || PrimarySpace::new(steps, Stream::new(0, Purpose::Check, 0, 0));
        Self([new(), new()])
    }

    /// Begins a sample of uniform numbers.
    pub(crate) fn begin(&mut self, seed: u64, sample: u32) {
        for (side, purpose) in self.0.iter_mut().zip([Purpose::Pixel, Purpose::Light]) {
            let whole = (Vec2::ZERO, Vec2::ONE);
            side.begin(Stream::new(seed, purpose, 0, sample), whole);
        }
    }

    /// From the first number on again.
    pub(crate) fn rewind(&mut self) -> [&mut PrimarySpace; 2] {
        let [eye, light] = &mut self.0;
        eye.propose(true);
        light.propose(true);
        [eye, light]
    }

    /// The paths of the whole sample.
    pub(crate) fn trace<'s>(
        &mut self,
        (space, both): (&PathSpace<'s>, &mut Bidirection<'s>),
        tracing: &Bidirectional,
        found: &mut impl FnMut(&Bidirection<'s>, &Connection),
    ) {
        let [eye, light] = self.rewind();
        let raster = eye.next_2d() * SIDE as f32;
        let ray = camera_sample(space, raster, eye);
        let sides = [eye, light];
        tracing.trace(space, both, (raster, &ray), &IMAGE, sides, found);
    }

    /// What one technique makes.
    pub(crate) fn trace_technique<'s>(
        &mut self,
        (space, both): (&PathSpace<'s>, &mut Bidirection<'s>),
        tracing: &Bidirectional,
        technique: (usize, usize),
    ) -> Option<Connection> {
        let [eye, light] = self.rewind();
        let raster = eye.next_2d() * SIDE as f32;
        let ray = camera_sample(space, raster, eye);
        let sides = [eye, light];
        tracing.trace_technique(space, both, (raster, &ray), &IMAGE, technique, sides)
    }
}
