//! Many rays, traced eight at a time.

use crate::bindings::{self, RTCRay8, RTCRayHit8};
use crate::scene::{CommittedScene, Hit, INVALID_ID, Ray, is_traceable};

/// Rays in a packet.
const LANES: usize = 8;

/// Which rays of a packet are traced: -1 for those, 0 for others. Aligned as Embree wants it.
#[derive(Default)]
#[repr(C, align(32))]
struct Valid([i32; LANES]);

impl CommittedScene {
    /// The closest hits of many rays: what [`CommittedScene::intersect`] finds for each one, in less
    /// time.
    ///
    /// What is found for a ray does not depend on the others.
    ///
    /// - `hits`: one a ray is added, in their order.
    #[inline]
    pub fn intersect_all(&self, rays: impl IntoIterator<Item = Ray>, hits: &mut Vec<Option<Hit>>) {
        if self.traces_alone() {
            hits.extend(rays.into_iter().map(|ray| self.intersect(&ray)));
            return;
        }
        let mut query = RTCRayHit8::default();
        trace_all(
            rays,
            &mut query,
            |query| &mut query.ray,
            |query, valid, count| {
                query.hit.geomID = [INVALID_ID; LANES];
                query.hit.instID = [[INVALID_ID; LANES]];
                // SAFETY: the scene is live and committed; mask and packet are ours, aligned, and
                // filled where the mask says so.
                unsafe {
                    bindings::shim_intersect_packet(self.handle(), valid.0.as_ptr(), query);
                }
                hits.extend((0..count).map(|lane| hit(query, lane)));
            },
        );
    }

    /// Whether anything is hit, for many rays: what [`CommittedScene::occluded`] says of each one,
    /// in less time.
    ///
    /// What is found for a ray does not depend on the others. Processors that have no more than
    /// SSE2 make an exception to the rest: a hit right at the end of the interval may count for one
    /// of the two methods only.
    ///
    /// - `occluded`: one a ray is added, in their order.
    #[inline]
    pub fn occluded_all(&self, rays: impl IntoIterator<Item = Ray>, occluded: &mut Vec<bool>) {
        if self.traces_alone() {
            occluded.extend(rays.into_iter().map(|ray| self.occluded(&ray)));
            return;
        }
        let mut query = RTCRay8::default();
        trace_all(
            rays,
            &mut query,
            |query| query,
            |query, valid, count| {
                // SAFETY: the scene is live and committed; mask and packet are ours, aligned, and
                // filled where the mask says so.
                unsafe {
                    bindings::shim_occluded_packet(self.handle(), valid.0.as_ptr(), query);
                }
                let found = query.tfar.iter().zip(valid.0).take(count);
                occluded.extend(found.map(|(far, valid)| valid != 0 && *far == f32::NEG_INFINITY));
            },
        );
    }
}

/// Fills packet after packet and hands each one on, with the mask and the number of its rays.
#[inline(always)]
fn trace_all<Q>(
    rays: impl IntoIterator<Item = Ray>,
    query: &mut Q,
    packet: impl Fn(&mut Q) -> &mut RTCRay8,
    mut trace: impl FnMut(&mut Q, &Valid, usize),
) {
    let mut rays = rays.into_iter();
    packet(query).mask = [u32::MAX; LANES];
    loop {
        let (mut valid, mut count) = (Valid::default(), 0);
        let lanes = packet(query);
        for ray in rays.by_ref().take(LANES) {
            if is_traceable(&ray) {
                set(lanes, count, &ray);
                valid.0[count] = -1;
            }
            count += 1;
        }
        if count > 0 {
            trace(query, &valid, count);
        }
        if count < LANES {
            return;
        }
    }
}

#[inline(always)]
fn set(rays: &mut RTCRay8, lane: usize, ray: &Ray) {
    [rays.org_x[lane], rays.org_y[lane], rays.org_z[lane]] = ray.origin;
    [rays.dir_x[lane], rays.dir_y[lane], rays.dir_z[lane]] = ray.direction;
    rays.tnear[lane] = ray.near;
    rays.tfar[lane] = ray.far;
}

#[inline(always)]
fn hit(query: &RTCRayHit8, lane: usize) -> Option<Hit> {
    let hit = &query.hit;
    let geometry = hit.geomID[lane];
    let instance = hit.instID[0][lane];
    (geometry != INVALID_ID).then(|| Hit {
        distance: query.ray.tfar[lane],
        u: hit.u[lane],
        v: hit.v[lane],
        normal: [hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane]],
        primitive: hit.primID[lane],
        geometry,
        instance: (instance != INVALID_ID).then_some(instance),
    })
}
