//! Which versions are at work.

use super::failure::Failure;
use crate::{accel, image};

/// Revision of the sources, as `git describe` gives it.
pub(super) const REVISION: &str = env!("LUMIFLOW_GIT_REVISION");

/// Version and revision: `0.1.0 (1234abc)`.
pub(super) fn own() -> String {
    format!("{} ({REVISION})", env!("CARGO_PKG_VERSION"))
}

/// What `--version` prints.
///
/// # Errors
/// When Embree cannot start.
pub(super) fn long() -> Result<String, Failure> {
    let (headers, library) = accel::versions().map_err(|error| Failure::File(error.to_string()))?;
    Ok(format!(
        "lumiflow {}\nEmbree {library} (built with headers {headers})\nOpenEXR {} (built with \
         headers {})\nobvhs {}",
        own(),
        image::exr_version(),
        env!("LUMIFLOW_OPENEXR_HEADERS"),
        accel::OBVHS_VERSION,
    ))
}
