//! The bytes of a file as text, and errors of the XML itself.

use std::borrow::Cow;

use super::source::{Location, Locator};

/// Files that are taken for scenes by mistake, by how they begin.
const OTHER_FORMATS: [(&[u8], &str); 7] = [
    (b"\x76\x2f\x31\x01", "an OpenEXR image"),
    (b"\x89PNG", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"#?RADIANCE", "a Radiance image"),
    (b"ply\n", "a PLY mesh"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\x1f\x8b", "a file packed by gzip"),
];

/// What a file is that is no XML, where its first bytes tell.
pub(super) fn other_format(bytes: &[u8]) -> Option<&'static str> {
    let found = OTHER_FORMATS
        .iter()
        .find(|(start, _)| bytes.starts_with(start));
    found.map(|(_, name)| *name)
}

/// The text of a file and whether it is UTF-8. Other files are taken as Latin-1, as editors of the
/// first generation wrote them.
pub(super) fn decode(bytes: &[u8]) -> (Cow<'_, str>, bool) {
    match std::str::from_utf8(bytes) {
        Ok(text) => (Cow::Borrowed(text), true),
        Err(_) => (
            Cow::Owned(bytes.iter().copied().map(char::from).collect()),
            false,
        ),
    }
}

/// Where and why a text is not XML.
pub(super) fn explain(error: &roxmltree::Error, locator: &Locator<'_>) -> (Location, String) {
    let place = error.pos();
    let location = locator.at(place.row as usize, place.col as usize);
    let end = locator.locate_end();
    let ends_early = matches!(
        error,
        roxmltree::Error::NoRootNode
            | roxmltree::Error::UnclosedRootNode
            | roxmltree::Error::UnexpectedEndOfStream
    );
    if ends_early || location >= end {
        return (
            end,
            "unexpected end of the file (is it truncated?)".to_owned(),
        );
    }
    let message = error.to_string();
    let suffix = format!(" at {place}");
    let message = message.strip_suffix(&suffix).unwrap_or(&message);
    (location, format!("broken XML: {message}"))
}
