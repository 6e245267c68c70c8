//! A slide projector.

use std::f32::consts::PI;

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample,
    RayOfLight,
};
use crate::math::{
    AreaDensity, Mat3, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3, rotation_part, warp,
};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TextureModel};

/// A point light that throws a picture: a camera whose light goes the other way.
///
/// A screen across its axis is lit as the slide says, evenly where the slide is even.
#[derive(Clone, Debug)]
pub struct Projector {
    position: Vec3,
    /// From the projector's axes to the world's, orthonormal.
    axes: Mat3,
    slide: Texture,
    scale: f32,
    /// Half of the picture's width and height on a screen at distance one.
    half_extent: Vec2,
    /// Intensity along the axis where the slide is at its mean, as luminance.
    mean: f32,
}

impl Projector {
    /// Makes the light.
    ///
    /// - `to_world`: from a projector at the origin that shines along +z, with +x to the left of the
    ///   picture and +y up; its scale is ignored.
    /// - `slide`: radiant exitance of a matt white screen at distance one, divided by π: times π,
    ///   its irradiance in W·m⁻².
    /// - `scale`: multiplies it; not negative.
    /// - `half_extent`: half of the picture's width and height on that screen, in m; positive.
    ///
    /// # Errors
    /// [`EmitterError::Singular`], [`EmitterError::BadScale`], [`EmitterError::BadAngle`] for a
    /// picture without extent.
    pub fn new(
        to_world: Mat4,
        slide: impl Into<Texture>,
        scale: f32,
        half_extent: Vec2,
    ) -> Result<Self, EmitterError> {
        let axes = rotation_part(to_world).ok_or(EmitterError::Singular)?;
        let position = to_world.w_axis.truncate();
        if !position.is_finite() {
            return Err(EmitterError::Singular);
        }
        if !(scale >= 0.0 && scale.is_finite()) {
            return Err(EmitterError::BadScale);
        }
        if !(half_extent.min_element() > 0.0 && half_extent.is_finite()) {
            return Err(EmitterError::BadAngle);
        }
        let slide = slide.into();
        let scale = PI * scale;
        let mean = slide.mean().luminance() * scale;
        Ok(Self {
            position,
            axes,
            slide,
            scale,
            half_extent,
            mean,
        })
    }

    /// Where on the slide a direction away from the projector goes through, and the inverse of the
    /// cube of its cosine to the axis; `None` beside the picture.
    #[inline]
    fn through_slide(&self, direction: Vec3) -> Option<(Vec2, f32)> {
        let local = self.axes.transpose() * direction;
        if local.z <= 0.0 {
            return None;
        }
        let on_screen = local.truncate() / local.z;
        let uv = 0.5 - on_screen * 0.5 / self.half_extent;
        let is_inside = uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all();
        is_inside.then(|| (uv, local.z.powi(-3)))
    }
}

impl EmitterModel for Projector {
    fn examples() -> Vec<Self> {
        let to_world = Mat4::from_translation(Vec3::new(0.2, -0.3, 0.1))
            * Mat4::from_rotation_y(0.8)
            * Mat4::from_scale(Vec3::splat(3.0));
        let slide = crate::texture::Checkerboard::new(
            [Rgb::new(0.2, 1.0, 0.5), Rgb::grey(0.1)],
            Mat3::from_scale(Vec2::splat(2.0)),
        );
        let made = Self::new(to_world, slide, 2.0, Vec2::new(0.8, 0.5));
        made.into_iter().collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Point
    }

    fn power(&self) -> f64 {
        // What passes through the screen: the cosine and the distance cancel the cube.
        4.0 * f64::from(self.half_extent.element_product()) * f64::from(self.mean)
    }

    #[inline]
    fn influence(&self, from: Vec3) -> f32 {
        let edge = from - self.position;
        let distance_squared = edge.length_squared().max(1e-20);
        let direction = edge / distance_squared.sqrt();
        // By the slide's mean: its dark spots may lie beside bright ones.
        self.through_slide(direction)
            .map_or(0.0, |(_, stretch)| self.mean * stretch / distance_squared)
    }

    #[inline]
    fn intensity(&self, direction: Vec3) -> Rgb {
        self.through_slide(direction)
            .map_or(Rgb::BLACK, |(uv, stretch)| {
                self.slide.colour(uv) * (self.scale * stretch)
            })
    }

    #[inline(never)]
    fn sample_toward(&self, from: Vec3, _u: Vec2) -> Option<EmitterSample> {
        EmitterSample::of_point(self.position, from, |direction| self.intensity(direction))
    }

    /// Directions are uniform on a screen across the axis.
    #[inline]
    fn sample_emission(&self, _u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        let on_screen = (1.0 - 2.0 * u_direction) * self.half_extent;
        let direction = (self.axes * on_screen.extend(1.0)).normalize();
        let density = self.emission_density(None, direction).direction;
        (density.0 > 0.0).then(|| {
            EmittedRay::from_point(self.position, direction, self.intensity(direction), density)
        })
    }

    #[inline]
    fn emission_density(&self, _at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity {
        let screen = 4.0 * self.half_extent.element_product();
        let stretch = self.through_slide(direction).map_or(0.0, |(_, s)| s);
        EmissionDensity {
            point: AreaDensity(1.0),
            direction: SolidAngleDensity(stretch / screen),
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
        // What goes through the slide at (u, v) is made of the same numbers.
        let (u, _) = self.through_slide(ray.direction)?;
        Some([spare[0], warp::into_unit_square(u)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_is_lit_evenly_and_the_picture_stands_upright() {
        let even = Projector::new(Mat4::IDENTITY, 1.0, 0.5, Vec2::new(1.0, 0.5)).unwrap();
        for (x, y) in [(0.0, 0.0), (0.9, 0.4), (-0.7, 0.1)] {
            let on_screen = Vec3::new(x, y, 2.0) * Vec3::new(2.0, 2.0, 1.0);
            let sample = even.sample_toward(on_screen, Vec2::ZERO).unwrap();
            let irradiance = sample.radiance.luminance() * -sample.direction.z;
            let expected = 0.5 * PI / 4.0;
            assert!((irradiance / expected - 1.0).abs() < 1e-5, "{irradiance}");
        }
        let beside = Vec3::new(2.1, 0.0, 2.0);
        assert!(even.sample_toward(beside, Vec2::ZERO).is_none());
        assert!(even.sample_toward(Vec3::NEG_Z, Vec2::ZERO).is_none());
        // The upper left corner of the picture, seen along the light, is its u = v = 0.
        let (uv, _) = even
            .through_slide(Vec3::new(0.99, 0.49, 1.0).normalize())
            .unwrap();
        assert!(uv.max_element() < 0.02, "{uv}");
    }

    #[test]
    fn projectors_that_cannot_be_are_refused() {
        let made = |scale, half: Vec2| Projector::new(Mat4::IDENTITY, 1.0, scale, half).err();
        assert_eq!(made(1.0, Vec2::ONE), None);
        assert_eq!(made(-1.0, Vec2::ONE), Some(EmitterError::BadScale));
        assert_eq!(made(1.0, Vec2::new(0.0, 1.0)), Some(EmitterError::BadAngle));
        let flat = Projector::new(Mat4::from_scale(Vec3::X), 1.0, 1.0, Vec2::ONE);
        assert_eq!(flat.err(), Some(EmitterError::Singular));
    }
}
