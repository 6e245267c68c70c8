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

/// Rays that Embree accepts, in its packets of eight.
#[derive(Clone, Debug, Default)]
pub struct RawPackets(embree4_sys::RawPackets);

impl RawPackets {
    /// Packs rays that are asked about together, those that are not broken.
    pub(super) fn new<'r>(groups: impl IntoIterator<Item = &'r [Ray]>) -> Self {
        let groups = groups.into_iter().map(|rays| rays.iter().map(embree_ray));
        Self(embree4_sys::RawPackets::new(groups))
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

    /// As [`Accel::raw_closest`], eight rays a call; `None` also where packets find other hits than single
    /// rays.
    pub fn raw_closest_packets(&self, packets: &RawPackets) -> Option<Tally> {
        self.embree()?.scene().raw_closest_packets(&packets.0)
    }

    /// As [`Accel::raw_occluded`], likewise.
    pub fn raw_occluded_packets(&self, packets: &RawPackets) -> Option<Tally> {
        self.embree()?.scene().raw_occluded_packets(&packets.0)
    }

    fn embree(&self) -> Option<&super::EmbreeAccel> {
        match &self.0 {
            Built::Embree(accel) => Some(accel),
            Built::Other(Other::Recorder(recorder)) => recorder.inner().embree(),
            Built::Other(Other::Obvhs(_)) => None,
        }
    }
}
