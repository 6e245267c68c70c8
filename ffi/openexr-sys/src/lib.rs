//! `OpenEXR` files through the C API of the installed library (`OpenEXRCore` 3.1 or newer).
//!
//! A safe face over what a renderer needs: [`write()`] makes a single-part scanline file with any
//! number of half and float channels, [`Reader`] reads the first part of a file, scanline or tiled.
//! Deep data and subsampled channels are refused with an error.
//!
//! Both work on an open [`std::fs::File`] through the library's stream callbacks, so that naming,
//! temporary files and renaming stay in one place in the caller, and so that each error of the
//! operating system arrives as what it is. Chunks are coded one after the other in the calling
//! thread.
//!
//! The same input gives the same bytes with the same version of the library; the bytes of the
//! deflate-based compressions depend on the zlib or libdeflate that the library was built with.

mod bindings;
mod context;
mod error;
mod header;
mod reader;
mod types;
mod writer;

pub use error::Error;
pub use header::{ChannelInfo, Header, SampleType};
pub use reader::Reader;
pub use types::{AttributeValue, Chromaticities, Compression, Precision, Window};
pub use writer::{Channel, ChannelFormat, Layout, WriteReport, write, write_rows};

/// Version of the library that is loaded now, such as `3.1.5`.
pub fn version() -> String {
    let (mut major, mut minor, mut patch) = (0, 0, 0);
    let mut extra = std::ptr::null();
    // SAFETY: four valid places to write to; the function does not fail.
    unsafe {
        bindings::exr_get_library_version(&mut major, &mut minor, &mut patch, &mut extra);
    }
    format!("{major}.{minor}.{patch}")
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_library_is_new_enough() {
        let version = super::version();
        let parts: Vec<u32> = version
            .split('.')
            .map(|part| part.parse().unwrap())
            .collect();
        assert!((parts[0], parts[1]) >= (3, 1), "{version}");
    }
}
