//! Textures in memory.

use std::fmt;

use half::f16;

use super::srgb::srgb_decode;
use crate::math::Rgb;

/// Stored values of a [`Bitmap`], rows from the top down, the channels of a texel side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Codes 0 to 255 for 0 to 1.
    U8(Vec<u8>),
    /// Codes 0 to 65535 for 0 to 1.
    U16(Vec<u16>),
    /// Half precision.
    Half(Vec<f16>),
    /// Single precision.
    Float(Vec<f32>),
}

impl Texels {
    fn len(&self) -> usize {
        match self {
            Self::U8(codes) => codes.len(),
            Self::U16(codes) => codes.len(),
            Self::Half(values) => values.len(),
            Self::Float(values) => values.len(),
        }
    }
}

/// How a stored value becomes a linear one. Alpha is always stored linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// The stored value is linear.
    Linear,
    /// Encoded for an sRGB display.
    Srgb,
    /// The linear value is the stored one to the power of this number, positive; values below 0
    /// become 0.
    Gamma(f32),
}

impl Transfer {
    /// The linear value of a stored one; stored codes are first mapped to 0 to 1.
    pub fn decode(self, stored: f32) -> f32 {
        match self {
            Self::Linear => stored,
            Self::Srgb => srgb_decode(stored),
            Self::Gamma(gamma) => f64::from(stored).max(0.0).powf(f64::from(gamma)) as f32,
        }
    }
}

/// A texture: grey (1 channel), RGB (3) or RGB and alpha (4), in the storage of its file.
///
/// Each lookup decodes one value, for 8 and 16 bits through a table.
#[derive(Clone)]
pub struct Bitmap {
    width: u32,
    height: u32,
    channels: u32,
    texels: Texels,
    transfer: Transfer,
    /// Linear value of every code; empty unless the texels are codes.
    table: Vec<f32>,
}

impl Bitmap {
    /// Makes a texture. Codes are taken as sRGB-encoded and floating point as linear, as in files;
    /// see [`with_transfer`](Self::with_transfer).
    ///
    /// - `width`, `height`: in texels, at least 1.
    /// - `channels`: 1, 3 or 4.
    /// - `texels`: `width` × `height` × `channels` values.
    ///
    /// Returns `None` when these numbers contradict each other.
    pub fn new(width: u32, height: u32, channels: u32, texels: Texels) -> Option<Self> {
        let count = u64::from(width)
            .checked_mul(u64::from(height))?
            .checked_mul(channels.into())?;
        if count == 0 || !matches!(channels, 1 | 3 | 4) || count != texels.len() as u64 {
            return None;
        }
        let transfer = match texels {
            Texels::U8(_) | Texels::U16(_) => Transfer::Srgb,
            Texels::Half(_) | Texels::Float(_) => Transfer::Linear,
        };
        let table = Vec::new();
        Some(
            Self {
                width,
                height,
                channels,
                texels,
                transfer,
                table,
            }
            .with_transfer(transfer),
        )
    }

    /// The same texels, understood in another way: a normal map in a PNG is linear, say.
    pub fn with_transfer(self, transfer: Transfer) -> Self {
        let last_code: u16 = match self.texels {
            Texels::U8(_) => u8::MAX.into(),
            Texels::U16(_) => u16::MAX,
            Texels::Half(_) | Texels::Float(_) => {
                return Self {
                    transfer,
                    table: Vec::new(),
                    ..self
                };
            }
        };
        let decode = |code| transfer.decode(f32::from(code) / f32::from(last_code));
        Self {
            transfer,
            table: (0..=last_code).map(decode).collect(),
            ..self
        }
    }

    /// The same with zero in place of negative values; `None` where there are none.
    pub fn without_negatives(&self) -> Option<Self> {
        let texels = match &self.texels {
            Texels::Half(values) if values.iter().any(|v| *v < f16::ZERO) => {
                Texels::Half(values.iter().map(|v| v.max(f16::ZERO)).collect())
            }
            Texels::Float(values) if values.iter().any(|v| *v < 0.0) => {
                Texels::Float(values.iter().map(|v| v.max(0.0)).collect())
            }
            _ => return None,
        };
        Some(Self {
            texels,
            ..self.clone()
        })
    }

    /// Columns of texels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of texels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// 1 (grey), 3 (RGB) or 4 (RGB and alpha).
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// Memory that it takes, in bytes.
    pub fn memory(&self) -> u64 {
        let texels = match &self.texels {
            Texels::U8(codes) => size_of_val(codes.as_slice()),
            Texels::U16(codes) => size_of_val(codes.as_slice()),
            Texels::Half(values) => size_of_val(values.as_slice()),
            Texels::Float(values) => size_of_val(values.as_slice()),
        };
        (texels + size_of_val(self.table.as_slice())) as u64
    }

    /// The stored values.
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// True when the stored values are taken as encoded for an sRGB display.
    pub fn is_srgb_encoded(&self) -> bool {
        self.transfer == Transfer::Srgb
    }

    /// The linear value of one channel of one texel.
    ///
    /// - `x`, `y`: column and row, below width and height; row 0 is the top.
    /// - `channel`: below [`channels`](Self::channels); 3 is alpha.
    ///
    /// # Panics
    /// When the texel lies beyond the last one.
    #[inline]
    pub fn value(&self, x: u32, y: u32, channel: u32) -> f32 {
        debug_assert!(
            x < self.width && y < self.height && channel < self.channels,
            "a lookup lies inside the bitmap"
        );
        let texel = y as usize * self.width as usize + x as usize;
        let index = texel * self.channels as usize + channel as usize;
        let is_alpha = channel == 3;
        match &self.texels {
            Texels::U8(codes) if is_alpha => f32::from(codes[index]) / f32::from(u8::MAX),
            Texels::U8(codes) => self.table[usize::from(codes[index])],
            Texels::U16(codes) if is_alpha => f32::from(codes[index]) / f32::from(u16::MAX),
            Texels::U16(codes) => self.table[usize::from(codes[index])],
            Texels::Half(values) => self.decode_float(values[index].to_f32(), is_alpha),
            Texels::Float(values) => self.decode_float(values[index], is_alpha),
        }
    }

    #[inline]
    fn decode_float(&self, stored: f32, is_alpha: bool) -> f32 {
        if is_alpha {
            stored
        } else {
            self.transfer.decode(stored)
        }
    }

    /// The linear colour of a texel; a grey one has three equal channels.
    ///
    /// - `x`, `y`: as for [`value`](Self::value), which says when it panics.
    #[inline]
    pub fn rgb(&self, x: u32, y: u32) -> Rgb {
        if self.channels == 1 {
            Rgb::grey(self.value(x, y, 0))
        } else {
            Rgb::new(
                self.value(x, y, 0),
                self.value(x, y, 1),
                self.value(x, y, 2),
            )
        }
    }

    /// The alpha of a texel: 0 is transparent, 1 opaque, and 1 where the file has none.
    ///
    /// - `x`, `y`: as for [`value`](Self::value), which says when it panics.
    #[inline]
    pub fn alpha(&self, x: u32, y: u32) -> f32 {
        if self.channels == 4 {
            self.value(x, y, 3)
        } else {
            1.0
        }
    }
}

impl fmt::Debug for Bitmap {
    /// Without the texels, of which there are millions.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("Bitmap")
            .field("width", &self.width)
            .field("height", &self.height)
            .field("channels", &self.channels)
            .field("transfer", &self.transfer)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_decoded_through_the_transfer() {
        let bitmap =
            Bitmap::new(2, 1, 4, Texels::U8(vec![0, 128, 255, 128, 10, 20, 30, 0])).unwrap();
        assert!(bitmap.is_srgb_encoded());
        assert_eq!(
            bitmap.rgb(0, 0),
            Rgb::new(0.0, srgb_decode(128.0 / 255.0), 1.0)
        );
        assert_eq!(bitmap.alpha(0, 0), 128.0 / 255.0);
        assert_eq!(bitmap.alpha(1, 0), 0.0);
        let linear = bitmap.clone().with_transfer(Transfer::Linear);
        assert!(!linear.is_srgb_encoded());
        assert_eq!(linear.value(1, 0, 1), 20.0 / 255.0);
        let squared = bitmap.with_transfer(Transfer::Gamma(2.0));
        assert!((squared.value(1, 0, 2) - (30.0_f32 / 255.0).powi(2)).abs() < 1e-7);
        assert_eq!(squared.alpha(0, 0), 128.0 / 255.0);
    }

    #[test]
    fn every_storage_gives_the_same_colour() {
        let grey = [0.25, 0.5, 1.0, 0.0];
        let storages = [
            Texels::U16(vec![16384, 32768, 65535, 0]),
            Texels::Half(grey.map(f16::from_f32).to_vec()),
            Texels::Float(grey.to_vec()),
        ];
        for texels in storages {
            let bitmap = Bitmap::new(2, 2, 1, texels)
                .unwrap()
                .with_transfer(Transfer::Linear);
            for (index, expected) in grey.iter().enumerate() {
                let colour = bitmap.rgb(index as u32 % 2, index as u32 / 2);
                assert!((colour.r() - expected).abs() < 1e-5, "{bitmap:?}");
                assert_eq!(colour, Rgb::grey(colour.r()));
            }
            assert_eq!(bitmap.alpha(1, 1), 1.0);
        }
    }

    #[test]
    fn floats_may_be_encoded() {
        let bitmap = Bitmap::new(1, 1, 3, Texels::Float(vec![0.5, -1.0, 4.0])).unwrap();
        assert_eq!(bitmap.rgb(0, 0), Rgb::new(0.5, -1.0, 4.0));
        let encoded = bitmap.with_transfer(Transfer::Srgb);
        assert_eq!(encoded.value(0, 0, 0), srgb_decode(0.5));
        assert_eq!(
            encoded.with_transfer(Transfer::Gamma(2.0)).value(0, 0, 1),
            0.0
        );
    }

    #[test]
    fn contradictions_are_refused() {
        assert!(Bitmap::new(2, 2, 3, Texels::U8(vec![0; 11])).is_none());
        assert!(Bitmap::new(2, 2, 2, Texels::U8(vec![0; 8])).is_none());
        assert!(Bitmap::new(0, 2, 1, Texels::U8(Vec::new())).is_none());
        assert!(Bitmap::new(u32::MAX, u32::MAX, 4, Texels::U8(Vec::new())).is_none());
    }
}
