//! What stands in for Embree: all of it in one variant, so that a ray that Embree traces is compared once.

use super::obvhs::ObvhsAccel;
use super::recorder::Recorder;
use super::{Hit, MemoryUse, Ray};
use crate::math::Vec3;

/// A tracer other than Embree alone.
#[derive(Debug)]
pub(super) enum Other {
    /// The second tracer.
    Obvhs(ObvhsAccel),
    /// One that keeps what it is asked.
    Recorder(Box<Recorder>),
}

/// Asks whichever it is.
macro_rules! forward {
    ($self:ident, $accel:ident => $call:expr) => {
        match $self {
            Self::Obvhs($accel) => $call,
            Self::Recorder($accel) => $call,
        }
    };
}

impl Other {
    /// As [`super::Accel::memory`].
    pub(super) fn memory(&self) -> MemoryUse {
        forward!(self, accel => accel.memory())
    }

    /// As [`super::Accel::intersect`].
    #[cold]
    #[inline(never)]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        forward!(self, accel => accel.intersect(ray))
    }

    /// As [`super::Accel::is_occluded`].
    #[cold]
    #[inline(never)]
    pub(super) fn is_occluded(&self, ray: &Ray) -> bool {
        forward!(self, accel => accel.is_occluded(ray))
    }

    /// As [`super::Accel::intersect_all`].
    #[cold]
    #[inline(never)]
    pub(super) fn intersect_all(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        forward!(self, accel => accel.intersect_all(rays, hits));
    }

    /// As [`super::Accel::are_occluded`].
    #[cold]
    #[inline(never)]
    pub(super) fn are_occluded<'r>(
        &self,
        rays: impl IntoIterator<Item = &'r Ray>,
        occluded: &mut Vec<bool>,
    ) {
        forward!(self, accel => accel.are_occluded(rays, occluded));
    }

    /// As [`super::Accel::bounding_box`].
    pub(super) fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        forward!(self, accel => accel.bounding_box())
    }
}
