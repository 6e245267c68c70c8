//! The scene: tables of objects, materials and lights, and the rays between them.

mod builder;
pub mod import;
mod interaction;
mod lights;
pub mod options;

pub use builder::{BuildError, SceneBuilder};
pub use interaction::Interaction;
pub use lights::{ChosenSample, Lights};

use std::sync::Arc;

use crate::accel::{Accel, Hit, Ray};
use crate::bsdf::{Bsdf, LobeSet};
use crate::emitter::SceneBounds;
use crate::math::Vec3;
use crate::shape::{Shape, SurfacePoint};

/// Index of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BsdfId(pub u32);

/// Index of an emitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EmitterId(pub u32);

/// A shape with its material and, where it glows, its light.
#[derive(Clone, Debug)]
pub struct Object {
    /// Where the surface is.
    pub shape: Arc<Shape>,
    /// What it is made of.
    pub bsdf: BsdfId,
    /// The lobes of that material.
    pub lobes: LobeSet,
    /// What it emits.
    pub emitter: Option<EmitterId>,
}

/// Everything that light can meet.
#[derive(Debug)]
pub struct Scene {
    accel: Accel,
    objects: Vec<Object>,
    bsdfs: Vec<Bsdf>,
    lights: Lights,
    bounds: SceneBounds,
}

impl Scene {
    /// The objects, in the order of the file.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The materials.
    pub fn bsdfs(&self) -> &[Bsdf] {
        &self.bsdfs
    }

    /// The lights.
    pub fn lights(&self) -> &Lights {
        &self.lights
    }

    /// A sphere around all objects.
    pub fn bounds(&self) -> SceneBounds {
        self.bounds
    }

    /// The tracer.
    pub fn accel(&self) -> &Accel {
        &self.accel
    }

    /// A material.
    #[inline]
    pub fn bsdf(&self, id: BsdfId) -> &Bsdf {
        &self.bsdfs[id.0 as usize]
    }

    /// The first surface that a ray meets.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray) -> Option<Interaction<'_>> {
        let hit = self.hit(ray)?;
        Some(self.interaction(ray, &hit))
    }

    /// Where a ray meets its first surface, and no more about it.
    #[inline(always)]
    pub fn hit(&self, ray: &Ray) -> Option<Hit> {
        self.accel.intersect(ray)
    }

    /// The surface at the first hit of a ray.
    #[inline(always)]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction<'_> {
        let object = &self.objects[hit.geometry as usize];
        Interaction::new(object, self.bsdf(object.bsdf), ray, hit)
    }

    /// True when nothing stands between two points.
    ///
    /// - `target`: already off its own surface.
    #[inline]
    pub fn is_visible(&self, from: &SurfacePoint, target: Vec3) -> bool {
        !self.accel.is_occluded(&from.ray_to(target))
    }

    /// True when nothing stands between a point and infinity in a unit direction.
    #[inline]
    pub fn is_visible_to_infinity(&self, from: &SurfacePoint, toward: Vec3) -> bool {
        !self.accel.is_occluded(&from.ray_toward(toward))
    }
}
