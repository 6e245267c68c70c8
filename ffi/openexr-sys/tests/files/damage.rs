//! No damage, and no wrong argument, gets further than an error.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::path::Path;

use openexr_sys::{AttributeValue, Channel, Compression, Error, Layout, Precision, Reader, write};

use crate::crafted::{self, Crafted};
use crate::{LOSSLESS, as_channels, layout, seven, write_to};

/// Reads all channels of a file; the point of many tests is that this returns at all.
fn read_all(path: &Path) -> Result<Vec<Vec<f32>>, Error> {
    let reader = Reader::new(File::open(path)?)?;
    let names: Vec<&str> = reader
        .header()
        .channels
        .iter()
        .map(|channel| channel.name.as_str())
        .collect();
    reader.read_channels(&names)
}

#[test]
fn a_full_disk_is_an_error_of_the_system() {
    let Ok(full) = OpenOptions::new().write(true).open("/dev/full") else {
        eprintln!("SKIPPED: there is no /dev/full here");
        return;
    };
    let images = seven(64 * 64);
    let error = write(
        &full,
        &layout(64, 64, Compression::Zip),
        &as_channels(&images),
    )
    .unwrap_err();
    assert!(matches!(error, Error::Io(_)), "{error:?}");
}

#[test]
fn what_is_no_exr_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.exr");
    for content in [
        &b""[..],
        b"v/1",
        b"PNG or so, but long enough to have a header",
    ] {
        fs::write(&path, content).unwrap();
        assert!(matches!(read_all(&path), Err(Error::NotExr)));
    }
    fs::write(&path, b"\x76\x2f\x31\x01").unwrap();
    assert!(matches!(read_all(&path), Err(Error::Broken(_))));
    assert!(matches!(
        Reader::new(File::open(folder.path()).unwrap()),
        Err(Error::Io(_))
    ));
}

/// Removes before writing: some file systems flush a file that is cut to nothing and filled again.
fn replace(path: &Path, bytes: &[u8]) {
    fs::remove_file(path).unwrap();
    fs::write(path, bytes).unwrap();
}

/// Where to damage a file: densely in the header, sparsely in the samples, and the last byte.
fn damage_positions(length: usize) -> impl Iterator<Item = usize> {
    (0..600)
        .step_by(3)
        .chain((600..length).step_by(89))
        .chain([length - 1])
}

#[test]
fn a_file_that_is_cut_off_is_refused_wherever_it_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.exr");
    let images = seven(9 * 40);
    for compression in LOSSLESS {
        write_to(&path, &layout(9, 40, compression), &as_channels(&images)).unwrap();
        let whole = fs::read(&path).unwrap();
        for length in damage_positions(whole.len()) {
            replace(&path, &whole[..length]);
            let error = read_all(&path).expect_err("half a file was read");
            assert!(!matches!(error, Error::Io(_)), "{error:?}");
        }
    }
}

#[test]
fn flipped_bits_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flipped.exr");
    let images = seven(9 * 40);
    for compression in LOSSLESS {
        write_to(&path, &layout(9, 40, compression), &as_channels(&images)).unwrap();
        let whole = fs::read(&path).unwrap();
        for position in damage_positions(whole.len()) {
            let mut damaged = whole.clone();
            damaged[position] ^= 1 << (position % 8);
            replace(&path, &damaged);
            if let Ok(read) = read_all(&path) {
                assert!(!read.is_empty());
            }
        }
    }
}

#[test]
fn a_header_that_claims_gigabytes_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.exr");
    for compression in [0, 3] {
        let mut file = Crafted::scanlines(&[("Y", 2)], 50_000, 50_000);
        file.compression = compression;
        fs::write(&path, file.bytes()).unwrap();
        let error = read_all(&path).expect_err("10 GB came out of nothing");
        assert!(
            matches!(error, Error::Oversized { .. } | Error::Broken(_)),
            "{error:?}"
        );
    }
}

#[test]
fn subsampled_and_deep_files_are_refused_politely() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.exr");
    let mut file = Crafted::scanlines(&[("RY", 1)], 4, 4);
    file.sampling = 2;
    fs::write(&path, file.bytes()).unwrap();
    let error = read_all(&path).unwrap_err();
    assert!(error.to_string().contains("subsampled (2×2)"), "{error}");

    let mut file = Crafted::scanlines(&[("Z", 2)], 4, 4);
    file.is_deep = true;
    fs::write(&path, file.bytes()).unwrap();
    let error = read_all(&path).unwrap_err();
    assert!(error.to_string().contains("deep"), "{error}");
}

#[test]
fn tiles_and_integers_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tiled.exr");
    let file = Crafted::tiles(&[("Z", 2), ("half", 1), ("id", 0)], 5, 7, (3, 4));
    fs::write(&path, file.bytes()).unwrap();
    let reader = Reader::new(File::open(&path).unwrap()).unwrap();
    assert!(reader.header().is_tiled);
    let read = reader.read_channels(&["id", "Z", "half"]).unwrap();
    for (channel, image) in [2, 0, 1].into_iter().zip(&read) {
        let expected: Vec<f32> = (0..35)
            .map(|i| crafted::value(i % 5, i / 5, channel) as f32)
            .collect();
        assert_eq!(*image, expected, "channel {channel}");
    }
    assert!(matches!(
        reader.read_channels(&["Y"]),
        Err(Error::Invalid(_))
    ));
}

#[test]
fn wrong_arguments_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("refused.exr");
    let data = [0.0; 4];
    let good = Channel {
        name: "Y",
        precision: Precision::Half,
        samples: &data,
    };
    let base = layout(2, 2, Compression::Zip);
    let refuse = |layout: &Layout, channels: &[Channel], expected: &str| {
        let error = write_to(&path, layout, channels).unwrap_err();
        assert!(matches!(error, Error::Invalid(_)), "{error:?}");
        assert!(error.to_string().contains(expected), "{error}");
    };
    refuse(&base, &[], "needs a channel");
    refuse(&base, &[good, good], "two channels");
    refuse(
        &base,
        &[Channel {
            samples: &data[1..],
            ..good
        }],
        "3 samples for 2×2",
    );
    refuse(&base, &[Channel { name: "", ..good }], "cannot be a name");
    refuse(
        &base,
        &[Channel {
            name: "a\0b",
            ..good
        }],
        "cannot be a name",
    );
    refuse(&layout(0, 2, Compression::Zip), &[good], "0×2 pixels");
    refuse(
        &Layout {
            zip_level: 0,
            ..base.clone()
        },
        &[good],
        "zip level",
    );
    refuse(
        &Layout {
            pixel_aspect_ratio: f32::NAN,
            ..base.clone()
        },
        &[good],
        "aspect",
    );
    let with = |name: &str, text: &str| Layout {
        attributes: BTreeMap::from([(name.to_owned(), AttributeValue::String(text.to_owned()))]),
        ..base.clone()
    };
    refuse(&with("dataWindow", "x"), &[good], "belongs to the format");
    refuse(&with("owner", "a\0b"), &[good], "zero byte");
}
