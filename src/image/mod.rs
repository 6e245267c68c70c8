//! Pictures in files: EXR in and out, textures in, PNG out.
//!
//! Two kinds of picture live here. An [`Image`] is a set of named f32 channels with metadata, as an
//! EXR file has them: what a render writes and what comparisons read. A [`Bitmap`] is a texture: it
//! keeps the storage of its file, a byte per channel for most, and decodes at each lookup, because
//! a production scene has gigabytes of 8-bit textures.
//!
//! Every file is written through [`AtomicFile`]: it appears whole or not at all.

mod atomic;
mod bitmap;
mod decode;
mod error;
mod exr;
mod layers;
mod png;
mod srgb;

pub use atomic::AtomicFile;
pub use bitmap::{Bitmap, Texels, Transfer};
pub use decode::{decode_bitmap, read_bitmap};
pub use error::ImageError;
pub use exr::{ExrOptions, ExrReport, exr_version, read_exr, write_exr};
pub use layers::{Channel, Image, Rows};
pub use png::{write_png, write_png_of};
pub use srgb::{srgb_decode, srgb_encode};

pub use openexr_sys::{AttributeValue, Chromaticities, Compression, Precision, Window};
