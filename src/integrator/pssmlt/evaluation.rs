//! From numbers to light.

use glam::DVec3;

use crate::integrator::chains::ChainFilm;
use crate::integrator::metropolis::{ChainPlan, Importance};
use crate::math::{Rgb, Vec2};
use crate::path::{
    self, Bidirection, Bidirectional, Connection, Found, LightImage, Path, PathSpace, camera_sample,
};
use crate::random::Numbers;

/// Which of a sample's paths count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// All whose energy goes to chains.
    All,
    /// Those of a number of edges that a technique has made.
    One {
        edges: usize,
        /// Vertices on the light's side: none where a ray has met the light by chance.
        light: usize,
    },
}

/// Light at a place on the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    pub(super) raster: Vec2,
    /// Of luminance one.
    pub(super) colour: Rgb,
    /// Luminance times the importance of the place.
    pub(super) importance: f64,
}

/// What a sample brings.
#[derive(Clone, Debug, Default)]
pub(super) struct Evaluation {
    /// Where the camera sample is seen.
    pub(super) raster: Vec2,
    /// Its light there, and that of light subpaths elsewhere.
    pub(super) splats: Vec<Splat>,
    /// Sum of the importances; zero for a sample without light.
    pub(super) importance: f64,
}

/// Places at which a sample lands without asking for more memory.
const PLACES: usize = 64;

impl Evaluation {
    /// Makes room for a sample.
    pub(super) fn new() -> Self {
        Self {
            splats: Vec::with_capacity(PLACES),
            ..Self::default()
        }
    }

    fn clear(&mut self) {
        self.splats.clear();
        self.importance = 0.0;
    }

    /// Adds light, unless there is none, or it is not finite.
    fn add(&mut self, raster: Vec2, value: DVec3, weights: &Importance) {
        let importance = path::luminance(value) * weights.at(raster);
        if let Some(colour) = path::colour(value).filter(|_| value.is_finite()) {
            self.importance += importance;
            self.splats.push(Splat {
                raster,
                colour,
                importance,
            });
        }
    }
}

/// How the paths of a sample are made.
enum Tracer<'a> {
    /// By path tracing.
    Path(Box<Path>),
    /// From both sides.
    Both {
        tracing: Bidirectional,
        image: LightImage,
        sample: Box<Bidirection<'a>>,
    },
}

/// Makes samples of numbers.
pub(super) struct Evaluator<'a> {
    film: &'a ChainFilm<'a>,
    importance: &'a Importance,
    pub(super) space: PathSpace<'a>,
    tracer: Tracer<'a>,
}

impl<'a> Evaluator<'a> {
    /// Makes working memory.
    ///
    /// - `tracing`: how paths are traced from both sides; `None` for path tracing.
    pub(super) fn new(plan: &ChainPlan<'a>, tracing: Option<&Bidirectional>) -> Self {
        Self {
            film: plan.film,
            importance: plan.importance,
            space: plan.film.space(),
            tracer: match tracing {
                None => Tracer::Path(Box::default()),
                Some(tracing) => Tracer::Both {
                    tracing: *tracing,
                    image: plan.film.light_image(),
                    sample: Box::default(),
                },
            },
        }
    }

    /// What the sample of numbers brings.
    ///
    /// - `numbers`: of the eye's side and of the light's; path tracing takes the first only.
    pub(super) fn evaluate<N: Numbers>(
        &mut self,
        wanted: Wanted,
        [eye, light]: [&mut N; 2],
        to: &mut Evaluation,
    ) {
        to.clear();
        let (film, weights) = (self.film, self.importance);
        let place = eye.next_2d();
        let raster = film.raster_of(place);
        to.raster = raster;
        let mut seen = DVec3::ZERO;
        match &mut self.tracer {
            Tracer::Path(path) => {
                let limit = match wanted {
                    Wanted::All => u32::MAX,
                    Wanted::One { edges, .. } => edges as u32,
                };
                let workers = (&self.space, &mut **path);
                film.trace_at(place, workers, limit, eye, &mut |found| {
                    if wanted == Wanted::All || wanted == wanted_by(&found) {
                        seen += found.energy.0.as_dvec3();
                    }
                });
            }
            Tracer::Both {
                tracing,
                image,
                sample,
            } => {
                let ray = camera_sample(&self.space, raster, eye);
                let camera = (raster, &ray);
                let add = &mut |_: &Bidirection<'_>, made: &Connection| {
                    let (edges, light) = (made.edges(), made.light);
                    let is_wanted = wanted == Wanted::All || wanted == Wanted::One { edges, light };
                    if !is_wanted || !film.seeds.goes_to_chains(edges as u32) {
                        return;
                    }
                    let value = made.energy().0.as_dvec3();
                    if made.eye > 0 {
                        seen += value;
                    } else if film.domain.contains(made.raster) {
                        to.add(made.raster, value, weights);
                    }
                };
                tracing.trace(&self.space, sample, camera, image, [eye, light], add);
            }
        }
        to.add(raster, seen, weights);
    }

    /// The path that is at a place among the luminances of a path-traced sample's paths; all of them for
    /// other samples.
    ///
    /// - `within`: from zero to the luminance of the sample.
    pub(super) fn path_at(&mut self, mut within: f64, numbers: &mut impl Numbers) -> Wanted {
        let mut chosen = Wanted::All;
        let Tracer::Path(path) = &mut self.tracer else {
            return chosen;
        };
        let place = numbers.next_2d();
        let workers = (&self.space, &mut **path);
        self.film
            .trace_at(place, workers, u32::MAX, numbers, &mut |path| {
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
        edges: path.edges as usize,
        light: usize::from(path.is_explicit),
    }
}
