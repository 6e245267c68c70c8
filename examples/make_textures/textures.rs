//! The textures of the scenes, as formulas: colours in codes of sRGB over the unit square, y downwards.

use std::f64::consts::{PI, TAU};

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// Red, green and blue, 0 to 255.
type Colour = [f64; 3];

/// A name, and what makes the texture of that name.
type Recipe = (&'static str, fn() -> Texture);

/// All textures.
pub(crate) const ALL: [Recipe; 4] = [
    ("boards", boards),
    ("carpet", carpet),
    ("picture", picture),
    ("wallpaper", wallpaper),
];

/// Pixels in rows from the top.
pub(crate) struct Texture {
    pub(crate) width: usize,
    pub(crate) codes: Vec<u8>,
}

impl Texture {
    fn new([width, height]: [usize; 2], colour: impl Fn(f64, f64) -> Colour) -> Self {
        let places = (0..width * height).map(|i| [i % width, i / width]);
        let colours = places.map(|[x, y]| {
            colour(
                (x as f64 + 0.5) / width as f64,
                (y as f64 + 0.5) / height as f64,
            )
        });
        let codes = colours.flatten().map(|c| c.round() as u8).collect();
        Self { width, codes }
    }

    /// As a PNG file of 8 bits.
    pub(crate) fn to_png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let height = self.codes.len() / (3 * self.width);
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive)
            .write_image(
                &self.codes,
                self.width as u32,
                height as u32,
                ExtendedColorType::Rgb8,
            )
            .expect("pixels that fill the picture");
        bytes
    }
}

fn mix(a: Colour, b: Colour, t: f64) -> Colour {
    let t = t.clamp(0.0, 1.0);
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

/// A number in 0–1 that looks random, the same for the same pair.
fn scatter(i: i64, j: i64) -> f64 {
    let mut x = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x >> 40) as f64 / (1u64 << 24) as f64
}

/// Smooth noise in 0–1 that repeats after `period` cells.
fn noise(x: f64, y: f64, period: [i64; 2]) -> f64 {
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    let at = |di: i64, dj: i64| {
        scatter(
            (i + di).rem_euclid(period[0]),
            (j + dj).rem_euclid(period[1]),
        )
    };
    let [s, t] = [x - x.floor(), y - y.floor()].map(|t| t * t * (3.0 - 2.0 * t));
    let row = |dj| at(0, dj) + (at(1, dj) - at(0, dj)) * s;
    row(0) + (row(1) - row(0)) * t
}

/// Eight boards, each cut in two; it repeats in both directions.
fn boards() -> Texture {
    Texture::new([320, 320], |u, v| {
        let board = (8.0 * u).floor();
        let across = 8.0 * u - board;
        let start = scatter(board as i64, 7);
        let along = (2.0 * v + start).rem_euclid(2.0);
        let piece = (board as i64) * 2 + along.floor() as i64;
        let end = along - along.floor();
        let shift = 13.0 * scatter(piece, 3);
        let bend = noise(4.0 * u, 6.0 * v, [4, 6]);
        let rings = (TAU * (1.6 * across + 2.2 * bend + shift)).sin();
        let fibre = noise(120.0 * u, 10.0 * v, [120, 10]);
        let dark = 0.32 * scatter(piece, 5) + 0.14 * rings + 0.34 * fibre;
        let gap = across.min(1.0 - across).min(14.0 * end.min(1.0 - end));
        let wood = mix(
            [190.0, 134.0, 84.0],
            [104.0, 62.0, 34.0],
            (24.0 * dark).round() / 24.0,
        );
        if gap < 0.035 {
            [52.0, 32.0, 20.0]
        } else {
            wood
        }
    })
}

/// A carpet with a medallion, corners and borders.
fn carpet() -> Texture {
    const RED: Colour = [134.0, 28.0, 30.0];
    const NAVY: Colour = [26.0, 36.0, 76.0];
    const CREAM: Colour = [224.0, 204.0, 164.0];
    const GOLD: Colour = [196.0, 142.0, 58.0];
    Texture::new([384, 256], |u, v| {
        // In units of the short side's half; the corners are alike.
        let (x, y) = ((3.0 * u - 1.5).abs(), (2.0 * v - 1.0).abs());
        let edge = (1.5 - x).min(1.0 - y);
        let flower = |cells: f64| {
            let [a, b] = [x, y].map(|t| (cells * t).rem_euclid(1.0) - 0.5);
            let petals = 0.3 + 0.12 * (4.0 * b.atan2(a)).cos();
            a.hypot(b) / petals
        };
        if edge < 0.03 {
            return NAVY;
        }
        if edge < 0.07 || (0.25..0.28).contains(&edge) {
            return CREAM;
        }
        if edge < 0.25 {
            let f = flower(8.0);
            return if f < 0.45 {
                CREAM
            } else if f < 1.0 {
                GOLD
            } else {
                NAVY
            };
        }
        let (far, angle) = ((0.8 * x).hypot(y), y.atan2(x));
        let star = far / (0.45 + 0.06 * (12.0 * angle).cos());
        let corner =
            (1.22 - x).hypot(0.72 - y) / (0.4 + 0.04 * (10.0 * (0.72 - y).atan2(1.22 - x)).cos());
        match star.min(corner) {
            s if s < 0.35 => GOLD,
            s if s < 0.45 => CREAM,
            s if s < 0.9 && flower(9.0) < 0.8 => GOLD,
            s if s < 0.9 => NAVY,
            s if s < 1.0 => CREAM,
            _ if flower(6.0) < 0.3 => CREAM,
            _ if flower(6.0) < 0.75 => NAVY,
            _ => RED,
        }
    })
}

/// A lake between mountains, in the evening.
fn picture() -> Texture {
    const SHORE: f64 = 0.66;
    let ridge = |u: f64, layer: f64| {
        let wave = |f: f64, p: f64| (TAU * (f * u + p + 0.37 * layer)).sin();
        let peaks = 0.5 * wave(1.1, 0.2)
            + 0.3 * wave(2.7, 0.5)
            + 0.12 * wave(6.1, 0.1)
            + 0.05 * wave(15.0, 0.0);
        0.36 + 0.085 * layer + 0.11 * peaks * (1.0 - 0.2 * layer)
    };
    let land = move |u: f64, v: f64| {
        let sky = mix([58.0, 84.0, 142.0], [250.0, 178.0, 104.0], 1.6 * v);
        let sun = (1.5 * (u - 0.64)).hypot(v - 0.33);
        let glow = mix(sky, [255.0, 226.0, 150.0], (-9.0 * sun).exp());
        let mut colour = if sun < 0.06 {
            [255.0, 244.0, 206.0]
        } else {
            glow
        };
        for layer in 0..4 {
            let depth = f64::from(layer);
            if v > ridge(u, depth) {
                let haze = mix([158.0, 120.0, 142.0], [24.0, 38.0, 46.0], depth / 3.0);
                colour = mix(haze, [214.0, 160.0, 130.0], 0.9 - 2.0 * v + 0.1 * depth);
            }
        }
        colour
    };
    Texture::new([288, 192], move |u, v| {
        if v < SHORE {
            return land(u, v);
        }
        let depth = (v - SHORE) / (1.0 - SHORE);
        let ripple = 0.012 * (1.0 + depth) * (26.0 * PI * depth.sqrt() + 9.0 * u).sin();
        let seen = land(u + ripple, (2.0 * SHORE - v).max(0.0) * 0.98);
        mix(seen, [18.0, 34.0, 60.0], 0.25 + 0.35 * depth)
    })
}

/// Sprigs on stripes; it repeats in both directions.
fn wallpaper() -> Texture {
    Texture::new([128, 192], |u, v| {
        let stripe = mix(
            [178.0, 190.0, 166.0],
            [164.0, 178.0, 152.0],
            if (4.0 * u).rem_euclid(2.0) < 1.0 {
                1.0
            } else {
                0.0
            },
        );
        // Two sprigs a tile, one beside the other and half a tile lower.
        let sprigs = [0.25, 0.75].map(|middle: f64| {
            let x = u - middle;
            let y = (v + middle).rem_euclid(1.0) - 0.5;
            let stem = (x - 0.05 * (TAU * y).sin()).abs() < 0.009 && y.abs() < 0.34;
            let leaf = (0..6).any(|i| {
                let height = -0.2 + 0.1 * f64::from(i);
                let side = if i % 2 == 0 { 1.0 } else { -1.0 };
                let (a, b) = (side * (x - 0.05 * (TAU * height).sin()), height - y);
                let (along, off) = (0.8 * a + 0.6 * b, 0.8 * b - 0.6 * a);
                ((along - 0.07) / 0.062).hypot(off / 0.022) < 1.0
            });
            let (a, b) = (x, 1.5 * (y + 0.37));
            let petals = 0.075 * (1.0 + 0.3 * (5.0 * b.atan2(a)).cos());
            (stem || leaf, a.hypot(b) / petals)
        });
        if sprigs.iter().any(|(_, bloom)| *bloom < 0.35) {
            [226.0, 190.0, 110.0]
        } else if sprigs.iter().any(|(_, bloom)| *bloom < 1.0) {
            [190.0, 104.0, 92.0]
        } else if sprigs.iter().any(|(green, _)| *green) {
            [96.0, 122.0, 92.0]
        } else {
            stripe
        }
    })
}
