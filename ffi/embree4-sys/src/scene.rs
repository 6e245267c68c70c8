//! A scene that is built and can be traced.
//!
//! One foreign call per ray, no allocation; the only check is that no number of the ray is broken.

use std::mem::MaybeUninit;

use crate::bindings;
use crate::buffers::VertexBuffer;
use crate::builder::Kept;
use crate::device::Device;

// The C compiler asserts the same numbers in csrc/shim.c: bindgen's parser and the compiler that
// built the shim agree on what crosses the border.
const _: () = {
    assert!(
        size_of::<bindings::ShimHit>() == 36 && align_of::<bindings::ShimHit>() == 4,
        "ShimHit has no padding"
    );
    assert!(
        size_of::<bindings::ShimShape>() == 24 + 13 * 8,
        "ShimShape has no padding"
    );
};

/// `RTC_INVALID_GEOMETRY_ID`, which bindgen cannot evaluate; `csrc/shim.c` asserts the value.
pub(crate) const INVALID_ID: u32 = u32::MAX;

/// A piece of a straight line.
///
/// Both ends of the interval belong to it, except that triangles in scenes built without
/// [`crate::BuildOptions::robust`] are not hit at `near` itself. What lies there is decided by the distance
/// that Embree finds, which differs in its last bits between processors. A ray with a number that is broken
/// (not-a-number, infinite other than `far`, coordinates beyond [`VertexBuffer::LARGEST`], negative
/// `near`) or with `near` above `far` misses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where distances are counted from, in scene units.
    pub origin: [f32; 3],
    /// Hits before this distance do not count. At least 0.
    pub near: f32,
    /// Any length; distances count in multiples of it.
    pub direction: [f32; 3],
    /// Hits beyond this distance do not count; may be infinite.
    pub far: f32,
}

impl Ray {
    /// Origin and near end, side by side in memory.
    #[inline(always)]
    pub(crate) fn start(&self) -> [f32; 4] {
        let [x, y, z] = self.origin;
        [x, y, z, self.near]
    }

    /// Direction and far end, likewise.
    #[inline(always)]
    pub(crate) fn way(&self) -> [f32; 4] {
        let [x, y, z] = self.direction;
        [x, y, z, self.far]
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The distance along the ray, in multiples of its direction.
    pub distance: f32,
    /// First surface coordinate; its meaning is told where the geometry is added.
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
    /// Normal of the surface, independent of the ray's side, in the space of the scene that holds
    /// the geometry. Unit length on analytic shapes, twice the area on triangles.
    pub normal: [f32; 3],
    /// Number of the triangle in its index buffer; 0 on analytic shapes.
    pub primitive: u32,
    /// Number of the geometry, see [`crate::GeometryId`], in the scene that holds it.
    pub geometry: u32,
    /// Number of the instance in the scene that was traced, if the geometry is in one.
    pub instance: Option<u32>,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates, in scene units.
    pub lower: [f32; 3],
    /// The corner with the largest coordinates, in scene units.
    pub upper: [f32; 3],
}

/// An Embree scene that is released when this is dropped.
#[derive(Debug)]
pub(crate) struct SceneHandle(bindings::RTCScene);

// SAFETY: Embree scenes have no thread affinity. Building needs one caller at a time, which the
// builder's `&mut self` gives; everything that takes `&self` is a query, allowed from any number
// of threads.
unsafe impl Send for SceneHandle {}
// SAFETY: as above.
unsafe impl Sync for SceneHandle {}

impl SceneHandle {
    /// Takes over the reference that rtcNewScene returned.
    pub(crate) fn new(scene: bindings::RTCScene) -> Self {
        Self(scene)
    }

    #[inline]
    pub(crate) fn raw(&self) -> bindings::RTCScene {
        self.0
    }
}

impl Drop for SceneHandle {
    fn drop(&mut self) {
        // SAFETY: this value owns the one reference that rtcNewScene gave.
        unsafe { bindings::rtcReleaseScene(self.0) }
    }
}

/// A scene that is built: it can be traced from any thread, and keeps its buffers, instanced scenes
/// and device alive.
#[derive(Debug)]
pub struct CommittedScene {
    // Before `kept` and `device`: fields are dropped in order, and Embree goes first.
    handle: SceneHandle,
    #[expect(dead_code, reason = "held for its memory, not read")]
    kept: Vec<Kept>,
    has_instances: bool,
    traces_alone: bool,
    device: Device,
}

impl CommittedScene {
    /// Whether Embree's packets would find other hits than single rays: so it is with B-splines, where
    /// a packet's search ends elsewhere within their tolerance.
    pub(crate) fn traces_alone(&self) -> bool {
        self.traces_alone
    }

    pub(crate) fn new(handle: SceneHandle, kept: Vec<Kept>, device: Device) -> Self {
        let has_instances = kept.iter().any(|kept| matches!(kept, Kept::Instance(_)));
        Self {
            handle,
            traces_alone: kept.iter().any(Kept::traces_alone),
            kept,
            has_instances,
            device,
        }
    }

    /// The closest hit at a distance in [near, far], or nothing.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        if !is_traceable(ray) {
            return None;
        }
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        let mut hit = MaybeUninit::<bindings::ShimHit>::uninit();
        // SAFETY: the scene is live and committed; `hit` is ours and has room for a hit.
        let is_hit = unsafe {
            let to = hit.as_mut_ptr();
            bindings::shim_intersect(
                self.handle.raw(),
                x,
                y,
                z,
                ray.near,
                dx,
                dy,
                dz,
                ray.far,
                to,
            )
        };
        if !is_hit {
            return None;
        }
        // SAFETY: where there is a hit, all of it has been written.
        let hit = unsafe { hit.assume_init() };
        Some(Hit {
            distance: hit.distance,
            u: hit.u,
            v: hit.v,
            normal: hit.normal,
            primitive: hit.primitive,
            geometry: hit.geometry,
            instance: (hit.instance != INVALID_ID).then_some(hit.instance),
        })
    }

    /// Whether anything is hit at a distance in [near, far].
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        if !is_traceable(ray) {
            return false;
        }
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        // SAFETY: the scene is live and committed.
        unsafe {
            bindings::shim_occluded(self.handle.raw(), x, y, z, ray.near, dx, dy, dz, ray.far)
        }
    }

    /// The box around everything in the scene, or nothing if the scene is empty.
    pub fn bounds(&self) -> Option<Bounds> {
        let mut bounds = bindings::RTCBounds::default();
        // SAFETY: the scene is live and committed, the box is ours.
        unsafe { bindings::rtcGetSceneBounds(self.handle.raw(), &mut bounds) };
        let lower = [bounds.lower_x, bounds.lower_y, bounds.lower_z];
        let upper = [bounds.upper_x, bounds.upper_y, bounds.upper_z];
        (lower[0] <= upper[0]).then_some(Bounds { lower, upper })
    }

    /// The device that the scene was built on.
    pub fn device(&self) -> &Device {
        &self.device
    }

    pub(crate) fn handle(&self) -> bindings::RTCScene {
        self.handle.raw()
    }

    pub(crate) fn has_instances(&self) -> bool {
        self.has_instances
    }
}

/// Whether Embree accepts the ray.
///
/// Debian 12 compiles Embree with its assertions: it ends the process over a ray with
/// not-a-number in it, where other builds visit the whole tree. Written so that not-a-number
/// fails.
#[inline]
pub(crate) fn is_traceable(ray: &Ray) -> bool {
    let (start, way) = (ray.start().map(f32::abs), ray.way().map(f32::abs));
    // One comparison for nearly all rays: no coordinate is larger than the sum of all.
    let sum = (start[0] + way[0]) + (start[1] + way[1]) + (start[2] + way[2]);
    let is_within = sum <= VertexBuffer::LARGEST || all_within(ray);
    is_within & (ray.near >= 0.0) & (ray.near <= ray.far)
}

/// Whether no coordinate is too large or not-a-number.
#[cold]
fn all_within(ray: &Ray) -> bool {
    let mut coordinates = ray.origin.iter().chain(&ray.direction);
    coordinates.all(|coordinate| coordinate.abs() <= VertexBuffer::LARGEST)
}
