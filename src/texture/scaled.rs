//! A texture, made brighter or darker.

use super::{Texture, TextureModel};
use crate::math::{Rgb, Vec2};

/// A texture times a factor.
///
/// Of a coloured factor, the luminance counts where one number is asked for.
#[derive(Clone, Debug)]
pub struct Scaled {
    nested: Box<Texture>,
    factor: Rgb,
}

impl Scaled {
    /// Makes the texture.
    ///
    /// - `factor`: 0 or more in each channel. Nothing is clamped: reflectances can leave `[0, 1]`.
    pub fn new(nested: impl Into<Texture>, factor: Rgb) -> Self {
        Self {
            nested: Box::new(nested.into()),
            factor,
        }
    }
}

impl TextureModel for Scaled {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        self.nested.colour(uv) * self.factor
    }

    #[inline]
    fn value(&self, uv: Vec2) -> f32 {
        self.nested.value(uv) * self.factor.luminance()
    }

    fn gradient(&self, uv: Vec2) -> Vec2 {
        self.nested.gradient(uv) * self.factor.luminance()
    }

    fn mean(&self) -> Rgb {
        self.nested.mean() * self.factor
    }

    fn is_constant(&self) -> bool {
        self.nested.is_constant()
    }

    fn of_numbers(self) -> Self {
        Self {
            nested: Box::new(self.nested.of_numbers()),
            ..self
        }
    }

    /// The texture and the factor, each by itself.
    fn without_negatives(&self) -> Option<Self> {
        let (nested, factor) = (self.nested.without_negatives(), super::clamped(self.factor));
        let is_clamped = nested.is_some() || factor.is_some();
        is_clamped.then(|| Self {
            nested: nested.map_or_else(|| self.nested.clone(), Box::new),
            factor: factor.unwrap_or(self.factor),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Mat3;
    use crate::texture::Checkerboard;

    #[test]
    fn all_answers_are_scaled() {
        let colours = [Rgb::grey(0.2), Rgb::new(0.4, 0.6, 0.8)];
        let board = Checkerboard::new(colours, Mat3::IDENTITY);
        let factor = Rgb::new(2.0, 1.0, 0.5);
        let scaled = Texture::from(Scaled::new(board, factor));
        for (u, colour) in [(0.2, colours[0]), (0.7, colours[1])] {
            let uv = Vec2::new(u, 0.2);
            assert_eq!(scaled.colour(uv), colour * factor);
            let value = colour.luminance() * factor.luminance();
            assert!((scaled.value(uv) - value).abs() < 1e-6);
        }
        let mean = (colours[0] + colours[1]) * 0.5 * factor;
        assert!((scaled.mean() - mean).0.abs().max_element() < 1e-6);
        assert!(!scaled.is_constant());
        assert!(Texture::from(Scaled::new(0.3, Rgb::BLACK)).is_zero());
    }
}
