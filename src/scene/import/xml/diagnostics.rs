//! What was wrong with a scene file, all of it.

use std::cell::RefCell;
use std::fmt;

use super::source::Location;

/// How bad a [`Diagnostic`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Something was made up that the file leaves open.
    Note,
    /// The scene can be rendered; something in it has no effect or was replaced.
    Warning,
    /// The scene cannot be rendered.
    Error,
}

/// How severely problems are judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strictness {
    /// Missing files and unknown plugins that shape the picture are errors, the rest warnings.
    #[default]
    Normal,
    /// What is not supported is replaced and reported as a warning (`--lenient`).
    Lenient,
    /// Every warning is an error (`--strict`).
    Strict,
}

/// One problem of a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Where it stands; `None` for the command line.
    pub location: Option<Location>,
    /// A lower-case sentence: what was found, what was expected, what may have been meant.
    pub message: String,
    /// True when something else stands in for what the file says.
    pub is_replacement: bool,
}

impl Diagnostic {
    /// `file:line:col: message` with the file's name only, which is the same wherever it stands.
    pub fn brief(&self) -> String {
        let Some(location) = &self.location else {
            return self.message.clone();
        };
        let path = &location.source.path;
        let file = path.file_name().unwrap_or(path.as_os_str());
        let (line, column) = (location.line, location.column);
        format!(
            "{}:{line}:{column}: {}",
            file.to_string_lossy(),
            self.message
        )
    }
}

impl fmt::Display for Diagnostic {
    /// `file:line:col: message`, with `warning: ` or `note: ` before the message of one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(location) = &self.location {
            write!(f, "{location}: ")?;
        }
        match self.severity {
            Severity::Note => f.write_str("note: ")?,
            Severity::Warning => f.write_str("warning: ")?,
            Severity::Error => {}
        }
        f.write_str(&self.message)
    }
}

/// Collects problems while reading goes on.
///
/// Takes `&self` everywhere: a parent and the children it builds report into the same list.
#[derive(Debug, Default)]
pub struct Diagnostics {
    strictness: Strictness,
    found: RefCell<Vec<Diagnostic>>,
}

impl Diagnostics {
    /// An empty list that judges by `strictness`.
    pub fn new(strictness: Strictness) -> Self {
        Self {
            strictness,
            found: RefCell::default(),
        }
    }

    /// Notes that the scene cannot be rendered.
    pub fn error(&self, location: &Location, message: impl Into<String>) {
        self.push(Severity::Error, Some(location), message.into());
    }

    /// Notes what was made up where the file leaves it open; that is no fault of the file.
    pub fn note(&self, location: &Location, message: impl Into<String>) {
        self.push(Severity::Note, Some(location), message.into());
    }

    /// Notes that something has no effect; an error under `--strict`.
    pub fn warning(&self, location: &Location, message: impl Into<String>) {
        self.push(self.warning_severity(), Some(location), message.into());
    }

    /// Notes that something else stands in for what the file says; an error under `--strict`.
    pub fn replacement(&self, location: &Location, message: impl Into<String>) {
        self.found.borrow_mut().push(Diagnostic {
            severity: self.warning_severity(),
            location: Some(location.clone()),
            message: message.into(),
            is_replacement: true,
        });
    }

    /// Notes a warning about the command line.
    pub(super) fn warning_without_location(&self, message: String) {
        self.push(self.warning_severity(), None, message);
    }

    /// Notes an unknown plugin or a missing file: an error, or under `--lenient` a replacement.
    ///
    /// - `instead`: what happens under `--lenient`, such as "left out".
    pub fn unsupported(&self, location: &Location, message: impl Into<String>, instead: &str) {
        let mut message = message.into();
        let is_replacement = self.strictness == Strictness::Lenient;
        let severity = if is_replacement {
            Severity::Warning
        } else {
            Severity::Error
        };
        if is_replacement {
            message.push_str("; ");
            message.push_str(instead);
        }
        let location = Some(location.clone());
        let diagnostic = Diagnostic {
            severity,
            location,
            message,
            is_replacement,
        };
        self.found.borrow_mut().push(diagnostic);
    }

    /// True when anything noted so far is an error.
    pub fn has_errors(&self) -> bool {
        self.found
            .borrow()
            .iter()
            .any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// Everything noted so far in the order of the files, each problem once; what has no location
    /// comes last.
    pub fn sorted(&self) -> Vec<Diagnostic> {
        let mut list = self.found.borrow().clone();
        list.sort_by(|a, b| {
            let key = |diagnostic: &Diagnostic| diagnostic.location.is_none();
            key(a)
                .cmp(&key(b))
                .then_with(|| a.location.cmp(&b.location))
        });
        list.dedup();
        list
    }

    fn warning_severity(&self) -> Severity {
        if self.strictness == Strictness::Strict {
            Severity::Error
        } else {
            Severity::Warning
        }
    }

    fn push(&self, severity: Severity, location: Option<&Location>, message: String) {
        let location = location.cloned();
        self.found.borrow_mut().push(Diagnostic {
            severity,
            location,
            message,
            is_replacement: false,
        });
    }
}
