//! Two textures, multiplied.

use super::{Texture, TextureModel};
use crate::math::{Rgb, Vec2};

/// One texture times another, channel by channel.
#[derive(Clone, Debug)]
pub struct Product {
    factors: Box<[Texture; 2]>,
}

impl Product {
    /// Makes the texture.
    pub fn new(first: impl Into<Texture>, second: impl Into<Texture>) -> Self {
        Self {
            factors: Box::new([first.into(), second.into()]),
        }
    }
}

impl TextureModel for Product {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        let [a, b] = &*self.factors;
        a.colour(uv) * b.colour(uv)
    }

    #[inline]
    fn value(&self, uv: Vec2) -> f32 {
        let [a, b] = &*self.factors;
        a.value(uv) * b.value(uv)
    }

    fn gradient(&self, uv: Vec2) -> Vec2 {
        let [a, b] = &*self.factors;
        a.gradient(uv) * b.value(uv) + b.gradient(uv) * a.value(uv)
    }

    /// Product of the means, as of textures that have nothing to do with each other.
    fn mean(&self) -> Rgb {
        let [a, b] = &*self.factors;
        a.mean() * b.mean()
    }

    fn is_constant(&self) -> bool {
        self.factors.iter().all(Texture::is_constant)
    }

    fn of_numbers(self) -> Self {
        Self {
            factors: Box::new(self.factors.map(TextureModel::of_numbers)),
        }
    }

    /// Each factor by itself.
    fn without_negatives(&self) -> Option<Self> {
        let [a, b] = &*self.factors;
        let (a_clamped, b_clamped) = (a.without_negatives(), b.without_negatives());
        let is_clamped = a_clamped.is_some() || b_clamped.is_some();
        let or =
            |clamped: Option<Texture>, plain: &Texture| clamped.unwrap_or_else(|| plain.clone());
        is_clamped.then(|| Self::new(or(a_clamped, a), or(b_clamped, b)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Mat3;
    use crate::texture::Checkerboard;

    #[test]
    fn all_answers_are_products() {
        let colours = [Rgb::grey(0.2), Rgb::new(0.4, 0.6, 0.8)];
        let board = Checkerboard::new(colours, Mat3::IDENTITY);
        let factor = Rgb::new(0.5, 1.0, 0.25);
        let product = Texture::from(Product::new(board, factor));
        for (u, colour) in [(0.2, colours[0]), (0.7, colours[1])] {
            let uv = Vec2::new(u, 0.2);
            assert_eq!(product.colour(uv), colour * factor);
            let value = colour.luminance() * factor.luminance();
            assert!((product.value(uv) - value).abs() < 1e-6);
        }
        assert!(!product.is_constant());
        assert!(Texture::from(Product::new(0.5, 0.25)).is_constant());
    }
}
