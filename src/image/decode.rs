//! Textures from files.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use ::image::codecs::hdr::HdrDecoder;
use ::image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use half::f16;
use openexr_sys::{ChannelInfo, SampleType};

use super::bitmap::{Bitmap, Texels};
use super::error::ImageError;
use super::exr::{open_exr, read_channels};
use super::layers::channel_name;

/// Enough of a file to tell its format.
const HEAD_BYTES: u64 = 16;

/// Memory that decoding may always take, in bytes.
const BASE_LIMIT: u64 = 64 << 20;

/// Bytes that one byte of a file may become at most. Deflate, the densest of the formats, reaches
/// 1032; a header that claims more is broken.
const MAX_EXPANSION: u64 = 1100;

/// Reads a texture from a PNG, JPEG, BMP, TGA, Radiance HDR or EXR file.
///
/// The content decides the format; TGA, which has no mark, is known by its extension. PNG, JPEG, BMP
/// and TGA give 8 or 16 bits a channel as stored and are sRGB-encoded; colour profiles in them are
/// not read. HDR gives f32, EXR half or f32, both linear. Grey with alpha becomes RGB with alpha.
/// An EXR file gives `R`, `G`, `B` or `Y`, each with `A` if there is one; without these, the first
/// layer that has `R`, `G` and `B`. Of an EXR file, the data window is the texture.
///
/// # Errors
/// [`ImageError::Read`], [`ImageError::UnknownFormat`], [`ImageError::Broken`],
/// [`ImageError::Unsupported`] and [`ImageError::NoColour`], each as it says.
pub fn read_bitmap(path: &Path) -> Result<Bitmap, ImageError> {
    let failed = |source| ImageError::read(path, source);
    let mut file = File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    (&mut file)
        .take(HEAD_BYTES)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    let Some(format) = detect(&bytes, path) else {
        return Err(ImageError::UnknownFormat {
            path: path.to_owned(),
        });
    };
    if format == ImageFormat::OpenExr {
        return read_exr_bitmap(path);
    }
    file.read_to_end(&mut bytes).map_err(failed)?;
    decode_as(format, &bytes, path)
}

/// Reads a texture from the bytes of a PNG, JPEG, BMP or HDR file, as [`read_bitmap`] does.
///
/// - `name`: of the picture, for messages.
///
/// # Errors
/// As [`read_bitmap`].
pub fn decode_bitmap(bytes: &[u8], name: &Path) -> Result<Bitmap, ImageError> {
    let format = detect(bytes, name).filter(|format| *format != ImageFormat::OpenExr);
    let format = format.ok_or_else(|| ImageError::UnknownFormat {
        path: name.to_owned(),
    })?;
    decode_as(format, bytes, name)
}

fn decode_as(format: ImageFormat, bytes: &[u8], path: &Path) -> Result<Bitmap, ImageError> {
    let broken =
        |reason: &str| ImageError::broken(path, format!("broken {} file: {reason}", name(format)));
    if format == ImageFormat::Jpeg && !has_jpeg_end(bytes) {
        return Err(broken("it ends too early"));
    }
    let decoded = decode(bytes, format).map_err(|error| broken(&error.to_string()))?;
    to_bitmap(decoded)
        .ok_or_else(|| ImageError::unsupported(path, "a layout of pixels that is not read"))
}

/// The format of a file, if it is one that is read.
fn detect(head: &[u8], path: &Path) -> Option<ImageFormat> {
    let has_tga_extension = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("tga"));
    match ::image::guess_format(head) {
        Ok(
            format @ (ImageFormat::Png
            | ImageFormat::Jpeg
            | ImageFormat::Bmp
            | ImageFormat::Hdr
            | ImageFormat::OpenExr),
        ) => Some(format),
        _ if head.starts_with(b"#?RGBE") => Some(ImageFormat::Hdr),
        _ if has_tga_extension => Some(ImageFormat::Tga),
        _ => None,
    }
}

fn name(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::Bmp => "BMP",
        ImageFormat::Hdr => "HDR",
        ImageFormat::Tga => "TGA",
        _ => "image",
    }
}

/// True when the mark of the end follows the pixels. The decoder fills up with grey otherwise.
fn has_jpeg_end(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xda;
    // After the first mark come segments: a mark, then a length that counts itself. They may hold a
    // thumbnail with an end of its own.
    let mut position = 2;
    while let Some(&[0xff, kind, high, low]) = bytes.get(position..position + 4) {
        if kind == START_OF_SCAN {
            return bytes[position..]
                .windows(2)
                .any(|pair| pair == [0xff, 0xd9]);
        }
        // Any number of bytes 0xff may stand before a mark.
        let is_fill = kind == 0xff;
        position += if is_fill {
            1
        } else {
            2 + usize::from(u16::from_be_bytes([high, low]))
        };
    }
    false
}

fn decode(bytes: &[u8], format: ImageFormat) -> ::image::ImageResult<DynamicImage> {
    let mut limits = Limits::default();
    let expanded = (bytes.len() as u64).saturating_mul(MAX_EXPANSION);
    limits.max_alloc = Some(BASE_LIMIT.saturating_add(expanded));
    let bytes = Cursor::new(bytes);
    if format == ImageFormat::Hdr {
        // Strict reading refuses files that begin with `#?RGBE` or repeat a line of the header.
        let decoder = HdrDecoder::new_nonstrict(bytes)?;
        limits.reserve(decoder.total_bytes())?;
        return DynamicImage::from_decoder(decoder);
    }
    let mut reader = ImageReader::with_format(bytes, format);
    reader.limits(limits);
    reader.decode()
}

/// Keeps the storage of the decoded image; `None` for a layout that no decoder here gives.
fn to_bitmap(decoded: DynamicImage) -> Option<Bitmap> {
    let (width, height) = (decoded.width(), decoded.height());
    let (channels, texels) = match decoded {
        DynamicImage::ImageLuma8(image) => (1, Texels::U8(image.into_raw())),
        DynamicImage::ImageLumaA8(image) => (4, Texels::U8(spread_grey(&image.into_raw()))),
        DynamicImage::ImageRgb8(image) => (3, Texels::U8(image.into_raw())),
        DynamicImage::ImageRgba8(image) => (4, Texels::U8(image.into_raw())),
        DynamicImage::ImageLuma16(image) => (1, Texels::U16(image.into_raw())),
        DynamicImage::ImageLumaA16(image) => (4, Texels::U16(spread_grey(&image.into_raw()))),
        DynamicImage::ImageRgb16(image) => (3, Texels::U16(image.into_raw())),
        DynamicImage::ImageRgba16(image) => (4, Texels::U16(image.into_raw())),
        DynamicImage::ImageRgb32F(image) => (3, Texels::Float(image.into_raw())),
        DynamicImage::ImageRgba32F(image) => (4, Texels::Float(image.into_raw())),
        _ => return None,
    };
    Bitmap::new(width, height, channels, texels)
}

/// Grey and alpha as red, green, blue and alpha.
fn spread_grey<T: Copy>(pairs: &[T]) -> Vec<T> {
    pairs
        .chunks_exact(2)
        .flat_map(|pair| [pair[0], pair[0], pair[0], pair[1]])
        .collect()
}

fn read_exr_bitmap(path: &Path) -> Result<Bitmap, ImageError> {
    let reader = open_exr(path)?;
    let header = reader.header();
    let Some(names) = colour_channels(&header.channels) else {
        let names: Vec<&str> = header
            .channels
            .iter()
            .map(|channel| channel.name.as_str())
            .collect();
        return Err(ImageError::NoColour {
            path: path.to_owned(),
            channels: names.join(", "),
        });
    };
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let planes = read_channels(path, &reader, &names)?;
    let is_half = header
        .channels
        .iter()
        .filter(|channel| names.contains(&channel.name.as_str()))
        .all(|channel| channel.sample_type == SampleType::Half);
    let order: &[usize] = match planes.len() {
        2 => &[0, 0, 0, 1],
        4 => &[0, 1, 2, 3],
        3 => &[0, 1, 2],
        _ => &[0],
    };
    let count = planes.first().map_or(0, Vec::len);
    let values = (0..count).flat_map(|texel| order.iter().map(move |&plane| (plane, texel)));
    let values = values.map(|(plane, texel)| planes[plane][texel]);
    let texels = if is_half {
        Texels::Half(values.map(f16::from_f32).collect())
    } else {
        Texels::Float(values.collect())
    };
    let window = header.data_window;
    Bitmap::new(window.width(), window.height(), order.len() as u32, texels)
        .ok_or_else(|| ImageError::broken(path, "the channels do not fill the data window"))
}

/// The channels that are the colour of a file: one (grey), two (grey, alpha), three or four.
fn colour_channels(channels: &[ChannelInfo]) -> Option<Vec<String>> {
    let has = |name: &String| channels.iter().any(|channel| channel.name == *name);
    let group = |layer: &str, letters: &[&str]| -> Option<Vec<String>> {
        let mut names: Vec<String> = letters
            .iter()
            .map(|letter| channel_name(layer, letter))
            .collect();
        let is_complete = names.iter().all(has);
        names.extend(Some(channel_name(layer, "A")).filter(has));
        is_complete.then_some(names)
    };
    // With RY and BY, Y is the luminance of a colour image, not a grey one.
    let has_chroma = has(&"RY".to_owned()) || has(&"BY".to_owned());
    let layers = channels
        .iter()
        .filter_map(|channel| channel.name.strip_suffix(".R"));
    group("", &["R", "G", "B"])
        .or_else(|| group("", &["Y"]).filter(|_| !has_chroma))
        .or_else(|| {
            layers
                .into_iter()
                .find_map(|layer| group(layer, &["R", "G", "B"]))
        })
}

#[cfg(test)]
mod tests;
