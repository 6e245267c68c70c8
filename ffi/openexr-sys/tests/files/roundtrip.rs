//! What was written comes back, here and in another implementation.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::process::Command;

use openexr_sys::{
    AttributeValue, Channel, Chromaticities, Compression, Error, Precision, Reader, SampleType,
};

use crate::{CHANNELS, LOSSLESS, as_channels, layout, seven, write_to};

fn bits(image: &[f32]) -> Vec<u32> {
    image.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn seven_channels_come_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("seven.exr");
    // One row, less than a chunk, and a last chunk that is not full.
    for (width, height) in [(1, 1), (5, 7), (37, 75)] {
        let images = seven(width * height);
        for compression in LOSSLESS {
            let mut layout = layout(width as u32, height as u32, compression);
            layout.data_window.min = [-3, 11];
            layout.data_window.max = [width as i32 - 4, height as i32 + 10];
            write_to(&path, &layout, &as_channels(&images)).unwrap();
            let reader = Reader::new(File::open(&path).unwrap()).unwrap();
            let header = reader.header();
            assert_eq!(header.compression, Some(compression));
            assert_eq!(header.data_window, layout.data_window);
            assert_eq!(header.display_window, layout.display_window);
            assert!(!header.is_tiled);
            let names = CHANNELS.map(|(name, _)| name);
            let read = reader.read_channels(&names).unwrap();
            for ((name, image), original) in names.iter().zip(&read).zip(&images) {
                assert_eq!(
                    bits(image),
                    bits(original),
                    "{compression:?} {width}×{height} {name}"
                );
            }
            for channel in &header.channels {
                let (_, precision) = CHANNELS
                    .iter()
                    .find(|(name, _)| *name == channel.name)
                    .unwrap();
                let expected = match precision {
                    Precision::Half => SampleType::Half,
                    Precision::Float => SampleType::Float,
                };
                assert_eq!(channel.sample_type, expected);
            }
        }
    }
}

/// A chunk that compresses to exactly its own size must not be taken for one that was not compressed.
///
/// One chunk of noise is as long as another but for a few bytes: among many, some come out even.
#[test]
fn chunks_that_do_not_shrink_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.exr");
    let mut state = 1_u32;
    let mut noise = |channel: &Channel<'_>| {
        state = state.wrapping_mul(0x0019_660d).wrapping_add(0x3c6e_f35f);
        let mixed = (state ^ (state >> 15)).wrapping_mul(0x2c1b_3c6d);
        let mixed = mixed ^ (mixed >> 13);
        match channel.precision {
            // Between 1 and 2: seven bits of the exponent never change.
            Precision::Float => f32::from_bits(0x3f00_0000 | (mixed & 0x00ff_ffff)),
            Precision::Half => 1.0 + (mixed >> 22) as f32 / 1024.0,
        }
    };
    for width in 16..96 {
        let blank = vec![vec![0.0]; CHANNELS.len()];
        let mut images = Vec::new();
        for channel in &as_channels(&blank) {
            let count = width as usize * 16;
            images.push((0..count).map(|_| noise(channel)).collect::<Vec<f32>>());
        }
        for compression in LOSSLESS {
            write_to(
                &path,
                &layout(width, 16, compression),
                &as_channels(&images),
            )
            .unwrap();
            let reader = Reader::new(File::open(&path).unwrap()).unwrap();
            let read = reader.read_channels(&CHANNELS.map(|(name, _)| name));
            for (image, original) in read.unwrap().iter().zip(&images) {
                assert_eq!(
                    bits(image),
                    bits(original),
                    "{compression:?}, width {width}"
                );
            }
        }
    }
}

#[test]
fn lossy_compressions_stay_close_or_say_no() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lossy.exr");
    let (width, height) = (40, 36);
    let images: Vec<Vec<f32>> = (0..7)
        .map(|c| {
            (0..width * height)
                .map(|i| (i / width + c) as f32 * 0.37 + 1.0)
                .collect()
        })
        .collect();
    for compression in [Compression::Pxr24, Compression::B44, Compression::Dwaa] {
        let layout = layout(width as u32, height as u32, compression);
        match write_to(&path, &layout, &as_channels(&images)) {
            Err(Error::Unsupported(message)) => {
                assert_eq!(compression, Compression::Dwaa, "{message}");
                assert!(message.contains("cannot do this"), "{message}");
                continue;
            }
            result => assert_eq!(result.unwrap().clamped, 0),
        }
        let reader = Reader::new(File::open(&path).unwrap()).unwrap();
        let read = reader
            .read_channels(&CHANNELS.map(|(name, _)| name))
            .unwrap();
        for (image, original) in read.iter().zip(&images) {
            for (value, expected) in image.iter().zip(original) {
                assert!(
                    (value / expected - 1.0).abs() < 0.03,
                    "{compression:?} {value} {expected}"
                );
            }
        }
    }
}

#[test]
fn infinities_and_nan_are_kept_and_large_halves_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("extreme.exr");
    let image = [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e9, -1e9, -0.0];
    let channels = [
        Channel {
            name: "half",
            precision: Precision::Half,
            samples: &image,
        },
        Channel {
            name: "float",
            precision: Precision::Float,
            samples: &image,
        },
    ];
    let report = write_to(&path, &layout(3, 2, Compression::Zip), &channels).unwrap();
    assert_eq!(report.clamped, 2);
    let reader = Reader::new(File::open(&path).unwrap()).unwrap();
    let read = reader.read_channels(&["float", "half"]).unwrap();
    assert_eq!(bits(&read[0]), bits(&image));
    assert_eq!(read[1][..2], image[..2]);
    assert!(read[1][2].is_nan());
    assert_eq!(read[1][3..5], [65504.0, -65504.0]);
    assert_eq!(read[1][5].to_bits(), (-0.0_f32).to_bits());
}

#[test]
fn attributes_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("attributes.exr");
    let mut layout = layout(2, 1, Compression::Zips);
    layout.pixel_aspect_ratio = 1.5;
    layout.attributes = BTreeMap::from([
        (
            "owner".to_owned(),
            AttributeValue::String("Ærø, 2 lines\nof text".to_owned()),
        ),
        ("empty".to_owned(), AttributeValue::String(String::new())),
        ("samples".to_owned(), AttributeValue::Int(-7)),
        ("expTime".to_owned(), AttributeValue::Float(0.25)),
        ("imageMean".to_owned(), AttributeValue::Double(1.0 / 3.0)),
        (
            "chromaticities".to_owned(),
            AttributeValue::Chromaticities(Chromaticities::REC709),
        ),
        (format!("long{}", "x".repeat(200)), AttributeValue::Int(1)),
    ]);
    let channels = [Channel {
        name: "Y",
        precision: Precision::Float,
        samples: &[1.0, 2.0],
    }];
    write_to(&path, &layout, &channels).unwrap();
    let reader = Reader::new(File::open(&path).unwrap()).unwrap();
    assert_eq!(reader.header().attributes, layout.attributes);
    assert_eq!(reader.header().pixel_aspect_ratio, 1.5);
    assert_eq!(reader.header().part_count, 1);
}

#[test]
fn the_same_image_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let paths = ["first.exr", "second.exr"].map(|name| folder.path().join(name));
    let images = seven(64 * 33);
    let mut layout = layout(64, 33, Compression::Zip);
    layout
        .attributes
        .insert("note".to_owned(), AttributeValue::String("same".to_owned()));
    for path in &paths {
        write_to(path, &layout, &as_channels(&images)).unwrap();
    }
    let first = fs::read(&paths[0]).unwrap();
    assert_eq!(first, fs::read(&paths[1]).unwrap());
    layout.zip_level = 9;
    write_to(&paths[1], &layout, &as_channels(&images)).unwrap();
    assert_ne!(
        first,
        fs::read(&paths[1]).unwrap(),
        "the zip level has no effect"
    );
}

/// The other implementation at hand: the Python module reads what we wrote.
#[test]
fn python_reads_the_same_samples() {
    let script = "import sys, OpenEXR, numpy
with OpenEXR.File(sys.argv[1], separate_channels=True) as file:
    for name in sorted(file.channels()):
        pixels = file.channels()[name].pixels
        print(name, pixels.dtype, numpy.ascontiguousarray(pixels.astype('f4')).tobytes().hex())";
    let probe = Command::new("python3")
        .args(["-c", "import OpenEXR, numpy"])
        .output();
    if !probe.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: python3 with the modules OpenEXR and numpy is not here");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("python.exr");
    let images = seven(37 * 75);
    for compression in LOSSLESS {
        write_to(&path, &layout(37, 75, compression), &as_channels(&images)).unwrap();
        let output = Command::new("python3")
            .args(["-c", script])
            .arg(&path)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let mut expected: Vec<String> = as_channels(&images)
            .iter()
            .map(|channel| {
                let kind = match channel.precision {
                    Precision::Half => "float16",
                    Precision::Float => "float32",
                };
                let bytes = channel.samples.iter().flat_map(|value| value.to_le_bytes());
                let hex = bytes
                    .map(|byte| format!("{byte:02x}"))
                    .collect::<Vec<_>>()
                    .concat();
                format!("{} {kind} {hex}", channel.name)
            })
            .collect();
        expected.sort();
        let lines: Vec<String> = String::from_utf8(output.stdout)
            .unwrap()
            .lines()
            .map(str::to_owned)
            .collect();
        assert!(
            lines == expected,
            "{compression:?}: Python reads other samples"
        );
    }
}
