//! Cameras.
//!
//! Raster coordinates are pixels on the full film, x to the right and y downwards from the upper
//! left corner; a crop is a part of that film. A pixel's value is ∫ h(r) L(r) dr over raster
//! positions r, with a filter h that integrates to one and pixels as the unit of area: so `W_e`
//! is h(r) times [`SensorModel::importance`].

mod perspective;

pub use perspective::{FieldOfView, FovAxis, Perspective, PerspectiveOptions};

use thiserror::Error;

use crate::math::{Vec2, Vec3};

/// A ray that leaves the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// Point on the lens.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Distance along the ray from which on surfaces are seen.
    pub near: f32,
    /// Distance along the ray up to which surfaces are seen.
    pub far: f32,
}

/// Why numbers do not describe a camera.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum SensorError {
    /// The camera-to-world transform has no inverse, or holds numbers that are not finite.
    #[error("the camera's transform flattens space or is not finite")]
    Singular,
    /// The field of view, or the focal length, opens no angle between 0 and 180 degrees.
    #[error("the field of view must lie between 0 and 180 degrees, a focal length above 0")]
    BadFieldOfView,
    /// Clipping planes are not positive, or out of order.
    #[error("the clipping distances must be positive, the near one below the far one")]
    BadClip,
    /// The film has no pixels.
    #[error("the film has no pixels")]
    NoPixels,
    /// The principal point is not finite.
    #[error("the principal point is not finite")]
    BadPrincipalPoint,
}

/// What a camera can answer.
pub trait SensorModel {
    /// The ray through a raster position.
    ///
    /// - `raster`: in pixels on the full film; may lie outside of it, as far as a filter reaches.
    /// - `u_lens`: uniform in the unit square; cameras without a lens ignore it.
    fn sample_ray(&self, raster: Vec2, u_lens: Vec2) -> CameraRay;

    /// The raster position at which a world-space point is seen, on the film or outside of it;
    /// `None` for points that are behind the camera or cut off by a clipping plane.
    fn project(&self, point: Vec3) -> Option<Vec2>;

    /// Raster area, in pixels, that one steradian around a unit direction from the camera covers:
    /// the density in solid angle of directions that are uniform in raster positions, per pixel.
    /// Zero behind the camera.
    fn raster_density(&self, direction: Vec3) -> f64;

    /// Importance `W_e` that the camera sends in a unit direction where the filter is one:
    /// [`SensorModel::raster_density`] per projected solid angle, in pixels/sr. Zero behind.
    ///
    /// Source: van Antwerpen 2011, Eqs. 3.14 to 3.16.
    fn importance(&self, direction: Vec3) -> f64;
}

/// Writes the enum of all cameras and forwards [`SensorModel`] to its variants.
macro_rules! sensor_models {
    ($($(#[$doc:meta])* $model:ident,)*) => {
        /// Any camera.
        #[derive(Clone, Debug)]
        pub enum Sensor {
            $($(#[$doc])* $model($model),)*
        }

        $(impl From<$model> for Sensor {
            fn from(model: $model) -> Self {
                Self::$model(model)
            }
        })*

        impl SensorModel for Sensor {
            #[inline]
            fn sample_ray(&self, raster: Vec2, u_lens: Vec2) -> CameraRay {
                match self { $(Self::$model(s) => s.sample_ray(raster, u_lens),)* }
            }
            #[inline]
            fn project(&self, point: Vec3) -> Option<Vec2> {
                match self { $(Self::$model(s) => s.project(point),)* }
            }
            #[inline]
            fn raster_density(&self, direction: Vec3) -> f64 {
                match self { $(Self::$model(s) => s.raster_density(direction),)* }
            }
            #[inline]
            fn importance(&self, direction: Vec3) -> f64 {
                match self { $(Self::$model(s) => s.importance(direction),)* }
            }
        }
    };
}

sensor_models! {
    /// A pinhole.
    Perspective,
}
