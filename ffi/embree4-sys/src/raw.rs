//! Embree alone: recorded rays in a loop of C that does nothing else.
//!
//! No renderer goes this way. It is what the throughput of one is measured against, on the same scene
//! in the same process, with the same flags.

use crate::bindings;
use crate::packets::LANES;
use crate::scene::{CommittedScene, Ray, is_traceable};

const _: () = assert!(
    size_of::<bindings::ShimRay>() == size_of::<Ray>()
        && align_of::<bindings::ShimRay>() == align_of::<Ray>(),
    "rays of both sides lie alike in memory"
);

/// Rays that Embree accepts, so that a loop over them need not look at them.
#[derive(Clone, Debug, Default)]
pub struct RawRays {
    rays: Vec<Ray>,
}

impl RawRays {
    /// Keeps the rays that are not broken, in their order; the others would miss anyway, see [`Ray`].
    pub fn new(rays: impl IntoIterator<Item = Ray>) -> Self {
        Self {
            rays: rays.into_iter().filter(is_traceable).collect(),
        }
    }

    /// The rays that were kept.
    pub fn as_slice(&self) -> &[Ray] {
        &self.rays
    }
}

/// Rays that Embree accepts, eight together as it reads them.
#[derive(Clone, Debug, Default)]
pub struct RawPackets {
    packets: Vec<bindings::ShimPacket>,
}

impl RawPackets {
    /// Packs rays that are asked about together; those that are broken are left out, as by
    /// [`RawRays::new`]. The last packet of a group may have room left.
    pub fn new<G: IntoIterator<Item = Ray>>(groups: impl IntoIterator<Item = G>) -> Self {
        let mut packets = Vec::new();
        for group in groups {
            let rays = RawRays::new(group);
            packets.extend(rays.as_slice().chunks(LANES).map(packet));
        }
        Self { packets }
    }
}

fn packet(rays: &[Ray]) -> bindings::ShimPacket {
    let mut packet = bindings::ShimPacket::default();
    for (lane, ray) in rays.iter().enumerate() {
        let [x, y, z] = ray.origin;
        let [way_x, way_y, way_z] = ray.direction;
        let numbers = [x, y, z, ray.near, way_x, way_y, way_z];
        for (row, number) in packet.start_and_direction.iter_mut().zip(numbers) {
            row[lane] = number;
        }
        packet.far[lane] = ray.far;
        packet.valid[lane] = -1;
    }
    packet
}

/// What became of many rays: two ways to trace them agree if they have the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Rays that hit something.
    pub hits: u64,
    /// Sum of their distances, added up in the order of the rays; zero where only occlusion is asked.
    pub distances: f64,
}

impl Tally {
    /// Counts the answer for one ray.
    ///
    /// - `distance`: of its hit; `None` for a miss.
    #[inline(always)]
    pub fn add(&mut self, distance: Option<f32>) {
        if let Some(distance) = distance {
            self.hits += 1;
            self.distances += f64::from(distance);
        }
    }
}

impl CommittedScene {
    /// The closest hits of many rays, found by `rtcIntersect1` in a loop of C.
    pub fn raw_closest(&self, rays: &RawRays) -> Tally {
        let (rays, count) = raw(rays);
        // SAFETY: the scene is live and committed; the pointer leads to so many rays, all of them such
        // as Embree accepts.
        tally(unsafe { bindings::shim_raw_closest(self.handle(), rays, count) })
    }

    /// Whether each of many rays hits anything, found by `rtcOccluded1` in a loop of C.
    pub fn raw_occluded(&self, rays: &RawRays) -> Tally {
        let (rays, count) = raw(rays);
        // SAFETY: as above.
        tally(unsafe { bindings::shim_raw_occluded(self.handle(), rays, count) })
    }

    /// As [`CommittedScene::raw_closest`], by `rtcIntersect8`.
    ///
    /// `None` in scenes where Embree's packets find other hits than single rays.
    pub fn raw_closest_packets(&self, packets: &RawPackets) -> Option<Tally> {
        let (first, count) = (packets.packets.as_ptr(), packets.packets.len());
        // SAFETY: the scene is live and committed; the pointer leads to so many packets, aligned as
        // Embree wants them, of rays such as it accepts.
        let found = || unsafe { bindings::shim_raw_closest_packets(self.handle(), first, count) };
        (!self.traces_alone()).then(|| tally(found()))
    }

    /// As [`CommittedScene::raw_occluded`], by `rtcOccluded8`; `None` as above.
    pub fn raw_occluded_packets(&self, packets: &RawPackets) -> Option<Tally> {
        let (first, count) = (packets.packets.as_ptr(), packets.packets.len());
        // SAFETY: as above.
        let found = || unsafe { bindings::shim_raw_occluded_packets(self.handle(), first, count) };
        (!self.traces_alone()).then(|| tally(found()))
    }
}

fn raw(rays: &RawRays) -> (*const bindings::ShimRay, usize) {
    (rays.rays.as_ptr().cast(), rays.rays.len())
}

fn tally(raw: bindings::ShimTally) -> Tally {
    Tally {
        hits: raw.hits,
        distances: raw.distances,
    }
}
