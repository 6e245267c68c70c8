//! Collects geometry and builds the tree.

use std::ptr;
use std::sync::Arc;

use crate::analytic::{self, Kind};
use crate::bindings;
use crate::buffers::{CurveBuffer, IndexBuffer, VertexBuffer};
use crate::curves::LinearCurves;
use crate::device::Device;
use crate::error::Error;
use crate::scene::{CommittedScene, INVALID_ID, SceneHandle};

/// Number of a geometry within its scene: 0 for the first that was added, then 1, and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GeometryId(pub u32);

/// How much time Embree spends on the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BuildQuality {
    /// Fastest to build. Which of two coincident triangles is hit may differ between builds.
    Low,
    /// Slower to build, faster to trace.
    #[default]
    Medium,
    /// Splits triangles: several times the build time for a few per cent of tracing speed.
    High,
}

/// How a scene is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildOptions {
    /// Whether rays at shared edges of triangles may not slip through; costs 15 to 28 % of tracing
    /// speed.
    pub robust: bool,
    /// How much time goes into the tree.
    pub quality: BuildQuality,
}

impl Default for BuildOptions {
    /// Robust, medium quality.
    fn default() -> Self {
        Self {
            robust: true,
            quality: BuildQuality::Medium,
        }
    }
}

/// What Embree reads through plain pointers while a scene lives.
#[derive(Debug)]
#[expect(dead_code, reason = "held for its memory, not read")]
pub(crate) enum Kept {
    Triangles(VertexBuffer, IndexBuffer),
    Linear(Arc<LinearCurves>),
    BSplines(CurveBuffer),
    Analytic(Arc<bindings::ShimShape>),
    Instance(Arc<CommittedScene>),
}

impl Kept {
    /// As [`CommittedScene::traces_alone`].
    pub(crate) fn traces_alone(&self) -> bool {
        match self {
            Self::BSplines(_) => true,
            Self::Instance(scene) => scene.traces_alone(),
            _ => false,
        }
    }
}

/// A scene that geometry is added to.
#[derive(Debug)]
pub struct SceneBuilder {
    // Before `kept` and `device`: fields are dropped in order, and Embree goes first.
    handle: SceneHandle,
    kept: Vec<Kept>,
    pub(crate) device: Device,
}

impl SceneBuilder {
    /// Begins an empty scene with the default [`BuildOptions`].
    ///
    /// # Errors
    /// [`Error::Embree`] if Embree cannot make a scene, for want of memory.
    pub fn new(device: &Device) -> Result<Self, Error> {
        Self::with_options(device, BuildOptions::default())
    }

    /// Begins an empty scene.
    ///
    /// # Errors
    /// [`Error::Embree`] if Embree cannot make a scene, for want of memory.
    pub fn with_options(device: &Device, options: BuildOptions) -> Result<Self, Error> {
        // SAFETY: the device is live.
        let scene = unsafe { bindings::rtcNewScene(device.handle()) };
        device.check("make a scene")?;
        let handle = SceneHandle::new(scene);
        let flags = if options.robust {
            bindings::RTC_SCENE_FLAG_ROBUST
        } else {
            bindings::RTC_SCENE_FLAG_NONE
        };
        let quality = match options.quality {
            BuildQuality::Low => bindings::RTC_BUILD_QUALITY_LOW,
            BuildQuality::Medium => bindings::RTC_BUILD_QUALITY_MEDIUM,
            BuildQuality::High => bindings::RTC_BUILD_QUALITY_HIGH,
        };
        // SAFETY: the scene is live and nobody else knows it yet.
        unsafe {
            bindings::rtcSetSceneFlags(scene, flags);
            bindings::rtcSetSceneBuildQuality(scene, quality);
        }
        device.check("set the options of a scene")?;
        Ok(Self {
            handle,
            kept: Vec::new(),
            device: device.clone(),
        })
    }

    /// Adds triangles. The scene reads the buffers where they are and keeps them alive.
    ///
    /// A hit has the barycentric coordinates `u`, `v` of the second and third corner and the normal
    /// (second − first) × (third − first); the primitive is the triangle's position in `indices`.
    ///
    /// # Errors
    /// [`Error::BadVertex`] for a coordinate that is not finite or beyond
    /// [`VertexBuffer::LARGEST`], [`Error::IndexOutOfRange`], [`Error::TooMany`],
    /// [`Error::Embree`] for want of memory.
    pub fn add_triangles(
        &mut self,
        vertices: &VertexBuffer,
        indices: &IndexBuffer,
    ) -> Result<GeometryId, Error> {
        check_triangles(vertices.as_slice(), indices.as_slice())?;
        // SAFETY: the device is live.
        let geometry = unsafe {
            bindings::rtcNewGeometry(self.device.handle(), bindings::RTC_GEOMETRY_TYPE_TRIANGLE)
        };
        self.device.check("make a triangle mesh")?;
        // SAFETY: Embree only reads through these pointers. The buffers have the stated number of
        // elements of the stated format, the vertices 16 bytes more; `attach` keeps them alive and
        // in place for as long as the scene that owns the geometry.
        unsafe {
            bindings::rtcSetSharedGeometryBuffer(
                geometry,
                bindings::RTC_BUFFER_TYPE_VERTEX,
                0,
                bindings::RTC_FORMAT_FLOAT3,
                vertices.as_ptr().cast(),
                0,
                size_of::<[f32; 3]>(),
                vertices.as_slice().len(),
            );
            bindings::rtcSetSharedGeometryBuffer(
                geometry,
                bindings::RTC_BUFFER_TYPE_INDEX,
                0,
                bindings::RTC_FORMAT_UINT3,
                indices.as_slice().as_ptr().cast(),
                0,
                size_of::<[u32; 3]>(),
                indices.as_slice().len(),
            );
        }
        self.attach(geometry, Kept::Triangles(vertices.clone(), indices.clone()))
    }

    /// Adds an exact sphere, hit from outside and inside.
    ///
    /// A hit has `u = v = 0` and the unit normal that points away from the centre.
    ///
    /// - `center`, `radius`: in scene units; the radius positive.
    ///
    /// # Errors
    /// [`Error::BadShape`] for a radius or centre that is not usable, [`Error::TooMany`],
    /// [`Error::Embree`] for want of memory.
    pub fn add_sphere(&mut self, center: [f32; 3], radius: f32) -> Result<GeometryId, Error> {
        self.add_analytic(Kind::Sphere, analytic::sphere(center, radius)?)
    }

    /// Adds an exact disk, hit from both sides: what `to_world` makes of the unit disk around the
    /// origin of the plane z = 0.
    ///
    /// A hit has `u` = distance from the centre in object space, in [0, 1]; `v` = angle from the
    /// object's x axis towards y as a fraction of a turn, in [0, 1); and the unit normal of the
    /// object's +z side.
    ///
    /// - `to_world`: affine map by rows; the last column is the translation. It may stretch and
    ///   shear, but not flatten.
    ///
    /// # Errors
    /// [`Error::BadShape`] for a matrix without an inverse or with entries that are not finite,
    /// [`Error::TooMany`], [`Error::Embree`] for want of memory.
    pub fn add_disk(&mut self, to_world: [[f32; 4]; 3]) -> Result<GeometryId, Error> {
        self.add_analytic(Kind::Disk, analytic::transformed(Kind::Disk, &to_world)?)
    }

    /// Adds an exact open cylinder, hit from outside and inside: what `to_world` makes of the one
    /// of radius 1 around the z axis from z = 0 to z = 1.
    ///
    /// A hit has `u` = angle from the object's x axis towards y as a fraction of a turn, in
    /// [0, 1); `v` = object-space z, in [0, 1]; and the unit normal that points away from the axis.
    ///
    /// - `to_world`: affine map by rows; the last column is the translation. It may stretch and
    ///   shear, but not flatten.
    ///
    /// # Errors
    /// As [`SceneBuilder::add_disk`].
    pub fn add_cylinder(&mut self, to_world: [[f32; 4]; 3]) -> Result<GeometryId, Error> {
        self.add_analytic(
            Kind::Cylinder,
            analytic::transformed(Kind::Cylinder, &to_world)?,
        )
    }

    /// Adds another scene under an affine map, and keeps it alive.
    ///
    /// A hit on it has this geometry's id as its instance, and the geometry, primitive, `u`, `v`
    /// and normal of `scene`; the normal is in the space of `scene`.
    ///
    /// - `to_world`: from the space of `scene` to this one, by rows; the last column is the
    ///   translation.
    ///
    /// # Errors
    /// [`Error::NestedInstance`] if `scene` contains instances, [`Error::ForeignDevice`] if it was
    /// built on another device, [`Error::BadShape`] for a matrix without an inverse or with entries
    /// that are not finite, [`Error::TooMany`], [`Error::Embree`] for want of memory.
    pub fn add_instance(
        &mut self,
        scene: Arc<CommittedScene>,
        to_world: [[f32; 4]; 3],
    ) -> Result<GeometryId, Error> {
        if scene.has_instances() {
            return Err(Error::NestedInstance);
        }
        if !scene.device().is_same(&self.device) {
            return Err(Error::ForeignDevice);
        }
        analytic::check_invertible("an instance", &to_world)?;
        // SAFETY: the device is live.
        let geometry = unsafe {
            bindings::rtcNewGeometry(self.device.handle(), bindings::RTC_GEOMETRY_TYPE_INSTANCE)
        };
        self.device.check("make an instance")?;
        // SAFETY: geometry and scene are live; Embree copies the twelve floats of the matrix.
        unsafe {
            bindings::rtcSetGeometryInstancedScene(geometry, scene.handle());
            bindings::rtcSetGeometryTransform(
                geometry,
                0,
                bindings::RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                ptr::from_ref(&to_world).cast(),
            );
        }
        self.attach(geometry, Kept::Instance(scene))
    }

    /// Builds the tree, with all threads of the device.
    ///
    /// # Errors
    /// [`Error::Embree`] if the build fails, for want of memory.
    pub fn commit(self) -> Result<CommittedScene, Error> {
        // SAFETY: the scene is live, and `self` is the only one who knows it.
        unsafe { bindings::rtcCommitScene(self.handle.raw()) };
        self.device.check("build the scene")?;
        Ok(CommittedScene::new(self.handle, self.kept, self.device))
    }

    fn add_analytic(
        &mut self,
        kind: Kind,
        shape: bindings::ShimShape,
    ) -> Result<GeometryId, Error> {
        let shape = Arc::new(shape);
        // SAFETY: the device is live; the shape stays at its address, unchanged, because `attach`
        // keeps it for as long as the scene that owns the geometry.
        let geometry = unsafe {
            bindings::shim_new_analytic(self.device.handle(), kind.to_shim(), Arc::as_ptr(&shape))
        };
        self.device.check("make an analytic shape")?;
        self.attach(geometry, Kept::Analytic(shape))
    }

    /// Hands a new geometry over to the scene, and what it reads to `kept`.
    pub(crate) fn attach(
        &mut self,
        geometry: bindings::RTCGeometry,
        kept: Kept,
    ) -> Result<GeometryId, Error> {
        let count = self.kept.len();
        let id = u32::try_from(count).ok().filter(|&id| id != INVALID_ID);
        // Kept before Embree sees the geometry, and on failure too: it may hold on to it.
        self.kept.push(kept);
        // SAFETY: the geometry is live and ours; after the release the scene is its only owner.
        unsafe {
            // Rays are traced with all mask bits set. The default mask is all ones in Embree 3
            // and 1 in Embree 4; this one is hit in both, whatever the ray's mask.
            bindings::rtcSetGeometryMask(geometry, u32::MAX);
            bindings::rtcCommitGeometry(geometry);
            if let Some(id) = id {
                bindings::rtcAttachGeometryByID(self.handle.raw(), geometry, id);
            }
            bindings::rtcReleaseGeometry(geometry);
        }
        self.device.check("add a geometry")?;
        id.map(GeometryId).ok_or(Error::TooMany {
            what: "geometries",
            count,
        })
    }
}

/// Finds what Embree would read out of bounds or leave out silently.
///
/// # Errors
/// As [`SceneBuilder::add_triangles`].
pub fn check_triangles(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<(), Error> {
    for (what, count) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
        if u32::try_from(count).is_err() {
            return Err(Error::TooMany { what, count });
        }
    }
    // Written so that not-a-number fails.
    let usable = |position: &[f32; 3]| {
        position
            .iter()
            .all(|coordinate| coordinate.abs() <= VertexBuffer::LARGEST)
    };
    if let Some(vertex) = vertices.iter().position(|position| !usable(position)) {
        return Err(Error::BadVertex {
            vertex,
            position: vertices[vertex],
        });
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        for &index in corners {
            if vertices.get(index as usize).is_none() {
                return Err(Error::IndexOutOfRange {
                    triangle,
                    index,
                    vertices: vertices.len(),
                });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::SceneBuilder;
    use crate::bindings;
    use crate::buffers::{IndexBuffer, VertexBuffer};
    use crate::device::Device;

    #[test]
    fn embree_reads_the_renderers_own_buffers() -> Result<(), Box<dyn Error>> {
        let vertices = VertexBuffer::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let indices = IndexBuffer::new(vec![[0, 1, 2]]);
        let mut builder = SceneBuilder::new(&Device::new("")?)?;
        let id = builder.add_triangles(&vertices, &indices)?;
        let scene = builder.commit()?;
        let address = |buffer| {
            // SAFETY: the scene is live and the geometry in it; only addresses are compared.
            unsafe {
                let geometry = bindings::rtcGetGeometry(scene.handle(), id.0);
                bindings::rtcGetGeometryBufferData(geometry, buffer, 0).cast_const()
            }
        };
        let in_vertices = address(bindings::RTC_BUFFER_TYPE_VERTEX);
        let in_indices = address(bindings::RTC_BUFFER_TYPE_INDEX);
        assert_eq!(in_vertices, vertices.as_slice().as_ptr().cast());
        assert_eq!(in_indices, indices.as_slice().as_ptr().cast());
        Ok(())
    }
}
