//! Writing images by the extension of their names.

use std::path::Path;

use crate::image::{ExrOptions, ImageError, Rows, write_exr, write_png_of};

/// Formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// All layers, with metadata.
    Exr,
    /// The picture alone, for looking at.
    Png,
}

impl FileKind {
    /// All kinds, with the extensions of their files.
    pub const EXTENSIONS: [(&'static str, Self); 2] = [("exr", Self::Exr), ("png", Self::Png)];

    /// The kind that a file's name asks for, ignoring letter case.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        Self::EXTENSIONS
            .into_iter()
            .find(|(known, _)| extension.eq_ignore_ascii_case(known))
            .map(|(_, kind)| kind)
    }
}

/// How images are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SaveOptions {
    /// How EXR files are packed.
    pub exr: ExrOptions,
    /// Brightness of PNG files, in stops.
    pub exposure: f32,
}

/// Writes an image; the file appears whole or not at all.
///
/// - `path`: an extension that [`FileKind`] does not know gives an EXR file.
///
/// Returns the number of values that were limited because half floats end at 65504.
///
/// # Errors
/// When the file cannot be written, or the image has no channels `R`, `G` and `B` for a PNG.
pub fn save(path: &Path, image: &dyn Rows, options: &SaveOptions) -> Result<u64, ImageError> {
    match FileKind::of(path) {
        Some(FileKind::Png) => {
            write_png_of(path, image, options.exposure)?;
            Ok(0)
        }
        Some(FileKind::Exr) | None => Ok(write_exr(path, image, &options.exr)?.clamped),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, Precision, read_bitmap, read_exr};

    #[test]
    fn the_extension_decides() {
        assert_eq!(FileKind::of(Path::new("a/b.EXR")), Some(FileKind::Exr));
        assert_eq!(FileKind::of(Path::new("b.png")), Some(FileKind::Png));
        assert_eq!(FileKind::of(Path::new("b.jpeg")), None);
        assert_eq!(FileKind::of(Path::new("png")), None);
    }

    #[test]
    fn both_kinds_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut image = Image::new(2, 1);
        image.push_rgb("", Precision::Half, &[[0.25; 3], [1e6, 0.0, 0.0]]);
        let options = SaveOptions {
            exr: ExrOptions::default(),
            exposure: 2.0,
        };
        let exr = folder.path().join("a.exr");
        assert_eq!(save(&exr, &image, &options).unwrap(), 1);
        assert_eq!(read_exr(&exr).unwrap().rgb("").unwrap()[0], [0.25; 3]);
        let png = folder.path().join("a.png");
        assert_eq!(save(&png, &image, &options).unwrap(), 0);
        assert_eq!(read_bitmap(&png).unwrap().rgb(0, 0).to_array(), [1.0; 3]);
    }
}
