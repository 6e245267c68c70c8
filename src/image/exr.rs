//! EXR files in and out.

use std::fs::File;
use std::path::Path;

use openexr_sys::{
    AttributeValue, ChannelFormat, Chromaticities, Compression, Layout, Precision, Reader,
    SampleType,
};

use super::atomic::AtomicFile;
use super::error::ImageError;
use super::layers::{Channel, Image, Rows};

/// Attribute with the primaries of the RGB channels, as the format names it.
const CHROMATICITIES: &str = "chromaticities";

/// How an EXR file is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExrOptions {
    /// The method.
    pub compression: Compression,
    /// Effort of deflate for the methods that use it, 1 (fast) to 9 (small).
    pub zip_level: u8,
}

impl Default for ExrOptions {
    /// Deflate by blocks of 16 rows at level 4: every reader knows it, and higher levels take
    /// several times as long for a few percent.
    fn default() -> Self {
        Self {
            compression: Compression::Zip,
            zip_level: 4,
        }
    }
}

/// What happened to the samples on the way into the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[must_use]
pub struct ExrReport {
    /// Finite samples that were limited to ±65504 because their channel is half precision.
    pub clamped: u64,
}

/// Version of the EXR library that is loaded now, such as `3.1.5`.
pub fn exr_version() -> String {
    openexr_sys::version()
}

/// Writes an EXR file: one part, rows from the top down.
///
/// - `path`: the final name; the file appears whole or not at all.
/// - `image`: its rows are asked for as they are written, a few at a time. Infinities and NaN are kept. In half precision, finite values beyond ±65504 become
///   ±65504 and are counted. With channels `R`, `G`, `B` in some layer, the file says that they are
///   Rec.709, unless the metadata says otherwise.
///
/// The same image and options give the same bytes with the same EXR library.
///
/// # Errors
/// [`ImageError::Invalid`] when sizes and names contradict each other, [`ImageError::Unsupported`]
/// when the installed library lacks the compression, [`ImageError::Write`] when the file cannot be
/// written.
pub fn write_exr(
    path: &Path,
    image: &dyn Rows,
    options: &ExrOptions,
) -> Result<ExrReport, ImageError> {
    if let Some(flaw) = image.flaw() {
        return Err(ImageError::invalid(path, flaw));
    }
    let channels = image.channels();
    let mut attributes = image.metadata().clone();
    if channels.iter().any(|(name, _)| is_red_of_rgb(image, name)) {
        attributes
            .entry(CHROMATICITIES.to_owned())
            .or_insert(AttributeValue::Chromaticities(Chromaticities::REC709));
    }
    let layout = Layout {
        data_window: image.data_window(),
        display_window: image.display_window(),
        pixel_aspect_ratio: 1.0,
        compression: options.compression,
        zip_level: options.zip_level,
        attributes,
    };
    let formats = channels.into_iter();
    let formats: Vec<_> = formats
        .map(|(name, precision)| ChannelFormat { name, precision })
        .collect();
    let file = AtomicFile::create(path)?;
    let fill = |channel, rows, samples: &mut [f32]| image.fill(channel, rows, samples);
    let report = openexr_sys::write_rows(file.file(), &layout, &formats, fill)
        .map_err(|error| ImageError::from_exr(path, error, ImageError::write))?;
    file.persist()?;
    Ok(ExrReport {
        clamped: report.clamped,
    })
}

/// True for the red channel of a layer that has green and blue, too.
fn is_red_of_rgb(image: &dyn Rows, name: &str) -> bool {
    let Some(layer) = name.strip_suffix('R') else {
        return false;
    };
    (layer.is_empty() || layer.ends_with('.'))
        && ["G", "B"]
            .iter()
            .all(|letter| image.channel_index(&format!("{layer}{letter}")).is_some())
}

/// Reads all channels of the first part of an EXR file, scanline or tiled, at full resolution.
///
/// Half channels are converted exactly. Unsigned integers are rounded to f32 and have
/// [`Precision::Float`]. Attributes of types that [`AttributeValue`] does not have are left out.
///
/// # Errors
/// [`ImageError::Read`] when the file cannot be read, [`ImageError::Broken`] when it is no EXR file
/// or damaged, [`ImageError::Unsupported`] for deep or subsampled data.
pub fn read_exr(path: &Path) -> Result<Image, ImageError> {
    let reader = open_exr(path)?;
    let header = reader.header();
    let names: Vec<&str> = header
        .channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect();
    let data = read_channels(path, &reader, &names)?;
    let channels = header
        .channels
        .iter()
        .zip(data)
        .map(|(channel, data)| {
            let precision = match channel.sample_type {
                SampleType::Half => Precision::Half,
                SampleType::Float | SampleType::Uint => Precision::Float,
            };
            Channel {
                name: channel.name.clone(),
                precision,
                data,
            }
        })
        .collect();
    Ok(Image {
        data_window: header.data_window,
        display_window: header.display_window,
        channels,
        metadata: header.attributes.clone(),
    })
}

/// Opens a file and reads its header.
pub(super) fn open_exr(path: &Path) -> Result<Reader, ImageError> {
    let file = File::open(path).map_err(|source| ImageError::read(path, source))?;
    Reader::new(file).map_err(|error| ImageError::from_exr(path, error, ImageError::read))
}

/// Reads some channels of an open file.
pub(super) fn read_channels(
    path: &Path,
    reader: &Reader,
    names: &[&str],
) -> Result<Vec<Vec<f32>>, ImageError> {
    reader
        .read_channels(names)
        .map_err(|error| ImageError::from_exr(path, error, ImageError::read))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::thread;

    use openexr_sys::Window;

    use super::*;

    /// A render as the film writes it: beauty, alpha and layers, with metadata.
    fn render() -> Image {
        let mut image = Image::new(6, 5);
        let pixel = |i: usize| [i as f32 * 0.25, 1.0 / (i + 1) as f32, -0.5];
        let pixels: Vec<[f32; 3]> = (0..30).map(pixel).collect();
        image.push_rgb("", Precision::Float, &pixels);
        image.push("A", Precision::Half, vec![1.0; 30]);
        image.push_rgb("albedo", Precision::Half, &[[0.5, 0.25, 0.125]; 30]);
        image.push(
            "depth.Z",
            Precision::Float,
            (0..30).map(|i| 1.0 + i as f32).collect(),
        );
        image
            .metadata
            .insert("seed".to_owned(), AttributeValue::Int(7));
        image.metadata.insert(
            "scene".to_owned(),
            AttributeValue::String("box.xml".to_owned()),
        );
        image
    }

    fn sorted(mut image: Image) -> Image {
        image.channels.sort_by(|a, b| a.name.cmp(&b.name));
        image
    }

    #[test]
    fn a_render_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render.exr");
        let mut image = render();
        image.data_window = Window {
            min: [2, 3],
            max: [7, 7],
        };
        image.display_window = Window::of_size(20, 10);
        assert_eq!(
            write_exr(&path, &image, &ExrOptions::default())
                .unwrap()
                .clamped,
            0
        );
        let rec709 = AttributeValue::Chromaticities(Chromaticities::REC709);
        image.metadata.insert(CHROMATICITIES.to_owned(), rec709);
        assert_eq!(read_exr(&path).unwrap(), sorted(image));
    }

    #[test]
    fn only_colour_has_chromaticities() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut image = Image::new(1, 1);
        for name in ["R", "G", "OTHER", "Z"] {
            image.push(name, Precision::Float, vec![1.0]);
        }
        let has = |image: &Image| {
            let _ = write_exr(&path, image, &ExrOptions::default()).unwrap();
            read_exr(&path)
                .unwrap()
                .metadata
                .contains_key(CHROMATICITIES)
        };
        assert!(!has(&image));
        image.push_rgb("normal", Precision::Float, &[[0.0; 3]]);
        assert!(has(&image));
    }

    #[test]
    fn large_halves_are_counted() {
        let folder = tempfile::tempdir().unwrap();
        let mut image = Image::new(3, 1);
        image.push("Y", Precision::Half, vec![1e6, f32::INFINITY, 2.0]);
        let path = folder.path().join("bright.exr");
        assert_eq!(
            write_exr(&path, &image, &ExrOptions::default())
                .unwrap()
                .clamped,
            1
        );
        assert_eq!(
            read_exr(&path).unwrap().channels[0].data,
            [65504.0, f32::INFINITY, 2.0]
        );
    }

    #[test]
    fn threads_write_into_one_folder() {
        let folder = tempfile::tempdir().unwrap();
        let image = render();
        thread::scope(|scope| {
            for thread in 0..4 {
                let (folder, image) = (folder.path(), &image);
                scope.spawn(move || {
                    for turn in 0..10 {
                        // Each thread has its own files; all write one of the same name.
                        for name in [format!("{thread}-{turn}.exr"), "same.exr".to_owned()] {
                            let path = folder.join(name);
                            let _ = write_exr(&path, image, &ExrOptions::default()).unwrap();
                        }
                    }
                });
            }
        });
        let first = fs::read(folder.path().join("same.exr")).unwrap();
        let mut count = 0;
        for entry in fs::read_dir(folder.path()).unwrap() {
            assert_eq!(fs::read(entry.unwrap().path()).unwrap(), first);
            count += 1;
        }
        assert_eq!(
            count, 41,
            "a temporary file was left, or one of ours is missing"
        );
    }

    #[test]
    fn errors_name_the_file_and_leave_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut image = render();
        image.channels[0].data.pop();
        let error = write_exr(&path, &image, &ExrOptions::default()).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("a.exr: channel R has 29 samples"),
            "{error}"
        );
        let missing = folder.path().join("missing/a.exr");
        let error = write_exr(&missing, &render(), &ExrOptions::default()).unwrap_err();
        assert!(matches!(error, ImageError::Write { .. }), "{error}");
        assert!(matches!(read_exr(&path), Err(ImageError::Read { .. })));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);

        fs::write(&path, "not an image").unwrap();
        let error = read_exr(&path).unwrap_err();
        assert!(
            error.to_string().ends_with("a.exr: not an EXR file"),
            "{error}"
        );
    }
}
