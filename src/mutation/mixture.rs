//! Mixtures of mutations of several sizes, any of which may make the same move.

use super::ratio::log_transition;
use super::{Mutate, Mutation, Perturbation};
use crate::path::{Path, PathSpace};

/// A mutation of one size, and the probability of choosing it.
#[derive(Clone, Copy, Debug)]
pub struct Component<'a> {
    /// The mutation.
    pub mutation: Mutation,
    /// Its size.
    pub settings: &'a Perturbation,
    /// Probability of choosing it at the path left.
    pub probability: f64,
}

/// Density of a move by any component of a mixture, over the density of the one that made it.
///
/// Counts the components that move the same vertices; others never make this move. Zero for moves that the
/// maker itself does not make.
///
/// - `maker`: the component that made the move.
/// - `from`, `to`: the path left and the path proposed.
///
/// Differs: a component counts where it makes the move and the way back, since a caustic perturbation rejects what has no
/// way back by itself.
///
/// Source: Lai et al. 2007, Eq. 4.
pub fn mixture_density<'a>(
    space: &PathSpace<'_>,
    maker: Component<'a>,
    components: impl Iterator<Item = Component<'a>>,
    (from, to): (&Path, &Path),
) -> f64 {
    let log_density = |component: &Component<'_>, from, to| {
        log_transition(component.mutation, space, component.settings, (from, to))
    };
    let Some(own) = log_density(&maker, from, to) else {
        return 0.0;
    };
    components
        .filter(|component| component.probability > 0.0)
        .filter(|component| move_the_same(component.mutation, maker.mutation, from))
        .filter(|component| log_density(component, to, from).is_some())
        .filter_map(|component| {
            let other = log_density(&component, from, to)?;
            Some(component.probability * (other - own).exp())
        })
        .sum()
}

/// Whether two mutations move the same vertices of a path.
fn move_the_same(a: Mutation, b: Mutation, path: &Path) -> bool {
    // What stays behind the Lai lens perturbation's finite vertices moves with all others.
    let is_lai_lens = |mutation| mutation == Mutation::LaiLens;
    let last_moved = |mutation: Mutation| mutation.site(path).map(|site| site.last_moved);
    a == b
        || (!is_lai_lens(a)
            && !is_lai_lens(b)
            && last_moved(a).is_some()
            && last_moved(a) == last_moved(b))
}
