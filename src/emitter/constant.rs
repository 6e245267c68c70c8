//! The same light from everywhere.

use std::f64::consts::PI;

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterModel, EmitterSample, RayOfLight, SceneBounds,
};
use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3, warp};
use crate::shape::SurfacePoint;

/// An environment of one colour.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    radiance: Rgb,
    bounds: SceneBounds,
}

impl Constant {
    /// Makes the light.
    ///
    /// - `radiance`: in W·m⁻²·sr⁻¹.
    pub const fn new(radiance: Rgb) -> Self {
        Self {
            radiance,
            bounds: SceneBounds::UNIT,
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
        self.bounds = bounds;
    }

    /// What enters the sphere around the scene.
    fn power(&self) -> f64 {
        let area = 4.0 * PI * f64::from(self.bounds.radius).powi(2);
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

    #[inline]
    fn sample_emission(&self, u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        let sample = self.sample_toward(self.bounds.centre, u_direction)?;
        Some(EmittedRay::from_infinity(&sample, self.bounds, u_point))
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity {
        EmissionDensity {
            point: self.bounds.disk_density(),
            direction: self.environment_density(-direction),
        }
    }

    fn invert_toward(
        &self,
        _from: Vec3,
        toward: Vec3,
        _at: Option<&SurfacePoint>,
        _spare: Vec2,
    ) -> Option<Vec2> {
        let u = warp::uniform_sphere_inverse(toward);
        Some(warp::into_unit_square(u))
    }

    fn invert_emission(
        &self,
        _at: Option<&SurfacePoint>,
        ray: RayOfLight,
        spare: [Vec2; 2],
    ) -> Option<[Vec2; 2]> {
        let direction = self.invert_toward(ray.through, -ray.direction, None, spare[1])?;
        Some([self.bounds.invert_disk(ray)?, direction])
    }
}
