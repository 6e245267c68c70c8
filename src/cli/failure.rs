//! Why a command did not do what was asked.

use std::path::Path;

use super::console::complain;
use crate::image::ImageError;
use crate::scene::import::ImportError;
use crate::scene::import::xml::Diagnostic;

/// Why a command did not do what was asked.
#[derive(Debug)]
pub(super) enum Failure {
    /// The command line asks for something that does not exist or makes no sense.
    Usage(String),
    /// The scene cannot be rendered.
    Scene(Vec<Diagnostic>),
    /// A file cannot be read or written.
    File(String),
    /// There is not enough memory.
    Memory(String),
}

impl Failure {
    /// What the process ends with.
    pub(super) fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Scene(_) => 3,
            Self::File(_) => 4,
            Self::Memory(_) => 5,
        }
    }

    /// Says it on stderr.
    pub(super) fn report(&self, command: &str) {
        match self {
            Self::Usage(message) => {
                let hint = format!("lumiflow help {command}");
                complain(&format!(
                    "{message}\n\nFor more information, try '{}'.",
                    hint.trim()
                ));
            }
            Self::Scene(diagnostics) => {
                for diagnostic in diagnostics {
                    super::console::say(&diagnostic.to_string());
                }
            }
            Self::File(message) | Self::Memory(message) => complain(message),
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        Self::File(error.to_string())
    }
}

impl From<ImportError> for Failure {
    fn from(error: ImportError) -> Self {
        match error {
            ImportError::Scene(diagnostics) => Self::Scene(diagnostics),
            ImportError::Memory { .. } => Self::Memory(error.to_string()),
            other => Self::File(other.to_string()),
        }
    }
}

/// The message for images of two sizes where one is needed.
pub(super) fn sizes_differ(a: &Path, size_a: (u32, u32), b: &Path, size_b: (u32, u32)) -> Failure {
    let shown = |path: &Path, (width, height)| format!("{} is {width}x{height}", path.display());
    Failure::Usage(format!("{}, but {}", shown(a, size_a), shown(b, size_b)))
}
