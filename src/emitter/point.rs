//! A point that radiates equally into all directions.

use std::f64::consts::PI;

use super::{EmissionDensity, EmittedRay, EmitterClass, EmitterModel, EmitterSample, RayOfLight};
use crate::math::{AreaDensity, Rgb, SolidAngleDensity, Vec2, Vec3, warp};
use crate::shape::SurfacePoint;

/// An isotropic point light.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    position: Vec3,
    intensity: Rgb,
}

impl Point {
    /// Makes the light.
    ///
    /// - `position`: in world space.
    /// - `intensity`: radiant intensity in W·sr⁻¹.
    pub const fn new(position: Vec3, intensity: Rgb) -> Self {
        Self {
            position,
            intensity,
        }
    }
}

impl EmitterModel for Point {
    fn examples() -> Vec<Self> {
        vec![Self::new(
            Vec3::new(0.1, 0.2, -0.3),
            Rgb::new(1.0, 0.5, 0.2),
        )]
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Point
    }

    fn power(&self) -> f64 {
        4.0 * PI * f64::from(self.intensity.luminance())
    }

    #[inline]
    fn influence(&self, from: Vec3) -> f32 {
        self.intensity.luminance() / (self.position - from).length_squared().max(1e-20)
    }

    #[inline]
    fn intensity(&self, _direction: Vec3) -> Rgb {
        self.intensity
    }

    #[inline(never)]
    fn sample_toward(&self, from: Vec3, _u: Vec2) -> Option<EmitterSample> {
        EmitterSample::of_point(self.position, from, |_| self.intensity)
    }

    #[inline]
    fn sample_emission(&self, _u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        Some(EmittedRay::from_point(
            self.position,
            warp::uniform_sphere(u_direction),
            self.intensity,
            SolidAngleDensity(warp::UNIFORM_SPHERE_DENSITY),
        ))
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, _direction: Vec3) -> EmissionDensity {
        EmissionDensity {
            point: AreaDensity(1.0),
            direction: SolidAngleDensity(warp::UNIFORM_SPHERE_DENSITY),
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
        let u = warp::uniform_sphere_inverse(ray.direction);
        Some([spare[0], warp::into_unit_square(u)])
    }
}
