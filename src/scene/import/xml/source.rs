//! Where in which file something stands.

use std::cmp::Ordering;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One file that was read, or a text that stands for one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The name shown to people, also the path from which relative file names start.
    pub path: PathBuf,
    /// Position in the order of reading: the root file is 0.
    pub order: usize,
}

impl Source {
    /// The folder of the file; empty (the current folder) for a bare name.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }
}

/// A place in a file. Sorts by file in the order of reading, then by line and column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub source: Arc<Source>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}:{}",
            self.source.path.display(),
            self.line,
            self.column
        )
    }
}

impl Ord for Location {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |location: &Self| (location.source.order, location.line, location.column);
        key(self).cmp(&key(other))
    }
}

impl PartialOrd for Location {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Turns byte offsets of one text into locations.
pub(super) struct Locator<'t> {
    pub(super) source: Arc<Source>,
    text: &'t str,
    line_starts: Vec<usize>,
}

impl<'t> Locator<'t> {
    pub(super) fn new(source: Arc<Source>, text: &'t str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0)
            .chain(breaks.map(|(i, _)| i + 1))
            .collect();
        Self {
            source,
            text,
            line_starts,
        }
    }

    /// The place of the byte at `offset`; the end of the text for larger ones.
    pub(super) fn locate(&self, offset: usize) -> Location {
        let offset = offset.min(self.text.len());
        let line = self.line_starts.partition_point(|start| *start <= offset);
        let before = self
            .text
            .get(self.line_starts[line - 1]..offset)
            .unwrap_or("");
        self.at(line, before.chars().count() + 1)
    }

    pub(super) fn locate_end(&self) -> Location {
        self.locate(self.text.trim_end().len())
    }

    pub(super) fn at(&self, line: usize, column: usize) -> Location {
        let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        Location {
            source: Arc::clone(&self.source),
            line: small(line),
            column: small(column),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_become_lines_and_columns() {
        let source = Arc::new(Source {
            path: "a.xml".into(),
            order: 0,
        });
        let locator = Locator::new(source, "ab\nαβγ\n\nd");
        let shown = |offset| locator.locate(offset).to_string();
        assert_eq!(shown(0), "a.xml:1:1");
        assert_eq!(shown(2), "a.xml:1:3");
        assert_eq!(shown(3), "a.xml:2:1");
        assert_eq!(shown(7), "a.xml:2:3");
        assert_eq!(shown(11), "a.xml:4:1");
        assert_eq!(shown(999), "a.xml:4:2");
    }
}
