//! What can go wrong while a device or a scene is made.

use crate::device::Versions;

/// Why a device or a scene could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Embree refused to make a device.
    #[error("Embree cannot make a device with the configuration \"{config}\": {message}")]
    Device {
        /// The configuration that was asked for.
        config: String,
        /// Embree's words where it has some, else the meaning of its error code.
        message: String,
    },
    /// The library that was loaded lays out its data differently from the headers of the build.
    #[error(
        "built with the headers of Embree {}, but the library that was loaded is Embree {}: \
         build again on this machine",
        .0.header,
        .0.library
    )]
    WrongLibrary(Versions),
    /// Embree reported an error while a scene was built.
    #[error("Embree could not {operation}: {message}")]
    Embree {
        /// What was being done, as a verb phrase.
        operation: &'static str,
        /// Embree's words where it has some, else the meaning of its error code.
        message: String,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} refers to vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange {
        /// Position of the triangle in its index buffer.
        triangle: usize,
        /// The index it holds.
        index: u32,
        /// Number of vertices in the vertex buffer.
        vertices: usize,
    },
    /// A coordinate is not a number, infinite, or beyond [`crate::VertexBuffer::LARGEST`].
    #[error("vertex {vertex} at {position:?} is not finite or too far out")]
    BadVertex {
        /// Position of the vertex in its vertex buffer.
        vertex: usize,
        /// Its coordinates.
        position: [f32; 3],
    },
    /// A buffer, or the number of geometries, exceeds what 32-bit ids can name.
    #[error("{count} {what} are more than Embree can number")]
    TooMany {
        /// What is being counted.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A sphere, disk, cylinder or instance has a radius, centre or matrix that describes nothing.
    #[error("{what} has an unusable {parameter}: {value}")]
    BadShape {
        /// The kind of shape.
        what: &'static str,
        /// The parameter at fault.
        parameter: &'static str,
        /// Its value, and what is wrong with it.
        value: String,
    },
    /// An instance of a scene that contains instances itself: Embree is built for one level.
    #[error("an instanced scene cannot contain instances")]
    NestedInstance,
    /// An instance of a scene that was built on another device.
    #[error("an instanced scene must be built on the same device")]
    ForeignDevice,
}
