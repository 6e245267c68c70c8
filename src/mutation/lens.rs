//! The lens perturbation.

use super::forward::{connection_factor, last_moved, rebuild, site_up_to};
use super::{Mutate, Perturbation, Rejection, Site};
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
    fn site(&self, path: &Path) -> Option<Site> {
        Some(site_up_to(path, last_moved(path, 0)?))
    }

    #[inline]
    fn factor(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        path: &Path,
        site: Site,
    ) -> f64 {
        connection_factor(space, settings, path, site.last_moved)
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
        rebuild(space, settings, None, (paths, site.last_moved), random)
    }
}
