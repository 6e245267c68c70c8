//! temporary
use crate::accel::Ray;
use crate::math::*;
#[derive(Clone, Debug)]
pub struct CameraRay {
    pub origin: Vec3,
    pub direction: Vec3,
    pub near: f32,
    pub far: f32,
}
impl CameraRay {
    pub fn to_ray(&self) -> Ray {
        Ray::new(self.origin, self.direction).between(self.near, self.far)
    }
}
#[derive(Clone, Debug)]
pub struct Sensor {
    pub origin: Vec3,
    pub scale: f32,
    pub size: f32,
}
pub trait SensorModel {
    fn sample_ray(&self, raster: Vec2, u: Vec2) -> CameraRay;
}
impl SensorModel for Sensor {
    fn sample_ray(&self, raster: Vec2, _u: Vec2) -> CameraRay {
        let p = (raster / self.size - 0.5) * 2.0 * self.scale;
        CameraRay {
            origin: self.origin,
            direction: Vec3::new(-p.x, -p.y, 1.0).normalize(),
            near: 0.0,
            far: f32::INFINITY,
        }
    }
}
