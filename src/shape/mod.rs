//! Shapes: where surfaces are, how they are parametrised, how points on them are sampled.
//!
//! The tracer says *that* a ray met a primitive; a shape says what is there. Rectangles and cubes are
//! triangle meshes; spheres, disks, cylinders and curves are exact.

pub mod mesh;
pub mod primitives;

mod affine;
#[cfg(test)]
pub(crate) mod brute_force;
mod curves;
mod cylinder;
mod disk;
mod placement;
mod sphere;
mod surface;
#[cfg(test)]
mod tests;
mod triangle_mesh;

pub use curves::Curves;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use placement::Placement;
pub use sphere::Sphere;
pub use surface::{Derivatives, SurfacePoint};
pub use triangle_mesh::{SurfaceLanes, Triangle, TriangleMesh};

use thiserror::Error;

use crate::accel::Geometry;
use crate::math::{AreaDensity, SolidAngleDensity, Vec2, Vec3};

/// Why numbers do not describe an exact shape.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number is infinite or not a number.
    #[error("a number of the shape is not finite")]
    NotFinite,
    /// A radius is zero or negative.
    #[error("the radius must be positive")]
    BadRadius,
    /// A curve has too few control points for one segment.
    #[error("a curve has {found} control points, expected {least} at least")]
    ShortCurve {
        /// How many it has.
        found: usize,
        /// How many a segment takes.
        least: usize,
    },
    /// The transform leaves no surface.
    #[error("the transform flattens the shape to nothing")]
    Flat,
    /// The transform makes an ellipsoid, or a cylinder with an elliptic or slanted cut, of it.
    #[error("the transform stretches or shears the shape, so that it is no longer round")]
    Stretched,
}

/// Where a ray met a shape.
#[derive(Clone, Copy, Debug)]
pub struct ShapeHit {
    /// Which primitive of the shape.
    pub primitive: u32,
    /// The tracer's coordinates on the primitive: barycentrics of the second and third vertex.
    pub barycentrics: Vec2,
    /// The point as the ray gives it, `origin + distance · direction`: less exact than the shape's.
    pub position: Vec3,
}

/// What a shape takes in memory, in bytes, beside the few that every shape has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShapeMemory {
    /// Buffers that the tracer reads, too.
    pub shared: u64,
    /// Normals, texture coordinates and tables, which the tracer does not know.
    pub own: u64,
}

/// What a shape can answer.
pub trait ShapeModel {
    /// What the tracer is given.
    fn geometry(&self) -> Geometry;

    /// What it takes in memory.
    fn memory(&self) -> ShapeMemory {
        ShapeMemory::default()
    }

    /// Prepares [`ShapeModel::sample_area`]; false when there is no area to sample.
    fn prepare_sampling(&mut self) -> bool {
        self.area() > 0.0
    }

    /// Everything about the point that a ray met.
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint;

    /// Surface coordinates of a point that this shape has made, also where it leaves them out of its points.
    ///
    /// - `primitive`: the triangle or segment that the point lies on.
    fn coordinates(&self, point: &SurfacePoint, primitive: u32) -> Vec2 {
        let _ = primitive;
        point.uv
    }

    /// Surface area in m².
    fn area(&self) -> f64;

    /// Samples a point uniformly by area.
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity);

    /// Goes back from a point to the numbers that [`ShapeModel::sample_area`] makes it of; `None` where
    /// no point is sampled.
    fn invert_area(&self, point: &SurfacePoint) -> Option<Vec2>;

    /// Samples a point that may be seen from `from`; the density is that of its direction.
    ///
    /// The point can be occluded or face away. `None` where there is no density to give: at the
    /// shape's own surface, or for a point that is seen edge-on.
    #[inline(always)]
    fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAngleDensity)> {
        let (point, density) = self.sample_area(u);
        Some((point, as_direction(density, from, &point)?))
    }

    /// Density with which [`ShapeModel::sample_toward`] makes the direction to `point`.
    fn density_toward(&self, from: Vec3, point: &SurfacePoint) -> SolidAngleDensity {
        let density = AreaDensity((1.0 / self.area()) as f32);
        as_direction(density, from, point).unwrap_or_default()
    }

    /// Goes back from a point to the numbers that [`ShapeModel::sample_toward`] makes it of; `None`
    /// for a point that is not sampled from there.
    fn invert_toward(&self, from: Vec3, point: &SurfacePoint) -> Option<Vec2> {
        let _ = from;
        self.invert_area(point)
    }
}

/// A density of points as that of the directions in which `from` sees them.
#[inline(always)]
fn as_direction(
    density: AreaDensity,
    from: Vec3,
    point: &SurfacePoint,
) -> Option<SolidAngleDensity> {
    let edge = point.position - from;
    let distance_squared = edge.length_squared();
    let cos = point.geometric_normal.dot(edge) / distance_squared.sqrt();
    density.to_solid_angle(cos, distance_squared)
}

/// Writes the enum of all shapes and forwards [`ShapeModel`] to its variants.
macro_rules! shape_models {
    ($($(#[$doc:meta])* $model:ident,)*) => {
        /// Any shape.
        #[derive(Clone, Debug)]
        pub enum Shape {
            $($(#[$doc])* $model($model),)*
        }

        $(impl From<$model> for Shape {
            fn from(model: $model) -> Self {
                Self::$model(model)
            }
        })*

        impl ShapeModel for Shape {
            fn geometry(&self) -> Geometry {
                match self { $(Self::$model(s) => s.geometry(),)* }
            }
            fn memory(&self) -> ShapeMemory {
                match self { $(Self::$model(s) => s.memory(),)* }
            }
            fn prepare_sampling(&mut self) -> bool {
                match self { $(Self::$model(s) => s.prepare_sampling(),)* }
            }
            #[inline(always)]
            fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
                match self { $(Self::$model(s) => s.surface_at(hit),)* }
            }
            fn coordinates(&self, point: &SurfacePoint, primitive: u32) -> Vec2 {
                match self { $(Self::$model(s) => s.coordinates(point, primitive),)* }
            }
            #[inline]
            fn area(&self) -> f64 {
                match self { $(Self::$model(s) => s.area(),)* }
            }
            #[inline]
            fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
                match self { $(Self::$model(s) => s.sample_area(u),)* }
            }
            #[inline(always)]
            fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAngleDensity)> {
                match self { $(Self::$model(s) => s.sample_toward(from, u),)* }
            }
            #[inline]
            fn density_toward(&self, from: Vec3, point: &SurfacePoint) -> SolidAngleDensity {
                match self { $(Self::$model(s) => s.density_toward(from, point),)* }
            }
            fn invert_area(&self, point: &SurfacePoint) -> Option<Vec2> {
                match self { $(Self::$model(s) => s.invert_area(point),)* }
            }
            fn invert_toward(&self, from: Vec3, point: &SurfacePoint) -> Option<Vec2> {
                match self { $(Self::$model(s) => s.invert_toward(from, point),)* }
            }
        }
    };
}

shape_models! {
    /// Round hairs and tubes.
    Curves,
    /// The round wall of a cylinder.
    Cylinder,
    /// A flat disk.
    Disk,
    /// A sphere.
    Sphere,
    /// Triangles that share vertices.
    TriangleMesh,
}
