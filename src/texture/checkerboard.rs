//! Squares of two textures.

use super::{MeshSurface, Texture, TextureModel};
use crate::math::{Mat3, Rgb, Vec2};

/// Two by two squares in the unit square, repeated.
///
/// Where the squares show textures, each is looked up at the same coordinates as the board, before the
/// board's own `to_uv` transform: as windows onto it, not as pictures in each square. So does Mitsuba
/// 3.9.1.
#[derive(Clone, Debug)]
pub struct Checkerboard {
    fields: Box<[Texture; 2]>,
    to_uv: Mat3,
    /// Where a point's texture coordinates are found, when its place on a mesh is asked with.
    surface: Option<MeshSurface>,
    /// Whether numbers are those of the other squares.
    swaps_numbers: bool,
}

impl Checkerboard {
    /// Makes the texture.
    ///
    /// - `fields`: the squares that touch the origin at (+, +) and (−, −), and the others.
    /// - `to_uv`: what surface coordinates are multiplied by before the lookup; affine.
    pub fn new(fields: [impl Into<Texture>; 2], to_uv: Mat3) -> Self {
        Self {
            fields: Box::new(fields.map(Into::into)),
            to_uv,
            surface: None,
            swaps_numbers: false,
        }
    }

    /// The same board at the texture coordinates of a mesh whose points tell where on it they lie.
    ///
    /// The textures in the squares are asked with the places as they are.
    pub fn on_mesh(self, surface: MeshSurface) -> Self {
        Self {
            surface: Some(surface),
            ..self
        }
    }

    /// The same board, where a number is asked for that of the other field: Mitsuba 3.9.1 has it so.
    pub fn with_numbers_swapped(self) -> Self {
        Self {
            swaps_numbers: true,
            ..self
        }
    }

    /// What is shown at a point; with `swaps`, what the other squares show there.
    #[inline]
    fn field(&self, uv: Vec2, swaps: bool) -> &Texture {
        let uv = self.surface.as_ref().map_or(uv, |mesh| mesh.uv_at(uv));
        let place = self.to_uv.transform_point2(uv);
        let place = place - place.floor();
        &self.fields[usize::from(((place.x < 0.5) != (place.y < 0.5)) != swaps)]
    }
}

impl TextureModel for Checkerboard {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        self.field(uv, false).colour(uv)
    }

    #[inline]
    fn value(&self, uv: Vec2) -> f32 {
        self.field(uv, self.swaps_numbers).value(uv)
    }

    /// Of the texture in the square; the jump to the next square has none.
    fn gradient(&self, uv: Vec2) -> Vec2 {
        self.field(uv, self.swaps_numbers).gradient(uv)
    }

    /// Half of each mean, as of textures that are the same in all squares.
    fn mean(&self) -> Rgb {
        let [a, b] = &*self.fields;
        (a.mean() + b.mean()) * 0.5
    }

    fn of_numbers(self) -> Self {
        let [a, b] = self.fields.map(TextureModel::of_numbers);
        Self {
            fields: Box::new(if self.swaps_numbers { [b, a] } else { [a, b] }),
            swaps_numbers: false,
            ..self
        }
    }

    fn without_negatives(&self) -> Option<Self> {
        let clamped = self.fields.each_ref().map(Texture::without_negatives);
        clamped.iter().any(Option::is_some).then(|| {
            let [a, b] = [0, 1].map(|i| {
                let field = clamped[i].as_ref();
                field.unwrap_or(&self.fields[i]).clone()
            });
            Self {
                fields: Box::new([a, b]),
                ..self.clone()
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::image::{self, Texels};
    use crate::texture::{Bitmap, Filter, Wrap};

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
        let swapped = board.clone().with_numbers_swapped();
        assert!((at(&swapped, 0.1, 0.1) - 0.9).abs() < 1e-6);
        let uv = Vec2::splat(0.1);
        assert_eq!(swapped.colour(uv), colours[0]);
        assert_eq!(swapped.of_numbers().colour(uv), colours[1]);
        assert_eq!(board.of_numbers().colour(uv), colours[0]);
    }

    /// Four texels, smooth between.
    fn picture(to_uv: Mat3) -> Bitmap {
        let texels = vec![0.1, 0.2, 0.4, 0.8];
        let image = image::Bitmap::new(2, 2, 1, Texels::Float(texels)).unwrap();
        Bitmap::new(Arc::new(image), Filter::Bilinear, Wrap::Repeat, to_uv)
    }

    /// Points that lie on no edge of the boards here.
    fn points() -> impl Iterator<Item = Vec2> {
        (0..400).map(|i| Vec2::new((i % 20) as f32, (i / 20) as f32) * 0.1 - 0.98)
    }

    #[test]
    fn squares_are_windows_onto_textures() {
        let zoomed = Mat3::from_scale(Vec2::new(3.0, 1.5));
        let grey = Rgb::new(0.3, 0.2, 0.1);
        let fields: [Texture; 2] = [picture(zoomed).into(), grey.into()];
        let board = Checkerboard::new(fields, Mat3::from_scale(Vec2::splat(2.0)));
        let swapped = board.clone().with_numbers_swapped();
        let mut seen = [0, 0];
        for uv in points() {
            // Squares with sides of a quarter.
            let square = (uv * 4.0).floor();
            let is_first = (square.x + square.y).rem_euclid(2.0) == 0.0;
            seen[usize::from(is_first)] += 1;
            let (shown, other) = (picture(zoomed), Texture::from(grey));
            let [first, second] = [
                (shown.colour(uv), shown.value(uv), shown.gradient(uv)),
                (other.colour(uv), other.value(uv), Vec2::ZERO),
            ];
            let (own, others) = if is_first {
                (first, second)
            } else {
                (second, first)
            };
            let answers = |b: &Checkerboard| (b.colour(uv), b.value(uv), b.gradient(uv));
            assert_eq!(answers(&board), own, "at {uv}");
            assert_eq!(answers(&swapped), (own.0, others.1, others.2), "at {uv}");
        }
        assert!(seen.into_iter().all(|count| count > 100), "{seen:?}");
    }

    /// A picture on a board of itself is the picture; so is a board on a board.
    #[test]
    fn a_board_of_one_texture_is_that_texture() {
        let plain = picture(Mat3::IDENTITY);
        let board = Checkerboard::new([plain.clone(), plain.clone()], Mat3::IDENTITY);
        let nested = Checkerboard::new([board.clone(), board], Mat3::from_angle(0.3));
        for uv in points() {
            assert_eq!(nested.colour(uv), plain.colour(uv));
            assert_eq!(nested.gradient(uv), plain.gradient(uv));
        }
        assert!((nested.mean().g() - 0.375).abs() < 1e-6);
    }

    #[test]
    fn numbers_are_swapped_at_every_level() {
        let [a, b, c] = [0.1, 0.5, 0.9].map(Rgb::grey);
        let scale = Mat3::from_scale(Vec2::splat(2.0));
        let inner = Checkerboard::new([a, b], scale).with_numbers_swapped();
        let fields: [Texture; 2] = [inner.into(), c.into()];
        let board = Checkerboard::new(fields, Mat3::IDENTITY).with_numbers_swapped();
        let numbers = board.clone().of_numbers();
        let mut found = std::collections::BTreeSet::new();
        for uv in points() {
            let number = board.value(uv);
            found.insert((number * 10.0).round() as u32);
            assert!((numbers.colour(uv).g() - number).abs() < 1e-6);
            assert!((numbers.value(uv) - number).abs() < 1e-6);
        }
        assert_eq!(found.into_iter().collect::<Vec<_>>(), [1, 5, 9]);
    }

    #[test]
    fn negatives_are_clamped_in_each_square() {
        let below = Rgb::new(-1.0, 0.5, 2.0);
        let board = Checkerboard::new([Rgb::WHITE, below], Mat3::IDENTITY);
        let clamped = board.without_negatives().expect("a negative number");
        assert_eq!(clamped.colour(Vec2::new(0.6, 0.1)), Rgb::new(0.0, 0.5, 2.0));
        assert_eq!(clamped.colour(Vec2::splat(0.1)), Rgb::WHITE);
        assert!(clamped.without_negatives().is_none());
    }
}
