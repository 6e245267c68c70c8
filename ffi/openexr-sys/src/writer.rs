//! Writing a single-part scanline file.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString};
use std::fs::File;
use std::ops::Range;

use half::f16;

use crate::bindings as c;
use crate::context::Context;
use crate::error::Error;
use crate::header::{RESERVED_ATTRIBUTES, from_chromaticities};
use crate::types::{AttributeValue, Compression, Precision, Window};

/// Longest name of a channel or an attribute, in bytes.
const MAX_NAME: usize = 255;

/// Longest name that readers from before `OpenEXR` 2 accept; longer ones need a flag in the file.
const MAX_SHORT_NAME: usize = 31;

/// The library's own default, fixed so that its changes do not change our files.
const DWA_QUALITY: f32 = 45.0;

/// Everything about a file but its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The pixels that are written.
    pub data_window: Window,
    /// The frame that the picture is meant to fill.
    pub display_window: Window,
    /// Width of a pixel over its height; positive.
    pub pixel_aspect_ratio: f32,
    /// How samples are packed.
    pub compression: Compression,
    /// Effort of deflate, 1 (fast) to 9 (small), for the compressions that use it. Fixed by the
    /// caller because the library's default differs between distributions.
    pub zip_level: u8,
    /// Further attributes by name. Names of the format's own attributes are refused.
    pub attributes: BTreeMap<String, AttributeValue>,
}

/// A channel of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelFormat<'a> {
    /// Name such as `R` or `albedo.R`: at most 255 bytes, no zero byte, no two the same.
    pub name: &'a str,
    /// How it is stored.
    pub precision: Precision,
}

/// One channel to write.
#[derive(Clone, Copy, Debug)]
pub struct Channel<'a> {
    /// As [`ChannelFormat::name`].
    pub name: &'a str,
    /// How it is stored.
    pub precision: Precision,
    /// Rows of the data window from the top down, each from the left. Infinities and NaN are kept;
    /// for half precision, finite values beyond ±65504 become ±65504 and are counted.
    pub samples: &'a [f32],
}

/// What happened to the samples on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteReport {
    /// Finite samples that were limited to ±65504 because their channel is half precision.
    pub clamped: u64,
}

/// Writes a whole file: header, samples, table of chunks.
///
/// - `file`: open for writing and empty; what it holds after an error is of no use.
/// - `layout`: the header.
/// - `channels`: at least one, in any order; the file has them sorted by name.
///
/// # Errors
/// [`Error::Invalid`] when the arguments contradict each other, [`Error::Unsupported`] when this
/// version of the library lacks the compression, [`Error::Io`] when the file cannot be written.
pub fn write(file: &File, layout: &Layout, channels: &[Channel]) -> Result<WriteReport, Error> {
    let formats = channels.iter().map(|channel| ChannelFormat {
        name: channel.name,
        precision: channel.precision,
    });
    let formats: Vec<_> = formats.collect();
    validate(layout, &formats)?;
    let (width, height) = (layout.data_window.width(), layout.data_window.height());
    let pixels = u64::from(width) * u64::from(height);
    for Channel { name, samples, .. } in channels {
        let count = samples.len();
        if count as u64 != pixels {
            let message = format!("channel {name} has {count} samples for {width}×{height}");
            return Err(Error::Invalid(message));
        }
    }
    write_rows(file, layout, &formats, |index, rows, samples| {
        let row = |row: usize| row * width as usize;
        samples.copy_from_slice(&channels[index].samples[row(rows.start)..row(rows.end)]);
    })
}

/// Writes a whole file as [`write()`] does, whose rows are made when they are needed: what is held at once
/// are the rows of one chunk, sixteen or thirty-two at most.
///
/// - `fill`: is told the index of a channel and which of its rows to put into the samples, which have the
///   length for it; rows count from the top of the data window.
///
/// # Errors
/// As [`write()`].
pub fn write_rows(
    file: &File,
    layout: &Layout,
    channels: &[ChannelFormat],
    fill: impl FnMut(usize, Range<usize>, &mut [f32]),
) -> Result<WriteReport, Error> {
    validate(layout, channels)?;
    let context = Context::write(file.try_clone()?)?;
    let names = write_header(&context, layout, channels)?;
    let report = write_chunks(&context, layout, channels, &names, fill)?;
    context.finish()?;
    Ok(report)
}

fn validate(layout: &Layout, channels: &[ChannelFormat]) -> Result<(), Error> {
    let invalid = |message: String| Err(Error::Invalid(message));
    let (width, height) = (layout.data_window.width(), layout.data_window.height());
    // A row of floats must have a length in bytes that fits the library's 32-bit strides.
    if width == 0 || height == 0 || width > i32::MAX as u32 / 4 {
        return invalid(format!("an EXR image cannot have {width}×{height} pixels"));
    }
    if layout.display_window.width() == 0 || layout.display_window.height() == 0 {
        return invalid("the display window is empty".to_owned());
    }
    if !(layout.pixel_aspect_ratio.is_finite() && layout.pixel_aspect_ratio > 0.0) {
        return invalid(format!(
            "pixel aspect ratio {} is not above 0",
            layout.pixel_aspect_ratio
        ));
    }
    if !(1..=9).contains(&layout.zip_level) {
        return invalid(format!("zip level {} is not in 1 to 9", layout.zip_level));
    }
    if channels.is_empty() {
        return invalid("an EXR image needs a channel".to_owned());
    }
    for (index, channel) in channels.iter().enumerate() {
        let name = channel.name;
        if channels[..index].iter().any(|other| other.name == name) {
            return invalid(format!("two channels have the name {name}"));
        }
    }
    for name in layout.attributes.keys() {
        if RESERVED_ATTRIBUTES.contains(&name.as_str()) {
            return invalid(format!("the attribute name {name} belongs to the format"));
        }
    }
    Ok(())
}

/// A name for the library.
fn to_name(name: &str) -> Result<CString, Error> {
    match CString::new(name) {
        Ok(text) if (1..=MAX_NAME).contains(&name.len()) => Ok(text),
        _ => Err(Error::Invalid(format!(
            "{name:?} cannot be a name: 1 to {MAX_NAME} bytes without zero are needed"
        ))),
    }
}

/// Declares the part and writes the header; returns the channels' names in the order of `channels`.
fn write_header(
    context: &Context,
    layout: &Layout,
    channels: &[ChannelFormat],
) -> Result<Vec<CString>, Error> {
    let names = channels
        .iter()
        .map(|channel| to_name(channel.name))
        .collect::<Result<Vec<_>, _>>()?;
    let raw = context.raw();
    let (data, display) = (
        layout.data_window.to_shim(),
        layout.display_window.to_shim(),
    );
    // SAFETY: an open context, strings that end with zero, valid windows; the library copies them.
    unsafe {
        context.check(c::exr_set_longname_support(
            raw,
            i32::from(has_long_name(layout, channels)),
        ))?;
        let mut part = 0;
        context.check(c::exr_add_part(
            raw,
            c"image".as_ptr(),
            c::EXR_STORAGE_SCANLINE,
            &mut part,
        ))?;
        context.check(c::openexr_shim_set_required(
            raw,
            &data,
            &display,
            layout.pixel_aspect_ratio,
            layout.compression.to_code(),
        ))?;
        context.check(c::exr_set_zip_compression_level(
            raw,
            0,
            i32::from(layout.zip_level),
        ))?;
        context.check(c::exr_set_dwa_compression_level(raw, 0, DWA_QUALITY))?;
        for (channel, name) in channels.iter().zip(&names) {
            context.check(c::exr_add_channel(
                raw,
                0,
                name.as_ptr(),
                type_code(channel.precision),
                c::EXR_PERCEPTUALLY_LOGARITHMIC,
                1,
                1,
            ))?;
        }
    }
    for (name, value) in &layout.attributes {
        set_attribute(context, &to_name(name)?, value)?;
    }
    // SAFETY: an open context.
    context.check(unsafe { c::exr_write_header(raw) })?;
    Ok(names)
}

/// True when readers from before `OpenEXR` 2 would refuse a name.
fn has_long_name(layout: &Layout, channels: &[ChannelFormat]) -> bool {
    let attributes = layout.attributes.keys().map(String::as_str);
    let mut names = channels
        .iter()
        .map(|channel| channel.name)
        .chain(attributes);
    names.any(|name| name.len() > MAX_SHORT_NAME)
}

fn type_code(precision: Precision) -> c::exr_pixel_type_t {
    match precision {
        Precision::Half => c::EXR_PIXEL_HALF,
        Precision::Float => c::EXR_PIXEL_FLOAT,
    }
}

fn set_attribute(context: &Context, name: &CStr, value: &AttributeValue) -> Result<(), Error> {
    let (raw, key) = (context.raw(), name.as_ptr());
    // SAFETY: an open context, strings that end with zero; the library copies the values.
    let code = unsafe {
        match value {
            AttributeValue::Int(value) => c::exr_attr_set_int(raw, 0, key, *value),
            AttributeValue::Float(value) => c::exr_attr_set_float(raw, 0, key, *value),
            AttributeValue::Double(value) => c::exr_attr_set_double(raw, 0, key, *value),
            AttributeValue::String(value) => {
                let value = CString::new(value.as_str()).map_err(|_| {
                    Error::Invalid(format!("the text of attribute {name:?} has a zero byte"))
                })?;
                c::exr_attr_set_string(raw, 0, key, value.as_ptr())
            }
            AttributeValue::Chromaticities(value) => {
                c::exr_attr_set_chromaticities(raw, 0, key, &from_chromaticities(value))
            }
        }
    };
    context.check(code)
}

/// Number of chunks, and of rows in each but the last.
fn chunks(context: &Context) -> Result<(i32, i32), Error> {
    let (mut count, mut rows) = (0, 0);
    // SAFETY: an open context and valid places to write to.
    unsafe {
        context.check(c::exr_get_chunk_count(context.raw(), 0, &mut count))?;
        context.check(c::exr_get_scanlines_per_chunk(context.raw(), 0, &mut rows))?;
    }
    Ok((count, rows))
}

/// Encodes all chunks from the top down and makes sure that there are as many as the header says:
/// the library closes a file without complaint when some are missing.
fn write_chunks(
    context: &Context,
    layout: &Layout,
    channels: &[ChannelFormat],
    names: &[CString],
    mut fill: impl FnMut(usize, Range<usize>, &mut [f32]),
) -> Result<WriteReport, Error> {
    let (chunk_count, chunk_rows) = chunks(context)?;
    let width = layout.data_window.width() as usize;
    let rows = usize::try_from(chunk_rows).unwrap_or(0).max(1);
    let mut report = WriteReport::default();
    let mut floats: Vec<Vec<f32>> = vec![Vec::new(); channels.len()];
    let mut halves: Vec<Vec<u16>> = vec![Vec::new(); channels.len()];
    let mut written = 0;
    for first_row in (0..layout.data_window.height() as usize).step_by(rows) {
        let end_row = (first_row + rows).min(layout.data_window.height() as usize);
        let mut planes = Vec::with_capacity(channels.len());
        let buffers = floats.iter_mut().zip(&mut halves);
        for (index, (samples, halves)) in buffers.enumerate() {
            let (channel, name) = (&channels[index], &names[index]);
            samples.resize((end_row - first_row) * width, 0.0);
            fill(index, first_row..end_row, samples);
            let pointer = match channel.precision {
                Precision::Float => samples.as_mut_ptr().cast(),
                Precision::Half => {
                    report.clamped += to_halves(samples, halves);
                    halves.as_mut_ptr().cast()
                }
            };
            planes.push(c::openexr_shim_plane {
                name: name.as_ptr(),
                samples: pointer,
                width: width as i32,
                height: (end_row - first_row) as i32,
                type_: type_code(channel.precision),
            });
        }
        let y = layout.data_window.min[1] + first_row as i32;
        // SAFETY: an open context; each plane has `width` × `height` samples of its type, alive
        // until the end of this turn, and encoding only reads them.
        context.check(unsafe {
            c::openexr_shim_encode_scanlines(context.raw(), y, planes.as_ptr(), planes.len() as i32)
        })?;
        written += 1;
    }
    if written != chunk_count {
        return Err(Error::Broken(format!(
            "{written} of {chunk_count} chunks were written"
        )));
    }
    Ok(report)
}

/// Rounds samples to half precision, to nearest, ties to even; returns how many were limited.
fn to_halves(samples: &[f32], halves: &mut Vec<u16>) -> u64 {
    let limit = f16::MAX.to_f32();
    let mut clamped = 0;
    halves.clear();
    halves.extend(samples.iter().map(|&sample| {
        let is_outside = sample.is_finite() && sample.abs() > limit;
        clamped += u64::from(is_outside);
        let sample = if is_outside {
            limit.copysign(sample)
        } else {
            sample
        };
        f16::from_f32(sample).to_bits()
    }));
    clamped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_saturate_but_keep_infinity_and_nan() {
        let samples = [
            1.0,
            -70000.0,
            65504.0,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            1e-9,
        ];
        let mut halves = Vec::new();
        assert_eq!(to_halves(&samples, &mut halves), 1);
        let values: Vec<f32> = halves
            .iter()
            .map(|&bits| f16::from_bits(bits).to_f32())
            .collect();
        assert_eq!(
            values[..5],
            [1.0, -65504.0, 65504.0, f32::INFINITY, f32::NEG_INFINITY]
        );
        assert!(values[5].is_nan());
        assert_eq!(values[6], 0.0);
    }
}
