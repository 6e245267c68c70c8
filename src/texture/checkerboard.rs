//! Squares of two colours.

use super::TextureModel;
use crate::math::{Mat3, Rgb, Vec2};

/// Two by two squares in the unit square, repeated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkerboard {
    colours: [Rgb; 2],
    to_uv: Mat3,
    /// Whether numbers are those of the other squares.
    swaps_numbers: bool,
}

impl Checkerboard {
    /// Makes the texture.
    ///
    /// - `colours`: of the squares that touch the origin at (+, +) and (−, −), and of the others.
    /// - `to_uv`: what surface coordinates are multiplied by before the lookup; affine.
    pub fn new(colours: [Rgb; 2], to_uv: Mat3) -> Self {
        Self {
            colours,
            to_uv,
            swaps_numbers: false,
        }
    }

    /// The same board, where a number is asked for that of the other colour: Mitsuba 3.9.1 has it so.
    pub fn with_numbers_swapped(self) -> Self {
        Self {
            swaps_numbers: true,
            ..self
        }
    }

    /// The board of the numbers that this one gives, as colours.
    pub fn of_numbers(self) -> Self {
        let [a, b] = self.colours;
        Self {
            colours: if self.swaps_numbers { [b, a] } else { [a, b] },
            swaps_numbers: false,
            ..self
        }
    }

    /// Which of the two colours lies at a point.
    #[inline]
    fn square(&self, uv: Vec2) -> usize {
        let place = self.to_uv.transform_point2(uv);
        let place = place - place.floor();
        usize::from((place.x < 0.5) != (place.y < 0.5))
    }
}

impl TextureModel for Checkerboard {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        self.colours[self.square(uv)]
    }

    #[inline]
    fn value(&self, uv: Vec2) -> f32 {
        let square = self.square(uv) ^ usize::from(self.swaps_numbers);
        self.colours[square].luminance()
    }

    fn gradient(&self, _uv: Vec2) -> Vec2 {
        Vec2::ZERO
    }

    fn mean(&self) -> Rgb {
        (self.colours[0] + self.colours[1]) * 0.5
    }

    fn without_negatives(&self) -> Option<Self> {
        let colours = self.colours.map(super::clamped);
        colours.iter().any(Option::is_some).then(|| {
            let [a, b] = [0, 1].map(|i| colours[i].unwrap_or(self.colours[i]));
            Self {
                colours: [a, b],
                ..*self
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What Mitsuba 3.9.1 returns for colours.
    #[test]
    fn squares_lie_where_mitsuba_has_them() {
        let colours = [Rgb::grey(0.1), Rgb::grey(0.9)];
        let board = Checkerboard::new(colours, Mat3::IDENTITY);
        let at = |board: &Checkerboard, u, v| board.value(Vec2::new(u, v));
        let u = [-0.6, -0.1, 0.1, 0.4, 0.6, 0.9, 1.1];
        let row = [0.1, 0.9, 0.1, 0.1, 0.9, 0.9, 0.1];
        for (u, value) in u.into_iter().zip(row) {
            assert!((at(&board, u, 0.1) - value).abs() < 1e-6);
            assert!((at(&board, u, 1.1) - value).abs() < 1e-6);
            assert!((at(&board, u, 0.6) - (1.0 - value)).abs() < 1e-6);
            assert!((at(&board, u, -0.1) - (1.0 - value)).abs() < 1e-6);
        }
        let fine = Checkerboard::new(colours, Mat3::from_scale(Vec2::splat(2.0)));
        assert!((at(&fine, 0.3, 0.1) - 0.9).abs() < 1e-6);
        assert!((fine.mean().g() - 0.5).abs() < 1e-6);
        let swapped = board.with_numbers_swapped();
        assert!((at(&swapped, 0.1, 0.1) - 0.9).abs() < 1e-6);
        let uv = Vec2::splat(0.1);
        assert_eq!(swapped.colour(uv), colours[0]);
        assert_eq!(swapped.of_numbers().colour(uv), colours[1]);
        assert_eq!(board.of_numbers(), board);
    }
}
