//! Materials: how a surface scatters light.

mod conductor_presets;
mod ior_presets;

pub use conductor_presets::{conductor, conductor_names};
pub use ior_presets::{ior, ior_names};
