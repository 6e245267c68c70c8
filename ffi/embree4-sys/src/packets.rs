//! Many rays, traced eight at a time.

use crate::bindings::{self, RTCRay8, RTCRayHit8};
use crate::buffers::VertexBuffer;
use crate::scene::{CommittedScene, Hit, INVALID_ID, Ray, is_traceable};

/// Rays in a packet.
pub(crate) const LANES: usize = 8;

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
    let mut batch = [UNUSED; LANES];
    loop {
        let mut count = 0;
        for (place, ray) in batch.iter_mut().zip(rays.by_ref()) {
            *place = ray;
            count += 1;
        }
        if count > 0 {
            let lanes = packet(query);
            set(lanes, &batch);
            let valid = traceable(lanes, &batch, count);
            trace(query, &valid, count);
        }
        if count < LANES {
            return;
        }
    }
}

/// Stands in lanes that have had no ray.
const UNUSED: Ray = Ray {
    origin: [0.0; 3],
    near: 0.0,
    direction: [0.0, 0.0, 1.0],
    far: 0.0,
};

/// Which of the first `count` rays are traceable, by [`is_traceable`].
///
/// - `lanes`: holds the rays of `batch`.
#[inline(always)]
fn traceable(lanes: &RTCRay8, batch: &[Ray; LANES], count: usize) -> Valid {
    // Lane by lane in each step, so that the compiler looks at several at once.
    let mut sums = [0.0; LANES];
    for numbers in [&lanes.org_x, &lanes.org_y, &lanes.org_z] {
        add_sizes(&mut sums, numbers);
    }
    for numbers in [&lanes.dir_x, &lanes.dir_y, &lanes.dir_z] {
        add_sizes(&mut sums, numbers);
    }
    let mut valid = Valid::default();
    let mut all = -1;
    for (lane, sum) in sums.into_iter().enumerate() {
        let (near, far) = (lanes.tnear[lane], lanes.tfar[lane]);
        let is_whole = (sum <= VertexBuffer::LARGEST) & (near >= 0.0) & (near <= far);
        let is_used = USED[count][lane];
        valid.0[lane] = is_used & -i32::from(is_whole);
        all &= valid.0[lane] | !is_used;
    }
    if all == 0 {
        recheck(&mut valid, batch, count);
    }
    valid
}

/// Row by number of rays: -1 for lanes that have one.
const USED: [[i32; LANES]; LANES + 1] = {
    let mut rows = [[0; LANES]; LANES + 1];
    let mut place = 0;
    while place < LANES * LANES {
        let (count, lane) = (1 + place / LANES, place % LANES);
        if lane < count {
            rows[count][lane] = -1;
        }
        place += 1;
    }
    rows
};

#[inline(always)]
fn add_sizes(sums: &mut [f32; LANES], numbers: &[f32; LANES]) {
    for (sum, number) in sums.iter_mut().zip(numbers) {
        *sum += number.abs();
    }
}

/// The whole test, where the sum of coordinates was too large for the short one.
#[cold]
fn recheck(valid: &mut Valid, batch: &[Ray; LANES], count: usize) {
    for (valid, ray) in valid.0.iter_mut().zip(batch).take(count) {
        *valid = -i32::from(is_traceable(ray));
    }
}

/// Writes rays into the lanes of a packet.
#[inline(always)]
fn set(lanes: &mut RTCRay8, batch: &[Ray; LANES]) {
    for (half, rays) in batch.chunks_exact(4).enumerate() {
        let lanes_of = |numbers: &mut [f32; LANES], row: [f32; 4]| {
            numbers[half * 4..half * 4 + 4].copy_from_slice(&row);
        };
        let [x, y, z, near] = transpose([0, 1, 2, 3].map(|i| rays[i].start()));
        lanes_of(&mut lanes.org_x, x);
        lanes_of(&mut lanes.org_y, y);
        lanes_of(&mut lanes.org_z, z);
        lanes_of(&mut lanes.tnear, near);
        let [x, y, z, far] = transpose([0, 1, 2, 3].map(|i| rays[i].way()));
        lanes_of(&mut lanes.dir_x, x);
        lanes_of(&mut lanes.dir_y, y);
        lanes_of(&mut lanes.dir_z, z);
        lanes_of(&mut lanes.tfar, far);
    }
}

/// Rows become columns.
#[inline(always)]
#[cfg(target_arch = "x86_64")]
fn transpose(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    use std::arch::x86_64::{
        _mm_loadu_ps, _mm_movehl_ps, _mm_movelh_ps, _mm_storeu_ps, _mm_unpackhi_ps, _mm_unpacklo_ps,
    };
    let mut columns = [[0.0; 4]; 4];
    // SAFETY: every x86-64 processor has SSE; each pointer is to four numbers of our own.
    unsafe {
        let [a, b, c, d] = rows.each_ref().map(|row| _mm_loadu_ps(row.as_ptr()));
        let (ab, ab_high) = (_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b));
        let (cd, cd_high) = (_mm_unpacklo_ps(c, d), _mm_unpackhi_ps(c, d));
        _mm_storeu_ps(columns[0].as_mut_ptr(), _mm_movelh_ps(ab, cd));
        _mm_storeu_ps(columns[1].as_mut_ptr(), _mm_movehl_ps(cd, ab));
        _mm_storeu_ps(columns[2].as_mut_ptr(), _mm_movelh_ps(ab_high, cd_high));
        _mm_storeu_ps(columns[3].as_mut_ptr(), _mm_movehl_ps(cd_high, ab_high));
    }
    columns
}

/// Rows become columns.
#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
fn transpose(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    std::array::from_fn(|column| rows.map(|row| row[column]))
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
