//! A sphere.

use std::f32::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use super::affine::{axes_and_origin, check_circular};
use super::{Derivatives, ShapeError, ShapeHit, ShapeModel, SurfacePoint, as_direction};
use crate::accel::Geometry;
use crate::math::{AreaDensity, Frame, Mat3, Mat4, SolidAngleDensity, Vec2, Vec3, angle_of, warp};

/// An exact sphere.
///
/// Its `u` is the azimuth around the object's z axis from x towards y, as a part of a turn; its `v`
/// is the angle from the z axis over π.
#[derive(Clone, Debug)]
pub struct Sphere {
    centre: Vec3,
    radius: f32,
    /// From the object's axes to the world's, orthonormal.
    axes: Mat3,
    /// 1, or −1 where normals point to the centre.
    side: f32,
    /// Bound on the error of positions, in m.
    error: f32,
    /// Whether points know their coordinates.
    coordinates: bool,
    /// Whether they know how they change with them.
    derivatives: bool,
}

impl Sphere {
    /// Makes the sphere that `to_world` makes of the one around `centre` with `radius`.
    ///
    /// Normals point outwards, also where `to_world` mirrors.
    ///
    /// Differs: Mitsuba 3.9.1 turns the normals of a mirrored sphere inwards.
    ///
    /// # Errors
    /// [`ShapeError::Stretched`] where an ellipsoid would come out, [`ShapeError::BadRadius`],
    /// [`ShapeError::Flat`], [`ShapeError::NotFinite`].
    pub fn new(centre: Vec3, radius: f32, to_world: Mat4) -> Result<Self, ShapeError> {
        let ([x, y, z], _) = axes_and_origin(to_world)?;
        if !(centre.is_finite() && radius.is_finite()) {
            return Err(ShapeError::NotFinite);
        }
        if radius <= 0.0 {
            return Err(ShapeError::BadRadius);
        }
        check_circular(x, y)?;
        check_circular(y, z)?;
        check_circular(z, x)?;
        let scale = (x.length() * y.length() * z.length()).cbrt();
        let unit = |axis: DVec3| axis.normalize().as_vec3();
        let centre = to_world.transform_point3(centre);
        let radius = (scale * f64::from(radius)) as f32;
        let sphere = Self {
            centre,
            radius,
            axes: Mat3::from_cols(unit(x), unit(y), unit(z)),
            side: 1.0,
            error: SurfacePoint::error_bound(centre.abs().max_element() + radius),
            coordinates: true,
            derivatives: true,
        };
        // The checked numbers may still have left the range of f32 together.
        if !(sphere.centre.is_finite() && sphere.radius.is_normal()) {
            return Err(ShapeError::NotFinite);
        }
        Ok(sphere)
    }

    /// Turns the normals to the other side.
    pub fn flip_normals(&mut self) {
        self.side = -self.side;
    }

    /// Makes points know no longer how they change with the coordinates, for speed: as isotropic materials
    /// without bumps have it. Shading frames then do not follow the coordinates.
    pub fn ignore_coordinates(&mut self) {
        self.derivatives = false;
    }

    /// Leaves the coordinates out of points, too, for speed: where neither the material nor the light there
    /// asks for them. [`ShapeModel::coordinates`] still knows them. Not for spheres of groups: a point that an
    /// instance has placed says no longer where on the sphere it was.
    pub fn omit_coordinates(&mut self) {
        self.coordinates = false;
        self.derivatives = false;
    }

    /// World-space centre.
    pub fn centre(&self) -> Vec3 {
        self.centre
    }

    /// Radius in m.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// The point in the unit direction `outward` from the centre.
    #[inline]
    fn point(&self, outward: Vec3) -> SurfacePoint {
        let normal = outward * self.side;
        let mut point = SurfacePoint {
            geometric_normal: normal,
            shading_normal: normal,
            error: self.error,
            ..SurfacePoint::bare(self.centre + outward * self.radius)
        };
        if self.coordinates {
            point.uv = self.coordinates_toward(outward);
        }
        if self.derivatives {
            let [by_u, by_v] = self.derivatives_toward(outward);
            point.derivatives = Derivatives::new(normal, by_u, by_v);
        }
        point
    }

    /// Surface coordinates in the unit direction `outward` from the centre.
    fn coordinates_toward(&self, outward: Vec3) -> Vec2 {
        let local = self.axes.transpose() * outward;
        let from_axis = local.truncate().length();
        Vec2::new(
            warp::turn(local.truncate()),
            angle_of(local.z, from_axis) * FRAC_1_PI,
        )
    }

    /// ∂p/∂u and ∂p/∂v in the unit direction `outward` from the centre.
    fn derivatives_toward(&self, outward: Vec3) -> [Vec3; 2] {
        let local = self.axes.transpose() * outward;
        let from_axis = local.truncate().length();
        let azimuth = local.truncate().normalize_or(Vec2::X);
        let by_u = self.axes * Vec3::new(-local.y, local.x, 0.0) * (TAU * self.radius);
        let by_v = self.axes * (azimuth * local.z).extend(-from_axis) * (PI * self.radius);
        [by_u, by_v]
    }

    /// The cone in which `from` sees the sphere; `None` from inside.
    #[inline]
    fn cone(&self, from: Vec3) -> Option<Cone> {
        // In f64, so that it holds from right above the surface and from very far away.
        let to_centre = self.centre.as_dvec3() - from.as_dvec3();
        let distance_squared = to_centre.length_squared();
        let radius_squared = f64::from(self.radius).powi(2);
        let tangent_squared = distance_squared - radius_squared;
        if tangent_squared <= 0.0 {
            return None;
        }
        let distance = distance_squared.sqrt();
        let cos = tangent_squared.sqrt() / distance;
        let one_minus_cos = radius_squared / distance_squared / (1.0 + cos);
        Some(Cone {
            axis: to_centre / distance,
            distance,
            one_minus_cos: one_minus_cos as f32,
        })
    }
}

/// The cone in which a sphere is seen.
struct Cone {
    /// Unit direction to the centre.
    axis: DVec3,
    /// Distance to the centre.
    distance: f64,
    /// One minus the cosine of the half angle.
    one_minus_cos: f32,
}

impl Cone {
    fn density(&self) -> Option<SolidAngleDensity> {
        let density = warp::uniform_cone_density(self.one_minus_cos);
        density.is_finite().then_some(SolidAngleDensity(density))
    }

    /// Outward normal of the nearer point of a sphere in the direction `local` of the cone's frame.
    fn normal(&self, local: Vec3, radius: f64) -> Vec3 {
        let sin_squared = local.truncate().as_dvec2().length_squared();
        let cos = f64::from(local.z);
        let half_chord_squared = radius * radius - self.distance * self.distance * sin_squared;
        let distance = self.distance * cos - half_chord_squared.max(0.0).sqrt();
        let frame = Frame::around(self.axis.as_vec3());
        let across = frame.tangent * local.x + frame.bitangent * local.y;
        let sideways = across.as_dvec3() * (distance / radius);
        let towards = self.axis * ((self.distance - distance * cos) / radius);
        (sideways - towards).normalize().as_vec3()
    }
}

impl ShapeModel for Sphere {
    fn geometry(&self) -> Geometry {
        Geometry::Sphere {
            centre: self.centre,
            radius: self.radius,
        }
    }

    // Out of line: paths have the code of triangles alone right where they need it.
    #[inline(never)]
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
        self.point((hit.position - self.centre).normalize_or(Vec3::Z))
    }

    fn coordinates(&self, point: &SurfacePoint, _primitive: u32) -> Vec2 {
        if self.coordinates {
            return point.uv;
        }
        self.coordinates_toward(point.geometric_normal * self.side)
    }

    fn area(&self) -> f64 {
        f64::from(4.0 * PI) * f64::from(self.radius).powi(2)
    }

    #[inline(never)]
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
        let outward = self.axes * warp::uniform_sphere(u);
        let density = AreaDensity((1.0 / self.area()) as f32);
        (self.point(outward.normalize()), density)
    }

    /// Uniform in the cone of sight from outside, by area from inside.
    ///
    /// Source: Shirley, Wang & Zimmerman 1996, Sec. 3.2.
    #[inline(never)]
    fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<(SurfacePoint, SolidAngleDensity)> {
        let Some(cone) = self.cone(from) else {
            let (point, density) = self.sample_area(u);
            return Some((point, as_direction(density, from, &point)?));
        };
        let local = warp::uniform_cone(u, cone.one_minus_cos);
        let outward = cone.normal(local, f64::from(self.radius));
        Some((self.point(outward), cone.density()?))
    }

    fn density_toward(&self, from: Vec3, point: &SurfacePoint) -> SolidAngleDensity {
        let Some(cone) = self.cone(from) else {
            let density = AreaDensity((1.0 / self.area()) as f32);
            return as_direction(density, from, point).unwrap_or_default();
        };
        // The cone makes the nearer point of each direction only.
        let outward = point.geometric_normal * self.side;
        if outward.dot(from - point.position) <= 0.0 {
            return SolidAngleDensity::ZERO;
        }
        cone.density().unwrap_or_default()
    }

    fn invert_area(&self, point: &SurfacePoint) -> Option<Vec2> {
        let outward = point.geometric_normal * self.side;
        let u = warp::uniform_sphere_inverse(self.axes.transpose() * outward);
        Some(warp::into_unit_square(u))
    }

    fn invert_toward(&self, from: Vec3, point: &SurfacePoint) -> Option<Vec2> {
        let Some(cone) = self.cone(from) else {
            return self.invert_area(point);
        };
        let outward = point.geometric_normal * self.side;
        if outward.dot(from - point.position) <= 0.0 {
            return None;
        }
        // From the centre outwards: near the rim a rounded position says little about the direction.
        let centre = self.centre.as_dvec3() - from.as_dvec3();
        let direction = (centre + outward.as_dvec3() * f64::from(self.radius)).normalize();
        let local = Frame::around(cone.axis.as_vec3()).to_local(direction.as_vec3());
        let u = warp::uniform_cone_inverse(local.0, cone.one_minus_cos);
        Some(warp::into_unit_square(u))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_know_the_coordinates_that_they_leave_out() {
        let turn = Mat4::from_rotation_x(0.4);
        let mut full = Sphere::new(Vec3::new(0.3, -1.0, 2.0), 0.7, turn).expect("a sphere");
        let mut bare = full.clone();
        bare.omit_coordinates();
        for _side in 0..2 {
            for place in 1..100 {
                let u = Vec2::new(place as f32 * 0.01, (place * 37 % 100) as f32 * 0.01);
                let (known, left_out) = (full.sample_area(u).0, bare.sample_area(u).0);
                assert_ne!(known.uv, Vec2::ZERO);
                assert_eq!(left_out.uv, Vec2::ZERO);
                assert_eq!(left_out.derivatives, Derivatives::NONE);
                assert_eq!(left_out.position, known.position);
                assert_eq!(bare.coordinates(&left_out, 0), known.uv);
                assert_eq!(full.coordinates(&known, 0), known.uv);
            }
            full.flip_normals();
            bare.flip_normals();
        }
    }
}
