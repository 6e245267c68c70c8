//! Lai's lens perturbation.

use super::forward::{Redirect, connection_factor, rebuild, site_behind_finite};
use super::{Fault, Mutate, Perturbation, Rejection, Site};
use crate::path::{Event, Path, PathSpace};
use crate::random::Stream;

/// As the multi-chain perturbation, but at a finite vertex before a Dirac one the path goes on to that
/// very vertex, which stays where it is.
///
/// Source: van Antwerpen 2011, Sec. 6.3.
#[derive(Clone, Copy, Debug)]
pub struct LaiLensPerturbation;

impl Mutate for LaiLensPerturbation {
    #[inline]
    fn site(&self, path: &Path) -> Option<Site> {
        site_behind_finite(path)
    }

    /// The coordinates are the positions of the vertices that stay: every direction to one brings the
    /// solid angle that its area takes up.
    #[inline]
    fn factor(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        path: &Path,
        site: Site,
    ) -> f64 {
        let last = site.last_moved;
        connection_factor(space, settings, path, last) * area_factor(space, settings, path, last)
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
        let (current, proposal) = paths;
        let work = ((current, &mut *proposal), site.last_moved);
        let factor = rebuild(space, settings, Some(Redirect::Aim), work, random)?;
        Ok(factor * area_factor(space, settings, proposal, site.last_moved))
    }
}

/// Solid angles, for each unit of area, of the vertices that stay while what is before them moves.
fn area_factor(space: &PathSpace<'_>, settings: &Perturbation, path: &Path, last: usize) -> f64 {
    let pairs = path.vertices()[..=last].windows(2);
    pairs
        .filter(|pair| pair[0].event == Event::Finite && pair[1].event.is_dirac())
        .map(|pair| space.solid_angle_per_area(&pair[0], &pair[1]))
        .map(|area| settings.fault.keep(Fault::Area, area))
        .product()
}
