//! Rays of light: where they leave an emitter or come from far away, and where they go.

use super::{Emitter, EmitterClass, EmitterModel, EmitterSample, SceneBounds};
use crate::math::{AreaDensity, Frame, Rgb, SolidAngleDensity, Vec2, Vec3, warp};
use crate::shape::SurfacePoint;

/// Density of an emitted ray: that of where it starts times that of where it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionDensity {
    /// Density of the point on a surface; one for a light at a point. For lights infinitely far away
    /// that of the point on a disk across the ray.
    pub point: AreaDensity,
    /// Density of the direction, given the point; one for a light of one direction.
    pub direction: SolidAngleDensity,
}

/// Where light goes along.
#[derive(Clone, Copy, Debug)]
pub struct RayOfLight {
    /// Any point of the ray inside of the scene, or where it starts.
    pub through: Vec3,
    /// Unit direction in which the light travels.
    pub direction: Vec3,
}

/// A ray of light that was sampled.
#[derive(Clone, Copy, Debug)]
pub struct EmittedRay {
    /// Where it starts, off the surface that glows; for lights infinitely far away a point before the
    /// scene.
    pub origin: Vec3,
    /// Unit direction in which the light travels.
    pub direction: Vec3,
    /// The point of the surface that glows; `None` for emitters that are no surfaces.
    pub surface: Option<SurfacePoint>,
    /// What is sent: radiance (W·m⁻²·sr⁻¹) of a surface or an environment, intensity (W·sr⁻¹) of a light
    /// at a point, irradiance (W·m⁻²) of a light of one direction, flux (W) of a single ray.
    pub value: Rgb,
    /// The density with which the ray was made.
    pub density: EmissionDensity,
}

impl EmittedRay {
    /// Value times cosine over density, in W: its mean is the power of the emitter.
    #[inline]
    pub fn power(&self) -> Rgb {
        let cos = self
            .surface
            .map_or(1.0, |at| at.geometric_normal.dot(self.direction).abs());
        self.value * (cos / (self.density.point.0 * self.density.direction.0))
    }

    /// Where the ray starts, as a sample of its emitter from a point: density and radiance are those of the
    /// direction from there. `None` where it shows its back.
    pub fn seen_from(&self, emitter: &Emitter, from: Vec3) -> Option<EmitterSample> {
        let class = emitter.class();
        if matches!(class, EmitterClass::Directional | EmitterClass::Environment) {
            return Some(EmitterSample {
                direction: -self.direction,
                target: None,
                radiance: self.value,
                density: self.density.direction,
                is_dirac: class.is_dirac(),
                surface: None,
            });
        }
        let position = self.surface.map_or(self.origin, |at| at.position);
        let distance_squared = position.distance_squared(from);
        let direction = (position - from) * (1.0 / distance_squared.sqrt());
        let (target, radiance, density) = match &self.surface {
            Some(at) => {
                let cos = at.geometric_normal.dot(direction);
                let density = self.density.point.to_solid_angle(cos, distance_squared)?;
                let target = at.ray_origin(-direction);
                (target, emitter.radiance(at, -direction), density)
            }
            None => {
                let arriving = emitter.intensity(-direction) / distance_squared;
                (position, arriving, SolidAngleDensity(1.0))
            }
        };
        let is_seen = direction.is_finite() && !radiance.is_black();
        is_seen.then_some(EmitterSample {
            direction,
            target: Some(target),
            radiance,
            density,
            is_dirac: class.is_dirac(),
            surface: self.surface,
        })
    }

    /// A ray that leaves a point of a surface, cosine-weighted.
    ///
    /// - `radiance`: of the point.
    /// - `density`: of the point.
    /// - `u`: uniform in the unit square.
    #[inline]
    pub(super) fn from_surface(
        at: SurfacePoint,
        density: AreaDensity,
        radiance: Rgb,
        u: Vec2,
    ) -> Self {
        let local = warp::cosine_hemisphere(u);
        let frame = Frame::around(at.geometric_normal);
        let across = frame.tangent * local.x + frame.bitangent * local.y;
        let direction = (across + frame.normal * local.z).normalize();
        Self {
            origin: at.ray_origin(direction),
            direction,
            surface: Some(at),
            value: radiance,
            density: EmissionDensity {
                point: density,
                direction: from_surface_density(&at, direction),
            },
        }
    }

    /// A ray that leaves a light at a point.
    #[inline]
    pub(super) fn from_point(
        origin: Vec3,
        direction: Vec3,
        intensity: Rgb,
        density: SolidAngleDensity,
    ) -> Self {
        Self {
            origin,
            direction,
            surface: None,
            value: intensity,
            density: EmissionDensity {
                point: AreaDensity(1.0),
                direction: density,
            },
        }
    }

    /// A ray from infinity through a disk as wide as the scene.
    ///
    /// - `sample`: where it comes from.
    /// - `u`: uniform in the unit square; chooses the point of the disk.
    #[inline]
    pub(super) fn from_infinity(sample: &EmitterSample, bounds: SceneBounds, u: Vec2) -> Self {
        let frame = Frame::around(sample.direction);
        let place = warp::uniform_disk(u);
        let across = frame.tangent * place.x + frame.bitangent * place.y;
        Self {
            origin: bounds.centre + (across + frame.normal * BEFORE) * bounds.radius,
            direction: -sample.direction,
            surface: None,
            value: sample.radiance,
            density: EmissionDensity {
                point: bounds.disk_density(),
                direction: sample.density,
            },
        }
    }
}

/// How far before the scene's middle rays from infinity start, in radii of the scene.
const BEFORE: f32 = 1.01;

/// Density of the directions of [`EmittedRay::from_surface`].
#[inline]
pub(super) fn from_surface_density(at: &SurfacePoint, direction: Vec3) -> SolidAngleDensity {
    let cos = at.geometric_normal.dot(direction);
    SolidAngleDensity(warp::cosine_hemisphere_density(cos))
}

/// Goes back from a direction to the numbers of [`EmittedRay::from_surface`]; `None` behind the surface.
pub(super) fn invert_from_surface(at: &SurfacePoint, direction: Vec3) -> Option<Vec2> {
    let local = Frame::around(at.geometric_normal).to_local(direction);
    (local.cos() > 0.0).then(|| warp::into_unit_square(warp::cosine_hemisphere_inverse(local.0)))
}

impl SceneBounds {
    /// Goes back from a ray to the numbers of its point for [`EmittedRay::from_infinity`]; `None` for one that
    /// passes the scene by.
    pub(super) fn invert_disk(&self, ray: RayOfLight) -> Option<Vec2> {
        let local = Frame::around(-ray.direction).to_local(ray.through - self.centre);
        let place = local.0.truncate() / self.radius;
        // The scene may reach the rim, and rounding beyond it.
        (place.length() < 1.0 + 1e-4)
            .then(|| warp::into_unit_square(warp::uniform_disk_inverse(place)))
    }

    /// Density of a uniform point on the largest disk inside of the sphere.
    #[inline]
    pub fn disk_density(&self) -> AreaDensity {
        AreaDensity(warp::UNIFORM_DISK_DENSITY / (self.radius * self.radius))
    }
}
