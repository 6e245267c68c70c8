//! From the sums of a render to the channels of a file.

use crate::film::{Accumulator, Layer};
use crate::image::{Image, Precision, Window};
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

/// Makes an image of a render.
///
/// - `film_size`: width and height of the full film, of which the render's window is a part.
///
/// Variance is left out where there were fewer than two replicas.
pub fn picture(rendered: &Rendered, film_size: (u32, u32), choice: LayerChoice) -> Image {
    let window = rendered.window;
    let mut image = Image::new(film_size.0, film_size.1);
    let corner = |low: u32, size: u32| (low as i32, (low + size) as i32 - 1);
    let (left, right) = corner(window.x, window.width);
    let (top, bottom) = corner(window.y, window.height);
    image.data_window = Window {
        min: [left, top],
        max: [right, bottom],
    };
    for ((layer, _), means) in rendered.layers.iter().zip(&rendered.means) {
        let precision = if needs_float(layer) {
            Precision::Float
        } else {
            choice.precision
        };
        push_layer(&mut image, layer, precision, means);
    }
    if choice.variance {
        for (layer, sums) in &rendered.layers {
            if let Some((layer, values)) = variance_layer(layer, sums) {
                push_layer(&mut image, &layer, Precision::Float, &values);
            }
        }
    }
    image
}

/// The variance of a layer's mean, without alpha; `None` where its spread is not kept, and for layers without colour.
fn variance_layer(layer: &Layer, sums: &Accumulator) -> Option<(Layer, Vec<f32>)> {
    let channels = layer.channels.len();
    let values = sums.variance_of_mean().filter(|_| channels >= 3)?;
    let without_alpha = values.chunks_exact(channels).flat_map(|pixel| &pixel[..3]);
    let name = match layer.name.as_str() {
        "" => "variance".to_owned(),
        name => format!("{name}.variance"),
    };
    Some((Layer::new(&name, "RGB"), without_alpha.copied().collect()))
}

fn needs_float(layer: &Layer) -> bool {
    matches!(
        layer.name.as_str(),
        "depth" | "position" | "uv" | "moment2" | "proposals" | "expected_proposals" | "chains"
    )
}

/// Adds a layer whose values stand pixel by pixel.
fn push_layer(image: &mut Image, layer: &Layer, precision: Precision, values: &[f32]) {
    let channels = layer.channels.len();
    for (index, name) in layer.channel_names().enumerate() {
        let data = values.iter().skip(index).step_by(channels).copied();
        image.push(name, precision, data.collect());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{self, Filter, PassBuffer, Unit};
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
        let image = picture(&rendered(), (8, 6), choice);
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
        let image = picture(&rendered(), (8, 6), choice);
        assert!(image.channel("variance.R").is_none());
    }
}
