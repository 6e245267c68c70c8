//! The tracer Embree.

use std::sync::Arc;

use embree4_sys::{CommittedScene, Device, Hit, SceneBuilder};

use super::{Geometry, Ray};
use crate::math::Vec3;

/// Why geometry could not be made traceable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AccelError {
    /// Embree cannot start, or cannot build.
    #[error("Embree: {0}")]
    Embree(#[from] embree4_sys::Error),
    /// Embree refuses a geometry.
    #[error("Embree: {error}")]
    Geometry {
        /// Its index.
        index: usize,
        /// What is wrong with it.
        error: embree4_sys::Error,
    },
}

/// Geometry that rays can be traced against.
#[derive(Debug)]
pub struct Accel {
    scene: CommittedScene,
}

/// A group of geometries, placed in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index of the group.
    pub group: u32,
    /// Affine map from the group's space to the world, by rows.
    pub to_world: [[f32; 4]; 3],
}

impl Accel {
    /// Builds the search structure.
    ///
    /// Hits on `geometries` have no instance; their geometry is the index in there. Hits on an
    /// instance have the number of `geometries` plus the index in `instances` as their instance, and
    /// the index in the group as their geometry.
    ///
    /// - `groups`: geometries that are not in the scene by themselves, each in a space of its own.
    ///
    /// # Errors
    /// When Embree cannot start, runs out of memory, or a buffer holds a vertex that is not finite or
    /// an index out of range. Errors count `geometries`, then those of the groups, then `instances`.
    pub fn build<G: IntoIterator<Item = Geometry>>(
        geometries: impl IntoIterator<Item = Geometry>,
        groups: impl IntoIterator<Item = G>,
        instances: impl IntoIterator<Item = Instance>,
    ) -> Result<Self, AccelError> {
        let device = Device::new("")?;
        let mut world = SceneBuilder::new(&device)?;
        let mut count = 0;
        add_all(&mut world, geometries, &mut count)?;
        let mut built = Vec::new();
        for group in groups {
            let mut builder = SceneBuilder::new(&device)?;
            add_all(&mut builder, group, &mut count)?;
            built.push(Arc::new(builder.commit()?));
        }
        for (index, instance) in (count..).zip(instances) {
            let group = Arc::clone(&built[instance.group as usize]);
            let added = world.add_instance(group, instance.to_world);
            added.map_err(|error| AccelError::Geometry { index, error })?;
        }
        Ok(Self {
            scene: world.commit()?,
        })
    }

    /// The closest hit.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.scene.intersect(&embree_ray(ray))
    }

    /// True when the ray hits anything.
    #[inline]
    pub fn is_occluded(&self, ray: &Ray) -> bool {
        self.scene.occluded(&embree_ray(ray))
    }

    /// The closest hits of many rays, as [`Accel::intersect`] finds them, in less time.
    ///
    /// - `hits`: filled anew, one a ray.
    #[inline]
    pub fn intersect_all(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        self.scene.intersect_all(rays.iter().map(embree_ray), hits);
    }

    /// Whether each of many rays hits anything, as [`Accel::is_occluded`] says, in less time.
    ///
    /// - `occluded`: filled anew, one a ray.
    #[inline]
    pub fn are_occluded<'r>(
        &self,
        rays: impl IntoIterator<Item = &'r Ray>,
        occluded: &mut Vec<bool>,
    ) {
        occluded.clear();
        let rays = rays.into_iter().map(embree_ray);
        self.scene.occluded_all(rays, occluded);
    }

    /// Lowest and highest corner of the box around everything; `None` when there is nothing.
    pub fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        let bounds = self.scene.bounds()?;
        Some((
            Vec3::from_array(bounds.lower),
            Vec3::from_array(bounds.upper),
        ))
    }
}

/// Versions of the tracer: of the headers at build time, and of the library that runs.
pub fn versions() -> Result<(String, String), AccelError> {
    let versions = Device::new("")?.version();
    Ok((versions.header.to_string(), versions.library.to_string()))
}

/// Sets the calling thread up for tracing: numbers too small to matter are flushed to zero.
pub fn prepare_worker() {
    embree4_sys::flush_denormals();
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
        added.map_err(|error| AccelError::Geometry { index, error })?;
        *count += 1;
    }
    Ok(())
}

#[inline]
fn embree_ray(ray: &Ray) -> embree4_sys::Ray {
    embree4_sys::Ray {
        origin: ray.origin().to_array(),
        direction: ray.direction().to_array(),
        near: ray.near(),
        far: ray.far(),
    }
}
