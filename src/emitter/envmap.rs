//! Light from a picture of all directions.
//!
//! Directions are sampled in proportion to the luminance that a lookup interpolates, cell by cell
//! between texel centres, and uniformly in the cosine to the pole: the density in solid angle has no
//! factor that grows towards the poles. A small uniform part keeps the density positive everywhere;
//! its price is one sample in sixty-five. The table takes 4 bytes a texel.

mod map;

use std::f64::consts::PI;
use std::sync::Arc;

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample,
    RayOfLight, SceneBounds,
};
use crate::image::{Bitmap, Texels};
use crate::math::{Mat3, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3, rotation_part};
use crate::shape::SurfacePoint;

use map::Map;

/// An environment from a latitude-longitude picture; clones share it.
///
/// In the emitter's frame, a unit direction `d` looks up u = atan2(d.x, −d.z)/2π and
/// v = acos(d.y)/π. Texel centres lie at half integers of the width; the first and the last row lie
/// on the poles.
#[derive(Clone, Debug)]
pub struct Envmap {
    map: Arc<Map>,
    /// From the emitter's frame to the world's, orthonormal.
    axes: Mat3,
    scale: f32,
    bounds: SceneBounds,
}

impl Envmap {
    /// Makes the light.
    ///
    /// - `image`: radiance in W·m⁻²·sr⁻¹; alpha is ignored, negative values count as zero.
    /// - `to_world`: only its rotation and mirrors count.
    /// - `scale`: multiplies the radiance; not negative.
    ///
    /// # Errors
    /// [`EmitterError::BadTexel`] where the picture holds an infinite value or not a number,
    /// [`EmitterError::BadScale`], [`EmitterError::Singular`].
    pub fn new(image: Arc<Bitmap>, to_world: Mat4, scale: f32) -> Result<Self, EmitterError> {
        let axes = rotation_part(to_world).ok_or(EmitterError::Singular)?;
        if !(scale >= 0.0 && scale.is_finite()) {
            return Err(EmitterError::BadScale);
        }
        Ok(Self {
            map: Arc::new(Map::new(image)?),
            axes,
            scale,
            bounds: SceneBounds::UNIT,
        })
    }

    /// Samples a unit direction, be it dark there or not; `None` for a black picture.
    #[inline]
    pub(super) fn sample_direction(&self, u: Vec2) -> Option<Vec3> {
        Some((self.axes * self.map.sample(u)?).normalize())
    }

    /// Undoes [`Envmap::sample_direction`], as exactly as numbers tell places inside of a cell apart.
    pub(super) fn invert_direction(&self, toward: Vec3) -> Option<Vec2> {
        self.map.invert(self.axes.transpose() * toward)
    }
}

impl EmitterModel for Envmap {
    fn examples() -> Vec<Self> {
        let smooth = |x: u16, y: u16| f32::from((x * 3 + y * 5) % 7) * 0.2;
        let sun = |x: u16, y: u16| if (x, y) == (3, 1) { 500.0 } else { 0.1 };
        let dark = |x: u16, y: u16| {
            if (4..7).contains(&x) && y > 2 {
                2.0
            } else {
                0.0
            }
        };
        let picture = |width: u16, height: u16, grey: &dyn Fn(u16, u16) -> f32| {
            let texels = (0..height)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .flat_map(|(x, y)| [grey(x, y), grey(x, y) * 0.5, 0.2 * grey(y, x)])
                .collect();
            let bitmap = Bitmap::new(width.into(), height.into(), 3, Texels::Float(texels))?;
            let to_world = Mat4::from_rotation_z(0.6) * Mat4::from_rotation_x(1.0);
            Self::new(Arc::new(bitmap), to_world, 1.5).ok()
        };
        [
            picture(12, 7, &smooth),
            picture(16, 8, &sun),
            picture(10, 6, &dark),
            picture(1, 1, &|_, _| 0.7),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Environment
    }

    fn set_scene_bounds(&mut self, bounds: SceneBounds) {
        self.bounds = bounds;
    }

    /// What enters the sphere around the scene.
    fn power(&self) -> f64 {
        let cross_section = PI * f64::from(self.bounds.radius).powi(2);
        cross_section * self.map.integral * f64::from(self.scale)
    }

    #[inline]
    fn influence(&self, _from: Vec3) -> f32 {
        // A quarter of the sphere's integral: the mean over all ways that a surface can face.
        0.25 * self.map.integral as f32 * self.scale
    }

    #[inline]
    fn environment_radiance(&self, toward: Vec3) -> Rgb {
        let place = self.map.place(self.axes.transpose() * toward);
        self.map.radiance(&place) * self.scale
    }

    #[inline(never)]
    fn sample_toward(&self, _from: Vec3, u: Vec2) -> Option<EmitterSample> {
        let direction = self.sample_direction(u)?;
        let place = self.map.place(self.axes.transpose() * direction);
        let radiance = self.map.radiance(&place) * self.scale;
        if radiance.is_black() {
            return None;
        }
        Some(EmitterSample {
            direction,
            target: None,
            radiance,
            density: self.map.density(&place),
            is_dirac: false,
            surface: None,
        })
    }

    #[inline]
    fn environment_density(&self, toward: Vec3) -> SolidAngleDensity {
        let place = self.map.place(self.axes.transpose() * toward);
        self.map.density(&place)
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
        self.invert_direction(toward)
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

#[cfg(test)]
mod tests;
