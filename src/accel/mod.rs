//! Rays against geometry: the only module that speaks to the tracers.
//!
//! There are two: Embree, in its robust mode or without, and a tree of obvhs that is walked in double
//! precision. Which one is at work is chosen when a scene is built; a branch on it costs a ray one
//! comparison. Either can be made to keep what it is asked ([`Accel::recording`]), for measurements.

mod embree;
mod obvhs;
mod other;
mod raw;
mod ray;
mod recorder;

use std::fmt;

pub use embree::versions;
pub use embree4_sys::{CurveBasis, CurveBuffer, Hit, IndexBuffer, MemoryUse, Tally, VertexBuffer};
pub use obvhs::VERSION as OBVHS_VERSION;
pub use raw::{RawPackets, RawRays};
pub use ray::{Ray, RayLanes};
pub use recorder::{Query, Recording};

use crate::math::Vec3;
use embree::EmbreeAccel;
use obvhs::ObvhsAccel;
use other::Other;
use recorder::Recorder;

/// What a tracer can be given.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// Triangles; the buffers are shared with the tracer, not copied.
    Triangles(VertexBuffer, IndexBuffer),
    /// Round curves; the buffer is shared with the tracer, not copied.
    Curves(CurveBasis, CurveBuffer),
    /// An exact sphere.
    Sphere {
        /// Centre in world space.
        centre: Vec3,
        /// Radius in m, positive.
        radius: f32,
    },
    /// The image of the unit disk at `z = 0` under an affine map, given by its rows.
    Disk([[f32; 4]; 3]),
    /// The image of the open cylinder of radius 1 from `z = 0` to `z = 1` under an affine map, given
    /// by its rows.
    Cylinder([[f32; 4]; 3]),
}

impl Geometry {
    /// Memory that a tracer takes while it builds its search structure over it, in bytes: rather more
    /// than less.
    ///
    /// Embree's peak by its own count was 94 to 120 bytes a triangle in scenes of 1 to 20 million.
    pub fn build_memory(&self, engine: Engine) -> u64 {
        let (count, bytes) = match self {
            Self::Triangles(_, triangles) => (triangles.as_slice().len(), 120),
            Self::Curves(_, curves) => (curves.segments().len(), 400),
            Self::Sphere { .. } | Self::Disk(_) | Self::Cylinder(_) => (1, 1000),
        };
        let bytes = match engine {
            Engine::Embree | Engine::EmbreeFast => bytes,
            Engine::Obvhs => bytes.max(350),
        };
        count as u64 * bytes
    }
}

/// A group of geometries, placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index of the group.
    pub group: u32,
    /// Affine map from the group's space to the world, by rows.
    pub to_world: [[f32; 4]; 3],
}

/// Which tracer finds what rays meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Engine {
    /// Embree in its robust mode: in single precision, no ray slips through between two triangles.
    #[default]
    Embree,
    /// Embree without its robust mode: faster, and less than one ray in a million slips through
    /// where two triangles meet.
    EmbreeFast,
    /// A tree of obvhs, walked in double precision: several times slower, shares no code with Embree.
    Obvhs,
}

impl Engine {
    /// All of them, the default first.
    pub const ALL: [Self; 3] = [Self::Embree, Self::EmbreeFast, Self::Obvhs];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Embree => "embree",
            Self::EmbreeFast => "embree-fast",
            Self::Obvhs => "obvhs",
        }
    }
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Embree | Self::EmbreeFast => "Embree",
            Self::Obvhs => "obvhs",
        })
    }
}

/// Why geometry could not be made traceable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AccelError {
    /// Embree cannot start, or cannot build.
    #[error("Embree: {0}")]
    Embree(#[from] embree4_sys::Error),
    /// A tracer refuses a geometry.
    #[error("{engine}: {error}")]
    Geometry {
        /// Which tracer.
        engine: Engine,
        /// The geometry's index.
        index: usize,
        /// What is wrong with it.
        error: embree4_sys::Error,
    },
    /// There is more than 32-bit numbers can tell apart.
    #[error("obvhs: {0} primitives are more than it can number")]
    TooMany(usize),
}

/// Geometry that rays can be traced against.
#[derive(Debug)]
pub struct Accel(Built);

/// The search structure of one of the tracers.
#[derive(Debug)]
enum Built {
    Embree(EmbreeAccel),
    Other(Other),
}

/// Asks whichever tracer is at work.
macro_rules! forward {
    ($self:ident, $accel:ident => $call:expr) => {
        match &$self.0 {
            Built::Embree($accel) => $call,
            Built::Other($accel) => $call,
        }
    };
}

impl Accel {
    /// Builds the search structure.
    ///
    /// Hits on `geometries` have no instance; their geometry is the index in there. Hits on an
    /// instance have the number of `geometries` plus the index in `instances` as their instance, and
    /// the index in the group as their geometry.
    ///
    /// - `groups`: geometries that are not in the scene by themselves, each in a space of its own.
    ///
    /// # Errors
    /// When the tracer cannot start, runs out of memory, or a buffer holds a vertex that is not finite
    /// or an index out of range. Errors count `geometries`, then those of the groups, then `instances`.
    pub fn build<G: IntoIterator<Item = Geometry>>(
        engine: Engine,
        geometries: impl IntoIterator<Item = Geometry>,
        groups: impl IntoIterator<Item = G>,
        instances: impl IntoIterator<Item = Instance>,
    ) -> Result<Self, AccelError> {
        Ok(Self(match engine {
            Engine::Embree | Engine::EmbreeFast => {
                let robust = engine == Engine::Embree;
                Built::Embree(EmbreeAccel::build(robust, geometries, groups, instances)?)
            }
            Engine::Obvhs => {
                let accel = ObvhsAccel::build(geometries, groups, instances)?;
                Built::Other(Other::Obvhs(accel))
            }
        }))
    }

    /// The same tracer, which keeps every ray that it is asked about from now on: in the order of asking
    /// where one thread asks. For measurements; slower, and memory grows with every ray.
    #[must_use]
    pub fn recording(self) -> Self {
        Self(Built::Other(Other::Recorder(Box::new(Recorder::new(self)))))
    }

    /// What was asked since [`Accel::recording`] or the last time; `None` where nothing is kept.
    pub fn take_recording(&self) -> Option<Recording> {
        match &self.0 {
            Built::Other(Other::Recorder(recorder)) => Some(recorder.take()),
            _ => None,
        }
    }

    /// Which tracer this is.
    pub fn engine(&self) -> Engine {
        match &self.0 {
            Built::Embree(accel) => accel.engine(),
            Built::Other(Other::Obvhs(_)) => Engine::Obvhs,
            Built::Other(Other::Recorder(recorder)) => recorder.inner().engine(),
        }
    }

    /// What the search structure takes, in bytes, without the buffers that it shares; of obvhs's, what
    /// building took is not known and left out.
    pub fn memory(&self) -> MemoryUse {
        forward!(self, accel => accel.memory())
    }

    /// The closest hit.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match &self.0 {
            Built::Embree(accel) => accel.intersect(ray),
            // A copy, and the hit part by part, so that both can stay in registers.
            Built::Other(accel) => accel.intersect(&{ *ray }).map(|hit| Hit {
                distance: hit.distance,
                u: hit.u,
                v: hit.v,
                normal: hit.normal,
                primitive: hit.primitive,
                geometry: hit.geometry,
                instance: hit.instance,
            }),
        }
    }

    /// True when the ray hits anything.
    #[inline(always)]
    pub fn is_occluded(&self, ray: &Ray) -> bool {
        match &self.0 {
            Built::Embree(accel) => accel.is_occluded(ray),
            Built::Other(accel) => accel.is_occluded(&{ *ray }),
        }
    }

    /// The closest hits of many rays, as [`Accel::intersect`] finds them, in less time.
    ///
    /// - `hits`: filled anew, one a ray.
    #[inline]
    pub fn intersect_all(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        forward!(self, accel => accel.intersect_all(rays, hits));
    }

    /// Whether each of many rays hits anything, as [`Accel::is_occluded`] says, in less time.
    ///
    /// - `occluded`: filled anew, one a ray.
    #[inline]
    pub fn are_occluded<'r>(
        &self,
        rays: impl IntoIterator<Item = &'r Ray>,
        occluded: &mut Vec<bool>,
    ) {
        forward!(self, accel => accel.are_occluded(rays, occluded));
    }

    /// Lowest and highest corner of the box around everything; `None` when there is nothing.
    pub fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        forward!(self, accel => accel.bounding_box())
    }
}

/// Sets the calling thread up for tracing: numbers too small to matter are flushed to zero.
pub fn prepare_worker() {
    embree4_sys::flush_denormals();
}
