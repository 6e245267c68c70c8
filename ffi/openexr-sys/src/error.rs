//! What can go wrong with an EXR file.

use std::io;

/// Why a file could not be read or written. The messages do not name the file: the caller knows it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to read or write.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file does not begin with the four bytes of an EXR file.
    #[error("not an EXR file")]
    NotExr,
    /// The library refused the file: it is broken, cut off or against the format.
    #[error("broken EXR file: {0}")]
    Broken(String),
    /// The header claims more samples than a file of this size can hold.
    #[error("broken EXR file: {claimed} bytes of samples cannot come from a file of {file} bytes")]
    Oversized {
        /// Bytes of the decoded image, as the header has it.
        claimed: u64,
        /// Bytes of the file.
        file: u64,
    },
    /// A sound file, or a wish of the caller, that needs what this crate or this version of the
    /// library does not have: deep data, subsampled channels, some compressions.
    #[error("{0}")]
    Unsupported(String),
    /// The caller's arguments contradict each other or the format.
    #[error("{0}")]
    Invalid(String),
    /// There is no memory for the samples.
    #[error("no memory for {0} bytes of samples")]
    OutOfMemory(u64),
}
