//! Paths.

use std::fmt;

use glam::DVec3;

use super::{Event, PathVertex};
use crate::emitter::EmitterClass;
use crate::math::{Rgb, Vec2, Vec3};

/// Largest number of vertices: longer paths are estimated, but not mutated.
pub const CAPACITY: usize = 32;

/// A path from the sensor to a light, sensor first.
///
/// A fixed array: a path is never allocated while a chain runs, and copying a few vertices costs less
/// than following references.
#[derive(Clone, Debug)]
pub struct Path {
    vertices: [PathVertex; CAPACITY],
    len: usize,
    raster: Vec2,
}

impl Default for Path {
    fn default() -> Self {
        Self {
            vertices: [PathVertex::sensor(Vec3::ZERO); CAPACITY],
            len: 0,
            raster: Vec2::ZERO,
        }
    }
}

impl Path {
    /// Starts anew with a vertex on the lens.
    ///
    /// - `raster`: where the path is seen, in pixels of the full film.
    pub fn start(&mut self, lens: Vec3, raster: Vec2) {
        self.vertices[0] = PathVertex::sensor(lens);
        self.len = 1;
        self.raster = raster;
    }

    /// Appends a vertex; false when there is no room.
    #[inline]
    pub fn push(&mut self, vertex: PathVertex) -> bool {
        let has_room = self.len < CAPACITY;
        if has_room {
            self.vertices[self.len] = vertex;
            self.len += 1;
        }
        has_room
    }

    /// Takes the last vertex away.
    #[inline]
    pub fn pop(&mut self) {
        self.len -= 1;
    }

    /// Keeps the first vertices only.
    #[inline]
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }

    /// The vertices, sensor first.
    #[inline]
    pub fn vertices(&self) -> &[PathVertex] {
        &self.vertices[..self.len]
    }

    /// The vertices, to be changed.
    #[inline]
    pub fn vertices_mut(&mut self) -> &mut [PathVertex] {
        &mut self.vertices[..self.len]
    }

    /// Number of edges, `k`; the last vertex has this index.
    #[inline]
    pub fn edges(&self) -> usize {
        self.len - 1
    }

    /// Where the path is seen, in pixels of the full film.
    #[inline]
    pub fn raster(&self) -> Vec2 {
        self.raster
    }

    /// Moves the place where the path is seen.
    #[inline]
    pub fn set_raster(&mut self, raster: Vec2) {
        self.raster = raster;
    }

    /// Takes the first vertices, up to index `last`, and the raster position from another path that is
    /// the same from there on.
    #[inline]
    pub fn copy_prefix(&mut self, other: &Self, last: usize) {
        self.vertices[..=last].copy_from_slice(&other.vertices[..=last]);
        self.raster = other.raster;
    }

    /// Becomes a copy of another path.
    pub fn copy_from(&mut self, other: &Self) {
        self.vertices[..other.len].copy_from_slice(&other.vertices[..other.len]);
        self.len = other.len;
        self.raster = other.raster;
    }

    /// Product of the vertices' values: the coloured part of the measurement contribution.
    ///
    /// With the densities of directions and points as they are when the path is generated from the eye,
    /// this is the whole contribution; other coordinates bring scalar factors.
    #[inline]
    pub fn value(&self) -> DVec3 {
        self.vertices().iter().fold(DVec3::ONE, |product, vertex| {
            product * vertex.value.0.as_dvec3()
        })
    }

    /// Luminance of [`Path::value`].
    #[inline]
    pub fn luminance(&self) -> f64 {
        luminance(self.value())
    }

    /// Colour of the path, scaled to luminance one; `None` for a path without light.
    #[inline]
    pub fn colour(&self) -> Option<Rgb> {
        colour(self.value())
    }

    /// The events from the sensor to the light, as letters.
    pub fn signature(&self) -> Signature<'_> {
        Signature(self.vertices())
    }
}

/// A value scaled to luminance one; `None` where it has none.
#[inline]
pub(crate) fn colour(value: DVec3) -> Option<Rgb> {
    let luminance = luminance(value);
    (luminance > 0.0 && luminance.is_finite()).then(|| Rgb((value / luminance).as_vec3()))
}

/// Luminance of a triple in `f64`.
#[inline]
pub(crate) fn luminance(value: DVec3) -> f64 {
    value.dot(Rgb::LUMINANCE_WEIGHTS.as_dvec3())
}

/// The regular expression of a path, such as `EDSSL`, read from the eye; `L` is `A` for an area light,
/// `P` for a point light, `R` for a directional light, `B` for a beam without width and `V` for an environment.
///
/// Source: Heckbert 1990.
pub struct Signature<'p>(&'p [PathVertex]);

impl fmt::Display for Signature<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|vertex| {
            f.write_str(match vertex.event {
                Event::Measurement => "E",
                Event::Finite => "D",
                Event::Specular(_) => "S",
                Event::Null(_) => "N",
                Event::Emission(EmitterClass::Area) => "A",
                Event::Emission(EmitterClass::Point) => "P",
                Event::Emission(EmitterClass::Directional) => "R",
                Event::Emission(EmitterClass::Collimated) => "B",
                Event::Emission(EmitterClass::Environment) => "V",
            })
        })
    }
}
