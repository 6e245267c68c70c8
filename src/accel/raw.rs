//! Embree alone on rays that were recorded: what the throughput of everything around it is measured
//! against.

use embree4_sys::Tally;

use super::embree::embree_ray;
use super::{Accel, Built, Other, Ray};
use crate::math::Vec3;

/// Rays that Embree accepts.
#[derive(Clone, Debug, Default)]
pub struct RawRays {
    ours: Vec<Ray>,
    raw: embree4_sys::RawRays,
}

impl RawRays {
    /// Keeps the rays that are not broken, in their order; the others miss whatever there is.
    pub fn new(rays: &[Ray]) -> Self {
        let raw = embree4_sys::RawRays::new(rays.iter().map(embree_ray));
        let ours = |ray: &embree4_sys::Ray| {
            let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
            Ray::new(origin, direction).between(ray.near, ray.far)
        };
        Self {
            ours: raw.as_slice().iter().map(ours).collect(),
            raw,
        }
    }

    /// The rays that were kept.
    pub fn as_slice(&self) -> &[Ray] {
        &self.ours
    }
}

impl Accel {
    /// The closest hits of many rays by calls of Embree in a loop of C; `None` where another tracer is
    /// at work.
    pub fn raw_closest(&self, rays: &RawRays) -> Option<Tally> {
        Some(self.embree()?.scene().raw_closest(&rays.raw))
    }

    /// Whether each of many rays hits anything, likewise.
    pub fn raw_occluded(&self, rays: &RawRays) -> Option<Tally> {
        Some(self.embree()?.scene().raw_occluded(&rays.raw))
    }

    fn embree(&self) -> Option<&super::EmbreeAccel> {
        match &self.0 {
            Built::Embree(accel) => Some(accel),
            Built::Other(Other::Recorder(recorder)) => recorder.inner().embree(),
            Built::Other(Other::Obvhs(_)) => None,
        }
    }
}
