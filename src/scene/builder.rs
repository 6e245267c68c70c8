//! Putting a scene together.

use std::sync::Arc;

use super::{
    BsdfId, EmitterId, Group, GroupId, Instance, Lights, Object, Scene, SceneMemory, build_accel,
    memory_of,
};
use crate::accel::{AccelError, Engine};
use crate::bsdf::{Bsdf, BsdfModel};
use crate::emitter::{Area, Emitter, EmitterModel, SceneBounds};
use crate::math::{Mat4, Vec3};
use crate::shape::{Placement, Shape, ShapeError, ShapeModel};
use crate::texture::Texture;

/// Collects objects, materials and lights; [`SceneBuilder::build`] makes the scene of them.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    objects: Vec<Object>,
    groups: Vec<Vec<Object>>,
    instances: Vec<Instance>,
    bsdfs: Vec<Bsdf>,
    emitters: Vec<Emitter>,
    engine: Engine,
    /// Triangles whose points are prepared.
    prepared: usize,
    /// Memory of all pictures, in bytes.
    pictures: u64,
}

/// Bytes that an instance takes in the search structure: rather more than less.
const INSTANCE: u64 = 1000;

/// Triangles whose points are prepared, at most: 16 MiB, which counts little beside what the triangles
/// of a large scene take by themselves.
const MOST_PREPARED: usize = 1 << 18;

/// Why a scene could not be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A shape that is to emit has no area.
    #[error("a shape without area cannot emit light")]
    NoArea,
    /// The tracer refused the geometry.
    #[error(transparent)]
    Accel(#[from] AccelError),
}

impl SceneBuilder {
    /// Starts an empty scene.
    pub fn new() -> Self {
        Self::default()
    }

    /// Lets another tracer than Embree find what rays meet.
    pub fn trace_with(&mut self, engine: Engine) {
        self.engine = engine;
    }

    /// The tracer.
    pub fn engine(&self) -> Engine {
        self.engine
    }

    /// Adds a material.
    pub fn add_bsdf(&mut self, bsdf: impl Into<Bsdf>) -> BsdfId {
        self.bsdfs.push(bsdf.into());
        BsdfId(self.bsdfs.len() as u32 - 1)
    }

    /// Adds a light that is no surface.
    pub fn add_emitter(&mut self, emitter: impl Into<Emitter>) -> EmitterId {
        self.emitters.push(emitter.into());
        EmitterId(self.emitters.len() as u32 - 1)
    }

    /// Adds a surface.
    ///
    /// - `radiance`: what its front emits, in W·m⁻²·sr⁻¹.
    ///
    /// # Errors
    /// [`BuildError::NoArea`] when a shape without area is to emit.
    pub fn add_shape(
        &mut self,
        shape: impl Into<Shape>,
        bsdf: BsdfId,
        radiance: Option<Texture>,
    ) -> Result<(), BuildError> {
        let mut shape = shape.into();
        if radiance.is_some() && !shape.prepare_sampling() {
            return Err(BuildError::NoArea);
        }
        let mut object = self.object(shape, bsdf);
        object.emitter = radiance
            .map(|radiance| self.add_emitter(Area::new(Arc::clone(&object.shape), radiance)));
        self.objects.push(object);
        Ok(())
    }

    /// Adds a group of surfaces, which is not in the scene until an instance places it.
    pub fn add_group(&mut self, members: impl IntoIterator<Item = (Shape, BsdfId)>) -> GroupId {
        let members = members.into_iter();
        let objects = members
            .map(|(shape, bsdf)| self.object(shape, bsdf))
            .collect();
        self.groups.push(objects);
        GroupId(self.groups.len() as u32 - 1)
    }

    /// Places a group in the world.
    ///
    /// # Errors
    /// [`ShapeError::Flat`] and [`ShapeError::NotFinite`], of the map.
    pub fn add_instance(&mut self, group: GroupId, to_world: Mat4) -> Result<(), ShapeError> {
        let placement = Placement::new(to_world)?;
        self.instances.push(Instance { group, placement });
        Ok(())
    }

    /// Notes that the scene's textures hold pictures of so many bytes.
    pub fn note_pictures(&mut self, bytes: u64) {
        self.pictures += bytes;
    }

    /// A surface that does not emit.
    fn object(&mut self, mut shape: Shape, bsdf: BsdfId) -> Object {
        if let Shape::TriangleMesh(mesh) = &mut shape {
            self.prepared += mesh.prepare_points(MOST_PREPARED - self.prepared);
        }
        let material = &self.bsdfs[bsdf.0 as usize];
        Object {
            shape: Arc::new(shape),
            bsdf,
            lobes: material.lobes(),
            diffuse: material.sole_diffuse(),
            is_smooth: material.is_smooth(),
            emitter: None,
        }
    }

    /// What the scene will take in memory; its search structure is estimated.
    pub fn needed_memory(&self) -> SceneMemory {
        let objects = self.objects.iter().chain(self.groups.iter().flatten());
        let mut memory = memory_of(objects.clone(), self.pictures);
        let trees = objects.map(|object| object.shape.geometry().build_memory(self.engine));
        let placed = INSTANCE * self.instances.len() as u64;
        memory.tree.peak = trees.sum::<u64>() + placed;
        memory
    }

    /// Builds the search structures and the choice of lights.
    ///
    /// # Errors
    /// What the tracer says of geometry that it cannot take.
    pub fn build(self) -> Result<Scene, BuildError> {
        let Self {
            mut objects,
            groups,
            instances,
            bsdfs,
            mut emitters,
            engine,
            pictures,
            ..
        } = self;
        let in_world = objects.len() as u32;
        let groups = groups.into_iter().map(|members| {
            let (first, count) = (objects.len() as u32, members.len() as u32);
            objects.extend(members);
            Group { first, count }
        });
        let groups: Vec<Group> = groups.collect();
        let accel = build_accel(engine, &objects, in_world, &groups, &instances)?;
        let bounds = bounding_sphere(accel.bounding_box());
        for emitter in &mut emitters {
            emitter.set_scene_bounds(bounds);
        }
        Ok(Scene {
            accel,
            objects,
            in_world,
            groups,
            instances,
            bsdfs,
            lights: Lights::new(emitters),
            bounds,
            pictures,
        })
    }
}

/// The sphere around a box; of radius one around nothing.
fn bounding_sphere(corners: Option<(Vec3, Vec3)>) -> SceneBounds {
    let (low, high) = corners.unwrap_or((-Vec3::ONE, Vec3::ONE));
    let radius = 0.5 * (high - low).length();
    SceneBounds {
        centre: 0.5 * (low + high),
        radius: radius.max(f32::MIN_POSITIVE),
    }
}
