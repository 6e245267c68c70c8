//! Shapes: where surfaces are, how they are parametrised, how points on them are sampled.
//!
//! The tracer says *that* a ray met a primitive; a shape says what is there. Rectangles and cubes are
//! triangle meshes; spheres, disks and cylinders are exact.

pub mod mesh;
mod surface;
mod triangle_mesh;

pub use surface::SurfacePoint;
pub use triangle_mesh::TriangleMesh;

use crate::math::{AreaDensity, SolidAngleDensity, Vec2, Vec3};

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

/// What a shape can answer.
pub trait ShapeModel {
    /// Everything about the point that a ray met.
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint;

    /// Surface area in m².
    fn area(&self) -> f64;

    /// Samples a point uniformly by area.
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity);

    /// Samples a point that may be seen from `from`; the density is that of its direction.
    ///
    /// The point can be occluded or face away. `None` where there is no density to give: at the
    /// shape's own surface, or for a point that is seen edge-on.
    fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAngleDensity)> {
        let (point, density) = self.sample_area(u);
        let edge = point.position - from;
        let distance_squared = edge.length_squared();
        let cos = point.geometric_normal.dot(edge) / distance_squared.sqrt();
        Some((point, density.to_solid_angle(cos, distance_squared)?))
    }

    /// Density with which [`ShapeModel::sample_toward`] makes the direction to `point`.
    fn density_toward(&self, from: Vec3, point: &SurfacePoint) -> SolidAngleDensity {
        let edge = point.position - from;
        let distance_squared = edge.length_squared();
        let cos = point.geometric_normal.dot(edge) / distance_squared.sqrt();
        let density = AreaDensity((1.0 / self.area()) as f32);
        density
            .to_solid_angle(cos, distance_squared)
            .unwrap_or_default()
    }
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
            #[inline]
            fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
                match self { $(Self::$model(s) => s.surface_at(hit),)* }
            }
            #[inline]
            fn area(&self) -> f64 {
                match self { $(Self::$model(s) => s.area(),)* }
            }
            #[inline]
            fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
                match self { $(Self::$model(s) => s.sample_area(u),)* }
            }
            #[inline]
            fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAngleDensity)> {
                match self { $(Self::$model(s) => s.sample_toward(from, u),)* }
            }
            #[inline]
            fn density_toward(&self, from: Vec3, point: &SurfacePoint) -> SolidAngleDensity {
                match self { $(Self::$model(s) => s.density_toward(from, point),)* }
            }
        }
    };
}

shape_models! {
    /// Triangles that share vertices.
    TriangleMesh,
}
