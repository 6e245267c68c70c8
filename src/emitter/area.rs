//! A surface that glows.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{EmitterClass, EmitterModel, EmitterSample};
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::{Shape, ShapeModel, SurfacePoint};
use crate::texture::{Texture, TextureModel};

/// Emits from the front of a shape, equally into all directions.
#[derive(Clone, Debug)]
pub struct Area {
    shape: Arc<Shape>,
    radiance: Texture,
}

impl Area {
    /// Makes the light.
    ///
    /// - `shape`: prepared for sampling.
    /// - `radiance`: emitted radiance in W·m⁻²·sr⁻¹.
    pub fn new(shape: Arc<Shape>, radiance: impl Into<Texture>) -> Self {
        Self {
            shape,
            radiance: radiance.into(),
        }
    }
}

impl EmitterModel for Area {
    fn class(&self) -> EmitterClass {
        EmitterClass::Area
    }

    fn power(&self) -> f64 {
        PI * self.shape.area() * f64::from(self.radiance.mean().luminance())
    }

    #[inline]
    fn radiance(&self, at: &SurfacePoint, direction: Vec3) -> Rgb {
        if at.geometric_normal.dot(direction) <= 0.0 {
            return Rgb::BLACK;
        }
        self.radiance.colour(at.uv)
    }

    #[inline]
    fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<EmitterSample> {
        let (point, density) = self.shape.sample_toward(from, u)?;
        let direction = (point.position - from).try_normalize()?;
        let radiance = self.radiance(&point, -direction);
        if radiance.is_black() {
            return None;
        }
        let target = Some(point.ray_origin(-direction));
        Some(EmitterSample {
            direction,
            target,
            radiance,
            density,
            is_dirac: false,
        })
    }

    #[inline]
    fn density_toward(&self, from: Vec3, at: &SurfacePoint) -> SolidAngleDensity {
        self.shape.density_toward(from, at)
    }
}
