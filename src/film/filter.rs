//! Reconstruction filters.

use std::ops::RangeInclusive;

use crate::math::Vec2;

/// Shape of a reconstruction filter, with its parameters; lengths are in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FilterKind {
    /// One over the pixel.
    Box {
        /// Half the width; 0.5 covers one pixel.
        radius: f32,
    },
    /// Falls linearly from the centre.
    Tent {
        /// Half the width.
        radius: f32,
    },
    /// A Gaussian, cut at four standard deviations and lowered to end at zero.
    Gaussian {
        /// Standard deviation.
        stddev: f32,
    },
    /// The two-parameter cubic of Mitchell & Netravali, radius 2.
    Mitchell {
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
    /// The interpolating cubic, radius 2: Mitchell with `b = 0`, `c = 0.5`.
    CatmullRom,
    /// A sinc in a sinc window.
    Lanczos {
        /// Number of lobes on each side, which is the radius, too.
        lobes: f32,
    },
}

impl FilterKind {
    /// Half the width of the filter, in pixels.
    pub fn radius(self) -> f32 {
        match self {
            Self::Box { radius } | Self::Tent { radius } => radius,
            Self::Gaussian { stddev } => 4.0 * stddev,
            Self::Mitchell { .. } | Self::CatmullRom => 2.0,
            Self::Lanczos { lobes } => lobes,
        }
    }

    /// Name in scene files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Tent { .. } => "tent",
            Self::Gaussian { .. } => "gaussian",
            Self::Mitchell { .. } => "mitchell",
            Self::CatmullRom => "catmullrom",
            Self::Lanczos { .. } => "lanczos",
        }
    }

    /// Value at `x` pixels from the centre, up to a constant factor; zero outside of the radius.
    fn shape(self, x: f32) -> f32 {
        self.shape_above(self.edge(), x)
    }

    /// What is taken off a shape that does not end at zero.
    fn edge(self) -> f32 {
        match self {
            Self::Gaussian { stddev } => {
                let alpha = -0.5 / (stddev * stddev);
                (alpha * self.radius() * self.radius()).exp()
            }
            _ => 0.0,
        }
    }

    /// [`FilterKind::shape`], given [`FilterKind::edge`].
    #[inline]
    fn shape_above(self, edge: f32, x: f32) -> f32 {
        let x = x.abs();
        if x > self.radius() {
            return 0.0;
        }
        match self {
            Self::Box { .. } => 1.0,
            Self::Tent { radius } => 1.0 - x / radius,
            Self::Gaussian { stddev } => {
                let alpha = -0.5 / (stddev * stddev);
                ((alpha * x * x).exp() - edge).max(0.0)
            }
            Self::Mitchell { b, c } => cubic(x, b, c),
            Self::CatmullRom => cubic(x, 0.0, 0.5),
            Self::Lanczos { lobes } => sinc(x) * sinc(x / lobes),
        }
    }
}

/// The piecewise cubic of radius 2.
///
/// Source: Mitchell & Netravali 1988, Eq. 8.
fn cubic(x: f32, b: f32, c: f32) -> f32 {
    let (x2, x3) = (x * x, x * x * x);
    let value = if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)
    } else {
        (-b - 6.0 * c) * x3
            + (6.0 * b + 30.0 * c) * x2
            + (-12.0 * b - 48.0 * c) * x
            + (8.0 * b + 24.0 * c)
    };
    value / 6.0
}

/// `sin(πx) / (πx)`.
fn sinc(x: f32) -> f32 {
    let a = std::f32::consts::PI * x;
    if a < 1e-4 { 1.0 } else { a.sin() / a }
}

/// A separable reconstruction filter whose integral is one.
///
/// A sample counts for every pixel within the radius with the weight of its distance, over the sum
/// of its weights for all pixels: no light is lost, and a flat picture stays flat, as for the kinds
/// whose shifted copies add up to one by themselves. A pixel's weights are *not* divided by their
/// sum over its samples, which would bias it. Filters too narrow to reach a pixel from everywhere
/// keep their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    kind: FilterKind,
    radius: f32,
    /// [`FilterKind::edge`].
    edge: f32,
    normalisation: f32,
    /// Whether the weights of each sample are made to add up to one.
    even: bool,
    /// Whether each sample counts for its own pixel alone, with weight one.
    is_pixel_box: bool,
}

/// Largest radius of a filter, in pixels.
const LARGEST_RADIUS: f32 = 64.0;

/// How many pixels it reaches along an axis, at most.
const MOST_PIXELS: usize = 2 * LARGEST_RADIUS as usize + 1;

impl Filter {
    /// Makes the filter; `None` when a parameter leaves nothing to weigh with.
    pub fn new(kind: FilterKind) -> Option<Self> {
        let radius = kind.radius();
        if !(radius.is_finite() && radius > 0.0 && radius <= LARGEST_RADIUS) {
            return None;
        }
        // Midpoints: the kinks of all kinds lie on cell edges of a grid of this fineness.
        let cells = 65_536;
        let step = 2.0 * f64::from(radius) / f64::from(cells);
        let integral: f64 = (0..cells)
            .map(|i| (f64::from(i) + 0.5) * step - f64::from(radius))
            .map(|x| f64::from(kind.shape(x as f32)) * step)
            .sum();
        (integral > 1e-6).then(|| {
            let normalisation = (1.0 / integral) as f32;
            let plain = Self {
                kind,
                radius,
                edge: kind.edge(),
                normalisation,
                even: false,
                is_pixel_box: kind == FilterKind::Box { radius: 0.5 },
            };
            let sum = |place| plain.weights::<MOST_PIXELS>(place).1.sum();
            let even = (0..256).all(|i| sum(i as f32 / 256.0) > 0.5);
            Self { even, ..plain }
        })
    }

    /// The filter that averages over one pixel.
    pub fn pixel_box() -> Self {
        Self {
            kind: FilterKind::Box { radius: 0.5 },
            radius: 0.5,
            edge: 0.0,
            normalisation: 1.0,
            even: true,
            is_pixel_box: true,
        }
    }

    /// Shape and parameters.
    pub fn kind(&self) -> FilterKind {
        self.kind
    }

    /// True for the filter that keeps each sample in its own pixel.
    #[inline]
    pub fn is_pixel_box(&self) -> bool {
        self.is_pixel_box
    }

    /// How many pixels beyond the film's edge hold samples that count for the film.
    pub fn border(&self) -> u32 {
        (self.radius - 0.5).ceil().max(0.0) as u32
    }

    /// Weight along one axis at `x` pixels from the centre of a pixel.
    #[inline]
    pub fn weight(&self, x: f32) -> f32 {
        self.kind.shape_above(self.edge, x) * self.normalisation
    }

    /// Calls `add(x, y, weight)` for every pixel that a sample at `raster` counts for.
    ///
    /// Pixel `(x, y)` covers `[x, x + 1) × [y, y + 1)`; coordinates can lie outside of the film.
    #[inline]
    pub fn for_each_pixel(&self, raster: Vec2, mut add: impl FnMut(i32, i32, f32)) {
        if self.is_pixel_box() {
            let (x, y) = pixel_of(raster);
            return add(x, y, 1.0);
        }
        // Most filters reach seven pixels at most.
        if self.radius <= 3.0 {
            self.spread::<7>(raster, add);
        } else {
            self.spread::<MOST_PIXELS>(raster, add);
        }
    }

    /// [`Filter::for_each_pixel`] for a filter that reaches no more than `MOST` pixels along an axis.
    #[inline]
    fn spread<const MOST: usize>(&self, raster: Vec2, mut add: impl FnMut(i32, i32, f32)) {
        let (first_x, along_x) = self.weights::<MOST>(raster.x);
        let (first_y, along_y) = self.weights::<MOST>(raster.y);
        let scale = if self.even {
            1.0 / (along_x.sum() * along_y.sum())
        } else {
            1.0
        };
        for (y, weight_y) in (first_y..).zip(along_y.iter()) {
            let along_y = scale * weight_y;
            for (x, weight_x) in (first_x..).zip(along_x.iter()) {
                add(x, y, along_y * weight_x);
            }
        }
    }

    /// The first pixel, along one axis, that a sample at `place` counts for, and the weights from there on.
    #[inline]
    fn weights<const MOST: usize>(&self, place: f32) -> (i32, Weights<MOST>) {
        let pixels = self.reach(place);
        let mut weights = Weights {
            values: [0.0; MOST],
            count: 0,
        };
        for (value, pixel) in weights.values.iter_mut().zip(pixels.clone()) {
            *value = self.weight(pixel as f32 + 0.5 - place);
            weights.count += 1;
        }
        (*pixels.start(), weights)
    }

    /// The pixels, along one axis, that a sample at `place` counts for.
    #[inline]
    fn reach(&self, place: f32) -> RangeInclusive<i32> {
        let first = (place - self.radius - 0.5).ceil() as i32;
        let last = (place + self.radius - 0.5).floor() as i32;
        first..=last
    }
}

/// Weights of pixels along an axis.
struct Weights<const MOST: usize> {
    values: [f32; MOST],
    count: usize,
}

impl<const MOST: usize> Weights<MOST> {
    #[inline]
    fn iter(&self) -> impl Iterator<Item = f32> {
        self.values[..self.count].iter().copied()
    }

    #[inline]
    fn sum(&self) -> f32 {
        self.iter().sum()
    }
}

/// The pixel that a raster position lies in.
#[inline]
pub fn pixel_of(raster: Vec2) -> (i32, i32) {
    // The base instructions of x86-64 cannot round down: `floor` would be a call.
    let floor = |place: f32| {
        let whole = place as i32;
        whole.saturating_sub(i32::from(whole as f32 > place))
    };
    (floor(raster.x), floor(raster.y))
}

#[cfg(test)]
mod tests;
