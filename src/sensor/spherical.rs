//! A camera that sees all around it.

use std::f32::consts::{PI, TAU};

use super::{CameraRay, SensorError, SensorModel};
use crate::math::{Mat3, Mat4, Vec2, Vec3, rotation_part};

/// A camera that maps all directions onto its film by longitude and latitude.
///
/// Its picture is the environment map of what stands around it: x / width = atan2(d.x, −d.z) / 2π and
/// y / height = acos(d.y) / π in the camera's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    origin: Vec3,
    axes: Mat3,
    /// Width and height of the film in pixels.
    film: Vec2,
}

impl Spherical {
    /// Makes the camera.
    ///
    /// - `to_world`: only its translation, rotation and mirrors count.
    /// - `film_size`: width and height of the full film in pixels.
    ///
    /// # Errors
    /// [`SensorError`], for numbers that describe none.
    pub fn new(to_world: Mat4, film_size: (u32, u32)) -> Result<Self, SensorError> {
        if film_size.0 == 0 || film_size.1 == 0 {
            return Err(SensorError::NoPixels);
        }
        Ok(Self {
            origin: to_world.transform_point3(Vec3::ZERO),
            axes: rotation_part(to_world).ok_or(SensorError::Shear)?,
            film: Vec2::new(film_size.0 as f32, film_size.1 as f32),
        })
    }
}

impl SensorModel for Spherical {
    /// Beyond the film's left and right it goes on around; beyond top and bottom down the other side.
    #[inline]
    fn camera_ray(&self, raster: Vec2, _origin: Vec3) -> CameraRay {
        let angles = raster / self.film * Vec2::new(TAU, PI);
        let (across, along) = angles.x.sin_cos();
        let (sin, cos) = angles.y.sin_cos();
        let local = Vec3::new(sin * across, cos, -sin * along);
        CameraRay {
            origin: self.origin,
            direction: (self.axes * local).normalize(),
            near: 0.0,
            far: f32::MAX,
        }
    }

    /// On the film: what it shows beyond its sides is the same once more.
    #[inline]
    fn raster_at(&self, _origin: Vec3, direction: Vec3) -> Option<Vec2> {
        let local = self.axes.transpose() * direction;
        let turn = local.x.atan2(-local.z) / TAU;
        let angle = local.x.hypot(local.z).atan2(local.y) / PI;
        Some(Vec2::new(turn.rem_euclid(1.0), angle) * self.film)
    }

    #[inline]
    fn pixels_per_steradian(&self, direction: Vec3) -> f32 {
        let sin = direction.cross(self.axes.y_axis).length();
        self.film.element_product() / (TAU * PI * sin.max(1e-12))
    }

    #[inline]
    fn clip(&self, _direction: Vec3) -> (f32, f32) {
        (0.0, f32::MAX)
    }

    #[inline]
    fn sample_lens(&self, _u: Vec2) -> Vec3 {
        self.origin
    }

    fn raster_range(&self) -> Option<Vec2> {
        Some(self.film)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Spherical {
        let turn = Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(-0.3);
        let to_world = Mat4::from_translation(Vec3::new(3.0, -1.0, 2.0)) * turn;
        Spherical::new(to_world, (200, 100)).unwrap()
    }

    #[test]
    fn the_middle_of_the_film_looks_along_z_and_its_top_up() {
        let camera = Spherical::new(Mat4::IDENTITY, (200, 100)).unwrap();
        for (raster, expected) in [
            ([100.0, 50.0], Vec3::Z),
            ([0.0, 50.0], Vec3::NEG_Z),
            ([50.0, 50.0], Vec3::X),
            ([30.0, 0.0], Vec3::Y),
            ([30.0, 100.0], Vec3::NEG_Y),
        ] {
            let ray = camera.camera_ray(Vec2::from_array(raster), Vec3::ZERO);
            assert!(ray.direction.distance(expected) < 1e-6, "{ray:?}");
        }
    }

    #[test]
    fn rasters_undo_rays_and_density_is_the_jacobian() {
        let camera = camera();
        for raster in [Vec2::new(3.0, 4.0), Vec2::new(180.0, 77.5)] {
            let at = |offset| camera.camera_ray(raster + offset, Vec3::ZERO).direction;
            let seen = camera.raster_at(Vec3::ZERO, at(Vec2::ZERO)).unwrap();
            assert!((seen - raster).length() < 1e-3, "{seen} is not {raster}");
            let along_x = at(Vec2::X * 0.5) - at(-Vec2::X * 0.5);
            let along_y = at(Vec2::Y * 0.5) - at(-Vec2::Y * 0.5);
            let product =
                camera.pixels_per_steradian(at(Vec2::ZERO)) * along_x.cross(along_y).length();
            assert!((product - 1.0).abs() < 1e-3, "{product}");
        }
    }

    #[test]
    fn the_sides_of_the_film_meet() {
        let camera = camera();
        let at = |x, y| camera.camera_ray(Vec2::new(x, y), Vec3::ZERO).direction;
        assert!(at(-1.5, 30.0).distance(at(198.5, 30.0)) < 1e-5);
        assert!(at(20.0, -2.0).distance(at(120.0, 2.0)) < 1e-5);
        let beyond = camera.raster_at(Vec3::ZERO, at(-1.5, 30.0)).unwrap();
        assert!((beyond - Vec2::new(198.5, 30.0)).length() < 1e-3);
    }

    #[test]
    fn numbers_without_a_camera_are_refused() {
        let flat = Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0));
        assert_eq!(Spherical::new(flat, (9, 9)), Err(SensorError::Shear));
        let empty = Spherical::new(Mat4::IDENTITY, (9, 0));
        assert_eq!(empty, Err(SensorError::NoPixels));
    }
}
