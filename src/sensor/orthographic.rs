//! A camera whose rays are parallel.

use super::{CameraRay, SensorError, SensorModel, perspective};
use crate::math::{Mat3, Mat4, Vec2, Vec3};

/// A camera that looks along parallel rays: things far away are as large as near ones.
///
/// Its rays start on its film, which stands for a lens of one point for each raster position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    /// World-space middle of the film.
    origin: Vec3,
    /// Unit axes: to the left, up, and along the rays.
    axes: Mat3,
    near: f32,
    far: f32,
    /// Raster position of the film's middle.
    centre: Vec2,
    /// Width and height of a pixel in m.
    pixel: Vec2,
}

impl Orthographic {
    /// Makes the camera.
    ///
    /// - `to_world`: from a camera that looks along +z from z = 0, with +x to the left and +y up, and
    ///   whose film spans −1 to 1 in x. Scales in x and y change what it spans.
    /// - `near`, `far`: distances of the clip planes from the film, in m.
    /// - `film_size`: width and height of the full film in pixels.
    ///
    /// # Errors
    /// [`SensorError`], for numbers that describe none.
    pub fn new(
        to_world: Mat4,
        (near, far): (f32, f32),
        film_size: (u32, u32),
    ) -> Result<Self, SensorError> {
        if !(near >= 0.0 && far > near) {
            return Err(SensorError::ClipPlanes { near, far });
        }
        if film_size.0 == 0 || film_size.1 == 0 {
            return Err(SensorError::NoPixels);
        }
        let map = Mat3::from_mat4(to_world);
        let axes = perspective::rotation(map).ok_or(SensorError::Shear)?;
        let film = Vec2::new(film_size.0 as f32, film_size.1 as f32);
        let scale = Vec2::new(map.x_axis.length(), map.y_axis.length());
        Ok(Self {
            origin: to_world.transform_point3(Vec3::ZERO),
            axes,
            near,
            far,
            centre: 0.5 * film,
            pixel: 2.0 * scale / film.x,
        })
    }

    /// The point of the film at coordinates in m.
    #[inline]
    fn on_film(&self, offset: Vec2) -> Vec3 {
        self.origin + self.axes * offset.extend(0.0)
    }

    /// Coordinates on the film, in m, of a point or of what lies before it.
    #[inline]
    fn offset(&self, point: Vec3) -> Vec2 {
        (self.axes.transpose() * (point - self.origin)).truncate()
    }
}

impl SensorModel for Orthographic {
    #[inline]
    fn camera_ray(&self, raster: Vec2, _origin: Vec3) -> CameraRay {
        CameraRay {
            origin: self.on_film((self.centre - raster) * self.pixel),
            direction: self.axes.z_axis,
            near: self.near,
            far: self.far,
        }
    }

    #[inline]
    fn raster_at(&self, origin: Vec3, direction: Vec3) -> Option<Vec2> {
        let is_before = self.axes.z_axis.dot(direction) > 0.0;
        is_before.then(|| self.centre - self.offset(origin) / self.pixel)
    }

    /// Here the number of pixels for each m² across the rays.
    #[inline]
    fn pixels_per_steradian(&self, direction: Vec3) -> f32 {
        if self.axes.z_axis.dot(direction) > 0.0 {
            1.0 / self.pixel.element_product()
        } else {
            0.0
        }
    }

    #[inline]
    fn has_parallel_rays(&self) -> bool {
        true
    }

    #[inline]
    fn spread(&self, _distance_squared: f32) -> f32 {
        1.0
    }

    #[inline]
    fn clip(&self, direction: Vec3) -> (f32, f32) {
        if self.axes.z_axis.dot(direction) > 0.0 {
            (self.near, self.far)
        } else {
            (f32::INFINITY, 0.0)
        }
    }

    #[inline]
    fn sample_lens(&self, _u: Vec2) -> Vec3 {
        self.origin
    }

    #[inline]
    fn lens_before(&self, point: Vec3, _origin: Vec3) -> Vec3 {
        self.on_film(self.offset(point))
    }

    fn is_on_lens(&self, origin: Vec3) -> bool {
        let off = self.axes.z_axis.dot(origin - self.origin).abs();
        off <= 1e-3 * (1.0 + self.origin.length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Orthographic {
        let turn = Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(-0.3);
        let to_world = Mat4::from_translation(Vec3::new(3.0, -1.0, 2.0)) * turn;
        let scaled = to_world * Mat4::from_scale(Vec3::new(2.0, 2.0, 5.0));
        Orthographic::new(scaled, (0.5, 50.0), (200, 100)).unwrap()
    }

    const RASTERS: [Vec2; 3] = [
        Vec2::new(3.0, 4.0),
        Vec2::new(180.0, 77.5),
        Vec2::new(-4.0, 101.0),
    ];

    #[test]
    fn the_film_spans_minus_one_to_one_with_x_to_the_left() {
        let camera = Orthographic::new(Mat4::IDENTITY, (0.0, 9.0), (200, 100)).unwrap();
        let ray = camera.camera_ray(Vec2::ZERO, Vec3::ZERO);
        assert_eq!(
            (ray.origin, ray.direction),
            (Vec3::new(1.0, 0.5, 0.0), Vec3::Z)
        );
        assert_eq!((ray.near, ray.far), (0.0, 9.0));
    }

    #[test]
    fn rasters_undo_rays_and_density_is_the_jacobian() {
        let camera = camera();
        for raster in RASTERS {
            let ray = camera.camera_ray(raster, Vec3::ZERO);
            let seen = camera.raster_at(ray.origin, ray.direction).unwrap();
            assert!((seen - raster).length() < 1e-3, "{seen} is not {raster}");
            let far_away = ray.origin + ray.direction * 7.0;
            let lens = camera.lens_before(far_away, Vec3::ZERO);
            assert!(lens.distance(ray.origin) < 1e-5 && camera.is_on_lens(lens));
            assert!(!camera.is_on_lens(far_away));
            let at = |offset| camera.camera_ray(raster + offset, Vec3::ZERO).origin;
            let area = (at(Vec2::X) - at(Vec2::ZERO)).cross(at(Vec2::Y) - at(Vec2::ZERO));
            let pixels = camera.pixels_per_steradian(ray.direction) / camera.spread(9.0);
            assert!((pixels * area.length() - 1.0).abs() < 1e-3);
            assert_eq!(camera.raster_at(ray.origin, -ray.direction), None);
            assert_eq!(camera.pixels_per_steradian(-ray.direction), 0.0);
        }
    }

    #[test]
    fn numbers_without_a_camera_are_refused() {
        let made = |to_world, clip, size| Orthographic::new(to_world, clip, size).is_ok();
        assert!(made(Mat4::IDENTITY, (0.0, 1.0), (9, 9)));
        assert!(!made(Mat4::IDENTITY, (1.0, 1.0), (9, 9)));
        assert!(!made(Mat4::IDENTITY, (0.0, 1.0), (0, 9)));
        let mut sheared = Mat4::IDENTITY;
        sheared.y_axis.x = 0.5;
        assert!(!made(sheared, (0.0, 1.0), (9, 9)));
    }
}
