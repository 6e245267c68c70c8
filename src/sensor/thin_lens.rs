//! A camera with a lens.

use super::{CameraRay, Perspective, PerspectiveSettings, SensorError, SensorModel};
use crate::math::{Vec2, Vec3, warp};

/// A camera with an ideal thin lens: what lies in one plane is sharp, all else is not.
///
/// It sees that plane exactly as the pinhole in the middle of its lens does. The lens is a disk of
/// the plane through that pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    pinhole: Perspective,
    /// Radius of the lens in m.
    radius: f32,
    /// Distance of the plane in focus along the optical axis, in m.
    focus_distance: f32,
}

impl ThinLens {
    /// Makes the camera.
    ///
    /// - `settings`: of the pinhole in the middle of the lens. Scales in its transform have no
    ///   effect, not on the lens either.
    /// - `aperture_radius`: radius of the lens in m.
    /// - `focus_distance`: distance of the plane in focus along the optical axis, in m; can be
    ///   infinite.
    ///
    /// # Errors
    /// [`SensorError`], for numbers that describe none; an aperture without area is one.
    pub fn new(
        settings: PerspectiveSettings,
        aperture_radius: f32,
        focus_distance: f32,
    ) -> Result<Self, SensorError> {
        if !(aperture_radius > 0.0 && aperture_radius.is_finite()) {
            return Err(SensorError::ApertureRadius(aperture_radius));
        }
        if focus_distance.is_nan() || focus_distance <= 0.0 {
            return Err(SensorError::FocusDistance(focus_distance));
        }
        Ok(Self {
            pinhole: Perspective::new(settings)?,
            radius: aperture_radius,
            focus_distance,
        })
    }

    /// How much less a ray from this point of the lens slopes to the optical axis than that from
    /// the middle to the same point in focus.
    #[inline]
    fn slope_lost(&self, origin: Vec3) -> Vec2 {
        self.lens_coordinates(origin) * (self.radius / self.focus_distance)
    }
}

impl SensorModel for ThinLens {
    #[inline]
    fn camera_ray(&self, raster: Vec2, origin: Vec3) -> CameraRay {
        let slope = self.pinhole.on_plane(raster) - self.slope_lost(origin);
        self.pinhole.ray(origin, slope)
    }

    #[inline]
    fn raster_at(&self, origin: Vec3, direction: Vec3) -> Option<Vec2> {
        let local = self.pinhole.local(direction);
        (local.z > 0.0).then(|| {
            let slope = local.truncate() / local.z;
            self.pinhole.raster(slope + self.slope_lost(origin))
        })
    }

    #[inline]
    fn pixels_per_steradian(&self, direction: Vec3) -> f32 {
        self.pinhole.pixels_per_steradian(direction)
    }

    #[inline]
    fn clip(&self, direction: Vec3) -> (f32, f32) {
        self.pinhole.clip(direction)
    }

    #[inline]
    fn has_lens(&self) -> bool {
        true
    }

    #[inline]
    fn sample_lens(&self, u: Vec2) -> Vec3 {
        self.lens_point(warp::uniform_disk(u))
    }

    fn invert_lens(&self, origin: Vec3, _spare: Vec2) -> Vec2 {
        let u = warp::uniform_disk_inverse(self.lens_coordinates(origin));
        warp::into_unit_square(u)
    }

    #[inline]
    fn lens_point(&self, coordinates: Vec2) -> Vec3 {
        self.pinhole.beside(coordinates * self.radius)
    }

    #[inline]
    fn lens_coordinates(&self, origin: Vec3) -> Vec2 {
        let offset = self.pinhole.local(origin - self.pinhole.origin());
        offset.truncate() / self.radius
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Transform;
    use crate::sensor::FieldOfViewAxis;

    fn settings() -> PerspectiveSettings {
        let (from, to) = (DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO);
        let to_world = Transform::look_at(from, to, Some(DVec3::Y)).unwrap();
        PerspectiveSettings {
            to_world: to_world.matrix(),
            field_of_view: 40.0,
            axis: FieldOfViewAxis::X,
            near: 0.1,
            far: 100.0,
            principal_point_offset: Vec2::ZERO,
            film_size: (200, 100),
        }
    }

    fn camera() -> ThinLens {
        ThinLens::new(settings(), 0.25, 3.0).unwrap()
    }

    const RASTERS: [Vec2; 3] = [
        Vec2::new(3.0, 4.0),
        Vec2::new(180.0, 77.5),
        Vec2::new(-4.0, 101.0),
    ];

    const LENS: [Vec2; 4] = [
        Vec2::ZERO,
        Vec2::new(0.3, -0.6),
        Vec2::new(-1.0, 0.0),
        Vec2::new(0.6, 0.8),
    ];

    /// Camera, raster position and numbers for the lens; origin and direction of its ray.
    type MitsubaRay = (usize, [f32; 2], [f32; 2], [f32; 3], [f32; 3]);

    /// What `sample_ray` of Mitsuba 3.9.1 returns (`scalar_rgb`, film of 200 × 100 pixels, near clip
    /// plane at 1e-9).
    const RAYS: [MitsubaRay; 6] = [
        (
            0,
            [20.0, 20.0],
            [0.5, 0.5],
            [1.0, 2.0, 3.0],
            [-0.536_604, -0.422_291, -0.730_566],
        ),
        (
            0,
            [20.0, 20.0],
            [0.9, 0.3],
            [0.837_643, 1.935_315, 3.097_243],
            [-0.490_745, -0.406_522, -0.770_655],
        ),
        (
            0,
            [160.0, 55.0],
            [0.1, 0.6],
            [1.179_496, 2.032_976, 2.918_184],
            [-0.115_443, -0.554_180, -0.824_353],
        ),
        (
            0,
            [100.0, 50.0],
            [0.25, 0.75],
            [1.068_912, 2.074_702, 2.927_228],
            [-0.289_980, -0.558_938, -0.776_852],
        ),
        (
            1,
            [150.0, 80.0],
            [0.2, 0.4],
            [1.345_638, 1.921_253, 2.937_285],
            [0.064_400, -0.662_699, -0.746_112],
        ),
        (
            2,
            [150.0, 80.0],
            [0.2, 0.4],
            [1.144_016, 1.967_189, 2.973_869],
            [-0.075_930, -0.613_007, -0.786_420],
        ),
    ];

    #[test]
    fn rays_are_those_of_mitsuba() {
        let other = PerspectiveSettings {
            axis: FieldOfViewAxis::Y,
            ..settings()
        };
        let cameras = [
            camera(),
            ThinLens::new(other, 0.6, 7.5).unwrap(),
            ThinLens::new(settings(), 0.25, settings().far).unwrap(),
        ];
        for (camera, raster, u, origin, direction) in RAYS {
            let raster = Vec2::from_array(raster);
            let ray = cameras[camera].sample_ray(raster, Vec2::from_array(u));
            let origin_error = ray.origin - Vec3::from_array(origin);
            let direction_error = ray.direction - Vec3::from_array(direction);
            assert!(
                origin_error.length() < 2e-6 && direction_error.length() < 2e-6,
                "{ray:?} is not {origin:?} {direction:?}"
            );
        }
    }

    #[test]
    fn the_plane_in_focus_is_seen_as_by_a_pinhole() {
        let pinhole = Perspective::new(settings()).unwrap();
        for raster in RASTERS {
            let from_middle = pinhole.sample_ray(raster, Vec2::ZERO);
            let focus = from_middle.origin + from_middle.direction * (30.0 * from_middle.near);
            for coordinates in LENS {
                let ray = camera().camera_ray(raster, camera().lens_point(coordinates));
                let missed = (focus - ray.origin).cross(ray.direction).length();
                assert!(missed < 1e-5, "{ray:?} misses {focus} by {missed}");
            }
        }
    }

    #[test]
    fn rasters_and_lens_coordinates_undo_rays() {
        let camera = camera();
        for (raster, coordinates) in RASTERS.into_iter().flat_map(|r| LENS.map(|l| (r, l))) {
            let ray = camera.camera_ray(raster, camera.lens_point(coordinates));
            let back = camera.lens_coordinates(ray.origin);
            assert!(
                (back - coordinates).length() < 1e-5,
                "{back} is not {coordinates}"
            );
            let seen = camera.raster_at(ray.origin, ray.direction).unwrap();
            assert!((seen - raster).length() < 1e-3, "{seen} is not {raster}");
            assert_eq!(camera.raster_at(ray.origin, -ray.direction), None);
            let (near, far) = camera.clip(ray.direction);
            assert!((near / ray.near - 1.0).abs() < 1e-5 && (far / ray.far - 1.0).abs() < 1e-5);
            assert!(camera.has_lens());
        }
    }

    #[test]
    fn density_is_the_jacobian_at_each_point_of_the_lens() {
        let camera = camera();
        for (raster, coordinates) in RASTERS.into_iter().flat_map(|r| LENS.map(|l| (r, l))) {
            let origin = camera.lens_point(coordinates);
            let at = |offset| camera.camera_ray(raster + offset, origin).direction;
            let along_x = at(Vec2::X * 0.5) - at(-Vec2::X * 0.5);
            let along_y = at(Vec2::Y * 0.5) - at(-Vec2::Y * 0.5);
            let solid_angle = along_x.cross(along_y).length();
            let density = camera.pixels_per_steradian(at(Vec2::ZERO));
            let product = density * solid_angle;
            assert!((product - 1.0).abs() < 1e-3, "{product}");
            assert_eq!(camera.pixels_per_steradian(-at(Vec2::ZERO)), 0.0);
        }
    }

    #[test]
    fn numbers_without_a_lens_are_refused() {
        let made = |radius, focus| ThinLens::new(settings(), radius, focus).is_ok();
        assert!(made(0.1, 2.0) && made(0.1, f32::INFINITY));
        assert!(!made(0.0, 2.0) && !made(-0.1, 2.0) && !made(f32::NAN, 2.0));
        assert!(!made(0.1, 0.0) && !made(0.1, -2.0) && !made(0.1, f32::NAN));
    }
}
