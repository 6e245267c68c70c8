//! Sensors: which rays a pixel looks along.

mod error;
mod orthographic;
mod perspective;
mod spherical;
#[cfg(test)]
mod tests;
mod thin_lens;

pub use error::SensorError;
pub use orthographic::Orthographic;
pub use perspective::{FieldOfViewAxis, Perspective, PerspectiveSettings};
pub use spherical::Spherical;
pub use thin_lens::ThinLens;

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
///
/// A ray leaves the sensor from a point of its lens, which is given by its world-space position
/// `origin`. A pinhole is a lens of one point: it takes any `origin` for that point.
pub trait SensorModel {
    /// The ray of a raster position.
    ///
    /// - `u_lens`: uniform in the unit square; chooses the point on the lens, where there is one.
    #[inline]
    fn sample_ray(&self, raster: Vec2, u_lens: Vec2) -> CameraRay {
        self.camera_ray(raster, self.sample_lens(u_lens))
    }

    /// The ray of a raster position through a given point of the lens.
    fn camera_ray(&self, raster: Vec2, origin: Vec3) -> CameraRay;

    /// Raster position that looks along `direction` from the point `origin` of the lens; `None`
    /// behind the sensor. It undoes [`SensorModel::camera_ray`].
    ///
    /// - `direction`: unit, away from the sensor.
    fn raster_at(&self, origin: Vec3, direction: Vec3) -> Option<Vec2>;

    /// Number of pixels for each steradian around a unit direction: the density of directions at
    /// one point of the lens when the raster position is uniform with density one. Zero behind the
    /// sensor.
    ///
    /// It is `1 / (A cos³ θ)` with `A` the area of a pixel on the plane at distance one, from any
    /// point of the lens; see `docs/math.md`, "Sensors".
    ///
    /// Source: van Antwerpen 2011, Eqs. 3.14 to 3.16.
    fn pixels_per_steradian(&self, direction: Vec3) -> f32;

    /// How the area that a pixel sees across a ray grows with the distance: as its square; not at all
    /// where rays are parallel. There, [`SensorModel::pixels_per_steradian`] counts pixels for each m².
    #[inline]
    fn spread(&self, distance_squared: f32) -> f32 {
        distance_squared
    }

    /// Whether all rays have one direction.
    #[inline]
    fn has_parallel_rays(&self) -> bool {
        false
    }

    /// Nearest and farthest distance that are seen along a unit direction, in m, as
    /// [`CameraRay::near`] and [`CameraRay::far`]. Behind the sensor the nearest is infinite.
    fn clip(&self, direction: Vec3) -> (f32, f32);

    /// Whether rays leave from more than one point.
    #[inline]
    fn has_lens(&self) -> bool {
        false
    }

    /// World-space point of the lens, uniform by area.
    ///
    /// - `u`: uniform in the unit square.
    fn sample_lens(&self, u: Vec2) -> Vec3;

    /// Goes back from a ray to the numbers that [`SensorModel::sample_ray`] makes it of: raster position and
    /// numbers for the lens. `None` behind the sensor.
    ///
    /// - `origin`, `direction`: a point of the lens and a unit direction from there.
    /// - `spare`: uniform in the unit square; stands in for the numbers of a lens of one point.
    fn invert_ray(&self, origin: Vec3, direction: Vec3, spare: Vec2) -> Option<(Vec2, Vec2)> {
        let raster = self.raster_at(origin, direction)?;
        Some((raster, self.invert_lens(origin, spare)))
    }

    /// Goes back from a point of the lens to the numbers that [`SensorModel::sample_lens`] makes it of.
    ///
    /// - `spare`: as with [`SensorModel::invert_ray`].
    #[inline]
    fn invert_lens(&self, origin: Vec3, spare: Vec2) -> Vec2 {
        let _ = origin;
        spare
    }

    /// World-space point of the lens at coordinates in units of its radius, in the unit disk.
    #[inline]
    fn lens_point(&self, coordinates: Vec2) -> Vec3 {
        let _ = coordinates;
        self.sample_lens(Vec2::ZERO)
    }

    /// Undoes [`SensorModel::lens_point`]; zero for a pinhole.
    #[inline]
    fn lens_coordinates(&self, origin: Vec3) -> Vec2 {
        let _ = origin;
        Vec2::ZERO
    }

    /// The point of the lens from which a ray leaves to `point`: `origin`, except where rays are
    /// parallel.
    #[inline]
    fn lens_before(&self, point: Vec3, origin: Vec3) -> Vec3 {
        let _ = point;
        origin
    }

    /// Width and height of the film in pixels where raster positions beyond it see once more what is
    /// seen on it: [`SensorModel::raster_at`] then gives those on the film only.
    #[inline]
    fn raster_range(&self) -> Option<Vec2> {
        None
    }

    /// True for points of the lens, up to rounding.
    fn is_on_lens(&self, origin: Vec3) -> bool {
        // A rounded position has rounded coordinates.
        let coordinates = self.lens_coordinates(origin);
        let off = self.lens_point(coordinates).distance(origin);
        coordinates.length() <= 1.001 && off <= 1e-3
    }
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
            fn camera_ray(&self, raster: Vec2, origin: Vec3) -> CameraRay {
                match self { $(Self::$model(s) => s.camera_ray(raster, origin),)* }
            }
            #[inline]
            fn raster_at(&self, origin: Vec3, direction: Vec3) -> Option<Vec2> {
                match self { $(Self::$model(s) => s.raster_at(origin, direction),)* }
            }
            #[inline]
            fn pixels_per_steradian(&self, direction: Vec3) -> f32 {
                match self { $(Self::$model(s) => s.pixels_per_steradian(direction),)* }
            }
            #[inline]
            fn has_parallel_rays(&self) -> bool {
                match self { $(Self::$model(s) => s.has_parallel_rays(),)* }
            }
            #[inline]
            fn spread(&self, distance_squared: f32) -> f32 {
                match self { $(Self::$model(s) => s.spread(distance_squared),)* }
            }
            #[inline]
            fn clip(&self, direction: Vec3) -> (f32, f32) {
                match self { $(Self::$model(s) => s.clip(direction),)* }
            }
            #[inline]
            fn has_lens(&self) -> bool {
                match self { $(Self::$model(s) => s.has_lens(),)* }
            }
            #[inline]
            fn sample_lens(&self, u: Vec2) -> Vec3 {
                match self { $(Self::$model(s) => s.sample_lens(u),)* }
            }
            #[inline]
            fn lens_point(&self, coordinates: Vec2) -> Vec3 {
                match self { $(Self::$model(s) => s.lens_point(coordinates),)* }
            }
            #[inline]
            fn lens_coordinates(&self, origin: Vec3) -> Vec2 {
                match self { $(Self::$model(s) => s.lens_coordinates(origin),)* }
            }
            #[inline]
            fn lens_before(&self, point: Vec3, origin: Vec3) -> Vec3 {
                match self { $(Self::$model(s) => s.lens_before(point, origin),)* }
            }
            fn invert_lens(&self, origin: Vec3, spare: Vec2) -> Vec2 {
                match self { $(Self::$model(s) => s.invert_lens(origin, spare),)* }
            }
            fn raster_range(&self) -> Option<Vec2> {
                match self { $(Self::$model(s) => s.raster_range(),)* }
            }
            fn is_on_lens(&self, origin: Vec3) -> bool {
                match self { $(Self::$model(s) => s.is_on_lens(origin),)* }
            }
        }
    };
}

sensor_models! {
    /// A camera whose rays are parallel.
    Orthographic,
    /// A pinhole camera.
    Perspective,
    /// A camera that sees all around it.
    Spherical,
    /// A camera with a lens, which has one distance in focus.
    ThinLens,
}
