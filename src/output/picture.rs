//! From the sums of a render to the channels of a file.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::film::{Accumulator, Layer};
use crate::image::{AttributeValue, Precision, Rows, Window};
use crate::integrator::Rendered;

/// Which layers a file has, and how they are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerChoice {
    /// How colours and directions are stored; lengths, coordinates, variances and moments are
    /// always floats, because half floats have too few digits and too small a range for them.
    pub precision: Precision,
    /// Whether to add the variance of the image's mean, where it is known.
    pub variance: bool,
}

/// The picture of a render: rows are made of its sums when they are asked for, so that writing holds a
/// few rows beside them.
#[derive(Debug)]
pub struct Picture<'r> {
    rendered: &'r Rendered,
    data_window: Window,
    display_window: Window,
    channels: Vec<Source>,
    /// Attributes of the file.
    pub metadata: BTreeMap<String, AttributeValue>,
}

/// What a channel shows.
#[derive(Debug)]
struct Source {
    name: String,
    precision: Precision,
    /// Index of the layer, and of the channel in it.
    layer: usize,
    channel: usize,
    /// The variance of the mean, rather than the mean.
    is_variance: bool,
}

impl<'r> Picture<'r> {
    /// Shows a render.
    ///
    /// - `film_size`: width and height of the full film, of which the render's window is a part.
    ///
    /// Variance is left out where there were fewer than two replicas.
    pub fn new(rendered: &'r Rendered, film_size: (u32, u32), choice: LayerChoice) -> Self {
        let window = rendered.window;
        let corner = |low: u32, size: u32| (low as i32, (low + size) as i32 - 1);
        let (left, right) = corner(window.x, window.width);
        let (top, bottom) = corner(window.y, window.height);
        let layers = rendered.layers.iter().enumerate();
        let means = layers.clone().flat_map(|(index, (layer, _))| {
            let precision = if needs_float(layer) {
                Precision::Float
            } else {
                choice.precision
            };
            sources(index, layer, precision, false)
        });
        let mut channels: Vec<Source> = means.collect();
        for (index, (layer, sums)) in layers.filter(|_| choice.variance) {
            if let Some(layer) = variance_layer(layer, sums) {
                channels.extend(sources(index, &layer, Precision::Float, true));
            }
        }
        Self {
            rendered,
            data_window: Window {
                min: [left, top],
                max: [right, bottom],
            },
            display_window: Window::of_size(film_size.0, film_size.1),
            channels,
            metadata: BTreeMap::new(),
        }
    }
}

impl Rows for Picture<'_> {
    fn data_window(&self) -> Window {
        self.data_window
    }

    fn display_window(&self) -> Window {
        self.display_window
    }

    fn channels(&self) -> Vec<(&str, Precision)> {
        let channels = self.channels.iter();
        channels
            .map(|source| (source.name.as_str(), source.precision))
            .collect()
    }

    fn metadata(&self) -> &BTreeMap<String, AttributeValue> {
        &self.metadata
    }

    fn fill(&self, channel: usize, rows: Range<usize>, samples: &mut [f32]) {
        let source = &self.channels[channel];
        let (layer, sums) = &self.rendered.layers[source.layer];
        let (stride, width) = (layer.channels.len(), self.data_window.width() as usize);
        let values = (rows.start * width..rows.end * width)
            .map(|pixel| pixel * stride + source.channel)
            .zip(samples);
        if source.is_variance {
            values.for_each(|(index, sample)| *sample = sums.variance_of_mean_at(index));
        } else {
            let means = &self.rendered.means[source.layer];
            values.for_each(|(index, sample)| *sample = means[index]);
        }
    }
}

/// The channels of a layer.
fn sources(index: usize, layer: &Layer, precision: Precision, is_variance: bool) -> Vec<Source> {
    let names = layer.channel_names().enumerate();
    let sources = names.map(|(channel, name)| Source {
        name,
        precision,
        layer: index,
        channel,
        is_variance,
    });
    sources.collect()
}

/// The layer of the variance of a layer's mean, without alpha; `None` where its spread is not kept, and for
/// layers without colour.
fn variance_layer(layer: &Layer, sums: &Accumulator) -> Option<Layer> {
    if layer.channels.len() < 3 || !sums.has_variance() {
        return None;
    }
    let name = match layer.name.as_str() {
        "" => "variance".to_owned(),
        name => format!("{name}.variance"),
    };
    Some(Layer::new(&name, "RGB"))
}

fn needs_float(layer: &Layer) -> bool {
    matches!(
        layer.name.as_str(),
        "depth" | "position" | "uv" | "moment2" | "proposals" | "expected_proposals" | "chains"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{self, Canvas, Filter, PassBuffer, Unit};
    use crate::image::Image;
    use crate::integrator::Counters;
    use crate::math::Vec2;

    const WINDOW: film::Window = film::Window {
        x: 1,
        y: 2,
        width: 2,
        height: 1,
    };

    fn layer<const N: usize>(layer: Layer, passes: &[[f32; N]]) -> (Layer, Accumulator) {
        let unit = Unit::for_magnitude(1.0);
        let mut buffer = PassBuffer::new(WINDOW, N, unit);
        let mut sums = Accumulator::new(WINDOW.pixel_count() * N, unit, Some(1));
        for values in passes {
            buffer.add(&Filter::pixel_box(), Vec2::new(2.5, 2.5), *values);
            sums.fold(&mut buffer);
        }
        (layer, sums)
    }

    fn rendered() -> Rendered {
        let layers = vec![
            layer(
                Layer::new("", "RGBA"),
                &[[1.0, 2.0, 3.0, 1.0], [3.0, 2.0, 5.0, 1.0]],
            ),
            layer(Layer::new("depth", "Z"), &[[4.0], [4.0]]),
        ];
        Rendered {
            means: layers.iter().map(|(_, sums)| sums.mean()).collect(),
            layers,
            window: WINDOW,
            passes: 2,
            counters: Counters::default(),
        }
    }

    #[test]
    fn layers_become_channels_inside_of_the_film() {
        let choice = LayerChoice {
            precision: Precision::Half,
            variance: true,
        };
        let rendered = rendered();
        let image = Image::from_rows(&Picture::new(&rendered, (8, 6), choice));
        assert_eq!(image.data_window.min, [1, 2]);
        assert_eq!(image.data_window.max, [2, 2]);
        assert_eq!(image.display_window, Window::of_size(8, 6));
        let data = |name: &str| image.channel(name).unwrap().data.clone();
        assert_eq!(data("R"), [0.0, 2.0]);
        assert_eq!(data("B"), [0.0, 4.0]);
        assert_eq!(data("A"), [0.0, 1.0]);
        assert_eq!(data("depth.Z"), [0.0, 4.0]);
        // Two values: their sample variance over two.
        assert_eq!(data("variance.R"), [0.0, 1.0]);
        assert_eq!(data("variance.G"), [0.0, 0.0]);
        let precision = |name: &str| image.channel(name).unwrap().precision;
        assert_eq!(precision("G"), Precision::Half);
        assert_eq!(precision("depth.Z"), Precision::Float);
        assert_eq!(precision("variance.B"), Precision::Float);
        assert!(image.channel("variance.A").is_none());
    }

    #[test]
    fn variance_is_left_out_where_it_is_not_wanted() {
        let choice = LayerChoice {
            precision: Precision::Float,
            variance: false,
        };
        let rendered = rendered();
        let image = Image::from_rows(&Picture::new(&rendered, (8, 6), choice));
        assert!(image.channel("variance.R").is_none());
    }
}
