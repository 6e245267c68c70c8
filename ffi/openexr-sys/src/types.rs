//! The plain values in an EXR header.

use crate::bindings as c;

/// A rectangle of pixels in the file's coordinates: x to the right, y downwards, both corners inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Left column and top row.
    pub min: [i32; 2],
    /// Right column and bottom row, themselves part of the window.
    pub max: [i32; 2],
}

impl Window {
    /// The window of an image of `width` × `height` pixels whose top left pixel is (0, 0).
    ///
    /// Sizes above `i32::MAX` give a window that [`crate::write()`] refuses.
    pub fn of_size(width: u32, height: u32) -> Self {
        let last = |size: u32| i32::try_from(i64::from(size) - 1).unwrap_or(i32::MIN);
        Self {
            min: [0, 0],
            max: [last(width), last(height)],
        }
    }

    /// Columns; 0 when the corners are the wrong way round.
    pub fn width(&self) -> u32 {
        Self::size(self.min[0], self.max[0])
    }

    /// Rows; 0 when the corners are the wrong way round.
    pub fn height(&self) -> u32 {
        Self::size(self.min[1], self.max[1])
    }

    fn size(min: i32, max: i32) -> u32 {
        u32::try_from(i64::from(max) - i64::from(min) + 1).unwrap_or(0)
    }

    pub(crate) fn to_shim(self) -> c::openexr_shim_window {
        c::openexr_shim_window {
            left: self.min[0],
            top: self.min[1],
            right: self.max[0],
            bottom: self.max[1],
        }
    }

    pub(crate) fn from_shim(window: c::openexr_shim_window) -> Self {
        Self {
            min: [window.left, window.top],
            max: [window.right, window.bottom],
        }
    }
}

/// How a channel that we write is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 16-bit floating point: 11 bits of precision, magnitudes up to 65504.
    Half,
    /// 32-bit floating point.
    Float,
}

/// How the samples of a file are packed. `Pxr24` (float channels), `B44` (half channels) and `Dwaa`
/// lose precision; the others do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Compression {
    /// As they are.
    None,
    /// Runs of equal bytes.
    Rle,
    /// Deflate, one row at a time.
    Zips,
    /// Deflate, 16 rows at a time.
    Zip,
    /// Wavelets and Huffman coding, 32 rows at a time; good for grainy images.
    Piz,
    /// Floats rounded to 24 bits, then deflate.
    Pxr24,
    /// Half channels in blocks of 4 × 4 at a fixed rate.
    B44,
    /// Lossy cosine transform. `OpenEXRCore` 3.1 does not have it: [`crate::write()`] says so.
    Dwaa,
}

impl Compression {
    /// Every compression that can be asked for.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Rle,
        Self::Zips,
        Self::Zip,
        Self::Piz,
        Self::Pxr24,
        Self::B44,
        Self::Dwaa,
    ];

    pub(crate) fn to_code(self) -> c::exr_compression_t {
        match self {
            Self::None => c::EXR_COMPRESSION_NONE,
            Self::Rle => c::EXR_COMPRESSION_RLE,
            Self::Zips => c::EXR_COMPRESSION_ZIPS,
            Self::Zip => c::EXR_COMPRESSION_ZIP,
            Self::Piz => c::EXR_COMPRESSION_PIZ,
            Self::Pxr24 => c::EXR_COMPRESSION_PXR24,
            Self::B44 => c::EXR_COMPRESSION_B44,
            Self::Dwaa => c::EXR_COMPRESSION_DWAA,
        }
    }

    pub(crate) fn from_code(code: c::exr_compression_t) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|compression| compression.to_code() == code)
    }
}

/// CIE x, y of the primaries and of white that RGB channels refer to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    /// Red primary.
    pub red: [f32; 2],
    /// Green primary.
    pub green: [f32; 2],
    /// Blue primary.
    pub blue: [f32; 2],
    /// White point.
    pub white: [f32; 2],
}

impl Chromaticities {
    /// Rec. ITU-R BT.709 with white D65, which sRGB shares.
    pub const REC709: Self = Self {
        red: [0.64, 0.33],
        green: [0.30, 0.60],
        blue: [0.15, 0.06],
        white: [0.3127, 0.3290],
    };
}

/// The value of a named attribute in the header.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue {
    /// 32-bit integer.
    Int(i32),
    /// 32-bit floating point.
    Float(f32),
    /// 64-bit floating point.
    Double(f64),
    /// Text; bytes in a file that are not UTF-8 are read as U+FFFD.
    String(String),
    /// Primaries and white point.
    Chromaticities(Chromaticities),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_counts_both_corners() {
        let window = Window::of_size(7, 3);
        assert_eq!((window.min, window.max), ([0, 0], [6, 2]));
        assert_eq!((window.width(), window.height()), (7, 3));
        assert_eq!(
            Window {
                min: [i32::MIN; 2],
                max: [i32::MAX; 2]
            }
            .width(),
            0
        );
        assert_eq!(
            Window {
                min: [1, 1],
                max: [0, -5]
            }
            .height(),
            0
        );
        assert_eq!(Window::of_size(0, 1).width(), 0);
        assert_eq!(Window::of_size(u32::MAX, 1).width(), 0);
    }
}
