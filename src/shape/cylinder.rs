//! The round wall of a cylinder.

use std::f32::consts::TAU;

use super::affine::{axes_and_origin, check_circular, check_perpendicular, rows};
use super::{Derivatives, ShapeError, ShapeHit, ShapeModel, SurfacePoint};
use crate::accel::Geometry;
use crate::math::{AreaDensity, Frame, Mat4, Vec2, Vec3, warp};

/// An exact circular cylinder without caps.
///
/// Its `u` is the azimuth around the axis as a part of a turn, its `v` the place along the axis.
#[derive(Clone, Debug)]
pub struct Cylinder {
    base: Vec3,
    /// Two perpendicular radii and, perpendicular to both, the axis from base to top.
    axes: [Vec3; 3],
    radius: f32,
    /// 1, or −1 where normals point to the axis.
    side: f32,
    error: f32,
}

impl Cylinder {
    /// Makes what `to_world` makes of the cylinder around the segment from `start` to `end`.
    ///
    /// Normals point away from the axis, also where `to_world` mirrors. `u` starts at the tangent
    /// of [`Frame::around`] the segment's direction: at x for a segment along z.
    ///
    /// # Errors
    /// [`ShapeError::Stretched`] where the wall would no longer be a right circular cylinder,
    /// [`ShapeError::BadRadius`], [`ShapeError::Flat`] where start and end are one point,
    /// [`ShapeError::NotFinite`].
    pub fn new(start: Vec3, end: Vec3, radius: f32, to_world: Mat4) -> Result<Self, ShapeError> {
        axes_and_origin(to_world)?;
        if !(start.is_finite() && end.is_finite() && radius.is_finite()) {
            return Err(ShapeError::NotFinite);
        }
        if radius <= 0.0 {
            return Err(ShapeError::BadRadius);
        }
        let along = end - start;
        let frame = Frame::around(along.try_normalize().ok_or(ShapeError::Flat)?);
        let to_world = to_world.as_dmat4();
        let moved = |v: Vec3| to_world.transform_vector3(v.as_dvec3());
        let (x, y, z) = (moved(frame.tangent), moved(frame.bitangent), moved(along));
        check_circular(x, y)?;
        check_perpendicular(x, z)?;
        check_perpendicular(y, z)?;
        // Perpendicular to the last digit, in the handedness of the map, so that the tracer's
        // wall, which comes from these axes, and ours are one.
        let z_unit = z.try_normalize().ok_or(ShapeError::Flat)?;
        let x_unit = (x - z_unit * x.dot(z_unit)).normalize();
        let y_unit = z_unit.cross(x_unit);
        let y_unit = if y_unit.dot(y) < 0.0 { -y_unit } else { y_unit };
        let world_radius = f64::from(radius) * (x.length() * y.length()).sqrt();
        let base = to_world.transform_point3(start.as_dvec3());
        let extent = base.abs().max((base + z).abs()).max_element() + world_radius;
        if !(extent as f32).is_normal() {
            return Err(ShapeError::NotFinite);
        }
        let radii = [x_unit, y_unit].map(|axis| (axis * world_radius).as_vec3());
        Ok(Self {
            base: base.as_vec3(),
            axes: [radii[0], radii[1], z.as_vec3()],
            radius: world_radius as f32,
            side: 1.0,
            error: SurfacePoint::error_bound(extent as f32),
        })
    }

    /// Turns the normals to the other side.
    pub fn flip_normals(&mut self) {
        self.side = -self.side;
    }

    /// The map, by rows, that makes this cylinder of the one of radius 1 around the z axis from
    /// z = 0 to z = 1.
    pub fn to_world(&self) -> [[f32; 4]; 3] {
        rows(self.axes, self.base)
    }

    /// The point at a unit direction of the base circle and a place along the axis.
    #[inline]
    fn point(&self, around: Vec2, along: f32) -> SurfacePoint {
        let [x, y, z] = self.axes;
        let outwards = x * around.x + y * around.y;
        let normal = outwards * (self.side / self.radius);
        SurfacePoint {
            position: self.base + outwards + z * along,
            geometric_normal: normal,
            shading_normal: normal,
            derivatives: Derivatives::new(normal, (y * around.x - x * around.y) * TAU, z),
            uv: Vec2::new(warp::turn(around), along),
            error: self.error,
        }
    }
}

impl ShapeModel for Cylinder {
    fn geometry(&self) -> Geometry {
        Geometry::Cylinder(self.to_world())
    }

    // Out of line: paths have the code of triangles alone right where they need it.
    #[inline(never)]
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
        let offset = hit.position - self.base;
        let [x, y, z] = self.axes;
        let around = Vec2::new(x.dot(offset), y.dot(offset)).normalize_or(Vec2::X);
        let along = z.dot(offset) / z.length_squared();
        self.point(around, along.clamp(0.0, 1.0))
    }

    fn area(&self) -> f64 {
        f64::from(TAU * self.radius) * f64::from(self.axes[2].length())
    }

    #[inline(never)]
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
        let (sin, cos) = (TAU * u.x).sin_cos();
        let density = AreaDensity((1.0 / self.area()) as f32);
        (self.point(Vec2::new(cos, sin), u.y), density)
    }

    fn invert_area(&self, point: &SurfacePoint) -> Option<Vec2> {
        Some(warp::into_unit_square(point.uv))
    }
}
