//! Pictures of named channels.

use std::collections::BTreeMap;
use std::ops::Range;

use openexr_sys::{AttributeValue, Precision, Window};

/// One channel of an [`Image`].
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name in the file: `R`, or with its layer `albedo.R`.
    pub name: String,
    /// How it is stored in a file.
    pub precision: Precision,
    /// Rows of the data window from the top down, each from the left.
    pub data: Vec<f32>,
}

/// Named channels of one size, with metadata: what an EXR file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The pixels that the channels cover: x to the right, y downwards, corners inside.
    pub data_window: Window,
    /// The frame of the whole picture, of which the data window may be a part.
    pub display_window: Window,
    /// The channels. In a file they are sorted by name; the order here has no meaning.
    pub channels: Vec<Channel>,
    /// Attributes by name, such as `owner` or `imageMean`.
    pub metadata: BTreeMap<String, AttributeValue>,
}

/// A picture whose rows are made when they are asked for: what a file is written from.
pub trait Rows {
    /// The pixels, as [`Image::data_window`].
    fn data_window(&self) -> Window;

    /// The frame, as [`Image::display_window`].
    fn display_window(&self) -> Window;

    /// Names of the channels, and how they are stored.
    fn channels(&self) -> Vec<(&str, Precision)>;

    /// Attributes by name.
    fn metadata(&self) -> &BTreeMap<String, AttributeValue>;

    /// Puts rows of a channel into `samples`, which has the length for it.
    ///
    /// - `channel`: its index in [`Rows::channels`].
    /// - `rows`: of the data window, from the top.
    fn fill(&self, channel: usize, rows: Range<usize>, samples: &mut [f32]);

    /// What makes it unfit for a file.
    fn flaw(&self) -> Option<String> {
        None
    }

    /// The index of the channel with exactly this name.
    fn channel_index(&self, name: &str) -> Option<usize> {
        self.channels().iter().position(|(known, _)| *known == name)
    }
}

impl Rows for Image {
    fn data_window(&self) -> Window {
        self.data_window
    }

    fn display_window(&self) -> Window {
        self.display_window
    }

    fn channels(&self) -> Vec<(&str, Precision)> {
        let channels = self.channels.iter();
        channels
            .map(|channel| (channel.name.as_str(), channel.precision))
            .collect()
    }

    fn metadata(&self) -> &BTreeMap<String, AttributeValue> {
        &self.metadata
    }

    fn fill(&self, channel: usize, rows: Range<usize>, samples: &mut [f32]) {
        let width = self.width() as usize;
        let data = &self.channels[channel].data;
        samples.copy_from_slice(&data[rows.start * width..rows.end * width]);
    }

    fn flaw(&self) -> Option<String> {
        let (width, height) = (self.width(), self.height());
        let pixels = u64::from(width) * u64::from(height);
        let wrong = self.channels.iter();
        let wrong = wrong.map(|channel| (&channel.name, channel.data.len()));
        let mut wrong = wrong.filter(|(_, count)| *count as u64 != pixels);
        let (name, count) = wrong.next()?;
        Some(format!(
            "channel {name} has {count} samples for {width}×{height}"
        ))
    }
}

impl Image {
    /// Makes all rows of a picture.
    pub fn from_rows(rows: &dyn Rows) -> Self {
        let mut image = Self {
            data_window: rows.data_window(),
            display_window: rows.display_window(),
            channels: Vec::new(),
            metadata: rows.metadata().clone(),
        };
        let (width, height) = (image.width() as usize, image.height() as usize);
        for (index, (name, precision)) in rows.channels().into_iter().enumerate() {
            let mut data = vec![0.0; width * height];
            rows.fill(index, 0..height, &mut data);
            image.push(name, precision, data);
        }
        image
    }

    /// An image without channels whose data window is the whole picture.
    ///
    /// - `width`, `height`: in pixels, at least 1.
    pub fn new(width: u32, height: u32) -> Self {
        let window = Window::of_size(width, height);
        Self {
            data_window: window,
            display_window: window,
            channels: Vec::new(),
            metadata: BTreeMap::new(),
        }
    }

    /// Columns of the data window.
    pub fn width(&self) -> u32 {
        self.data_window.width()
    }

    /// Rows of the data window.
    pub fn height(&self) -> u32 {
        self.data_window.height()
    }

    /// The channel with exactly this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// Adds one channel; [`crate::image::write_exr`] checks its size and name.
    pub fn push(&mut self, name: impl Into<String>, precision: Precision, data: Vec<f32>) {
        self.channels.push(Channel {
            name: name.into(),
            precision,
            data,
        });
    }

    /// Adds the three channels of a colour layer: `R`, `G`, `B`, or `albedo.R` and so on.
    ///
    /// - `layer`: empty for the picture itself, otherwise the name of the layer.
    /// - `pixels`: linear Rec.709, rows from the top down.
    pub fn push_rgb(&mut self, layer: &str, precision: Precision, pixels: &[[f32; 3]]) {
        for (index, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let data = pixels.iter().map(|pixel| pixel[index]).collect();
            self.push(channel_name(layer, letter), precision, data);
        }
    }

    /// The pixels of a colour layer, `None` unless all three channels are there.
    ///
    /// - `layer`: empty for the picture itself, otherwise the name of the layer.
    pub fn rgb(&self, layer: &str) -> Option<Vec<[f32; 3]>> {
        let data = |letter| {
            self.channel(&channel_name(layer, letter))
                .map(|channel| &channel.data)
        };
        let (red, green, blue) = (data("R")?, data("G")?, data("B")?);
        Some(
            red.iter()
                .zip(green)
                .zip(blue)
                .map(|((&r, &g), &b)| [r, g, b])
                .collect(),
        )
    }
}

/// The name of a layer's channel.
pub(super) fn channel_name(layer: &str, letter: &str) -> String {
    if layer.is_empty() {
        letter.to_owned()
    } else {
        format!("{layer}.{letter}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_layers_go_in_and_out() {
        let mut image = Image::new(2, 1);
        let beauty = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        let albedo = [[0.1, 0.2, 0.3]; 2];
        image.push_rgb("", Precision::Half, &beauty);
        image.push_rgb("albedo", Precision::Half, &albedo);
        image.push("depth.Z", Precision::Float, vec![7.0, 8.0]);
        assert_eq!(image.rgb("").unwrap(), beauty);
        assert_eq!(image.rgb("albedo").unwrap(), albedo);
        assert_eq!(image.rgb("depth"), None);
        assert_eq!(image.channel("albedo.G").unwrap().data, [0.2, 0.2]);
        assert_eq!((image.width(), image.height()), (2, 1));
    }
}
