//! The multi-chain perturbation.

use super::forward::{Redirect, connection_factor, rebuild, site_behind_finite};
use super::{Mutate, Perturbation, Rejection, Site};
use crate::path::{Path, PathSpace};
use crate::random::Stream;

/// As the lens perturbation, but goes on through further runs of Dirac events: at a finite vertex
/// before such a run, the direction to the next vertex is turned by a small angle.
///
/// Applies to paths with a finite vertex before a Dirac one, counted from the eye before the first
/// pair of finite vertices.
///
/// Source: Cline et al. 2005, Sec. 4.3; van Antwerpen 2011, Sec. 6.3.
#[derive(Clone, Copy, Debug)]
pub struct MultiChainPerturbation;

impl Mutate for MultiChainPerturbation {
    #[inline]
    fn site(&self, path: &Path) -> Option<Site> {
        site_behind_finite(path)
    }

    /// `f_s · |cos θ_o|` at each turned direction is in the vertices' values.
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
        let redirect = Redirect::Turn(settings.angle);
        rebuild(
            space,
            settings,
            Some(redirect),
            (paths, site.last_moved),
            random,
        )
    }
}
