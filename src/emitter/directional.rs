//! Parallel light from infinitely far away.

use std::f64::consts::PI;

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample,
    RayOfLight, SceneBounds,
};
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::SurfacePoint;

/// Parallel light.
#[derive(Clone, Copy, Debug)]
pub struct Directional {
    /// Unit direction in which the light travels.
    direction: Vec3,
    irradiance: Rgb,
    bounds: SceneBounds,
}

impl Directional {
    /// Makes the light.
    ///
    /// - `direction`: in which the light travels, in world space, of any length.
    /// - `irradiance`: on a surface that faces the light, in W·m⁻².
    ///
    /// # Errors
    /// [`EmitterError::NoDirection`] for a vector that has none.
    pub fn new(direction: Vec3, irradiance: Rgb) -> Result<Self, EmitterError> {
        let direction = direction.try_normalize().ok_or(EmitterError::NoDirection)?;
        Ok(Self {
            direction,
            irradiance,
            bounds: SceneBounds::UNIT,
        })
    }
}

impl EmitterModel for Directional {
    fn examples() -> Vec<Self> {
        let direction = Vec3::new(1.0, -2.0, 0.5);
        Self::new(direction, Rgb::new(1.0, 2.0, 0.5))
            .into_iter()
            .collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Directional
    }

    fn set_scene_bounds(&mut self, bounds: SceneBounds) {
        self.bounds = bounds;
    }

    /// What passes through the largest cross-section of the scene.
    fn power(&self) -> f64 {
        PI * f64::from(self.bounds.radius).powi(2) * f64::from(self.irradiance.luminance())
    }

    #[inline]
    fn influence(&self, _from: Vec3) -> f32 {
        self.irradiance.luminance()
    }

    #[inline(never)]
    fn sample_toward(&self, _from: Vec3, _u: Vec2) -> Option<EmitterSample> {
        Some(EmitterSample {
            direction: -self.direction,
            target: None,
            radiance: self.irradiance,
            density: SolidAngleDensity(1.0),
            is_dirac: true,
            surface: None,
        })
    }

    #[inline]
    fn sample_emission(&self, u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        let sample = self.sample_toward(self.bounds.centre, u_direction)?;
        Some(EmittedRay::from_infinity(&sample, self.bounds, u_point))
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, _direction: Vec3) -> EmissionDensity {
        EmissionDensity {
            point: self.bounds.disk_density(),
            direction: SolidAngleDensity(1.0),
        }
    }

    fn invert_toward(
        &self,
        _from: Vec3,
        _toward: Vec3,
        _at: Option<&SurfacePoint>,
        spare: Vec2,
    ) -> Option<Vec2> {
        Some(spare)
    }

    fn invert_emission(
        &self,
        _at: Option<&SurfacePoint>,
        ray: RayOfLight,
        spare: [Vec2; 2],
    ) -> Option<[Vec2; 2]> {
        let direction = self.direction;
        let point = self.bounds.invert_disk(RayOfLight { direction, ..ray })?;
        Some([point, spare[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mitsuba 3.9.1: direction (1, 1, 0) and irradiance 2 give (−0.707107, −0.707107, 0) and 2.
    #[test]
    fn light_arrives_against_its_direction() {
        let light = Directional::new(Vec3::new(1.0, 1.0, 0.0), Rgb::grey(2.0)).unwrap();
        let sample = light.sample_toward(Vec3::Z, Vec2::ZERO).unwrap();
        let half = -0.5_f32.sqrt();
        assert!((sample.direction - Vec3::new(half, half, 0.0)).length() < 1e-6);
        assert_eq!(sample.radiance, Rgb::grey(2.0));
        assert_eq!(sample.target, None);
        let none = Directional::new(Vec3::ZERO, Rgb::WHITE).err();
        assert_eq!(none, Some(EmitterError::NoDirection));
    }
}
