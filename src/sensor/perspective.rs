//! A pinhole camera.

use super::{CameraRay, SensorError, SensorModel};
use crate::math::{Mat3, Mat4, Vec2, Vec3};

/// Which extent of the film the field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldOfViewAxis {
    /// Its width.
    #[default]
    X,
    /// Its height.
    Y,
    /// From corner to corner.
    Diagonal,
    /// The smaller of width and height.
    Smaller,
    /// The larger of width and height.
    Larger,
}

/// What makes up a [`Perspective`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerspectiveSettings {
    /// Camera to world: the camera looks along +z, with +x to the left and +y up. Scales in it have
    /// no effect.
    pub to_world: Mat4,
    /// Field of view in degrees.
    pub field_of_view: f32,
    /// What the field of view spans.
    pub axis: FieldOfViewAxis,
    /// Distance of the near clip plane along the optical axis, in m.
    pub near: f32,
    /// Distance of the far clip plane along the optical axis, in m.
    pub far: f32,
    /// Where the optical axis meets the film, away from its middle, in widths and heights of it.
    pub principal_point_offset: Vec2,
    /// Width and height of the full film in pixels.
    pub film_size: (u32, u32),
}

impl PerspectiveSettings {
    /// Field of view from corner to corner, in degrees, of a lens of this focal length before a film
    /// of 36 × 24 mm.
    pub fn field_of_view_of_focal_length(millimetres: f32) -> f32 {
        let diagonal = 36.0_f32.hypot(24.0);
        2.0 * (diagonal / (2.0 * millimetres)).atan().to_degrees()
    }

    /// Half of the film's width and height on the plane at distance one, in m.
    ///
    /// - `degrees`, `axis`: the field of view and what it spans.
    /// - `film`: width and height of the film, in any unit.
    pub fn half_extent(degrees: f32, axis: FieldOfViewAxis, film: Vec2) -> Vec2 {
        let half = (0.5 * degrees.to_radians()).tan();
        let spanned = match axis {
            FieldOfViewAxis::X => film.x,
            FieldOfViewAxis::Y => film.y,
            FieldOfViewAxis::Diagonal => film.length(),
            FieldOfViewAxis::Smaller => film.min_element(),
            FieldOfViewAxis::Larger => film.max_element(),
        };
        film * (half / spanned)
    }
}

/// A camera without a lens: everything is in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perspective {
    origin: Vec3,
    rotation: Mat3,
    near: f32,
    far: f32,
    /// Raster position of the optical axis.
    centre: Vec2,
    /// Size of a pixel on the plane at distance one.
    pixel: Vec2,
}

impl Perspective {
    /// Makes the camera.
    ///
    /// # Errors
    /// [`SensorError`], for numbers that describe none.
    pub fn new(settings: PerspectiveSettings) -> Result<Self, SensorError> {
        let PerspectiveSettings {
            to_world,
            field_of_view,
            near,
            far,
            ..
        } = settings;
        if !(field_of_view > 0.0 && field_of_view < 180.0) {
            return Err(SensorError::FieldOfView(field_of_view));
        }
        if !(near >= 0.0 && far > near) {
            return Err(SensorError::ClipPlanes { near, far });
        }
        if settings.film_size.0 == 0 || settings.film_size.1 == 0 {
            return Err(SensorError::NoPixels);
        }
        let rotation = rotation(Mat3::from_mat4(to_world)).ok_or(SensorError::Shear)?;
        let film = Vec2::new(settings.film_size.0 as f32, settings.film_size.1 as f32);
        let half = PerspectiveSettings::half_extent(field_of_view, settings.axis, film);
        Ok(Self {
            origin: to_world.transform_point3(Vec3::ZERO),
            rotation,
            near,
            far,
            centre: film * (0.5 - settings.principal_point_offset),
            pixel: 2.0 * half / film,
        })
    }
}

/// The axes of a transform, scaled to unit length; `None` unless they are perpendicular.
pub(super) fn rotation(map: Mat3) -> Option<Mat3> {
    let axes = [map.x_axis, map.y_axis, map.z_axis].map(Vec3::try_normalize);
    let [Some(x), Some(y), Some(z)] = axes else {
        return None;
    };
    let skew = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
    (skew < 1e-3).then(|| Mat3::from_cols(x, y, z))
}

impl Perspective {
    /// World-space position of the pinhole.
    #[inline]
    pub(super) fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Where a raster position lies on the plane at distance one, in the camera's axes.
    #[inline]
    pub(super) fn on_plane(&self, raster: Vec2) -> Vec2 {
        (self.centre - raster) * self.pixel
    }

    /// Undoes [`Perspective::on_plane`].
    #[inline]
    pub(super) fn raster(&self, on_plane: Vec2) -> Vec2 {
        self.centre - on_plane / self.pixel
    }

    /// Writes a world-space direction or offset in the camera's axes.
    #[inline]
    pub(super) fn local(&self, world: Vec3) -> Vec3 {
        self.rotation.transpose() * world
    }

    /// The point of the lens plane, which holds the pinhole, at coordinates in m.
    #[inline]
    pub(super) fn beside(&self, offset: Vec2) -> Vec3 {
        self.origin + self.rotation * offset.extend(0.0)
    }

    /// The ray from a point of the lens plane with the slope `on_plane` to the optical axis.
    #[inline]
    pub(super) fn ray(&self, origin: Vec3, on_plane: Vec2) -> CameraRay {
        let local = on_plane.extend(1.0);
        let length = local.length();
        CameraRay {
            origin,
            direction: self.rotation * (local * (1.0 / length)),
            near: self.near * length,
            far: self.far * length,
        }
    }
}

impl SensorModel for Perspective {
    #[inline]
    fn camera_ray(&self, raster: Vec2, _origin: Vec3) -> CameraRay {
        self.ray(self.origin, self.on_plane(raster))
    }

    #[inline]
    fn raster_at(&self, _origin: Vec3, direction: Vec3) -> Option<Vec2> {
        let local = self.local(direction);
        (local.z > 0.0).then(|| self.raster(local.truncate() / local.z))
    }

    #[inline]
    fn pixels_per_steradian(&self, direction: Vec3) -> f32 {
        let cos = self.rotation.z_axis.dot(direction);
        if cos > 0.0 {
            1.0 / (self.pixel.element_product() * cos * cos * cos)
        } else {
            0.0
        }
    }

    #[inline]
    fn clip(&self, direction: Vec3) -> (f32, f32) {
        let cos = self.rotation.z_axis.dot(direction);
        if cos > 0.0 {
            (self.near / cos, self.far / cos)
        } else {
            (f32::INFINITY, 0.0)
        }
    }

    #[inline]
    fn sample_lens(&self, _u: Vec2) -> Vec3 {
        self.origin
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Transform;

    fn settings() -> PerspectiveSettings {
        PerspectiveSettings {
            to_world: Mat4::IDENTITY,
            field_of_view: 90.0,
            axis: FieldOfViewAxis::X,
            near: 0.1,
            far: 100.0,
            principal_point_offset: Vec2::ZERO,
            film_size: (200, 100),
        }
    }

    fn ray(settings: PerspectiveSettings, x: f32, y: f32) -> CameraRay {
        Perspective::new(settings)
            .unwrap()
            .sample_ray(Vec2::new(x, y), Vec2::ZERO)
    }

    fn check_direction(found: Vec3, expected: [f32; 3]) {
        let expected = Vec3::from_array(expected).normalize();
        assert!(
            (found - expected).length() < 1e-5,
            "{found} is not {expected}"
        );
    }

    #[test]
    fn the_camera_looks_along_z_with_x_to_the_left() {
        check_direction(ray(settings(), 100.0, 50.0).direction, [0.0, 0.0, 1.0]);
        check_direction(ray(settings(), 0.0, 50.0).direction, [1.0, 0.0, 1.0]);
        check_direction(ray(settings(), 200.0, 0.0).direction, [-1.0, 0.5, 1.0]);
    }

    #[test]
    fn the_field_of_view_spans_what_it_says() {
        let corner = |axis| ray(PerspectiveSettings { axis, ..settings() }, 0.0, 0.0).direction;
        check_direction(corner(FieldOfViewAxis::Larger), [1.0, 0.5, 1.0]);
        check_direction(corner(FieldOfViewAxis::Y), [2.0, 1.0, 1.0]);
        check_direction(corner(FieldOfViewAxis::Smaller), [2.0, 1.0, 1.0]);
        let diagonal = corner(FieldOfViewAxis::Diagonal);
        assert!((diagonal.z - 0.5_f32.sqrt()).abs() < 1e-5, "{diagonal}");
        let normal_lens = PerspectiveSettings::field_of_view_of_focal_length(50.0);
        assert!((normal_lens - 46.793).abs() < 1e-2, "{normal_lens}");
    }

    #[test]
    fn clip_planes_are_planes() {
        let corner = ray(settings(), 0.0, 50.0);
        assert!((corner.near - 0.1 * 2.0_f32.sqrt()).abs() < 1e-6);
        assert!((corner.far - 100.0 * 2.0_f32.sqrt()).abs() < 1e-3);
    }

    #[test]
    fn a_principal_point_moves_the_picture() {
        let offset = Vec2::new(0.25, 0.0);
        let moved = PerspectiveSettings {
            principal_point_offset: offset,
            ..settings()
        };
        check_direction(ray(moved, 50.0, 50.0).direction, [0.0, 0.0, 1.0]);
    }

    #[test]
    fn rasters_undo_rays_and_density_is_the_jacobian() {
        let turn = Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(-0.3);
        let to_world = Mat4::from_translation(Vec3::new(3.0, -1.0, 2.0)) * turn;
        let camera = Perspective::new(PerspectiveSettings {
            to_world,
            ..settings()
        })
        .unwrap();
        for raster in [
            Vec2::new(3.0, 4.0),
            Vec2::new(180.0, 77.5),
            Vec2::new(-4.0, 101.0),
        ] {
            let at = |offset| camera.sample_ray(raster + offset, Vec2::ZERO);
            let ray = at(Vec2::ZERO);
            let seen = camera.raster_at(ray.origin, ray.direction).unwrap();
            assert!((seen - raster).length() < 1e-3, "{seen} is not {raster}");
            let step = 0.5;
            let along_x = at(Vec2::X * step).direction - at(-Vec2::X * step).direction;
            let along_y = at(Vec2::Y * step).direction - at(-Vec2::Y * step).direction;
            let solid_angle = along_x.cross(along_y).length();
            let density = camera.pixels_per_steradian(ray.direction);
            assert!(
                (density * solid_angle - 1.0).abs() < 1e-3,
                "{}",
                density * solid_angle
            );
            assert_eq!(camera.raster_at(ray.origin, -ray.direction), None);
            assert_eq!(camera.pixels_per_steradian(-ray.direction), 0.0);
            let (near, far) = camera.clip(ray.direction);
            assert!((near / ray.near - 1.0).abs() < 1e-5 && (far / ray.far - 1.0).abs() < 1e-5);
            let (near, far) = camera.clip(-ray.direction);
            assert!(near > far);
        }
    }

    /// Directions of `sample_ray`, read off Mitsuba 3.9.1 (`scalar_rgb`, film of 200 × 100 pixels).
    #[test]
    fn directions_are_those_of_mitsuba() {
        let to_world = Transform::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, Some(DVec3::Y));
        let base = PerspectiveSettings {
            to_world: to_world.unwrap().matrix(),
            field_of_view: 40.0,
            ..settings()
        };
        let focal_length = PerspectiveSettings::field_of_view_of_focal_length(50.0);
        let diagonal = FieldOfViewAxis::Diagonal;
        let offset = Vec2::new(0.1, -0.2);
        let lens = PerspectiveSettings {
            field_of_view: focal_length,
            axis: diagonal,
            ..base
        };
        let moved = PerspectiveSettings {
            principal_point_offset: offset,
            ..base
        };
        for (settings, raster, expected) in [
            (base, [20.0, 20.0], [-0.536604, -0.422291, -0.730566]),
            (base, [160.0, 55.0], [-0.0556882, -0.537157, -0.841642]),
            (
                PerspectiveSettings {
                    axis: diagonal,
                    ..base
                },
                [20.0, 20.0],
                [-0.511426, -0.435451, -0.740828],
            ),
            (lens, [20.0, 20.0], [-0.551238, -0.414341, -0.724195]),
            (moved, [20.0, 20.0], [-0.485945, -0.366208, -0.793568]),
            (moved, [160.0, 55.0], [-0.00024507, -0.468264, -0.883588]),
            // The crop window of 60 × 40 pixels at (50, 20), at (0.1, 0.2) of it.
            (base, [56.0, 28.0], [-0.425951, -0.45954, -0.779351]),
        ] {
            check_direction(ray(settings, raster[0], raster[1]).direction, expected);
        }
    }

    #[test]
    fn numbers_without_a_camera_are_refused() {
        let refused = |change: fn(&mut PerspectiveSettings)| {
            let mut changed = settings();
            change(&mut changed);
            Perspective::new(changed).is_err()
        };
        assert!(refused(|s| s.field_of_view = 180.0));
        assert!(refused(|s| s.field_of_view = f32::NAN));
        assert!(refused(|s| s.far = 0.05));
        assert!(refused(|s| s.film_size = (0, 9)));
        assert!(refused(|s| s.to_world.y_axis.x = 0.5));
        assert!(!refused(
            |s| s.to_world *= Mat4::from_scale(Vec3::new(3.0, 2.0, 1.0))
        ));
    }
}
