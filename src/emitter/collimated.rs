//! A single ray of light.

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample,
    RayOfLight,
};
use crate::math::{AreaDensity, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::SurfacePoint;

/// A beam without width: all of its light leaves one point in one direction.
///
/// No surface can ask for it, but at the one point that it meets, which no path from the eye finds: only light
/// that is traced from the beam on shows it.
#[derive(Clone, Copy, Debug)]
pub struct Collimated {
    position: Vec3,
    /// Unit direction in which the light travels.
    direction: Vec3,
    flux: Rgb,
}

impl Collimated {
    /// Makes the beam.
    ///
    /// - `to_world`: from a beam that leaves the origin along +z; only where it puts that point and
    ///   that direction counts.
    /// - `flux`: radiant flux in W.
    ///
    /// # Errors
    /// [`EmitterError::Singular`] where the transform leaves no direction, or no point.
    pub fn new(to_world: Mat4, flux: Rgb) -> Result<Self, EmitterError> {
        let direction = to_world.transform_vector3(Vec3::Z).try_normalize();
        let position = to_world.w_axis.truncate();
        match direction {
            Some(direction) if position.is_finite() => Ok(Self {
                position,
                direction,
                flux,
            }),
            _ => Err(EmitterError::Singular),
        }
    }
}

impl EmitterModel for Collimated {
    fn examples() -> Vec<Self> {
        let place = Mat4::from_translation(Vec3::new(0.3, -0.2, 1.0));
        Self::new(place * Mat4::from_rotation_x(2.0), Rgb::new(3.0, 2.0, 1.0))
            .into_iter()
            .collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Collimated
    }

    fn power(&self) -> f64 {
        f64::from(self.flux.luminance())
    }

    /// None: no point can ask for the beam.
    #[inline]
    fn influence(&self, _from: Vec3) -> f32 {
        0.0
    }

    #[inline]
    fn sample_toward(&self, _from: Vec3, _u: Vec2) -> Option<EmitterSample> {
        None
    }

    #[inline]
    fn sample_emission(&self, _u_point: Vec2, _u_direction: Vec2) -> Option<EmittedRay> {
        let one = SolidAngleDensity(1.0);
        Some(EmittedRay::from_point(
            self.position,
            self.direction,
            self.flux,
            one,
        ))
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, _direction: Vec3) -> EmissionDensity {
        EmissionDensity {
            point: AreaDensity(1.0),
            direction: SolidAngleDensity(1.0),
        }
    }

    fn invert_toward(
        &self,
        _from: Vec3,
        _toward: Vec3,
        _at: Option<&SurfacePoint>,
        _spare: Vec2,
    ) -> Option<Vec2> {
        None
    }

    fn invert_emission(
        &self,
        _at: Option<&SurfacePoint>,
        _ray: RayOfLight,
        spare: [Vec2; 2],
    ) -> Option<[Vec2; 2]> {
        Some(spare)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ray_is_the_same_and_carries_all() {
        let turned = Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let place = Mat4::from_translation(Vec3::new(1.0, 2.0, 3.0));
        let scaled = place * turned * Mat4::from_scale(Vec3::splat(7.0));
        let beam = Collimated::new(scaled, Rgb::new(1.0, 2.0, 4.0)).unwrap();
        for u in [Vec2::ZERO, Vec2::splat(0.5), Vec2::new(0.9, 0.1)] {
            let ray = beam.sample_emission(u, u).unwrap();
            assert_eq!(ray.origin, Vec3::new(1.0, 2.0, 3.0));
            assert!((ray.direction - Vec3::X).length() < 1e-6);
            assert_eq!(ray.power(), Rgb::new(1.0, 2.0, 4.0));
        }
        assert!(beam.sample_toward(Vec3::ZERO, Vec2::ZERO).is_none());
        let flat = Mat4::from_scale(Vec3::new(1.0, 1.0, 0.0));
        let none = Collimated::new(flat, Rgb::WHITE).err();
        assert_eq!(none, Some(EmitterError::Singular));
    }
}
