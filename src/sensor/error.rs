//! Why a sensor cannot be made.

/// Why numbers describe no camera.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensorError {
    /// The field of view is not an angle that a plane can span.
    #[error("the field of view is {0} degrees, expected more than 0 and less than 180")]
    FieldOfView(f32),
    /// The clip planes are in the wrong order.
    #[error("the clip planes are at {near} and {far}, expected 0 or more and growing")]
    ClipPlanes {
        /// Distance of the near one.
        near: f32,
        /// Distance of the far one.
        far: f32,
    },
    /// The transform bends right angles.
    #[error(
        "the transform shears the camera; only rotations, translations and scales are possible"
    )]
    Shear,
    /// The film has no pixels.
    #[error("the film has no pixels")]
    NoPixels,
    /// The lens has no area.
    #[error("the radius of the aperture is {0}, expected more than 0")]
    ApertureRadius(f32),
    /// The plane in focus does not lie before the lens.
    #[error("the distance of focus is {0}, expected more than 0")]
    FocusDistance(f32),
}
