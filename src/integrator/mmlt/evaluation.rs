//! From numbers to one path's light.

use crate::integrator::chains::ChainFilm;
use crate::integrator::metropolis::{ChainPlan, Importance};
use crate::math::{Rgb, Vec2};
use crate::path::{
    self, Bidirection, Bidirectional, Connection, LightImage, PathSpace, camera_sample,
};
use crate::random::Numbers;
use crate::sensor::CameraRay;

/// By how many vertices of either side a path is made: the lens is not counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Technique {
    pub(super) eye: usize,
    pub(super) light: usize,
}

impl Technique {
    /// The technique that a number chooses: all that make paths of some edges are equally likely.
    ///
    /// - `number`: in `[0, 1)`.
    pub(super) fn of(number: f32, edges: usize) -> Self {
        let light = ((number * (edges + 1) as f32) as usize).min(edges);
        let eye = edges - light;
        Self { eye, light }
    }

    /// Number of edges of its paths.
    pub(super) fn edges(self) -> usize {
        self.eye + self.light
    }

    /// A number that chooses the technique; uniform among those if `u` is, in `[0, 1)`.
    pub(super) fn number(self, u: f32) -> f32 {
        let number = |u: f32| (self.light as f32 + u) / (self.edges() + 1) as f32;
        let found = number(u);
        // Rounding may reach the next technique.
        if Self::of(found, self.edges()) == self {
            found
        } else {
            number(0.5)
        }
    }
}

/// What a path shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) raster: Vec2,
    /// Of luminance one.
    pub(super) colour: Rgb,
    /// Luminance of the weighed path times the importance of the place.
    pub(super) importance: f64,
}

impl Shown {
    /// What a connection shows; `None` where that is no light, or not finite.
    fn of(connection: &Connection, importance: &Importance) -> Option<Self> {
        let value = connection.energy().0.as_dvec3();
        let colour = path::colour(value).filter(|_| value.is_finite())?;
        let raster = connection.raster;
        Some(Self {
            raster,
            colour,
            importance: path::luminance(value) * importance.at(raster),
        })
    }
}

/// Makes paths of numbers.
pub(super) struct Evaluator<'a> {
    film: &'a ChainFilm<'a>,
    importance: &'a Importance,
    pub(super) space: PathSpace<'a>,
    tracing: Bidirectional,
    image: LightImage,
    sample: Box<Bidirection<'a>>,
}

impl<'a> Evaluator<'a> {
    /// Makes working memory.
    pub(super) fn new(plan: &ChainPlan<'a>, tracing: &Bidirectional) -> Self {
        Self {
            film: plan.film,
            importance: plan.importance,
            space: plan.film.space(),
            tracing: *tracing,
            image: plan.film.light_image(),
            sample: Box::default(),
        }
    }

    /// Where a sample is seen, and its ray.
    fn camera(&self, eye: &mut impl Numbers) -> (Vec2, CameraRay) {
        let raster = self.film.raster_of(eye.next_2d());
        (raster, camera_sample(&self.space, raster, eye))
    }

    /// Traces a whole sample, subpaths ended by Russian roulette, and hands out all that it shows by each of its
    /// paths that go to chains.
    pub(super) fn trace(
        &mut self,
        [eye, light]: [&mut impl Numbers; 2],
        found: &mut impl FnMut(Technique, Shown),
    ) {
        let (film, importance) = (self.film, self.importance);
        let (raster, ray) = self.camera(eye);
        let add = &mut |_: &Bidirection<'_>, made: &Connection| {
            let technique = Technique {
                eye: made.eye,
                light: made.light,
            };
            if film.seeds.goes_to_chains(technique.edges() as u32) {
                if let Some(shown) = Shown::of(made, importance) {
                    found(technique, shown);
                }
            }
        };
        let (space, camera) = (&self.space, (raster, &ray));
        self.tracing.trace(
            space,
            &mut self.sample,
            camera,
            &self.image,
            [eye, light],
            add,
        );
    }

    /// Makes room for paths of some edges, so that chains need no more memory.
    pub(super) fn reserve(&mut self, edges: usize) {
        self.sample.reserve(edges);
    }

    /// What the path that numbers and a technique make shows, and where the sample was tried; without Russian roulette.
    pub(super) fn evaluate(
        &mut self,
        technique: Technique,
        [eye, light]: [&mut impl Numbers; 2],
    ) -> (Option<Shown>, Option<Vec2>) {
        let (raster, ray) = self.camera(eye);
        let (space, camera) = (&self.space, (raster, &ray));
        let pair = (technique.eye, technique.light);
        let sides = [eye, light];
        let sample = &mut self.sample;
        let made = self
            .tracing
            .trace_technique(space, sample, camera, &self.image, pair, sides);
        let shown = made.and_then(|made| Shown::of(&made, self.importance));
        let seen = (technique.eye > 0).then_some(raster);
        (shown, seen.or(shown.map(|shown| shown.raster)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_techniques_can_be_undone() {
        for edges in 1..=64 {
            for light in 0..=edges {
                let technique = Technique {
                    eye: edges - light,
                    light,
                };
                for u in [0.0, 0.25, 0.5, 0.999, 1.0 - f32::EPSILON / 2.0] {
                    assert_eq!(Technique::of(technique.number(u), edges), technique);
                }
                let share = technique.number(0.75) - technique.number(0.25);
                assert!((share * (edges + 1) as f32 - 0.5).abs() < 1e-4, "{share}");
            }
        }
    }
}
