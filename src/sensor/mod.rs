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
#[derive(Clone, Copy, Debug)]
pub enum FieldOfViewAxis {
    X,
    Y,
    Diagonal,
    Smaller,
    Larger,
}
#[derive(Clone, Debug)]
pub struct PerspectiveSettings {
    pub to_world: Mat4,
    pub fov: f32,
    pub axis: FieldOfViewAxis,
    pub near: f32,
    pub far: f32,
    pub principal_point: Vec2,
    pub film_size: (u32, u32),
}
#[derive(Clone, Debug)]
pub struct Perspective {
    s: PerspectiveSettings,
    t: Vec2,
}
impl Perspective {
    pub fn new(s: PerspectiveSettings) -> Result<Self, std::fmt::Error> {
        let (w, h) = (s.film_size.0 as f32, s.film_size.1 as f32);
        let t = (s.fov / 2.0).to_radians().tan();
        let tx = match s.axis {
            FieldOfViewAxis::X => t,
            FieldOfViewAxis::Y => t * w / h,
            FieldOfViewAxis::Smaller => {
                if w < h {
                    t
                } else {
                    t * w / h
                }
            }
            FieldOfViewAxis::Larger => {
                if w > h {
                    t
                } else {
                    t * w / h
                }
            }
            FieldOfViewAxis::Diagonal => t * w / (w * w + h * h).sqrt(),
        };
        Ok(Self {
            t: Vec2::new(tx, tx * h / w),
            s,
        })
    }
}
pub type Sensor = Perspective;
pub trait SensorModel {
    fn sample_ray(&self, raster: Vec2, u: Vec2) -> CameraRay;
}
impl SensorModel for Sensor {
    fn sample_ray(&self, raster: Vec2, _u: Vec2) -> CameraRay {
        let size = Vec2::new(self.s.film_size.0 as f32, self.s.film_size.1 as f32);
        let p = (raster / size - 0.5) * 2.0 * self.t;
        let d = Vec3::new(-p.x, -p.y, 1.0).normalize();
        CameraRay {
            origin: self.s.to_world.transform_point3(Vec3::ZERO),
            direction: self.s.to_world.transform_vector3(d).normalize(),
            near: self.s.near / d.z,
            far: self.s.far / d.z,
        }
    }
}
