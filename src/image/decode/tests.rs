//! Tiny files of every format, made here and read back.

use std::fs;
use std::path::PathBuf;

use ::image::{DynamicImage, ImageBuffer, ImageFormat};
use tempfile::TempDir;

use super::*;
use crate::image::{ExrOptions, Image, Precision, srgb_decode, write_exr};
use crate::math::Rgb;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn save(&self, name: &str, image: impl Into<DynamicImage>, format: ImageFormat) -> PathBuf {
        let path = self.path(name);
        image.into().save_with_format(&path, format).unwrap();
        path
    }
}

/// 3 × 2 pixels whose red, green and blue all differ.
fn rgb8() -> ::image::RgbImage {
    ImageBuffer::from_fn(3, 2, |x, y| {
        ::image::Rgb([10 + x as u8, 100 + y as u8, 255])
    })
}

fn decoded(code: u8) -> f32 {
    srgb_decode(f32::from(code) / 255.0)
}

#[test]
fn lossless_8_bit_formats_keep_their_bytes() {
    let folder = Folder::new();
    for (name, format) in [
        ("a.png", ImageFormat::Png),
        ("a.bmp", ImageFormat::Bmp),
        ("a.tga", ImageFormat::Tga),
    ] {
        let bitmap = read_bitmap(&folder.save(name, rgb8(), format)).unwrap();
        assert_eq!(
            (bitmap.width(), bitmap.height(), bitmap.channels()),
            (3, 2, 3),
            "{name}"
        );
        assert_eq!(*bitmap.texels(), Texels::U8(rgb8().into_raw()), "{name}");
        assert!(bitmap.is_srgb_encoded());
        assert_eq!(
            bitmap.rgb(2, 1),
            Rgb::new(decoded(12), decoded(101), 1.0),
            "{name}"
        );
        assert_eq!(bitmap.alpha(2, 1), 1.0);
    }
}

#[test]
fn grey_alpha_and_16_bits_are_kept() {
    let folder = Folder::new();
    let grey = ::image::GrayImage::from_pixel(2, 2, ::image::Luma([77]));
    let bitmap = read_bitmap(&folder.save("grey.png", grey, ImageFormat::Png)).unwrap();
    assert_eq!(*bitmap.texels(), Texels::U8(vec![77; 4]));

    let grey_alpha = ::image::GrayAlphaImage::from_pixel(1, 1, ::image::LumaA([77, 5]));
    let bitmap = read_bitmap(&folder.save("ga.png", grey_alpha, ImageFormat::Png)).unwrap();
    assert_eq!(*bitmap.texels(), Texels::U8(vec![77, 77, 77, 5]));
    assert_eq!(bitmap.alpha(0, 0), 5.0 / 255.0);

    let deep = ImageBuffer::from_pixel(1, 1, ::image::Rgb([1_u16, 30000, 65535]));
    let deep = DynamicImage::ImageRgb16(deep);
    let bitmap = read_bitmap(&folder.save("deep.png", deep, ImageFormat::Png)).unwrap();
    assert_eq!(*bitmap.texels(), Texels::U16(vec![1, 30000, 65535]));
    assert!((bitmap.value(0, 0, 1) - srgb_decode(30000.0 / 65535.0)).abs() < 1e-7);
}

/// A 2 × 1 PNG with a palette of two colours, the second half transparent.
#[test]
fn a_palette_becomes_colours() {
    let folder = Folder::new();
    let path = folder.path("palette.png");
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        let body = [kind, data].concat();
        png.extend((data.len() as u32).to_be_bytes());
        png.extend(&body);
        let mut crc = flate2::Crc::new();
        crc.update(&body);
        png.extend(crc.sum().to_be_bytes());
    };
    chunk(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 1, 1, 3, 0, 0, 0]);
    chunk(b"PLTE", &[255, 0, 0, 0, 0, 255]);
    chunk(b"tRNS", &[255, 128]);
    let mut deflate = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    // Filter 0, then the bits 0 and 1.
    std::io::Write::write_all(&mut deflate, &[0, 0b0100_0000]).unwrap();
    chunk(b"IDAT", &deflate.finish().unwrap());
    chunk(b"IEND", &[]);
    fs::write(&path, png).unwrap();
    let bitmap = read_bitmap(&path).unwrap();
    assert_eq!(
        *bitmap.texels(),
        Texels::U8(vec![255, 0, 0, 255, 0, 0, 255, 128])
    );
}

#[test]
fn jpeg_is_close() {
    let folder = Folder::new();
    let flat = ::image::RgbImage::from_pixel(16, 16, ::image::Rgb([200, 50, 90]));
    let bitmap = read_bitmap(&folder.save("a.jpg", flat, ImageFormat::Jpeg)).unwrap();
    let Texels::U8(codes) = bitmap.texels() else {
        panic!("JPEG has 8 bits")
    };
    for (code, expected) in codes.iter().zip([200, 50, 90].iter().cycle()) {
        assert!(code.abs_diff(*expected) <= 3, "{code} {expected}");
    }
}

#[test]
fn radiance_files_are_linear_whatever_their_first_line() {
    let folder = Folder::new();
    for first in ["#?RADIANCE", "#?RGBE"] {
        let path = folder.path("a.hdr");
        let mut file = format!("{first}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n").into_bytes();
        // Mantissas over 256 times two to the exponent less 128.
        file.extend([128, 64, 32, 129, 128, 128, 128, 138]);
        fs::write(&path, file).unwrap();
        let bitmap = read_bitmap(&path).unwrap();
        assert!(!bitmap.is_srgb_encoded());
        assert_eq!(bitmap.rgb(0, 0), Rgb::new(1.0, 0.5, 0.25));
        assert_eq!(bitmap.rgb(1, 0), Rgb::grey(512.0));
    }
}

#[test]
fn exr_channels_become_a_texture() {
    let folder = Folder::new();
    let path = folder.path("a.exr");
    let read = |channels: &[(&str, Precision)]| {
        let mut image = Image::new(2, 1);
        for (index, (name, precision)) in channels.iter().enumerate() {
            image.push(*name, *precision, vec![index as f32 + 0.5, 8.0]);
        }
        let _ = write_exr(&path, &image, &ExrOptions::default()).unwrap();
        read_bitmap(&path)
    };
    let (half, float) = (Precision::Half, Precision::Float);
    let halves = |values: &[f32]| Texels::Half(values.iter().map(|&v| f16::from_f32(v)).collect());

    let bitmap = read(&[("R", half), ("G", half), ("B", half), ("Z", float)]).unwrap();
    assert_eq!(*bitmap.texels(), halves(&[0.5, 1.5, 2.5, 8.0, 8.0, 8.0]));
    assert!(!bitmap.is_srgb_encoded());
    let bitmap = read(&[("A", half), ("R", float), ("G", half), ("B", half)]).unwrap();
    assert_eq!(
        *bitmap.texels(),
        Texels::Float(vec![1.5, 2.5, 3.5, 0.5, 8.0, 8.0, 8.0, 8.0])
    );
    let bitmap = read(&[("Y", half), ("x.R", half), ("x.G", half), ("x.B", half)]).unwrap();
    assert_eq!(
        (bitmap.channels(), bitmap.texels()),
        (1, &halves(&[0.5, 8.0]))
    );
    let bitmap = read(&[("Y", half), ("A", half)]).unwrap();
    assert_eq!((bitmap.channels(), bitmap.alpha(0, 0)), (4, 1.5));
    let layers = [
        ("b.B", half),
        ("b.G", half),
        ("b.R", half),
        ("a.R", half),
        ("b.A", half),
    ];
    let bitmap = read(&layers).unwrap();
    assert_eq!(
        *bitmap.texels(),
        halves(&[2.5, 1.5, 0.5, 4.5, 8.0, 8.0, 8.0, 8.0])
    );

    let error = read(&[("Z", float), ("R", float)]).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("no channels R, G, B or Y among R, Z"),
        "{error}"
    );
    assert!(matches!(
        read(&[("Y", half), ("RY", half)]),
        Err(ImageError::NoColour { .. })
    ));
}

#[test]
fn content_wins_over_the_extension() {
    let folder = Folder::new();
    for name in ["a.jpg", "a.tga", "a.unknown", "noextension"] {
        let bitmap = read_bitmap(&folder.save(name, rgb8(), ImageFormat::Png)).unwrap();
        assert_eq!(*bitmap.texels(), Texels::U8(rgb8().into_raw()), "{name}");
    }
}

#[test]
fn other_files_are_refused_by_name() {
    let folder = Folder::new();
    let path = folder.path("wood.png");
    for content in [&b""[..], b"<html>not found</html>", b"GIF89a and so on"] {
        fs::write(&path, content).unwrap();
        let error = read_bitmap(&path).unwrap_err().to_string();
        let expected = "wood.png: not a PNG, JPEG, BMP, TGA, HDR or EXR image";
        assert!(error.ends_with(expected), "{error}");
    }
    let error = read_bitmap(&folder.path("missing.png")).unwrap_err();
    assert!(
        error.to_string().contains("missing.png: No such file"),
        "{error}"
    );
    assert!(matches!(
        read_bitmap(folder.0.path()),
        Err(ImageError::Read { .. })
    ));
}

#[test]
fn damaged_files_are_errors() {
    let folder = Folder::new();
    let noise = |x: u32, y: u32| ((x * 7919 + y * 104_729) % 251) as u8;
    let image =
        ::image::RgbImage::from_fn(40, 40, |x, y| ::image::Rgb([noise(x, y), 9, noise(y, x)]));
    let float = DynamicImage::ImageRgb8(image.clone()).into_rgb32f();
    let mut paths = vec![folder.save("a.hdr", float, ImageFormat::Hdr)];
    for (name, format) in [
        ("a.png", ImageFormat::Png),
        ("a.bmp", ImageFormat::Bmp),
        ("a.tga", ImageFormat::Tga),
        ("a.jpg", ImageFormat::Jpeg),
    ] {
        paths.push(folder.save(name, image.clone(), format));
    }
    for path in paths {
        let whole = fs::read(&path).unwrap();
        fs::write(&path, &whole[..whole.len() / 2]).unwrap();
        let error = read_bitmap(&path).expect_err("half a file was read");
        assert!(matches!(error, ImageError::Broken { .. }), "{error}");
        for position in (0..whole.len()).step_by(37) {
            let mut damaged = whole.clone();
            damaged[position] ^= 0x55;
            fs::remove_file(&path).unwrap();
            fs::write(&path, &damaged).unwrap();
            // Some damage shows as other pixels only; what counts is that there is no panic.
            let _ = read_bitmap(&path);
        }
    }
}

#[test]
fn a_claim_of_gigabytes_is_refused() {
    let folder = Folder::new();
    let path = folder.save("a.bmp", rgb8(), ImageFormat::Bmp);
    let mut bmp = fs::read(&path).unwrap();
    bmp[18..22].copy_from_slice(&60_000_u32.to_le_bytes());
    bmp[22..26].copy_from_slice(&60_000_u32.to_le_bytes());
    fs::write(&path, bmp).unwrap();
    assert!(matches!(read_bitmap(&path), Err(ImageError::Broken { .. })));
    let path = folder.path("a.hdr");
    fs::write(
        &path,
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n",
    )
    .unwrap();
    assert!(matches!(read_bitmap(&path), Err(ImageError::Broken { .. })));
}

#[test]
fn the_shared_scenes_textures_are_read() {
    let shared = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !shared.is_dir() {
        eprintln!("SKIPPED: {} is not here", shared.display());
        return;
    }
    let mut folders = vec![shared];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
            if path.is_dir() {
                folders.push(path);
            } else if ["png", "jpg", "exr", "hdr", "tga", "bmp"]
                .iter()
                .any(|e| extension == *e)
            {
                let bitmap = read_bitmap(&path).unwrap();
                let corner = bitmap.rgb(bitmap.width() - 1, bitmap.height() - 1);
                assert!(corner.is_finite(), "{}", path.display());
            }
        }
    }
}
