//! Embree 3.13 or 4 with a safe face.
//!
//! The bindings are made at build time from the headers that are installed, because the layout of
//! a hit differs between releases; a C shim covers the calls that differ between 3 and 4. Nothing
//! that Embree names leaves this crate: callers see buffers, a builder, and a committed scene that
//! owns all it needs and can be traced from any number of threads.
//!
//! Errors are found before or while a scene is built. A committed scene cannot fail: a ray with
//! not-a-number in it misses.
//!
//! ```no_run
//! use embree4_sys::{Device, IndexBuffer, Ray, SceneBuilder, VertexBuffer};
//!
//! # fn main() -> Result<(), embree4_sys::Error> {
//! let device = Device::new("")?;
//! let vertices = VertexBuffer::new(vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
//! let indices = IndexBuffer::new(vec![[0, 1, 2]]);
//! let mut builder = SceneBuilder::new(&device)?;
//! builder.add_triangles(&vertices, &indices)?;
//! let scene = builder.commit()?;
//! let ray = Ray {
//!     origin: [0.25, 0.25, 0.0],
//!     direction: [0.0, 0.0, 1.0],
//!     near: 0.0,
//!     far: f32::INFINITY,
//! };
//! assert_eq!(scene.intersect(&ray).map(|hit| hit.distance), Some(1.0));
//! # Ok(())
//! # }
//! ```
#![deny(
    unsafe_op_in_unsafe_fn,
    clippy::undocumented_unsafe_blocks,
    clippy::missing_safety_doc
)]

mod analytic;
mod buffers;
mod builder;
mod curves;
mod denormals;
mod device;
mod error;
mod packets;
mod raw;
mod scene;

/// What bindgen made of `csrc/shim.h` and the installed headers.
#[expect(
    clippy::allow_attributes,
    dead_code,
    non_snake_case,
    unreachable_pub,
    reason = "generated: C names, whole enumerations, everything public"
)]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}

pub use analytic::{check_map, check_sphere};
pub use buffers::{CurveBuffer, IndexBuffer, VertexBuffer};
pub use builder::{BuildOptions, BuildQuality, GeometryId, SceneBuilder, check_triangles};
pub use curves::CurveBasis;
pub use denormals::flush_denormals;
pub use device::{Device, MemoryUse, Version, Versions};
pub use error::Error;
pub use raw::{RawPackets, RawRays, Tally};
pub use scene::{Bounds, CommittedScene, Hit, Ray};
