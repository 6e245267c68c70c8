//! The film: where estimates land on pixels.
//!
//! Everything lands in 64-bit fixed point, because integer sums do not depend on their order: any
//! number of threads, any sharding and any resume add up to the same bits. The price is a unit that
//! must be known before the first sample (see [`Unit`]).

mod accumulator;
mod buffer;
mod filter;
mod tile;

pub use accumulator::Accumulator;
pub use buffer::{Canvas, PassBuffer, Unit};
pub use filter::{Filter, FilterKind, pixel_of};
pub use tile::Tile;

/// The pixels that are rendered: a window into the full film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Left column, in pixels of the full film.
    pub x: u32,
    /// Top row, in pixels of the full film.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Window {
    /// The most pixels that are rendered at once: 32 bits tell them apart, a filter's border included.
    pub const MOST_PIXELS: u64 = 1 << 30;

    /// The whole of a film.
    pub const fn full(width: u32, height: u32) -> Self {
        Self {
            x: 0,
            y: 0,
            width,
            height,
        }
    }

    /// Whether there are [`Window::MOST_PIXELS`] at most.
    pub const fn is_affordable(&self) -> bool {
        self.width as u64 * self.height as u64 <= Self::MOST_PIXELS
    }

    /// Number of pixels.
    pub const fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Place of a pixel of the full film among those of the window, row by row; `None` outside of it.
    #[inline]
    fn index_of(&self, x: i32, y: i32) -> Option<usize> {
        // Numbers below zero wrap to such as no film has.
        let column = (x as u32).wrapping_sub(self.x);
        let row = (y as u32).wrapping_sub(self.y);
        (column < self.width && row < self.height)
            .then(|| row as usize * self.width as usize + column as usize)
    }
}

/// A named group of channels of the result, such as `albedo.R albedo.G albedo.B`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layer {
    /// Name before the dot; empty for the beauty layer.
    pub name: String,
    /// Names of the channels.
    pub channels: Vec<String>,
}

impl Layer {
    /// Makes a layer whose channels have one letter each.
    pub fn new(name: &str, channels: &str) -> Self {
        Self {
            name: name.to_owned(),
            channels: channels.chars().map(String::from).collect(),
        }
    }

    /// Full names of the channels, as files show them.
    pub fn channel_names(&self) -> impl Iterator<Item = String> + '_ {
        self.channels
            .iter()
            .map(|channel| match self.name.as_str() {
                "" => channel.clone(),
                name => format!("{name}.{channel}"),
            })
    }
}
