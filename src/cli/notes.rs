//! Warnings of one scene: those of its file, and those of rendering it.

use super::console::say;
use super::failure::Failure;
use crate::scene::import::xml::{Diagnostic, Location, Severity, Strictness};

/// Warnings of one scene, printed as they come.
#[derive(Debug)]
pub(super) struct Notes {
    strictness: Strictness,
    quiet: bool,
    list: Vec<Diagnostic>,
    printed: usize,
}

impl Notes {
    /// Starts with the warnings of the importer.
    pub(super) fn new(strictness: Strictness, quiet: bool, list: Vec<Diagnostic>) -> Self {
        Self {
            strictness,
            quiet,
            list,
            printed: 0,
        }
    }

    /// Notes that something in the scene has no effect; an error under `--strict`.
    pub(super) fn warn(&mut self, location: Option<&Location>, message: String) {
        self.push(location, message, false);
    }

    /// Notes that something stands in for what the scene asks for; an error under `--strict`.
    pub(super) fn replace(&mut self, location: Option<&Location>, message: String) {
        self.push(location, message, true);
    }

    /// Notes something that is no fault of the scene.
    pub(super) fn remark(&mut self, message: String) {
        self.list.push(Diagnostic {
            severity: Severity::Warning,
            location: None,
            message,
            is_replacement: false,
        });
    }

    /// As [`Notes::remark`], and prints it.
    pub(super) fn remark_now(&mut self, message: String) {
        self.remark(message);
        self.print();
    }

    fn push(&mut self, location: Option<&Location>, message: String, is_replacement: bool) {
        let severity = match self.strictness {
            Strictness::Strict => Severity::Error,
            _ => Severity::Warning,
        };
        self.list.push(Diagnostic {
            severity,
            location: location.cloned(),
            message,
            is_replacement,
        });
    }

    /// Prints what is new, or gives everything up.
    ///
    /// # Errors
    /// [`Failure::Scene`] when something noted is an error.
    pub(super) fn settle(&mut self) -> Result<(), Failure> {
        if self
            .list
            .iter()
            .any(|note| note.severity == Severity::Error)
        {
            return Err(Failure::Scene(std::mem::take(&mut self.list)));
        }
        self.print();
        Ok(())
    }

    fn print(&mut self) {
        if !self.quiet {
            for note in &self.list[self.printed..] {
                say(&note.to_string());
            }
        }
        self.printed = self.list.len();
    }

    /// All warnings, a line each.
    pub(super) fn lines(&self) -> Vec<String> {
        self.list.iter().map(Diagnostic::to_string).collect()
    }

    /// What stands in for something that the scene asks for, each with its place.
    pub(super) fn replaced(&self) -> Vec<String> {
        let replaced = self.list.iter().filter(|note| note.is_replacement);
        replaced.map(|note| note.brief()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_strictness_makes_errors() {
        let mut notes = Notes::new(Strictness::Normal, true, Vec::new());
        notes.warn(None, "a".to_owned());
        notes.replace(None, "b".to_owned());
        notes.settle().unwrap();
        assert_eq!(notes.lines(), ["warning: a", "warning: b"]);
        assert_eq!(notes.replaced(), ["b"]);

        let mut notes = Notes::new(Strictness::Strict, true, Vec::new());
        notes.remark("a".to_owned());
        notes.settle().unwrap();
        notes.replace(None, "b".to_owned());
        assert_eq!(notes.settle().unwrap_err().exit_code(), 3);
    }
}
