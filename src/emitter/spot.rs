//! A lamp with a beam.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample,
    RayOfLight,
};
use crate::math::{
    AreaDensity, Mat3, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3, rotation_part, warp,
};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// How wide the beam of a [`Spot`] is; angles from its axis, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// From here on there is no light.
    pub cutoff: f32,
    /// Up to here there is full light; falls off linearly in the angle from here to the cutoff.
    pub full: f32,
}

impl Beam {
    /// A beam with full light over the inner three quarters of its angle.
    pub fn new(cutoff: f32) -> Self {
        Self {
            cutoff,
            full: 0.75 * cutoff,
        }
    }

    /// Part of the full light at an angle.
    #[inline]
    fn falloff(self, angle: f32) -> f32 {
        if angle <= self.full {
            1.0
        } else {
            (self.cutoff - angle) / (self.cutoff - self.full)
        }
    }

    /// One minus the cosine of the cutoff.
    #[inline]
    fn one_minus_cos(self) -> f32 {
        2.0 * (0.5 * self.cutoff).sin().powi(2)
    }

    /// Solid angle in sr, weighted by the falloff.
    fn solid_angle(self) -> f64 {
        let (full, cutoff) = (f64::from(self.full), f64::from(self.cutoff));
        let mean_cos = if cutoff > full {
            (cutoff.sin() - full.sin()) / (cutoff - full)
        } else {
            cutoff.cos()
        };
        std::f64::consts::TAU * (1.0 - mean_cos)
    }
}

/// A point light that shines into a cone around its +z, perhaps through a slide.
#[derive(Clone, Debug)]
pub struct Spot {
    position: Vec3,
    /// From the lamp's axes to the world's, orthonormal.
    axes: Mat3,
    intensity: Rgb,
    slide: Option<Texture>,
    beam: Beam,
    power: f64,
}

impl Spot {
    /// Makes the light.
    ///
    /// - `to_world`: from a lamp at the origin that shines along +z; its scale is ignored.
    /// - `intensity`: radiant intensity along the axis, in W·sr⁻¹.
    /// - `beam`: where `full` lies beyond `cutoff`, the beam has a sharp edge.
    /// - `slide`: multiplies the intensity. It is projected so that the cone is inscribed in its
    ///   unit square, `u` along the lamp's +x and `v` along its +y.
    ///
    /// # Errors
    /// [`EmitterError::Singular`]; [`EmitterError::BadAngle`] for a cutoff outside of (0, π], or of
    /// (0, π/2) where there is a slide.
    pub fn new(
        to_world: Mat4,
        intensity: Rgb,
        beam: Beam,
        slide: Option<Texture>,
    ) -> Result<Self, EmitterError> {
        let axes = rotation_part(to_world).ok_or(EmitterError::Singular)?;
        let position = to_world.w_axis.truncate();
        if !position.is_finite() {
            return Err(EmitterError::Singular);
        }
        let beam = Beam {
            full: beam.full.min(beam.cutoff),
            ..beam
        };
        let limit_kept = match slide {
            Some(_) => beam.cutoff < FRAC_PI_2,
            None => beam.cutoff <= PI,
        };
        // Written so that a number that is not one fails as well.
        if !(beam.cutoff > 0.0 && limit_kept && beam.full >= 0.0) {
            return Err(EmitterError::BadAngle);
        }
        let mut spot = Self {
            position,
            axes,
            intensity,
            slide,
            beam,
            power: 0.0,
        };
        spot.power = match &spot.slide {
            None => beam.solid_angle() * f64::from(intensity.luminance()),
            Some(_) => spot.power_through_slide(),
        };
        Ok(spot)
    }

    /// Intensity in a unit direction away from the lamp.
    #[inline]
    fn intensity_along(&self, direction: Vec3) -> Rgb {
        let local = self.axes.transpose() * direction;
        let angle = local.truncate().length().atan2(local.z);
        if angle >= self.beam.cutoff {
            return Rgb::BLACK;
        }
        let falloff = self.intensity * self.beam.falloff(angle);
        match &self.slide {
            None => falloff,
            Some(slide) => {
                let half_width = self.beam.cutoff.tan() * local.z;
                falloff * slide.colour(0.5 + local.truncate() * (0.5 / half_width))
            }
        }
    }

    /// Power by midpoints: 64 angles to the axis, 256 around it.
    fn power_through_slide(&self) -> f64 {
        const ANGLES: u32 = 64;
        const TURNS: u32 = 256;
        let step = self.beam.cutoff / ANGLES as f32;
        let mut power = 0.0;
        for i in 0..ANGLES {
            let (sin, cos) = ((i as f32 + 0.5) * step).sin_cos();
            for j in 0..TURNS {
                let (y, x) = ((j as f32 + 0.5) / TURNS as f32 * TAU).sin_cos();
                let direction = self.axes * Vec3::new(sin * x, sin * y, cos);
                power += f64::from(self.intensity_along(direction).luminance() * sin);
            }
        }
        power * f64::from(step * TAU) / f64::from(TURNS)
    }
}

impl EmitterModel for Spot {
    fn examples() -> Vec<Self> {
        let to_world = Mat4::from_translation(Vec3::new(0.2, -0.3, 0.1))
            * Mat4::from_rotation_y(0.8)
            * Mat4::from_scale(Vec3::splat(3.0));
        let intensity = Rgb::new(3.0, 2.0, 1.0);
        let slide = crate::texture::Checkerboard::new(
            [Rgb::new(0.2, 1.0, 0.5), Rgb::grey(0.1)],
            Mat3::from_scale(Vec2::splat(1.3)),
        );
        let wide = Beam {
            cutoff: 2.5,
            full: 0.4,
        };
        let sharp = Beam {
            cutoff: 0.7,
            full: 1.0,
        };
        [
            (Beam::new(0.35), None),
            (wide, None),
            (sharp, Some(slide.into())),
        ]
        .into_iter()
        .filter_map(|(beam, slide)| Self::new(to_world, intensity, beam, slide).ok())
        .collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Point
    }

    fn power(&self) -> f64 {
        self.power
    }

    #[inline]
    fn influence(&self, from: Vec3) -> f32 {
        let edge = from - self.position;
        let distance_squared = edge.length_squared().max(1e-20);
        let angle = edge.angle_between(self.axes.z_axis);
        if angle >= self.beam.cutoff {
            return 0.0;
        }
        // Without the slide, whose dark spots may lie beside bright ones.
        self.intensity.luminance() * self.beam.falloff(angle) / distance_squared
    }

    #[inline]
    fn intensity(&self, direction: Vec3) -> Rgb {
        self.intensity_along(direction)
    }

    #[inline(never)]
    fn sample_toward(&self, from: Vec3, _u: Vec2) -> Option<EmitterSample> {
        EmitterSample::of_point(self.position, from, |direction| {
            self.intensity_along(direction)
        })
    }

    /// Directions are uniform in the cone.
    #[inline]
    fn sample_emission(&self, _u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        let local = warp::uniform_cone(u_direction, self.beam.one_minus_cos());
        let direction = (self.axes * local).normalize();
        Some(EmittedRay::from_point(
            self.position,
            direction,
            self.intensity_along(direction),
            SolidAngleDensity(warp::uniform_cone_density(self.beam.one_minus_cos())),
        ))
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity {
        let one_minus_cos = self.beam.one_minus_cos();
        // From the difference: the cosine says little about small angles.
        let is_inside = direction.distance_squared(self.axes.z_axis) <= 2.0 * one_minus_cos;
        let cone = warp::uniform_cone_density(one_minus_cos);
        EmissionDensity {
            point: AreaDensity(1.0),
            direction: SolidAngleDensity(if is_inside { cone } else { 0.0 }),
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
        let is_made = self.emission_density(None, ray.direction).direction.0 > 0.0;
        let local = self.axes.transpose() * ray.direction;
        let u = is_made.then(|| warp::uniform_cone_inverse(local, self.beam.one_minus_cos()))?;
        Some([spare[0], warp::into_unit_square(u)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Texels};
    use crate::texture::{self, Filter, Wrap};

    fn received(spot: &Spot, from: Vec3) -> Rgb {
        spot.sample_toward(from, Vec2::ZERO)
            .map_or(Rgb::BLACK, |sample| sample.radiance)
    }

    /// Irradiance at 2 m from a lamp of 2 W/sr, in Mitsuba 3.9.1.
    #[test]
    fn falloff_is_that_of_mitsuba() {
        let cutoff = 20.0_f32.to_radians();
        let narrow = Beam {
            cutoff,
            full: 10.0_f32.to_radians(),
        };
        let lamp = |beam| Spot::new(Mat4::IDENTITY, Rgb::grey(2.0), beam, None).unwrap();
        let check = |spot: &Spot, degrees: f32, expected: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let found = received(spot, Vec3::new(sin, 0.0, cos) * 2.0).r();
            assert!((found - expected).abs() < 1e-5, "{found} at {degrees}");
        };
        let values = [
            (0.0, 0.5),
            (9.99, 0.5),
            (10.01, 0.4995),
            (12.0, 0.4),
            (15.0, 0.25),
            (17.0, 0.15),
            (19.9, 0.005),
            (20.1, 0.0),
            (180.0, 0.0),
        ];
        for (degrees, expected) in values {
            check(&lamp(narrow), degrees, expected);
        }
        for (degrees, expected) in [(14.9, 0.5), (15.1, 0.49), (17.0, 0.3), (19.9, 0.01)] {
            check(&lamp(Beam::new(cutoff)), degrees, expected);
        }
    }

    /// A picture with `u` in red and `v` in green, through a lamp of 40° in Mitsuba 3.9.1.
    #[test]
    fn slides_are_projected_as_in_mitsuba() {
        let texel = |i: u16| (f32::from(i) + 0.5) / 64.0;
        let texels = (0..64 * 64).flat_map(|i| [texel(i % 64), texel(i / 64), 1.0]);
        let image = Bitmap::new(64, 64, 3, Texels::Float(texels.collect())).unwrap();
        let slide =
            texture::Bitmap::new(image.into(), Filter::Bilinear, Wrap::Clamp, Mat3::IDENTITY);
        let beam = Beam {
            cutoff: 40.0_f32.to_radians(),
            full: 39.0_f32.to_radians(),
        };
        let spot = Spot::new(Mat4::IDENTITY, Rgb::WHITE, beam, Some(slide.into())).unwrap();
        let values = [
            ([0.2, 0.3], [0.619_175, 0.678_763]),
            ([-0.2, 0.3], [0.380_825, 0.678_763]),
            ([0.2, -0.3], [0.619_175, 0.321_237]),
            ([0.5, 0.0], [0.797_938, 0.5]),
            ([0.0, 0.7], [0.5, 0.917_114]),
        ];
        for ([x, y], [u, v]) in values {
            let from = Vec3::new(x, y, 1.0);
            let colour = received(&spot, from) * from.length_squared();
            let miss = (colour - Rgb::new(u, v, 1.0)).0.abs().max_element();
            assert!(miss < 1e-5, "{colour:?} at {from}");
        }
    }

    #[test]
    fn angles_out_of_range_are_refused() {
        let spot = |cutoff, slide: Option<Texture>, to_world| {
            Spot::new(to_world, Rgb::WHITE, Beam::new(cutoff), slide).err()
        };
        let slide = || Some(Texture::from(1.0));
        assert_eq!(spot(3.0, None, Mat4::IDENTITY), None);
        assert_eq!(
            spot(1.6, slide(), Mat4::IDENTITY),
            Some(EmitterError::BadAngle)
        );
        assert_eq!(
            spot(0.0, None, Mat4::IDENTITY),
            Some(EmitterError::BadAngle)
        );
        assert_eq!(
            spot(f32::NAN, None, Mat4::IDENTITY),
            Some(EmitterError::BadAngle)
        );
        assert_eq!(spot(1.0, None, Mat4::ZERO), Some(EmitterError::Singular));
    }
}
