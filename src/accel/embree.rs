//! The tracer Embree.

use std::sync::Arc;

use embree4_sys::{BuildOptions, CommittedScene, Device, Hit, MemoryUse, SceneBuilder};

use super::{AccelError, Engine, Geometry, Instance, Ray};
use crate::math::Vec3;

/// Geometry in Embree's search structure.
#[derive(Debug)]
pub(super) struct EmbreeAccel {
    scene: CommittedScene,
    robust: bool,
}

impl EmbreeAccel {
    /// As [`super::Accel::build`].
    ///
    /// - `robust`: whether no ray may slip through between two triangles.
    pub(super) fn build<G: IntoIterator<Item = Geometry>>(
        robust: bool,
        geometries: impl IntoIterator<Item = Geometry>,
        groups: impl IntoIterator<Item = G>,
        instances: impl IntoIterator<Item = Instance>,
    ) -> Result<Self, AccelError> {
        let device = Device::new("")?;
        let options = BuildOptions {
            robust,
            ..BuildOptions::default()
        };
        let mut world = SceneBuilder::with_options(&device, options)?;
        let mut count = 0;
        add_all(&mut world, geometries, &mut count)?;
        let mut built = Vec::new();
        for group in groups {
            let mut builder = SceneBuilder::with_options(&device, options)?;
            add_all(&mut builder, group, &mut count)?;
            built.push(Arc::new(builder.commit()?));
        }
        for (index, instance) in (count..).zip(instances) {
            let group = Arc::clone(&built[instance.group as usize]);
            let added = world.add_instance(group, instance.to_world);
            added.map_err(|error| refused(index, error))?;
        }
        Ok(Self {
            scene: world.commit()?,
            robust,
        })
    }

    /// As [`super::Accel::engine`].
    pub(super) fn engine(&self) -> Engine {
        match self.robust {
            true => Engine::Embree,
            false => Engine::EmbreeFast,
        }
    }

    /// The scene in Embree's own terms.
    pub(super) fn scene(&self) -> &CommittedScene {
        &self.scene
    }

    /// As [`super::Accel::memory`].
    pub(super) fn memory(&self) -> MemoryUse {
        self.scene.device().memory()
    }

    /// As [`super::Accel::intersect`].
    #[inline(always)]
    pub(super) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.scene.intersect(&embree_ray(ray))
    }

    /// As [`super::Accel::is_occluded`].
    #[inline(always)]
    pub(super) fn is_occluded(&self, ray: &Ray) -> bool {
        self.scene.occluded(&embree_ray(ray))
    }

    /// As [`super::Accel::intersect_all`].
    #[inline]
    pub(super) fn intersect_all(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        self.scene.intersect_all(rays.iter().map(embree_ray), hits);
    }

    /// As [`super::Accel::are_occluded`].
    #[inline]
    pub(super) fn are_occluded<'r>(
        &self,
        rays: impl IntoIterator<Item = &'r Ray>,
        occluded: &mut Vec<bool>,
    ) {
        occluded.clear();
        let rays = rays.into_iter().map(embree_ray);
        self.scene.occluded_all(rays, occluded);
    }

    /// As [`super::Accel::bounding_box`].
    pub(super) fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        let bounds = self.scene.bounds()?;
        Some((
            Vec3::from_array(bounds.lower),
            Vec3::from_array(bounds.upper),
        ))
    }
}

/// Versions of Embree: of the headers at build time, and of the library that runs.
///
/// # Errors
/// When Embree cannot start.
pub fn versions() -> Result<(String, String), AccelError> {
    let versions = Device::new("")?.version();
    Ok((versions.header.to_string(), versions.library.to_string()))
}

/// Embree refuses a geometry.
fn refused(index: usize, error: embree4_sys::Error) -> AccelError {
    AccelError::Geometry {
        engine: Engine::Embree,
        index,
        error,
    }
}

/// Adds geometries to a scene; `count` is that of all geometries so far.
fn add_all(
    builder: &mut SceneBuilder,
    geometries: impl IntoIterator<Item = Geometry>,
    count: &mut usize,
) -> Result<(), AccelError> {
    for geometry in geometries {
        let added = match geometry {
            Geometry::Triangles(vertices, triangles) => {
                builder.add_triangles(&vertices, &triangles)
            }
            Geometry::Curves(basis, curves) => builder.add_curves(basis, &curves),
            Geometry::Sphere { centre, radius } => builder.add_sphere(centre.to_array(), radius),
            Geometry::Disk(to_world) => builder.add_disk(to_world),
            Geometry::Cylinder(to_world) => builder.add_cylinder(to_world),
        };
        let index = *count;
        added.map_err(|error| refused(index, error))?;
        *count += 1;
    }
    Ok(())
}

/// The ray in Embree's own terms.
#[inline]
pub(super) fn embree_ray(ray: &Ray) -> embree4_sys::Ray {
    embree4_sys::Ray {
        origin: ray.origin().to_array(),
        direction: ray.direction().to_array(),
        near: ray.near(),
        far: ray.far(),
    }
}
