//! Files as a whole: what was written comes back, and no damage gets further than an error.

mod crafted;
mod damage;
mod roundtrip;

use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use openexr_sys::{Channel, Compression, Error, Layout, Precision, Window, WriteReport, write};

const LOSSLESS: [Compression; 5] = [
    Compression::None,
    Compression::Rle,
    Compression::Zips,
    Compression::Zip,
    Compression::Piz,
];

const CHANNELS: [(&str, Precision); 7] = [
    ("R", Precision::Half),
    ("G", Precision::Half),
    ("B", Precision::Half),
    ("A", Precision::Half),
    ("depth.Z", Precision::Float),
    ("variance.R", Precision::Float),
    ("albedo.R", Precision::Half),
];

fn layout(width: u32, height: u32, compression: Compression) -> Layout {
    Layout {
        data_window: Window::of_size(width, height),
        display_window: Window::of_size(width, height),
        pixel_aspect_ratio: 1.0,
        compression,
        zip_level: 4,
        attributes: BTreeMap::new(),
    }
}

/// Numbers that are exact in half precision, smooth in places and noisy in others.
fn samples(count: usize, channel: usize) -> Vec<f32> {
    let mut state = 0x9e37_79b9_u32.wrapping_mul(channel as u32 + 1);
    let mut value = |index: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        match index % 5 {
            0 => (state >> 22) as f32 / 64.0,
            1 => -((state >> 24) as f32) * 256.0,
            _ => (index / 40) as f32 * 0.125,
        }
    };
    (0..count).map(&mut value).collect()
}

fn seven(count: usize) -> Vec<Vec<f32>> {
    (0..CHANNELS.len())
        .map(|channel| samples(count, channel))
        .collect()
}

fn as_channels(images: &[Vec<f32>]) -> Vec<Channel<'_>> {
    let describe = |(&(name, precision), samples)| Channel {
        name,
        precision,
        samples,
    };
    CHANNELS
        .iter()
        .zip(images)
        .map(|(kind, image)| describe((kind, image.as_slice())))
        .collect()
}

fn write_to(path: &Path, layout: &Layout, channels: &[Channel]) -> Result<WriteReport, Error> {
    write(&File::create(path).unwrap(), layout, channels)
}
