//! Rays against geometry: the only module that speaks to the tracer.

mod embree;
mod ray;

pub use embree::{Accel, AccelError, Instance, prepare_worker, versions};
pub use embree4_sys::{CurveBasis, CurveBuffer, Hit, IndexBuffer, VertexBuffer};
pub use ray::Ray;

use crate::math::Vec3;

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
