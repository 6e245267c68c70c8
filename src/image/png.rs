//! 8-bit previews.

use std::io::{BufWriter, Write};
use std::path::Path;

use ::image::codecs::png::{CompressionType, FilterType, PngEncoder};
use ::image::{ExtendedColorType, ImageEncoder};

use super::atomic::AtomicFile;
use super::error::ImageError;
use super::layers::Rows;
use super::srgb::srgb_encode;

/// Writes an 8-bit sRGB PNG; the same input gives the same bytes.
///
/// - `path`: the final name; the file appears whole or not at all.
/// - `width`, `height`: in pixels, at least 1.
/// - `rgb`: linear Rec.709 pixels, rows from the top down.
/// - `exposure`: in stops; each pixel is multiplied by 2^`exposure`.
///
/// Values above 1 become white, values below 0 and NaN become black, each channel by itself.
///
/// # Errors
/// [`ImageError::Invalid`] when the number of pixels is not `width` × `height`,
/// [`ImageError::Write`] when the file cannot be written.
pub fn write_png(
    path: &Path,
    width: u32,
    height: u32,
    rgb: &[[f32; 3]],
    exposure: f32,
) -> Result<(), ImageError> {
    if rgb.is_empty() || rgb.len() as u64 != u64::from(width) * u64::from(height) {
        let message = format!("{} pixels are no image of {width}×{height}", rgb.len());
        return Err(ImageError::invalid(path, message));
    }
    let values = rgb.iter().flatten();
    let codes: Vec<u8> = values.map(|value| to_code(*value, exposure)).collect();
    write_codes(path, width, height, &codes)
}

/// Writes the channels `R`, `G` and `B` of a picture as [`write_png`] does; beside the 8-bit pixels, one
/// row is held at a time.
///
/// # Errors
/// As [`write_png`], and [`ImageError::Invalid`] when a channel is missing.
pub fn write_png_of(path: &Path, image: &dyn Rows, exposure: f32) -> Result<(), ImageError> {
    let (width, height) = (image.data_window().width(), image.data_window().height());
    let mut codes = vec![0; 3 * width as usize * height as usize];
    let mut samples = vec![0.0; width as usize];
    for (place, name) in ["R", "G", "B"].into_iter().enumerate() {
        let channel = image.channel_index(name);
        let channel = channel
            .ok_or_else(|| ImageError::invalid(path, format!("there is no channel {name}")))?;
        for (row, codes) in codes.chunks_exact_mut(3 * width as usize).enumerate() {
            image.fill(channel, row..row + 1, &mut samples);
            for (code, value) in codes[place..].iter_mut().step_by(3).zip(&samples) {
                *code = to_code(*value, exposure);
            }
        }
    }
    write_codes(path, width, height, &codes)
}

fn write_codes(path: &Path, width: u32, height: u32, codes: &[u8]) -> Result<(), ImageError> {
    let mut file = AtomicFile::create(path)?;
    let mut buffer = BufWriter::new(&mut file);
    PngEncoder::new_with_quality(&mut buffer, CompressionType::Default, FilterType::Adaptive)
        .write_image(codes, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| match error {
            ::image::ImageError::IoError(source) => ImageError::write(path, source),
            other => ImageError::invalid(path, other.to_string()),
        })?;
    buffer
        .flush()
        .map_err(|source| ImageError::write(path, source))?;
    drop(buffer);
    file.persist()
}

/// The nearest 8-bit sRGB code of a linear value.
fn to_code(value: f32, exposure: f32) -> u8 {
    let linear = f64::from(value) * f64::from(exposure.exp2());
    let limited = linear.clamp(0.0, 1.0) as f32;
    // NaN survives up to here and is cast to 0.
    (srgb_encode(limited) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::image::read_bitmap;

    #[test]
    fn pixels_are_exposed_encoded_and_limited() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preview.png");
        let rgb = [
            [0.0, 0.09, 0.5],
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY],
            [-1.0, 1e-9, 7.0],
        ];
        write_png(&path, 3, 1, &rgb, 1.0).unwrap();
        let decoded = ::image::open(&path).unwrap().into_rgb8();
        assert_eq!(decoded.dimensions(), (3, 1));
        // 0.09 at one stop more is 18 % grey, code 118.
        assert_eq!(decoded.into_raw(), [0, 118, 255, 0, 255, 0, 0, 0, 255]);
        assert!(read_bitmap(&path).unwrap().is_srgb_encoded());
    }

    #[test]
    fn the_same_pixels_give_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["a.png", "b.png"].map(|name| folder.path().join(name));
        let rgb: Vec<[f32; 3]> = (0..35 * 20).map(|i| [i as f32 / 700.0, 0.5, 0.1]).collect();
        for path in &paths {
            write_png(path, 35, 20, &rgb, -0.5).unwrap();
        }
        assert_eq!(fs::read(&paths[0]).unwrap(), fs::read(&paths[1]).unwrap());
    }

    #[test]
    fn wrong_sizes_and_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(matches!(
            write_png(&path, 2, 2, &[[0.0; 3]; 3], 0.0),
            Err(ImageError::Invalid { .. })
        ));
        assert!(matches!(
            write_png(&path, 0, 2, &[], 0.0),
            Err(ImageError::Invalid { .. })
        ));
        let missing = folder.path().join("missing/a.png");
        let error = write_png(&missing, 1, 1, &[[0.0; 3]], 0.0).unwrap_err();
        assert!(error.to_string().starts_with("cannot write "), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
