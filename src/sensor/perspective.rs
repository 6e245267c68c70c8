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
mod tests;
