//! One colour everywhere.

use super::TextureModel;
use crate::math::{Rgb, Vec2};

/// A texture with one colour everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    colour: Rgb,
}

impl Constant {
    /// Makes the texture.
    pub const fn new(colour: Rgb) -> Self {
        Self { colour }
    }
}

impl TextureModel for Constant {
    #[inline]
    fn colour(&self, _uv: Vec2) -> Rgb {
        self.colour
    }

    fn gradient(&self, _uv: Vec2) -> Vec2 {
        Vec2::ZERO
    }

    fn mean(&self) -> Rgb {
        self.colour
    }

    fn is_constant(&self) -> bool {
        true
    }

    fn without_negatives(&self) -> Option<Self> {
        super::clamped(self.colour).map(Self::new)
    }
}
