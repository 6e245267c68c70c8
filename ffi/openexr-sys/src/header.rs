//! The header of a file's first part, copied into Rust.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString};

use crate::bindings as c;
use crate::context::{Context, text};
use crate::error::Error;
use crate::types::{AttributeValue, Chromaticities, Compression, Window};

/// Attributes with a field of their own in [`Header`], or which the format keeps for itself.
pub(crate) const RESERVED_ATTRIBUTES: [&str; 13] = [
    "channels",
    "chunkCount",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "name",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
    "version",
];

/// How a channel is stored in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SampleType {
    /// 32-bit unsigned integers.
    Uint,
    /// 16-bit floating point.
    Half,
    /// 32-bit floating point.
    Float,
}

impl SampleType {
    pub(crate) fn bytes(self) -> u64 {
        match self {
            Self::Half => 2,
            Self::Uint | Self::Float => 4,
        }
    }

    pub(crate) fn to_code(self) -> c::exr_pixel_type_t {
        match self {
            Self::Uint => c::EXR_PIXEL_UINT,
            Self::Half => c::EXR_PIXEL_HALF,
            Self::Float => c::EXR_PIXEL_FLOAT,
        }
    }

    fn from_code(code: c::exr_pixel_type_t) -> Option<Self> {
        [Self::Uint, Self::Half, Self::Float]
            .into_iter()
            .find(|kind| kind.to_code() == code)
    }
}

/// One channel of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChannelInfo {
    /// Name such as `R` or `albedo.R`; bytes that are not UTF-8 are shown as U+FFFD.
    pub name: String,
    /// How its samples are stored.
    pub sample_type: SampleType,
    /// One sample every so many columns and rows; (1, 1) unless the channel is subsampled.
    pub sampling: (i32, i32),
}

/// What a file says about its first part.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The channels, sorted by name as the format has them.
    pub channels: Vec<ChannelInfo>,
    /// The pixels that the file holds.
    pub data_window: Window,
    /// The frame that the picture is meant to fill.
    pub display_window: Window,
    /// Width of a pixel over its height.
    pub pixel_aspect_ratio: f32,
    /// How the samples are packed; `None` for a method that [`crate::write()`] does not offer.
    pub compression: Option<Compression>,
    /// True for tiles, false for rows.
    pub is_tiled: bool,
    /// Parts in the file; only the first is described here.
    pub part_count: i32,
    /// All further attributes of a type that [`AttributeValue`] has; others are left out.
    pub attributes: BTreeMap<String, AttributeValue>,
}

/// A header with what reading needs besides.
pub(crate) struct Parsed {
    pub(crate) header: Header,
    /// Exact names, in the order of `header.channels`.
    pub(crate) names: Vec<CString>,
    pub(crate) compression_code: c::exr_compression_t,
}

/// Copies the header of the first part.
pub(crate) fn parse(context: &Context) -> Result<Parsed, Error> {
    let raw = context.raw();
    let mut part_count = 0;
    let mut storage = c::EXR_STORAGE_LAST_TYPE;
    let mut compression_code = 0;
    let mut pixel_aspect_ratio = 1.0;
    let mut data = Window::of_size(0, 0).to_shim();
    let mut display = data;
    // SAFETY: an open context and valid places to write to, here and below.
    unsafe {
        context.check(c::exr_get_count(raw, &mut part_count))?;
        context.check(c::exr_get_storage(raw, 0, &mut storage))?;
        context.check(c::exr_get_compression(raw, 0, &mut compression_code))?;
        context.check(c::exr_get_pixel_aspect_ratio(
            raw,
            0,
            &mut pixel_aspect_ratio,
        ))?;
        context.check(c::openexr_shim_get_windows(raw, &mut data, &mut display))?;
    }
    let is_tiled = match storage {
        c::EXR_STORAGE_SCANLINE => false,
        c::EXR_STORAGE_TILED => true,
        _ => return Err(Error::Unsupported("deep EXR files are not read".to_owned())),
    };
    let (channels, names) = parse_channels(context)?;
    let header = Header {
        channels,
        data_window: Window::from_shim(data),
        display_window: Window::from_shim(display),
        pixel_aspect_ratio,
        compression: Compression::from_code(compression_code),
        is_tiled,
        part_count,
        attributes: parse_attributes(context)?,
    };
    Ok(Parsed {
        header,
        names,
        compression_code,
    })
}

fn parse_channels(context: &Context) -> Result<(Vec<ChannelInfo>, Vec<CString>), Error> {
    let mut list = std::ptr::null();
    // SAFETY: an open context and a valid place to write to.
    context.check(unsafe { c::exr_get_channels(context.raw(), 0, &mut list) })?;
    // SAFETY: on success the list is valid until the context is closed.
    let list = unsafe { &*list };
    let count = usize::try_from(list.num_channels).unwrap_or(0);
    let (mut channels, mut names) = (Vec::new(), Vec::new());
    for index in 0..count {
        // SAFETY: the list has `num_channels` entries, each with a name that ends with zero.
        let (entry, name) = unsafe {
            let entry = &*list.entries.add(index);
            (entry, CStr::from_ptr(entry.name.str_).to_owned())
        };
        let name_text = name.to_string_lossy().into_owned();
        let Some(sample_type) = SampleType::from_code(entry.pixel_type) else {
            return Err(Error::Broken(format!(
                "channel {name_text} has an unknown sample type"
            )));
        };
        let sampling = (entry.x_sampling, entry.y_sampling);
        channels.push(ChannelInfo {
            name: name_text,
            sample_type,
            sampling,
        });
        names.push(name);
    }
    Ok((channels, names))
}

fn parse_attributes(context: &Context) -> Result<BTreeMap<String, AttributeValue>, Error> {
    let mut count = 0;
    // SAFETY: an open context and a valid place to write to.
    context.check(unsafe { c::exr_get_attribute_count(context.raw(), 0, &mut count) })?;
    let mut attributes = BTreeMap::new();
    for index in 0..count {
        let mut attribute = std::ptr::null();
        let order = c::EXR_ATTR_LIST_FILE_ORDER;
        // SAFETY: an open context and a valid place to write to; on success the attribute and its
        // name are valid until the context is closed.
        let (name, kind) = unsafe {
            context.check(c::exr_get_attribute_by_index(
                context.raw(),
                0,
                order,
                index,
                &mut attribute,
            ))?;
            (CStr::from_ptr((*attribute).name), (*attribute).type_)
        };
        let key = name.to_string_lossy().into_owned();
        if RESERVED_ATTRIBUTES.contains(&key.as_str()) {
            continue;
        }
        if let Some(value) = parse_value(context, name, kind)? {
            attributes.insert(key, value);
        }
    }
    Ok(attributes)
}

/// The value of a named attribute; `None` for a type that [`AttributeValue`] does not have.
fn parse_value(
    context: &Context,
    name: &CStr,
    kind: c::exr_attribute_type_t,
) -> Result<Option<AttributeValue>, Error> {
    let (raw, name) = (context.raw(), name.as_ptr());
    // SAFETY: an open context, a string that ends with zero, and valid places to write to. The text
    // of a string attribute is copied while the context is open.
    let value = unsafe {
        match kind {
            c::EXR_ATTR_INT => {
                let mut value = 0;
                context.check(c::exr_attr_get_int(raw, 0, name, &mut value))?;
                AttributeValue::Int(value)
            }
            c::EXR_ATTR_FLOAT => {
                let mut value = 0.0;
                context.check(c::exr_attr_get_float(raw, 0, name, &mut value))?;
                AttributeValue::Float(value)
            }
            c::EXR_ATTR_DOUBLE => {
                let mut value = 0.0;
                context.check(c::exr_attr_get_double(raw, 0, name, &mut value))?;
                AttributeValue::Double(value)
            }
            c::EXR_ATTR_STRING => {
                let (mut length, mut value) = (0, std::ptr::null());
                context.check(c::exr_attr_get_string(
                    raw,
                    0,
                    name,
                    &mut length,
                    &mut value,
                ))?;
                AttributeValue::String(text(value))
            }
            c::EXR_ATTR_CHROMATICITIES => {
                let mut value = from_chromaticities(&Chromaticities::REC709);
                context.check(c::exr_attr_get_chromaticities(raw, 0, name, &mut value))?;
                AttributeValue::Chromaticities(to_chromaticities(&value))
            }
            _ => return Ok(None),
        }
    };
    Ok(Some(value))
}

/// The library's form of chromaticities.
pub(crate) fn from_chromaticities(value: &Chromaticities) -> c::exr_attr_chromaticities_t {
    c::exr_attr_chromaticities_t {
        red_x: value.red[0],
        red_y: value.red[1],
        green_x: value.green[0],
        green_y: value.green[1],
        blue_x: value.blue[0],
        blue_y: value.blue[1],
        white_x: value.white[0],
        white_y: value.white[1],
    }
}

fn to_chromaticities(value: &c::exr_attr_chromaticities_t) -> Chromaticities {
    Chromaticities {
        red: [value.red_x, value.red_y],
        green: [value.green_x, value.green_y],
        blue: [value.blue_x, value.blue_y],
        white: [value.white_x, value.white_y],
    }
}
