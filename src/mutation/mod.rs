//! Mutations: from a path to another one of the same signature, and how likely that is accepted.
//!
//! A mutation proposes in coordinates of its own in which a move and its way back are equally likely
//! (or in which their ratio is part of its target): the raster position, turned directions, the
//! position of what stays. [`Mutate::target`] is the luminance of the measurement contribution in these
//! coordinates, up to a factor that all paths reachable by the mutation share. Acceptance is then the
//! ratio of two targets, and no density is ever evaluated.
//!
//! A new mutation is a file and a line in `mutations!`. The tests of balance pick it up.

mod bidirectional;
mod caustic;
mod chain;
mod choice;
mod fault;
mod forward;
mod kernel;
mod lai_lens;
mod lens;
mod lens_point;
mod mixture;
mod moves;
mod multi_chain;
mod primary;
mod ratio;
mod rejection;
mod statistics;

pub use bidirectional::{BidirectionalMutation, SectionFault};
pub use caustic::{CausticKernel, CausticPerturbation};
pub use chain::{Chain, Proposed};
pub use choice::{Choice, ChoiceAt, Choose};
pub use fault::Fault;
pub use kernel::{AngleKernel, RasterKernel, turned};
pub use lai_lens::LaiLensPerturbation;
pub use lens::LensPerturbation;
pub use mixture::{Component, mixture_density};
pub use moves::{Move, MoveStatistics};
pub use multi_chain::MultiChainPerturbation;
pub use primary::{PrimarySpace, SmallSteps};
pub use ratio::{log_ratio_by_measure, log_ratio_by_rules, log_transition};
pub use rejection::Rejection;
pub use statistics::MutationStatistics;

use crate::math::Vec2;
use crate::path::{Path, PathSpace};
use crate::random::Stream;

/// How far mutations move, and where they may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// Moves of the raster position.
    pub raster: RasterKernel,
    /// Turns of directions inside of the scene.
    pub angle: AngleKernel,
    /// Turns of the direction at the head of a caustic.
    pub caustic: CausticKernel,
    /// Radius of the disk of moves on the lens, in radii of the lens.
    pub lens: f32,
    /// Where paths are seen.
    pub domain: RasterDomain,
    /// What is wrong on purpose: nothing, except in tests of tests.
    pub fault: Fault,
}

/// The raster positions that count: the film with as much around it as its filter reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RasterDomain {
    /// Lower corner, in pixels of the full film.
    pub low: Vec2,
    /// Upper corner, which does not belong to the domain.
    pub high: Vec2,
}

impl RasterDomain {
    /// Its area in pixels.
    pub fn pixels(&self) -> f64 {
        let size = self.high - self.low;
        f64::from(size.x) * f64::from(size.y)
    }

    /// True for positions in the domain.
    #[inline]
    pub fn contains(&self, raster: Vec2) -> bool {
        raster.cmpge(self.low).all() && raster.cmplt(self.high).all()
    }
}

/// Where a mutation works on a path, and so on all paths that perturbations make of it: they share their
/// signature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Site {
    /// Index of the last vertex that moves, counted from the sensor.
    pub last_moved: usize,
    /// Index of the last vertex that changes, its position or its value.
    pub last_changed: usize,
}

/// What a mutation can do.
pub trait Mutate {
    /// Where the mutation works; `None` for paths that it does not apply to. Depends on the path's signature
    /// alone.
    fn site(&self, path: &Path) -> Option<Site>;

    /// The factor on a path's luminance in the mutation's own coordinates; not negative.
    fn factor(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        path: &Path,
        site: Site,
    ) -> f64;

    /// The target density at a path in the mutation's own coordinates, in which its proposals are
    /// symmetric; not negative.
    #[inline]
    fn target(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        path: &Path,
        site: Site,
    ) -> f64 {
        let luminance = fault::path_luminance(space, settings, path, path.value());
        luminance * self.factor(space, settings, path, site)
    }

    /// Makes a proposal; returns [`Mutate::factor`] there, most of which the way to it has worked out.
    ///
    /// - `site`: where the mutation works on the current path.
    /// - `paths`: the current path, which is left; and what becomes the proposal: a copy of it, seen where it is
    ///   seen, apart from what this mutation has changed in it before.
    ///
    /// # Errors
    /// Why there is none; of the copy, no more has changed than the mutation changes, and where it is seen.
    fn propose(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        site: Site,
        paths: (&Path, &mut Path),
        random: &mut Stream,
    ) -> Result<f64, Rejection>;
}

/// Writes the enum of all mutations and forwards [`Mutate`] to its variants.
macro_rules! mutations {
    ($($(#[$doc:meta])* $name:literal $variant:ident: $model:ident,)*) => {
        /// Any mutation.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Mutation {
            $($(#[$doc])* $variant,)*
        }

        impl Mutation {
            /// All mutations.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];
            /// Number of mutations.
            pub const COUNT: usize = Self::ALL.len();

            /// Its name in options and statistics.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }

        impl Mutate for Mutation {
            #[inline]
            fn site(&self, path: &Path) -> Option<Site> {
                match self { $(Self::$variant => $model.site(path),)* }
            }
            #[inline]
            fn factor(
                &self,
                space: &PathSpace<'_>,
                settings: &Perturbation,
                path: &Path,
                site: Site,
            ) -> f64 {
                match self { $(Self::$variant => $model.factor(space, settings, path, site),)* }
            }
            #[inline]
            fn propose(
                &self,
                space: &PathSpace<'_>,
                settings: &Perturbation,
                site: Site,
                paths: (&Path, &mut Path),
                random: &mut Stream,
            ) -> Result<f64, Rejection> {
                match self {
                    $(Self::$variant => $model.propose(space, settings, site, paths, random),)*
                }
            }
        }
    };
}

mutations! {
    /// Moves the raster position of a path that goes on to two finite vertices.
    "lens" Lens: LensPerturbation,
    /// Moves the raster position, and turns directions before further Dirac events.
    "multi_chain" MultiChain: MultiChainPerturbation,
    /// Moves the raster position, and aims at further Dirac vertices, which stay.
    "lai_lens" LaiLens: LaiLensPerturbation,
    /// Turns the direction of light before it reaches what the eye sees.
    "caustic" Caustic: CausticPerturbation,
}
