//! Lights.
//!
//! An emitter answers three questions: what it sends along a given ray, how to find it from a point,
//! and which rays leave it. [`EmitterModel::density_toward`] is exactly the density of
//! [`EmitterModel::sample_toward`], and [`EmitterModel::emission_density`] that of
//! [`EmitterModel::sample_emission`]; Dirac emitters (points, parallel light) are never hit by chance.
//!
//! A new model is a file, a line in `emitter_models!` and an arm in the importer. The tests pick it
//! up from its [`EmitterModel::examples`].

mod area;
mod collimated;
mod constant;
mod directional;
mod emission;
mod envmap;
mod point;
mod projector;
mod spot;
mod sun_sky;
#[cfg(test)]
mod tests;

pub use area::{Area, MeshLight};
pub use collimated::Collimated;
pub use constant::Constant;
pub use directional::Directional;
pub use emission::{EmissionDensity, EmittedRay, RayOfLight};
pub use envmap::Envmap;
pub use point::Point;
pub use projector::Projector;
pub use spot::{Beam, Spot};
pub use sun_sky::{DateAndPlace, SUN_RADIUS, SunSky, SunSkySettings, sun_irradiance};

use thiserror::Error;

use crate::math::{Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::SurfacePoint;

/// What kind of thing an emitter is: decides which path mutations apply to its paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmitterClass {
    /// A surface that glows.
    Area,
    /// A point in space: no ray meets it.
    Point,
    /// One direction from infinitely far away: no ray meets it.
    Directional,
    /// One point and one direction: no ray meets it, and no point can be connected to it.
    Collimated,
    /// All directions from infinitely far away.
    Environment,
}

impl EmitterClass {
    /// True for emitters that no ray can meet by chance.
    #[inline]
    pub fn is_dirac(self) -> bool {
        matches!(self, Self::Point | Self::Directional | Self::Collimated)
    }

    /// True for emitters that send something to every point that sees them, so that paths from the eye can end there.
    #[inline]
    pub fn is_connectable(self) -> bool {
        self != Self::Collimated
    }
}

/// Why numbers do not describe an emitter.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum EmitterError {
    /// The emitter-to-world transform has no inverse, or holds numbers that are not finite.
    #[error("the emitter's transform flattens space or is not finite")]
    Singular,
    /// The direction of a directional light is zero or not finite.
    #[error("the direction is zero or not finite")]
    NoDirection,
    /// The cutoff of a spot light is out of its range.
    #[error("the cutoff angle must lie between 0 and 180 degrees, and below 90 with a texture")]
    BadAngle,
    /// A scale is negative or not finite.
    #[error("the scale must be a finite number that is not negative")]
    BadScale,
    /// The sun's disk has no radius, or that of half the sky.
    #[error("the sun's radius must be more than 0 and less than 90 degrees")]
    BadRadius,
    /// The turbidity of the air or the albedo of the ground is out of its range.
    #[error("the turbidity must lie between 1 and 10, and the albedo between 0 and 1")]
    BadAir,
    /// It is night.
    #[error("the sun is below the horizon")]
    SunBelowHorizon,
    /// The picture of an environment map holds an infinite value or not a number.
    #[error("the texel in column {x} of row {y} is not finite")]
    BadTexel {
        /// Column, from 0.
        x: u32,
        /// Row, from 0.
        y: u32,
    },
}

/// A sphere around the whole scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneBounds {
    /// Its centre.
    pub centre: Vec3,
    /// Its radius in m, positive.
    pub radius: f32,
}

impl SceneBounds {
    /// What emitters assume until they are told.
    const UNIT: Self = Self {
        centre: Vec3::ZERO,
        radius: 1.0,
    };
}

/// A direction to an emitter that was sampled.
#[derive(Clone, Copy, Debug)]
pub struct EmitterSample {
    /// Unit direction from the asking point to the emitter.
    pub direction: Vec3,
    /// Where a shadow ray must reach to; `None` when the emitter is infinitely far away.
    pub target: Option<Vec3>,
    /// Radiance that arrives (W·m⁻²·sr⁻¹); for Dirac emitters the irradiance on a surface that faces
    /// `direction` (W·m⁻²).
    pub radiance: Rgb,
    /// Density of the direction; one for Dirac emitters.
    pub density: SolidAngleDensity,
    /// True when the direction has no density, so that no other technique can make it.
    pub is_dirac: bool,
    /// The point of the surface that glows; `None` for emitters that are no surfaces.
    pub surface: Option<SurfacePoint>,
}

impl EmitterSample {
    /// The direction to a light at a point; `None` from right there, and where it sends nothing.
    ///
    /// - `intensity`: radiant intensity (W·sr⁻¹) in a unit direction away from the light.
    #[inline]
    fn of_point(position: Vec3, from: Vec3, intensity: impl FnOnce(Vec3) -> Rgb) -> Option<Self> {
        let edge = position - from;
        let direction = edge.try_normalize()?;
        let intensity = intensity(-direction);
        (!intensity.is_black()).then(|| Self {
            direction,
            target: Some(position),
            radiance: intensity / edge.length_squared(),
            density: SolidAngleDensity(1.0),
            is_dirac: true,
            surface: None,
        })
    }
}

/// What a light can answer.
pub trait EmitterModel {
    /// Lights that stand for the model in tests and benchmarks: each feature, each limit.
    fn examples() -> Vec<Self>
    where
        Self: Sized;

    /// The kind of light.
    fn class(&self) -> EmitterClass;

    /// Takes note of the size of the scene; called once, before anything else is asked.
    fn set_scene_bounds(&mut self, bounds: SceneBounds) {
        let _ = bounds;
    }

    /// Emitted power in W, as luminance.
    fn power(&self) -> f64;

    /// Roughly the irradiance, as luminance in W·m⁻², that the emitter causes at a point, whatever
    /// faces it or stands in between: emitters are chosen in proportion to it. Never negative.
    fn influence(&self, from: Vec3) -> f32;

    /// Radiance that leaves the point of an area light in a direction away from it; zero behind.
    fn radiance(&self, at: &SurfacePoint, direction: Vec3) -> Rgb {
        let _ = (at, direction);
        Rgb::BLACK
    }

    /// Radiant intensity (W·sr⁻¹) of a light at a point in a unit direction away from it.
    fn intensity(&self, direction: Vec3) -> Rgb {
        let _ = direction;
        Rgb::BLACK
    }

    /// Radiance that arrives from the unit direction `toward` infinity.
    fn environment_radiance(&self, toward: Vec3) -> Rgb {
        let _ = toward;
        Rgb::BLACK
    }

    /// Samples a direction to the emitter; `None` when it sends nothing to `from`.
    ///
    /// - `u`: uniform in the unit square.
    fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<EmitterSample>;

    /// Density with which [`EmitterModel::sample_toward`] makes the direction to a point of an area
    /// light.
    fn density_toward(&self, from: Vec3, at: &SurfacePoint) -> SolidAngleDensity {
        let _ = (from, at);
        SolidAngleDensity::ZERO
    }

    /// Density with which [`EmitterModel::sample_toward`] makes the unit direction `toward` infinity.
    fn environment_density(&self, toward: Vec3) -> SolidAngleDensity {
        let _ = toward;
        SolidAngleDensity::ZERO
    }

    /// Samples a ray of the light; `None` when there is none.
    ///
    /// - `u_point`, `u_direction`: uniform in the unit square.
    fn sample_emission(&self, u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay>;

    /// Density with which [`EmitterModel::sample_emission`] makes a ray.
    ///
    /// - `at`: the point of an area light; `None` for others.
    /// - `direction`: unit, in which the light travels. A light of one direction takes any for that one.
    fn emission_density(&self, at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity;

    /// Goes back from a direction to the numbers that [`EmitterModel::sample_toward`] makes it of.
    ///
    /// - `toward`: unit, from the asking point to the emitter.
    /// - `at`: the point of an area light; `None` for others.
    /// - `spare`: uniform in the unit square; stands in for what the direction leaves open. Of the
    ///   direction of a sample of uniform numbers, the result is uniform again.
    ///
    /// `None` where nothing is sampled so.
    fn invert_toward(
        &self,
        from: Vec3,
        toward: Vec3,
        at: Option<&SurfacePoint>,
        spare: Vec2,
    ) -> Option<Vec2>;

    /// Goes back from a ray to the numbers that [`EmitterModel::sample_emission`] makes it of: those of
    /// the point, and those of the direction. A light at a point has no numbers for the one, parallel
    /// light none for the other: they are `spare`.
    ///
    /// - `at`: the point of an area light; `None` for others.
    /// - `spare`: as with [`EmitterModel::invert_toward`], for either pair.
    ///
    /// `None` where no such ray is made.
    fn invert_emission(
        &self,
        at: Option<&SurfacePoint>,
        ray: RayOfLight,
        spare: [Vec2; 2],
    ) -> Option<[Vec2; 2]>;
}

impl Emitter {
    /// [`EmitterModel::sample_toward`], with what becomes of the sample.
    ///
    /// What is done with samples of the commonest lights is written out where they are made: a
    /// sample that passes through memory costs as much as making it.
    #[inline(always)]
    pub fn sample_toward_then<R>(
        &self,
        from: Vec3,
        u: Vec2,
        then: impl FnOnce(EmitterSample) -> R,
    ) -> Option<R> {
        if let Self::Area(area) = self {
            area.sample_toward_then(from, u, then)
        } else {
            self.sample_toward_apart(from, u).map(then)
        }
    }

    #[inline(never)]
    fn sample_toward_apart(&self, from: Vec3, u: Vec2) -> Option<EmitterSample> {
        self.sample_toward(from, u)
    }
}

/// Writes the enum of all emitters and forwards [`EmitterModel`] to its variants.
macro_rules! emitter_models {
    ($($(#[$doc:meta])* $model:ident,)*) => {
        /// Any emitter.
        #[derive(Clone, Debug)]
        pub enum Emitter {
            $($(#[$doc])* $model($model),)*
        }

        $(impl From<$model> for Emitter {
            fn from(model: $model) -> Self {
                Self::$model(model)
            }
        })*

        impl EmitterModel for Emitter {
            /// The examples of all models.
            fn examples() -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend($model::examples().into_iter().map(Self::from));)*
                all
            }
            #[inline]
            fn class(&self) -> EmitterClass {
                match self { $(Self::$model(e) => e.class(),)* }
            }
            fn set_scene_bounds(&mut self, bounds: SceneBounds) {
                match self { $(Self::$model(e) => e.set_scene_bounds(bounds),)* }
            }
            #[inline]
            fn influence(&self, from: Vec3) -> f32 {
                match self { $(Self::$model(e) => e.influence(from),)* }
            }
            fn power(&self) -> f64 {
                match self { $(Self::$model(e) => e.power(),)* }
            }
            #[inline]
            fn radiance(&self, at: &SurfacePoint, direction: Vec3) -> Rgb {
                match self { $(Self::$model(e) => e.radiance(at, direction),)* }
            }
            #[inline]
            fn intensity(&self, direction: Vec3) -> Rgb {
                match self { $(Self::$model(e) => e.intensity(direction),)* }
            }
            #[inline]
            fn environment_radiance(&self, toward: Vec3) -> Rgb {
                match self { $(Self::$model(e) => e.environment_radiance(toward),)* }
            }
            #[inline(always)]
            fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<EmitterSample> {
                match self { $(Self::$model(e) => e.sample_toward(from, u),)* }
            }
            #[inline]
            fn density_toward(&self, from: Vec3, at: &SurfacePoint) -> SolidAngleDensity {
                match self { $(Self::$model(e) => e.density_toward(from, at),)* }
            }
            #[inline]
            fn environment_density(&self, toward: Vec3) -> SolidAngleDensity {
                match self { $(Self::$model(e) => e.environment_density(toward),)* }
            }
            #[inline]
            fn sample_emission(&self, u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
                match self { $(Self::$model(e) => e.sample_emission(u_point, u_direction),)* }
            }
            #[inline]
            fn emission_density(&self, at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity {
                match self { $(Self::$model(e) => e.emission_density(at, direction),)* }
            }
            fn invert_toward(&self, from: Vec3, toward: Vec3, at: Option<&SurfacePoint>, spare: Vec2)
                -> Option<Vec2> {
                match self { $(Self::$model(e) => e.invert_toward(from, toward, at, spare),)* }
            }
            fn invert_emission(&self, at: Option<&SurfacePoint>, ray: RayOfLight, spare: [Vec2; 2])
                -> Option<[Vec2; 2]> {
                match self { $(Self::$model(e) => e.invert_emission(at, ray, spare),)* }
            }
        }
    };
}

emitter_models! {
    /// A surface that glows.
    Area,
    /// A beam without width.
    Collimated,
    /// The same light from everywhere.
    Constant,
    /// Parallel light.
    Directional,
    /// Light from a picture of all directions.
    Envmap,
    /// A point that radiates equally into all directions.
    Point,
    /// A slide projector.
    Projector,
    /// A lamp with a beam.
    Spot,
    /// The sun and the sky by day.
    SunSky,
}
