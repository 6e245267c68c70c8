//! The sun and the sky by day.

mod position;
mod sun_light;
#[cfg(test)]
mod tests;

pub use position::DateAndPlace;
pub use sun_light::SUN_RADIUS;

use sun_light::sun_radiance;

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use hw_skymodel::rgb::{Channel, SkyParams, SkyState};

use super::{
    EmissionDensity, EmittedRay, EmitterClass, EmitterError, EmitterModel, EmitterSample, Envmap,
    RayOfLight, SceneBounds,
};
use crate::image::{Bitmap, Texels};
use crate::math::{Frame, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3, warp};
use crate::shape::SurfacePoint;

/// Width of the table of the sky, around the horizon.
const WIDTH: u32 = 512;
/// Height of the table: odd, so that one row is the horizon.
const HEIGHT: u32 = 257;

/// ∫ ȳ dλ of the CIE 1931 observer in nm: the sky's data are such integrals.
const OBSERVER_INTEGRAL: f32 = 106.856_895;

/// What makes up a [`SunSky`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunSkySettings {
    /// World-space direction to the zenith, of any length.
    pub up: Vec3,
    /// World-space direction to the sun, of any length, above the horizon.
    pub to_sun: Vec3,
    /// Haze of the air, from 1 (none) to 10.
    pub turbidity: f32,
    /// Reflectance of the ground, which lights the air from below, in [0, 1].
    pub albedo: Rgb,
    /// Factor on the sky's radiance; 0 leaves the sky out.
    pub sky_scale: f32,
    /// Factor on the sun's radiance; 0 leaves the sun out.
    pub sun_scale: f32,
    /// Factor on the sun's radius, positive. Its irradiance stays what it is.
    pub sun_radius_scale: f32,
}

/// An environment of a clear or hazy day: the sky above the horizon, and the sun's disk before it.
///
/// The sky is a table of half a degree's steps. Radiance is in W·m⁻²·sr⁻¹·nm⁻¹, averaged over
/// wavelengths as the eye weighs them.
///
/// Source: Hošek & Wilkie 2012, Eq. 8; Preetham, Shirley & Smits 1999, Appendix A.1.
#[derive(Clone, Debug)]
pub struct SunSky {
    sky: Envmap,
    sun: Sun,
    /// Share of the samples that go to the sky.
    sky_share: f32,
    bounds: SceneBounds,
}

/// A disk of even radiance.
#[derive(Clone, Copy, Debug)]
struct Sun {
    /// Where its middle stands.
    frame: Frame,
    radiance: Rgb,
    /// One minus the cosine of its radius.
    one_minus_cos: f32,
}

impl SunSky {
    /// Makes the light.
    ///
    /// # Errors
    /// [`EmitterError::NoDirection`] for a vector that has none, [`EmitterError::SunBelowHorizon`],
    /// [`EmitterError::BadAir`] for a turbidity or an albedo out of range, [`EmitterError::BadScale`],
    /// [`EmitterError::BadRadius`].
    pub fn new(settings: SunSkySettings) -> Result<Self, EmitterError> {
        let unit = |v: Vec3| v.try_normalize().ok_or(EmitterError::NoDirection);
        let (up, to_sun) = (unit(settings.up)?, unit(settings.to_sun)?);
        let scales = [settings.sky_scale, settings.sun_scale];
        if !scales.iter().all(|s| *s >= 0.0 && s.is_finite()) {
            return Err(EmitterError::BadScale);
        }
        let sun = Sun::new(to_sun, up, &settings)?;
        let sky = sky(to_sun, up, &settings)?;
        // Four influences are the integral over the sphere, as the sun's is over its disk.
        let (of_sky, of_sun) = (4.0 * sky.influence(Vec3::ZERO), sun.irradiance());
        let sky_share = match (of_sky > 0.0, of_sun > 0.0) {
            (true, true) => (of_sky / (of_sky + of_sun)).clamp(0.1, 0.9),
            (_, of_sun) => f32::from(u8::from(!of_sun)),
        };
        Ok(Self {
            sky,
            sun,
            sky_share,
            bounds: SceneBounds::UNIT,
        })
    }
}

/// Irradiance in W·m⁻²·nm⁻¹ of the sun on a surface that faces it, for a sun without extent.
///
/// - `elevation`: above the horizon, in radians.
pub fn sun_irradiance(elevation: f32, turbidity: f32) -> Rgb {
    let solid_angle = std::f32::consts::TAU * one_minus_cos(SUN_RADIUS);
    sun_radiance(f64::from(elevation), f64::from(turbidity)) * solid_angle
}

/// One minus the cosine of an angle in degrees.
fn one_minus_cos(degrees: f32) -> f32 {
    2.0 * (0.5 * degrees.to_radians()).sin().powi(2)
}

/// Elevation above the horizon in radians.
fn elevation(to_sun: Vec3, up: Vec3) -> Result<f32, EmitterError> {
    let sin = to_sun.dot(up);
    if sin < 0.0 {
        return Err(EmitterError::SunBelowHorizon);
    }
    Ok(sin.min(1.0).asin())
}

/// The sky as a table.
fn sky(to_sun: Vec3, up: Vec3, settings: &SunSkySettings) -> Result<Envmap, EmitterError> {
    let parameters = SkyParams {
        elevation: elevation(to_sun, up)?.min(FRAC_PI_2 as f32),
        turbidity: settings.turbidity,
        albedo: settings.albedo.0.to_array(),
    };
    let model = SkyState::new(&parameters).map_err(|_| EmitterError::BadAir)?;
    let frame = Frame::around(up);
    let axes = [frame.tangent, up, frame.bitangent];
    let radiance = |x: u32, y: u32| -> [f32; 3] {
        let cos = (PI * f64::from(y) / f64::from(HEIGHT - 1)).cos() as f32;
        if 2 * y > HEIGHT - 1 {
            return [0.0; 3];
        }
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (across, along) = (std::f32::consts::TAU * (x as f32 + 0.5) / WIDTH as f32).sin_cos();
        let toward = axes[0] * (sin * across) + up * cos - axes[2] * (sin * along);
        let from_zenith = cos.clamp(0.0, 1.0).acos();
        let from_sun = toward.dot(to_sun).clamp(-1.0, 1.0).acos();
        [Channel::R, Channel::G, Channel::B].map(|channel| {
            let radiance = model.radiance(from_zenith, from_sun, channel);
            radiance.max(0.0) / OBSERVER_INTEGRAL
        })
    };
    let places = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let texels = places.flat_map(|(x, y)| radiance(x, y));
    let Some(table) = Bitmap::new(WIDTH, HEIGHT, 3, Texels::Float(texels.collect())) else {
        unreachable!("the table has a texel for each place")
    };
    let [x, y, z] = axes.map(|axis| axis.extend(0.0));
    let to_world = Mat4::from_cols(x, y, z, glam::Vec4::W);
    Envmap::new(Arc::new(table), to_world, settings.sky_scale)
}

impl Sun {
    fn new(to_sun: Vec3, up: Vec3, settings: &SunSkySettings) -> Result<Self, EmitterError> {
        let radius = SUN_RADIUS * settings.sun_radius_scale;
        if !(radius > 0.0 && radius < 90.0) {
            return Err(EmitterError::BadRadius);
        }
        let elevation = elevation(to_sun, up)?;
        let one_minus_cos = one_minus_cos(radius);
        let solid_angle = std::f32::consts::TAU * one_minus_cos;
        let irradiance = sun_irradiance(elevation, settings.turbidity) * settings.sun_scale;
        Ok(Self {
            frame: Frame::around(to_sun),
            radiance: irradiance * (1.0 / solid_angle),
            one_minus_cos,
        })
    }

    /// Luminance of the irradiance on a surface that faces it.
    fn irradiance(&self) -> f32 {
        std::f32::consts::TAU * self.one_minus_cos * self.radiance.luminance()
    }

    /// A unit direction, uniform on the disk.
    #[inline]
    fn sample(&self, u: Vec2) -> Vec3 {
        let local = warp::uniform_cone(u, self.one_minus_cos);
        let frame = &self.frame;
        let across = frame.tangent * local.x + frame.bitangent * local.y;
        (across + frame.normal * local.z).normalize()
    }

    /// Undoes [`Sun::sample`]; `None` beside the disk.
    fn invert(&self, toward: Vec3) -> Option<Vec2> {
        let local = self.frame.to_local(toward).0;
        let u = warp::uniform_cone_inverse(local, self.one_minus_cos);
        self.is_seen(toward).then(|| warp::into_unit_square(u))
    }

    /// True for directions that meet the disk.
    #[inline]
    fn is_seen(&self, toward: Vec3) -> bool {
        // From the difference: the cosine says little about small angles.
        toward.distance_squared(self.frame.normal) <= 2.0 * self.one_minus_cos
    }
}

impl EmitterModel for SunSky {
    fn examples() -> Vec<Self> {
        let clear = SunSkySettings {
            up: Vec3::Y,
            to_sun: Vec3::new(0.5, 0.6, -0.2),
            turbidity: 3.0,
            albedo: Rgb::grey(0.2),
            sky_scale: 1.0,
            sun_scale: 1.0,
            // Wide enough for tests that look at cells of several degrees.
            sun_radius_scale: 60.0,
        };
        let hazy = SunSkySettings {
            up: Vec3::new(0.2, -0.3, 1.0),
            to_sun: Vec3::new(1.0, 0.0, 0.6),
            turbidity: 8.3,
            sun_scale: 0.05,
            ..clear
        };
        let sky_alone = SunSkySettings {
            sun_scale: 0.0,
            ..hazy
        };
        let sun_alone = SunSkySettings {
            sky_scale: 0.0,
            ..clear
        };
        let all = [clear, hazy, sky_alone, sun_alone];
        all.into_iter().filter_map(|s| Self::new(s).ok()).collect()
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Environment
    }

    fn set_scene_bounds(&mut self, bounds: SceneBounds) {
        self.sky.set_scene_bounds(bounds);
        self.bounds = bounds;
    }

    /// What enters the sphere around the scene.
    fn power(&self) -> f64 {
        let cross_section = PI * f64::from(self.bounds.radius).powi(2);
        self.sky.power() + cross_section * f64::from(self.sun.irradiance())
    }

    #[inline]
    fn influence(&self, from: Vec3) -> f32 {
        self.sky.influence(from) + self.sun.irradiance()
    }

    #[inline]
    fn environment_radiance(&self, toward: Vec3) -> Rgb {
        let sky = self.sky.environment_radiance(toward);
        if self.sun.is_seen(toward) {
            sky + self.sun.radiance
        } else {
            sky
        }
    }

    #[inline(never)]
    fn sample_toward(&self, _from: Vec3, u: Vec2) -> Option<EmitterSample> {
        let direction = if u.x < self.sky_share {
            let u = Vec2::new(u.x / self.sky_share, u.y);
            self.sky.sample_direction(u)?
        } else {
            let x = (u.x - self.sky_share) / (1.0 - self.sky_share);
            let u = Vec2::new(x.clamp(0.0, warp::ONE_MINUS_EPSILON), u.y);
            self.sun.sample(u)
        };
        let radiance = self.environment_radiance(direction);
        if radiance.is_black() {
            return None;
        }
        Some(EmitterSample {
            direction,
            target: None,
            radiance,
            density: self.environment_density(direction),
            is_dirac: false,
            surface: None,
        })
    }

    #[inline]
    fn environment_density(&self, toward: Vec3) -> SolidAngleDensity {
        let sky = self.sky_share * self.sky.environment_density(toward).0;
        if !self.sun.is_seen(toward) {
            return SolidAngleDensity(sky);
        }
        let sun = warp::uniform_cone_density(self.sun.one_minus_cos);
        SolidAngleDensity(sky + (1.0 - self.sky_share) * sun)
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
        spare: Vec2,
    ) -> Option<Vec2> {
        let sky = self.sky_share * self.sky.environment_density(toward).0;
        let sun = self.environment_density(toward).0 - sky;
        if spare.x * (sky + sun) < sky {
            let u = self.sky.invert_direction(toward)?;
            return Some(Vec2::new(warp::within(u.x, 0.0, self.sky_share), u.y));
        }
        let u = self.sun.invert(toward)?;
        Some(Vec2::new(warp::within(u.x, self.sky_share, 1.0), u.y))
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
