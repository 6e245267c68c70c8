//! The scene: tables of objects, materials and lights, and the rays between them.

mod builder;
pub mod import;
mod interaction;
mod lights;
pub mod options;

pub use builder::{BuildError, SceneBuilder};
pub use interaction::Interaction;
use interaction::{point_on_instance, put_point_in_world};
pub use lights::{ChosenRay, ChosenSample, Lights};

use std::sync::Arc;

use crate::accel::{self, Accel, AccelError, Engine, Geometry, Hit, MemoryUse, Ray};
use crate::bsdf::{Bsdf, LobeSet, SoleDiffuse};
use crate::emitter::SceneBounds;
use crate::math::{Vec2, Vec3};
use crate::shape::{Placement, Shape, ShapeModel, SurfacePoint};

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
    /// All about that material, where it is diffuse.
    pub diffuse: Option<SoleDiffuse>,
    /// Whether that material is smooth, so that a cosine is all it asks for: [`Bsdf::is_smooth`].
    pub is_smooth: bool,
    /// What it emits.
    pub emitter: Option<EmitterId>,
}

/// Index of a group of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GroupId(pub u32);

/// Objects that are not in the scene by themselves, but wherever an instance places them.
#[derive(Clone, Copy, Debug)]
struct Group {
    /// Where they stand among the scene's objects.
    first: u32,
    count: u32,
}

/// A group, placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Which group.
    pub group: GroupId,
    /// From the group's space to the world.
    pub placement: Placement,
}

/// Everything that light can meet.
#[derive(Debug)]
pub struct Scene {
    accel: Accel,
    /// Those in the world, then those of the groups.
    objects: Vec<Object>,
    /// How many stand in the world.
    in_world: u32,
    groups: Vec<Group>,
    instances: Vec<Instance>,
    bsdfs: Vec<Bsdf>,
    lights: Lights,
    bounds: SceneBounds,
    pictures: u64,
}

/// What a scene takes in memory, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneMemory {
    /// The tracer's search structure.
    pub tree: MemoryUse,
    /// Positions and indices, which the tracer reads where they are.
    pub buffers: u64,
    /// What shapes hold beside them: normals, texture coordinates, tables.
    pub surfaces: u64,
    /// Pictures of textures and of surroundings.
    pub pictures: u64,
}

impl SceneMemory {
    /// All of it, once built.
    pub fn held(&self) -> u64 {
        self.tree.held + self.buffers + self.surfaces + self.pictures
    }
}

impl Scene {
    /// The objects, in the order of the file: those that stand in the world by themselves, then those
    /// of the groups.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The objects that stand in the world by themselves.
    pub fn objects_in_world(&self) -> &[Object] {
        &self.objects[..self.in_world as usize]
    }

    /// The objects of each group, in the order of the file.
    pub fn groups(&self) -> impl Iterator<Item = &[Object]> {
        self.groups.iter().map(|group| &self.objects[group.range()])
    }

    /// The instances, in the order of the file.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The objects that an instance places.
    pub fn objects_of(&self, instance: &Instance) -> &[Object] {
        &self.objects[self.groups[instance.group.0 as usize].range()]
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

    /// The same scene, whose tracer keeps what it is asked, see [`Accel::recording`].
    #[must_use]
    pub fn recording(self) -> Self {
        Self {
            accel: self.accel.recording(),
            ..self
        }
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
        let mut point = SurfacePoint::bare(Vec3::ZERO);
        let (index, object) = self.put_surface(ray, hit, &mut point);
        Interaction::new(point, (index, object), self.bsdf(object.bsdf), ray, hit)
    }

    /// The point of a hit, put in its place; returns the object that it lies on, with its index.
    ///
    /// A point that is made elsewhere and then copied costs as much again as making it: it is read in other
    /// pieces than it was written in, and has to wait until it is in the cache.
    ///
    /// - `point`: becomes it.
    #[inline(always)]
    pub fn put_surface(&self, ray: &Ray, hit: &Hit, point: &mut SurfacePoint) -> (u32, &Object) {
        let index = match hit.instance {
            Some(instance) => self.put_point_on(instance, ray, hit, point),
            None => {
                let shape = &self.objects[hit.geometry as usize].shape;
                put_point_in_world(shape, ray, hit, point);
                hit.geometry
            }
        };
        (index, &self.objects[index as usize])
    }

    /// Puts the point of a hit on an instance in its place; returns the index of its object. The tracer counts
    /// instances after what stands in the world.
    #[inline(never)]
    fn put_point_on(&self, instance: u32, ray: &Ray, hit: &Hit, point: &mut SurfacePoint) -> u32 {
        let placement = &self.instances[(instance - self.in_world) as usize].placement;
        let index = self.index_on(instance, hit);
        let shape = &self.objects[index as usize].shape;
        *point = point_on_instance(placement, shape, ray, hit);
        index
    }

    /// The object that a hit lies on.
    #[inline(always)]
    pub fn object_at(&self, hit: &Hit) -> &Object {
        let on = |instance| self.index_on(instance, hit);
        &self.objects[hit.instance.map_or(hit.geometry, on) as usize]
    }

    /// Index of the object that a hit on an instance lies on.
    #[inline]
    fn index_on(&self, instance: u32, hit: &Hit) -> u32 {
        let group = self.instances[(instance - self.in_world) as usize].group;
        self.groups[group.0 as usize].first + hit.geometry
    }

    /// Surface coordinates where a ray has met a surface, also where that leaves them out of its points.
    pub fn coordinates(&self, met: &Interaction<'_>) -> Vec2 {
        let shape = &self.objects[met.object as usize].shape;
        shape.coordinates(&met.point, met.primitive)
    }

    /// What it takes in memory.
    pub fn memory(&self) -> SceneMemory {
        SceneMemory {
            tree: self.accel.memory(),
            ..memory_of(&self.objects, self.pictures)
        }
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

impl Group {
    fn range(self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// What objects take, without a search structure.
fn memory_of<'o>(objects: impl IntoIterator<Item = &'o Object>, pictures: u64) -> SceneMemory {
    let mut memory = SceneMemory {
        pictures,
        ..SceneMemory::default()
    };
    for object in objects {
        let shape = object.shape.memory();
        memory.buffers += shape.shared;
        memory.surfaces += shape.own + (size_of::<Object>() + size_of::<Shape>()) as u64;
    }
    memory
}

/// Builds the search structure of what stands in the world and of all instances.
fn build_accel(
    engine: Engine,
    objects: &[Object],
    in_world: u32,
    groups: &[Group],
    instances: &[Instance],
) -> Result<Accel, AccelError> {
    let geometries = |objects: &'_ [Object]| -> Vec<Geometry> {
        objects.iter().map(|o| o.shape.geometry()).collect()
    };
    let groups = groups
        .iter()
        .map(|group| geometries(&objects[group.range()]));
    let instances = instances.iter().map(|instance| accel::Instance {
        group: instance.group.0,
        to_world: instance.placement.to_world(),
    });
    let in_world = geometries(&objects[..in_world as usize]);
    Accel::build(engine, in_world, groups, instances)
}
