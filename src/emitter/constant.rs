//! The same light from everywhere.

use std::f64::consts::PI;

use super::{EmitterClass, EmitterModel, EmitterSample, SceneBounds};
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3, warp};

/// An environment of one colour.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    radiance: Rgb,
    scene_radius: f32,
}

impl Constant {
    /// Makes the light.
    ///
    /// - `radiance`: in W·m⁻²·sr⁻¹.
    pub const fn new(radiance: Rgb) -> Self {
        Self {
            radiance,
            scene_radius: 1.0,
        }
    }
}

impl EmitterModel for Constant {
    fn examples() -> Vec<Self> {
        vec![Self::new(Rgb::new(0.3, 0.5, 2.0))]
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Environment
    }

    fn set_scene_bounds(&mut self, bounds: SceneBounds) {
        self.scene_radius = bounds.radius;
    }

    /// What enters the sphere around the scene.
    fn power(&self) -> f64 {
        let area = 4.0 * PI * f64::from(self.scene_radius).powi(2);
        PI * area * f64::from(self.radiance.luminance())
    }

    #[inline]
    fn influence(&self, _from: Vec3) -> f32 {
        std::f32::consts::PI * self.radiance.luminance()
    }

    #[inline]
    fn environment_radiance(&self, _toward: Vec3) -> Rgb {
        self.radiance
    }

    #[inline(never)]
    fn sample_toward(&self, _from: Vec3, u: Vec2) -> Option<EmitterSample> {
        if self.radiance.is_black() {
            return None;
        }
        Some(EmitterSample {
            direction: warp::uniform_sphere(u),
            target: None,
            radiance: self.radiance,
            density: SolidAngleDensity(warp::UNIFORM_SPHERE_DENSITY),
            is_dirac: false,
            surface: None,
        })
    }

    #[inline]
    fn environment_density(&self, _toward: Vec3) -> SolidAngleDensity {
        SolidAngleDensity(warp::UNIFORM_SPHERE_DENSITY)
    }
}
