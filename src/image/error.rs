//! What can go wrong between a picture and its file.

use std::io;
use std::path::{Path, PathBuf};

/// Why a picture could not be read or written. Every message names the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file is missing, may not be read, or reading it fails.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The file's folder is missing, may not be written to, or the disk is full.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file that was to appear; it is as it was before.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The content of the file is that of no format that is read.
    #[error("{}: not a PNG, JPEG, BMP, TGA, HDR or EXR image", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file begins as its format does, but is damaged, cut off or claims an absurd size.
    #[error("{}: {message}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is broken, as the decoder sees it.
        message: String,
    },
    /// A sound file with something that is not handled, such as deep or subsampled EXR channels, or
    /// a compression that the installed library lacks.
    #[error("{}: {message}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What is not handled.
        message: String,
    },
    /// An EXR file was asked for a texture, but its channels are no colour.
    #[error("{}: no channels R, G, B or Y among {channels}", path.display())]
    NoColour {
        /// The file.
        path: PathBuf,
        /// The channels that it has.
        channels: String,
    },
    /// The picture to write contradicts itself: sizes, names or values that no file can hold.
    #[error("{}: {message}", path.display())]
    Invalid {
        /// The file that was to appear.
        path: PathBuf,
        /// The contradiction.
        message: String,
    },
}

impl ImageError {
    pub(super) fn read(path: &Path, source: io::Error) -> Self {
        Self::Read {
            path: path.to_owned(),
            source,
        }
    }

    pub(super) fn write(path: &Path, source: io::Error) -> Self {
        Self::Write {
            path: path.to_owned(),
            source,
        }
    }

    pub(super) fn broken(path: &Path, message: impl Into<String>) -> Self {
        Self::Broken {
            path: path.to_owned(),
            message: message.into(),
        }
    }

    pub(super) fn unsupported(path: &Path, message: impl Into<String>) -> Self {
        Self::Unsupported {
            path: path.to_owned(),
            message: message.into(),
        }
    }

    pub(super) fn invalid(path: &Path, message: impl Into<String>) -> Self {
        Self::Invalid {
            path: path.to_owned(),
            message: message.into(),
        }
    }

    /// An error of the EXR library; `io` makes the variant for errors of the operating system.
    pub(super) fn from_exr(
        path: &Path,
        error: openexr_sys::Error,
        io: fn(&Path, io::Error) -> Self,
    ) -> Self {
        match error {
            openexr_sys::Error::Io(source) => io(path, source),
            openexr_sys::Error::NotExr
            | openexr_sys::Error::Broken(_)
            | openexr_sys::Error::Oversized { .. } => Self::broken(path, error.to_string()),
            openexr_sys::Error::Invalid(message) => Self::invalid(path, message),
            other => Self::unsupported(path, other.to_string()),
        }
    }
}
