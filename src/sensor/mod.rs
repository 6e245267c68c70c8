//! Sensors: which rays a pixel looks along.

mod perspective;

pub use perspective::{FieldOfViewAxis, Perspective, PerspectiveSettings, SensorError};

use crate::accel::Ray;
use crate::math::{Vec2, Vec3};

/// A ray that a sensor looks along, limited to what lies between its clip planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// Where the ray starts: a point of the lens, in world space.
    pub origin: Vec3,
    /// Unit direction in world space.
    pub direction: Vec3,
    /// Nearest distance that is seen, in m.
    pub near: f32,
    /// Farthest distance that is seen, in m.
    pub far: f32,
}

impl CameraRay {
    /// The ray that the tracer follows.
    #[inline]
    pub fn to_ray(&self) -> Ray {
        Ray::new(self.origin, self.direction).between(self.near, self.far)
    }
}

/// What a sensor can answer.
///
/// Raster coordinates count pixels of the *full* film, `x` to the right and `y` down, whatever part
/// of it is rendered; they may lie outside of the film.
pub trait SensorModel {
    /// The ray of a raster position.
    ///
    /// - `u_lens`: uniform in the unit square; chooses the point on the lens, where there is one.
    fn sample_ray(&self, raster: Vec2, u_lens: Vec2) -> CameraRay;

    /// Raster position at which a point of space is seen from the middle of the lens; `None` behind
    /// the sensor.
    fn project(&self, point: Vec3) -> Option<Vec2>;

    /// Number of pixels for each steradian around a unit direction: the density of directions when
    /// the raster position is uniform with density one. Zero behind the sensor.
    ///
    /// It is `1 / (A cos³ θ)` with `A` the area of a pixel on the plane at distance one.
    ///
    /// Source: van Antwerpen 2011, Eqs. 3.14 to 3.16.
    fn pixels_per_steradian(&self, direction: Vec3) -> f32;
}

/// Writes the enum of all sensors and forwards [`SensorModel`] to its variants.
macro_rules! sensor_models {
    ($($(#[$doc:meta])* $model:ident,)*) => {
        /// Any sensor.
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
            fn pixels_per_steradian(&self, direction: Vec3) -> f32 {
                match self { $(Self::$model(s) => s.pixels_per_steradian(direction),)* }
            }
        }
    };
}

sensor_models! {
    /// A pinhole camera.
    Perspective,
}
