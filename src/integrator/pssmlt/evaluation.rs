//! From numbers to light.

use glam::DVec3;

use crate::integrator::chains::ChainFilm;
use crate::integrator::metropolis::{ChainPlan, Importance};
use crate::math::{Rgb, Vec2};
use crate::path::{self, Found, Path, PathSpace};
use crate::random::Numbers;

/// Which of a sample's paths count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// All whose energy goes to chains.
    All,
    /// Those of a number of edges that a technique has made.
    One {
        edges: u32,
        /// Whether the light was sampled, and not met by chance.
        is_explicit: bool,
    },
}

/// What a camera sample brings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Evaluation {
    /// Where it is seen.
    pub(super) raster: Vec2,
    /// Of luminance one.
    pub(super) colour: Rgb,
    /// Luminance times the importance of the place; zero for a sample without light, and for what is not
    /// finite.
    pub(super) importance: f64,
}

impl Evaluation {
    fn new(raster: Vec2, value: DVec3, weight: f64) -> Self {
        let importance = path::luminance(value) * weight;
        match path::colour(value) {
            Some(colour) if value.is_finite() => Self {
                raster,
                colour,
                importance,
            },
            _ => Self {
                raster,
                ..Self::default()
            },
        }
    }
}

/// Makes camera samples of numbers.
pub(super) struct Evaluator<'a> {
    film: &'a ChainFilm<'a>,
    importance: &'a Importance,
    pub(super) space: PathSpace<'a>,
    path: Path,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(plan: &ChainPlan<'a>) -> Self {
        Self {
            film: plan.film,
            importance: plan.importance,
            space: plan.film.space(),
            path: Path::default(),
        }
    }

    /// Traces the camera sample of numbers, and hands out every path whose energy goes to chains.
    fn trace(
        &mut self,
        max_depth: u32,
        numbers: &mut impl Numbers,
        mut found: impl FnMut(Found<'_>),
    ) -> Vec2 {
        let place = numbers.next_2d();
        let workers = (&self.space, &mut self.path);
        self.film
            .trace_at(place, workers, max_depth, numbers, &mut found)
    }

    /// What the camera sample of numbers brings.
    #[inline]
    pub(super) fn evaluate(&mut self, wanted: Wanted, numbers: &mut impl Numbers) -> Evaluation {
        let mut value = DVec3::ZERO;
        let raster = match wanted {
            Wanted::All => self.trace(u32::MAX, numbers, |path| {
                value += path.energy.0.as_dvec3();
            }),
            Wanted::One { edges, .. } => self.trace(edges, numbers, |path| {
                if wanted == wanted_by(&path) {
                    value += path.energy.0.as_dvec3();
                }
            }),
        };
        Evaluation::new(raster, value, self.importance.at(raster))
    }

    /// The path that is at a place among the luminances of a sample's paths.
    ///
    /// - `within`: from zero to the luminance of the sample.
    pub(super) fn path_at(&mut self, mut within: f64, numbers: &mut impl Numbers) -> Wanted {
        let mut chosen = Wanted::All;
        self.trace(u32::MAX, numbers, |path| {
            let luminance = path.luminance();
            if within >= 0.0 && luminance > 0.0 {
                chosen = wanted_by(&path);
                within -= luminance;
            }
        });
        chosen
    }
}

/// What asks for such paths as this one.
fn wanted_by(path: &Found<'_>) -> Wanted {
    Wanted::One {
        edges: path.edges,
        is_explicit: path.is_explicit,
    }
}
