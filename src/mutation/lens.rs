//! The lens perturbation.

use super::forward::{connection_factor, last_moved, rebuild};
use super::{Mutate, Perturbation, Rejection};
use crate::path::{Path, PathSpace};
use crate::random::Stream;

/// Moves the raster position, follows the path's Dirac events to the first finite vertex and connects
/// it to the next vertex, which stays; or reaches the light on the way.
///
/// Applies to paths `E S* D D …`, `E S* D L` and `E S* L`.
///
/// Source: Cline et al. 2005, Sec. 4.3.
#[derive(Clone, Copy, Debug)]
pub struct LensPerturbation;

impl Mutate for LensPerturbation {
    #[inline]
    fn last_changed(&self, path: &Path) -> Option<usize> {
        Some((last_moved(path, 0)? + 1).min(path.edges()))
    }

    #[inline]
    fn factor(&self, space: &PathSpace<'_>, settings: &Perturbation, path: &Path) -> f64 {
        last_moved(path, 0).map_or(0.0, |last| connection_factor(space, settings, path, last))
    }

    #[inline]
    fn propose(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        proposal: &mut Path,
        random: &mut Stream,
    ) -> Result<f64, Rejection> {
        let last = last_moved(proposal, 0).ok_or(Rejection::SignatureChanged)?;
        rebuild(space, settings, None, proposal, last, random)
    }
}
