//! A flat disk.

use std::f32::consts::TAU;
use std::f64::consts::PI;

use super::affine::{axes_and_origin, rows};
use super::{Derivatives, ShapeError, ShapeHit, ShapeModel, SurfacePoint};
use crate::accel::Geometry;
use crate::math::{AreaDensity, Mat4, Vec2, Vec3, warp};

/// An exact disk, or the ellipse that a transform makes of it.
///
/// Its `u` is the distance from the centre, 1 at the rim; its `v` is the angle from the object's x
/// axis towards y, as a part of a turn.
#[derive(Clone, Debug)]
pub struct Disk {
    centre: Vec3,
    /// Images of the object's x and y axis: from the centre to the rim.
    axes: [Vec3; 2],
    /// What an offset from the centre is multiplied by to give its coordinates along `axes`.
    duals: [Vec3; 2],
    /// Image of the object's z axis, perpendicular to the others.
    normal: Vec3,
    /// 1, or −1 where the front is turned to −`normal`.
    side: f32,
    area: f64,
    error: f32,
}

impl Disk {
    /// Makes what `to_world` makes of the unit disk around the origin of the plane z = 0.
    ///
    /// Any stretch and shear is exact: an affine map changes all areas of one plane alike. The
    /// front is the side of the object's +z.
    ///
    /// # Errors
    /// [`ShapeError::Flat`] where no area is left, [`ShapeError::NotFinite`].
    pub fn new(to_world: Mat4) -> Result<Self, ShapeError> {
        let ([x, y, z], centre) = axes_and_origin(to_world)?;
        let cross = x.cross(y);
        let cross_squared = cross.length_squared();
        let area = PI * cross_squared.sqrt();
        // A squeeze along z alone does no harm; then x × y says which side is the front.
        let normal = if cross.dot(z) < 0.0 { -cross } else { cross };
        let duals = [y.cross(cross), cross.cross(x)].map(|d| (d / cross_squared).as_vec3());
        if !(area > 0.0 && duals.iter().all(|d| d.is_finite())) {
            return Err(ShapeError::Flat);
        }
        let extent = centre.abs() + x.abs() + y.abs();
        Ok(Self {
            centre: centre.as_vec3(),
            axes: [x.as_vec3(), y.as_vec3()],
            duals,
            normal: normal.normalize().as_vec3(),
            side: 1.0,
            area,
            error: SurfacePoint::error_bound(extent.max_element() as f32),
        })
    }

    /// Turns the normal to the other side.
    pub fn flip_normals(&mut self) {
        self.side = -self.side;
    }

    /// The map, by rows, that makes this disk of the unit disk around the origin of z = 0.
    pub fn to_world(&self) -> [[f32; 4]; 3] {
        let [x, y] = self.axes;
        let size = (self.area / PI).sqrt() as f32;
        rows([x, y, self.normal * size], self.centre)
    }

    /// Object coordinates of a world-space position on the disk.
    #[inline]
    fn coordinates(&self, position: Vec3) -> Vec2 {
        let offset = position - self.centre;
        let [x, y] = self.duals;
        Vec2::new(x.dot(offset), y.dot(offset))
    }

    /// The point at object coordinates `p` in the unit disk.
    #[inline]
    fn point(&self, p: Vec2) -> SurfacePoint {
        let [x, y] = self.axes;
        let from_centre = p.length().min(1.0);
        // The centre has no direction of growing radius; the x axis is as good as any.
        let outwards = p.normalize_or(Vec2::X);
        let by_u = x * outwards.x + y * outwards.y;
        let by_v = (y * p.x - x * p.y) * TAU;
        let normal = self.normal * self.side;
        SurfacePoint {
            position: self.centre + x * p.x + y * p.y,
            geometric_normal: normal,
            shading_normal: normal,
            derivatives: Derivatives::new(normal, by_u, by_v),
            uv: Vec2::new(from_centre, warp::turn(p)),
            error: self.error,
        }
    }
}

impl ShapeModel for Disk {
    fn geometry(&self) -> Geometry {
        Geometry::Disk(self.to_world())
    }

    // Out of line: paths have the code of triangles alone right where they need it.
    #[inline(never)]
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
        self.point(self.coordinates(hit.position))
    }

    fn area(&self) -> f64 {
        self.area
    }

    #[inline(never)]
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
        let density = AreaDensity((1.0 / self.area) as f32);
        (self.point(warp::uniform_disk(u)), density)
    }

    fn invert_area(&self, point: &SurfacePoint) -> Option<Vec2> {
        let u = warp::uniform_disk_inverse(self.coordinates(point.position));
        Some(warp::into_unit_square(u))
    }
}
