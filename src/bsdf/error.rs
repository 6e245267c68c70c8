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
    /// A material that lets light through was given to one that holds opaque ones only.
    #[error("{0} cannot hold a material that lets light through")]
    NestedTransmission(&'static str),
    /// Weights of materials are no shares of one; their sum is given.
    #[error("the weights of materials must be 0 or more and add up to 1 at most, not to {0}")]
    Weights(f32),
}
