//! Planted errors, which prove that the tests of balance can fail.

use glam::DVec3;

use super::Perturbation;
use crate::path::{Path, PathSpace, luminance};

/// What is wrong with a mutation. Builds without debug assertions know no faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fault {
    /// Nothing.
    #[default]
    None,
    /// Caustic: no cosine at the head.
    HeadCosine,
    /// Caustic: no cosine at the first vertex towards the lens.
    ImageCosine,
    /// Caustic: no squared distance of the first vertex from the lens.
    ImageDistance,
    /// Caustic: no pixels for each steradian, which go as one over the cubed cosine at the lens.
    PixelsPerSteradian,
    /// Caustic: no cosine at the first vertex towards the light.
    FirstCosine,
    /// Caustic: no factor between the two directions in which Dirac events are followed.
    Adjoint,
    /// Caustic: that factor as if true and shaded surface were the same.
    ShadingNormals,
    /// Caustic in pixels: no ratio of the largest angles.
    LargestAngle,
    /// Caustic in pixels: moves without a way back are made.
    WayBack,
    /// Connections: no cosine at the vertex that stays.
    ConnectionCosine,
    /// Connections: no squared distance.
    ConnectionDistance,
    /// Dirac coefficients do not count.
    Coefficient,
    /// Dirac coefficients are divided by the probability of being selected.
    Selection,
    /// Lai lens: directions are taken for coordinates where points are.
    Area,
    /// Multi-chain: the turned direction is that to the old vertex.
    Aim,
    /// The probabilities of choosing the mutation do not count.
    Choice,
    /// Ratios are a hundredth too large.
    Ratio,
}

impl Fault {
    /// All faults.
    pub const ALL: [Self; 17] = [
        Self::HeadCosine,
        Self::ImageCosine,
        Self::ImageDistance,
        Self::PixelsPerSteradian,
        Self::FirstCosine,
        Self::Adjoint,
        Self::ShadingNormals,
        Self::LargestAngle,
        Self::WayBack,
        Self::ConnectionCosine,
        Self::ConnectionDistance,
        Self::Coefficient,
        Self::Selection,
        Self::Area,
        Self::Aim,
        Self::Choice,
        Self::Ratio,
    ];

    /// True when this is the fault, in a build that knows faults.
    #[inline(always)]
    pub(super) fn is(self, fault: Self) -> bool {
        cfg!(debug_assertions) && self == fault
    }

    /// A factor, or one where leaving it out is the fault.
    #[inline(always)]
    pub(super) fn keep(self, fault: Self, factor: f64) -> f64 {
        if self.is(fault) { 1.0 } else { factor }
    }
}

/// Luminance of a path's value.
///
/// - `value`: of the path, see [`Path::value`].
#[inline]
pub(super) fn path_luminance(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    path: &Path,
    value: DVec3,
) -> f64 {
    if settings.fault.is(Fault::Coefficient) {
        let finite = path.vertices().iter().filter(|v| !v.event.is_dirac());
        return luminance(finite.fold(DVec3::ONE, |product, v| product * v.value.0.as_dvec3()));
    }
    if settings.fault.is(Fault::Selection) {
        let chosen = |index| space.selection(path, index).map_or(1.0, |s| s.probability);
        let probability: f64 = (1..path.edges()).map(|i| f64::from(chosen(i))).product();
        return luminance(value) / probability;
    }
    luminance(value)
}

/// The factor of a Dirac vertex, given the true one.
#[inline]
pub(super) fn adjoint(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    path: &Path,
    index: usize,
) -> f64 {
    let adjoint = f64::from(path.vertices()[index].adjoint);
    if settings.fault.is(Fault::ShadingNormals) {
        return adjoint / space.shading_factor(path, index).unwrap_or(1.0);
    }
    settings.fault.keep(Fault::Adjoint, adjoint)
}
