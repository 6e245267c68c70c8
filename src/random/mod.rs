//! Random numbers with an address, and the samplers that draw from them.
//!
//! A number is a function of (seed, purpose, index, sample, draw) alone: no generator state passes
//! from one unit of work to another, so pictures do not depend on threads, shards or resumes.

mod philox;
mod sampler;

pub use philox::{Purpose, Stream};
pub use sampler::{Numbers, PixelAddress, PrimarySample, Sampler, SamplerKind};
