//! A pinhole camera.

use glam::{DMat3, DVec2};

use super::{CameraRay, SensorError, SensorModel};
use crate::math::{Mat4, Vec2, Vec3, rotation_part};

/// The side of the film that an angle of view belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FovAxis {
    /// The width.
    X,
    /// The height.
    Y,
    /// From corner to corner.
    Diagonal,
    /// The shorter side.
    Smaller,
    /// The longer side.
    Larger,
}

/// How wide a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// The full angle over a side of the film.
    Angle {
        /// In radians, between 0 and π.
        angle: f32,
        /// The side.
        axis: FovAxis,
    },
    /// The focal length in mm of a 35 mm camera with the same angle over the diagonal of its
    /// 36 mm × 24 mm film.
    FocalLength(f32),
}

impl FieldOfView {
    /// Half the width of the film over its distance, for a film of `size` pixels.
    fn half_width(self, size: DVec2) -> f64 {
        let (half_tangent, axis) = match self {
            Self::Angle { angle, axis } => ((0.5 * f64::from(angle)).tan(), axis),
            Self::FocalLength(length) => {
                let diagonal = 36.0_f64.hypot(24.0);
                (0.5 * diagonal / f64::from(length), FovAxis::Diagonal)
            }
        };
        let per_side = match axis {
            FovAxis::X => size.x,
            FovAxis::Y => size.y,
            FovAxis::Diagonal => size.length(),
            FovAxis::Smaller => size.min_element(),
            FovAxis::Larger => size.max_element(),
        };
        half_tangent * size.x / per_side
    }

    fn is_valid(self) -> bool {
        match self {
            Self::Angle { angle, .. } => angle > 0.0 && angle < std::f32::consts::PI,
            Self::FocalLength(length) => length > 0.0 && length.is_finite(),
        }
    }
}

/// What a [`Perspective`] is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerspectiveOptions {
    /// Camera to world: the camera stands at the origin and looks along +z, with +x to its left
    /// and +y upwards. Scale and shear are ignored, mirrors are not.
    pub to_world: Mat4,
    /// How wide it sees.
    pub field_of_view: FieldOfView,
    /// Width and height of the full film in pixels.
    pub film_size: [u32; 2],
    /// Distances along the optical axis between which surfaces are seen, positive.
    pub clip: [f32; 2],
    /// How far the optical axis lies from the film's centre, in widths to the left and heights
    /// upwards.
    pub principal_point_offset: Vec2,
}

/// A pinhole camera.
///
/// Differs: Mitsuba 3 refuses transforms with a scale; here the rotation in them counts.
#[derive(Clone, Debug)]
pub struct Perspective {
    origin: Vec3,
    /// Camera to world, orthonormal.
    axes: DMat3,
    clip: [f32; 2],
    /// Raster position of the optical axis.
    centre: DVec2,
    /// Size of a pixel on the film at distance one. Pixels are square.
    pixel: f64,
}

impl Perspective {
    /// Makes the camera.
    ///
    /// # Errors
    /// One of [`SensorError`] for each option out of its range.
    pub fn new(options: PerspectiveOptions) -> Result<Self, SensorError> {
        let axes = rotation_part(options.to_world).ok_or(SensorError::Singular)?;
        let origin = options.to_world.w_axis.truncate();
        if !origin.is_finite() {
            return Err(SensorError::Singular);
        }
        if !options.field_of_view.is_valid() {
            return Err(SensorError::BadFieldOfView);
        }
        let [near, far] = options.clip;
        // Written so that a number that is not one fails as well.
        if !(near > 0.0 && far > near) {
            return Err(SensorError::BadClip);
        }
        if options.film_size.contains(&0) {
            return Err(SensorError::NoPixels);
        }
        let offset = options.principal_point_offset.as_dvec2();
        if !offset.is_finite() {
            return Err(SensorError::BadPrincipalPoint);
        }
        let size = DVec2::new(options.film_size[0].into(), options.film_size[1].into());
        Ok(Self {
            origin,
            axes: axes.as_dmat3(),
            clip: options.clip,
            centre: size * (DVec2::splat(0.5) - offset),
            pixel: 2.0 * options.field_of_view.half_width(size) / size.x,
        })
    }

    /// World-space position of the pinhole.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Cosine of the angle of a unit direction to the optical axis.
    fn cos(&self, direction: Vec3) -> f64 {
        self.axes.z_axis.dot(direction.as_dvec3())
    }
}

impl SensorModel for Perspective {
    #[inline]
    fn sample_ray(&self, raster: Vec2, _u_lens: Vec2) -> CameraRay {
        // The camera's x and y grow to the left and upwards, the raster's to the right and down.
        let on_film = (self.centre - raster.as_dvec2()) * self.pixel;
        let towards = self.axes * on_film.extend(1.0);
        let per_depth = towards.length();
        CameraRay {
            origin: self.origin,
            direction: (towards / per_depth).as_vec3(),
            near: self.clip[0] * per_depth as f32,
            far: self.clip[1] * per_depth as f32,
        }
    }

    #[inline]
    fn project(&self, point: Vec3) -> Option<Vec2> {
        let offset = point.as_dvec3() - self.origin.as_dvec3();
        let local = self.axes.transpose() * offset;
        let [near, far] = self.clip.map(f64::from);
        // Written so that a position that is not a number is not seen.
        if !(local.z >= near && local.z <= far) {
            return None;
        }
        let raster = self.centre - local.truncate() / (local.z * self.pixel);
        Some(raster.as_vec2())
    }

    #[inline]
    fn raster_density(&self, direction: Vec3) -> f64 {
        let cos = self.cos(direction);
        if cos <= 0.0 {
            return 0.0;
        }
        1.0 / (self.pixel * self.pixel * cos * cos * cos)
    }

    #[inline]
    fn importance(&self, direction: Vec3) -> f64 {
        let cos = self.cos(direction);
        if cos <= 0.0 {
            return 0.0;
        }
        self.raster_density(direction) / cos
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options() -> PerspectiveOptions {
        PerspectiveOptions {
            to_world: Mat4::IDENTITY,
            field_of_view: FieldOfView::Angle {
                angle: 50.0_f32.to_radians(),
                axis: FovAxis::X,
            },
            film_size: [40, 30],
            clip: [0.01, 10_000.0],
            principal_point_offset: Vec2::ZERO,
        }
    }

    fn direction(options: PerspectiveOptions, raster: [f32; 2]) -> Vec3 {
        let camera = Perspective::new(options).unwrap();
        let ray = camera.sample_ray(raster.into(), Vec2::ZERO);
        assert!((ray.direction.length() - 1.0).abs() < 1e-6);
        ray.direction
    }

    fn check(options: PerspectiveOptions, raster: [f32; 2], expected: [f32; 3]) {
        let found = direction(options, raster);
        let miss = (found - Vec3::from_array(expected)).length();
        assert!(miss < 2e-6, "{found} instead of {expected:?}");
    }

    /// Directions that Mitsuba 3.9.1 samples.
    #[test]
    fn angles_of_view_are_those_of_mitsuba() {
        let with = |axis| PerspectiveOptions {
            field_of_view: FieldOfView::Angle {
                angle: 50.0_f32.to_radians(),
                axis,
            },
            ..options()
        };
        let by_width = [0.402_865_4, 0.302_149, 0.863_947_6];
        let by_height = [0.490_916_9, 0.368_187_7, 0.789_581_1];
        check(with(FovAxis::X), [0.0, 0.0], by_width);
        check(
            with(FovAxis::X),
            [10.0, 21.0],
            [0.224_985_5, -0.134_991_2, 0.964_965_7],
        );
        check(with(FovAxis::Y), [0.0, 0.0], by_height);
        check(with(FovAxis::Smaller), [0.0, 0.0], by_height);
        check(with(FovAxis::Larger), [0.0, 0.0], by_width);
        check(
            with(FovAxis::Diagonal),
            [0.0, 0.0],
            [0.338_094_6, 0.253_570_9, 0.906_307_8],
        );
        let portrait = PerspectiveOptions {
            film_size: [30, 40],
            ..with(FovAxis::Smaller)
        };
        check(portrait, [0.0, 0.0], [0.368_187_7, 0.490_917, 0.789_581_1]);
        let focal = PerspectiveOptions {
            field_of_view: FieldOfView::FocalLength(50.0),
            ..options()
        };
        check(focal, [0.0, 0.0], [0.317_673_4, 0.238_255_1, 0.917_778_8]);
    }

    /// A crop at (10, 5) of 8 × 6 pixels, and a principal point, in Mitsuba 3.9.1.
    #[test]
    fn crops_and_principal_points_are_those_of_mitsuba() {
        check(
            options(),
            [10.0, 5.0],
            [0.221_427_4, 0.221_427_4, 0.949_705_1],
        );
        check(
            options(),
            [12.0, 9.2],
            [0.181_761_7, 0.131_777_2, 0.974_472_9],
        );
        let shifted = PerspectiveOptions {
            principal_point_offset: Vec2::new(0.1, 0.05),
            ..options()
        };
        check(
            shifted,
            [20.0, 15.0],
            [-0.092_802_3, -0.034_800_8, 0.995_076_3],
        );
        check(
            shifted,
            [40.0, 30.0],
            [-0.462_926, -0.318_261_6, 0.827_290_2],
        );
        check(
            shifted,
            [18.0, 11.0],
            [-0.046_501_4, 0.058_126_8, 0.997_225_5],
        );
    }

    #[test]
    fn clipping_planes_cut_rays_by_depth() {
        let clipped = PerspectiveOptions {
            clip: [0.5, 20.0],
            ..options()
        };
        let camera = Perspective::new(clipped).unwrap();
        let ray = camera.sample_ray(Vec2::ZERO, Vec2::ZERO);
        assert!((ray.near - 0.5 / 0.863_947_6).abs() < 1e-5);
        // Mitsuba starts at the near plane and goes on for 22.570814.
        assert!((ray.far - ray.near - 22.570_814).abs() < 1e-4);
        assert_eq!(camera.project(Vec3::new(0.0, 0.0, 0.499)), None);
        assert_eq!(camera.project(Vec3::new(0.0, 0.0, 20.01)), None);
        assert_eq!(camera.project(Vec3::new(0.0, 0.0, -1.0)), None);
        assert_eq!(camera.project(Vec3::NAN), None);
        let centre = camera.project(Vec3::new(0.0, 0.0, 1.0));
        assert_eq!(centre, Some(Vec2::new(20.0, 15.0)));
    }

    #[test]
    fn scale_is_ignored_and_a_mirror_mirrors() {
        let moved = Mat4::from_translation(Vec3::new(1.0, 2.0, 3.0)) * Mat4::from_rotation_y(0.4);
        let with = |scale: Vec3| PerspectiveOptions {
            to_world: moved * Mat4::from_scale(scale),
            ..options()
        };
        let plain = direction(with(Vec3::ONE), [3.0, 7.0]);
        check(with(Vec3::new(2.0, 3.0, 0.5)), [3.0, 7.0], plain.to_array());
        check(
            with(Vec3::new(-1.0, 1.0, 1.0)),
            [37.0, 7.0],
            plain.to_array(),
        );
        let camera = Perspective::new(with(Vec3::ONE)).unwrap();
        assert_eq!(camera.origin(), Vec3::new(1.0, 2.0, 3.0));
    }

    fn oblique() -> Perspective {
        let to_world = Mat4::from_translation(Vec3::new(-31.0, 12.5, 7.0))
            * Mat4::from_rotation_y(2.1)
            * Mat4::from_rotation_x(-0.6);
        Perspective::new(PerspectiveOptions {
            to_world,
            film_size: [1920, 1080],
            principal_point_offset: Vec2::new(-0.2, 0.1),
            ..options()
        })
        .unwrap()
    }

    const RASTER: [Vec2; 4] = [
        Vec2::new(960.5, 540.25),
        Vec2::new(0.1, 1079.0),
        Vec2::new(1919.0, 3.0),
        Vec2::new(-2.0, 1081.5),
    ];

    #[test]
    fn projecting_undoes_sampling() {
        let camera = oblique();
        for raster in RASTER {
            let ray = camera.sample_ray(raster, Vec2::ZERO);
            for distance in [0.5, 30.0, 4000.0] {
                let found = camera
                    .project(ray.origin + ray.direction * distance)
                    .unwrap();
                // Near the camera the point's own rounding shows.
                assert!(
                    (found - raster).length() < 0.02,
                    "{raster} came back as {found}"
                );
            }
        }
    }

    #[test]
    fn raster_density_is_the_jacobian_of_sampling() {
        let camera = oblique();
        for raster in RASTER {
            let at = |offset: Vec2| {
                let ray = camera.sample_ray(raster + offset, Vec2::ZERO);
                ray.direction.as_dvec3()
            };
            let half = 4.0;
            let along_x = (at(Vec2::X * half) - at(-Vec2::X * half)) / f64::from(2.0 * half);
            let along_y = (at(Vec2::Y * half) - at(-Vec2::Y * half)) / f64::from(2.0 * half);
            let solid_angle = along_x.cross(along_y).length();
            let direction = camera.sample_ray(raster, Vec2::ZERO).direction;
            let density = camera.raster_density(direction);
            assert!((density * solid_angle - 1.0).abs() < 1e-3, "{raster}");
            let cos = camera.axes.z_axis.dot(direction.as_dvec3());
            assert!((camera.importance(direction) * cos / density - 1.0).abs() < 1e-9);
            assert_eq!(camera.importance(-direction), 0.0);
            assert_eq!(camera.raster_density(-direction), 0.0);
        }
    }

    #[test]
    fn senseless_options_are_refused() {
        let spoilt = |spoil: fn(&mut PerspectiveOptions)| {
            let mut options = options();
            spoil(&mut options);
            Perspective::new(options).err()
        };
        let angle = |angle| FieldOfView::Angle {
            angle,
            axis: FovAxis::X,
        };
        assert!(Perspective::new(options()).is_ok());
        assert_eq!(
            spoilt(|o| o.to_world = Mat4::ZERO),
            Some(SensorError::Singular)
        );
        assert_eq!(
            spoilt(|o| o.to_world.w_axis.x = f32::NAN),
            Some(SensorError::Singular)
        );
        assert_eq!(
            spoilt(|o| o.film_size = [0, 4]),
            Some(SensorError::NoPixels)
        );
        assert_eq!(spoilt(|o| o.clip = [0.0, 1.0]), Some(SensorError::BadClip));
        assert_eq!(
            spoilt(|o| o.clip = [1.0, f32::NAN]),
            Some(SensorError::BadClip)
        );
        assert_eq!(
            spoilt(|o| o.principal_point_offset.x = f32::INFINITY),
            Some(SensorError::BadPrincipalPoint)
        );
        for field_of_view in [
            angle(0.0),
            angle(3.2),
            angle(f32::NAN),
            FieldOfView::FocalLength(0.0),
        ] {
            let options = PerspectiveOptions {
                field_of_view,
                ..options()
            };
            assert_eq!(
                Perspective::new(options).err(),
                Some(SensorError::BadFieldOfView)
            );
        }
    }
}
