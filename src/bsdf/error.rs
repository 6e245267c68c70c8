//! What can be wrong with the numbers of a material.

/// Why a material cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BsdfError {
    /// An index of refraction is zero, negative or not finite, or the ratio of the two is.
    #[error("an index of refraction must be positive and finite, not {0}")]
    IndexOfRefraction(f32),
    /// A rough dielectric between indices so close that rays go on as if it were not there.
    #[error("a rough dielectric needs two indices of refraction that differ; their ratio is {0}")]
    IndexMatched(f32),
    /// A material that lets light through was given to `twosided`.
    #[error("a two-sided material cannot hold one that lets light through")]
    NestedTransmission,
}
