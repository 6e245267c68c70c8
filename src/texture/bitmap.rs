//! A picture on a surface.

use std::sync::Arc;

use super::TextureModel;
use crate::image;
use crate::math::{Mat3, Rgb, Vec2};

/// What lies between texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The value of the texel that holds the point.
    Nearest,
    /// Linear in u and in v between the four nearest texel centres.
    Bilinear,
}

/// What lies beyond the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The picture again.
    Repeat,
    /// The picture again, every other time mirrored.
    Mirror,
    /// The texels of the border.
    Clamp,
    /// Zero.
    Zero,
    /// One.
    One,
}

/// Where a lookup ends up on one axis.
enum Texel {
    Inside(u32),
    Outside,
}

impl Wrap {
    /// The texel of `0..size` that stands at `index`.
    #[inline]
    fn texel(self, index: i64, size: u32) -> Texel {
        let end = i64::from(size);
        let wrapped = match self {
            Self::Repeat => index.rem_euclid(end),
            Self::Mirror => {
                let place = index.rem_euclid(2 * end);
                place.min(2 * end - 1 - place)
            }
            Self::Clamp => index.clamp(0, end - 1),
            Self::Zero | Self::One if (0..end).contains(&index) => index,
            Self::Zero | Self::One => return Texel::Outside,
        };
        Texel::Inside(wrapped as u32)
    }
}

/// A bitmap texture; clones share the picture.
///
/// `v` grows downwards: the picture's first row lies at v = 0. Texel centres lie at half integers.
#[derive(Clone, Debug)]
pub struct Bitmap {
    image: Arc<image::Bitmap>,
    filter: Filter,
    wrap: Wrap,
    to_uv: Mat3,
}

impl Bitmap {
    /// Makes the texture.
    ///
    /// - `image`: the decoded picture, its transfer function set; alpha is ignored.
    /// - `to_uv`: what surface coordinates are multiplied by before the lookup; affine.
    pub fn new(image: Arc<image::Bitmap>, filter: Filter, wrap: Wrap, to_uv: Mat3) -> Self {
        Self {
            image,
            filter,
            wrap,
            to_uv,
        }
    }

    /// Width and height in texels.
    #[inline]
    pub fn size(&self) -> Vec2 {
        Vec2::new(self.image.width() as f32, self.image.height() as f32)
    }

    /// One texel, wherever it lies; `texel` reads one of the picture, `outside` stands beyond the
    /// border.
    #[inline]
    fn read<T>(
        &self,
        (x, y): (i64, i64),
        outside: impl Fn(f32) -> T,
        texel: impl Fn(u32, u32) -> T,
    ) -> T {
        let column = self.wrap.texel(x, self.image.width());
        match (column, self.wrap.texel(y, self.image.height())) {
            (Texel::Inside(x), Texel::Inside(y)) => texel(x, y),
            _ => outside(if self.wrap == Wrap::One { 1.0 } else { 0.0 }),
        }
    }

    /// The picture filtered at a point; `outside` and `texel` as for [`Bitmap::read`].
    #[inline]
    fn lookup<T>(&self, uv: Vec2, outside: impl Fn(f32) -> T, texel: impl Fn(u32, u32) -> T) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        let place = self.to_uv.transform_point2(uv) * self.size();
        let read = |x: i64, y: i64| self.read((x, y), &outside, &texel);
        match self.filter {
            Filter::Nearest => read(place.x.floor() as i64, place.y.floor() as i64),
            Filter::Bilinear => {
                let place = place - 0.5;
                let corner = place.floor();
                let f = place - corner;
                let (x, y) = (corner.x as i64, corner.y as i64);
                let above = read(x, y) * (1.0 - f.x) + read(x + 1, y) * f.x;
                let below = read(x, y + 1) * (1.0 - f.x) + read(x + 1, y + 1) * f.x;
                above * (1.0 - f.y) + below * f.y
            }
        }
    }

    /// The number that [`TextureModel::value`] interpolates.
    #[inline]
    fn texel_value(&self, x: u32, y: u32) -> f32 {
        if self.image.channels() == 1 {
            self.image.value(x, y, 0)
        } else {
            self.image.rgb(x, y).luminance()
        }
    }
}

impl TextureModel for Bitmap {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        self.lookup(uv, Rgb::grey, |x, y| self.image.rgb(x, y))
    }

    #[inline]
    fn value(&self, uv: Vec2) -> f32 {
        if self.image.channels() == 1 {
            self.lookup(uv, |v| v, |x, y| self.image.value(x, y, 0))
        } else {
            self.colour(uv).luminance()
        }
    }

    /// Of the bilinear surface between four texels, whose slope jumps from one four to the next.
    fn gradient(&self, uv: Vec2) -> Vec2 {
        if self.filter == Filter::Nearest {
            return Vec2::ZERO;
        }
        let size = self.size();
        let place = self.to_uv.transform_point2(uv) * size - 0.5;
        let corner = place.floor();
        let f = place - corner;
        let (x, y) = (corner.x as i64, corner.y as i64);
        let read = |x, y| self.read((x, y), |v| v, |x, y| self.texel_value(x, y));
        let [a, b] = [read(x, y), read(x + 1, y)];
        let [c, d] = [read(x, y + 1), read(x + 1, y + 1)];
        let across = (b - a) * (1.0 - f.y) + (d - c) * f.y;
        let down = (c - a) * (1.0 - f.x) + (d - b) * f.x;
        // By the chain rule: rows of the map of coordinates, weighted by the slopes along them.
        let slopes = Vec2::new(across, down) * size;
        let by = |axis: glam::Vec3| axis.truncate().dot(slopes);
        Vec2::new(by(self.to_uv.x_axis), by(self.to_uv.y_axis))
    }

    fn without_negatives(&self) -> Option<Self> {
        let image = Arc::new(self.image.without_negatives()?);
        Some(Self {
            image,
            ..self.clone()
        })
    }

    /// Mean over all texels; where `to_uv` shows another part of the picture, over 64 × 64 lookups.
    fn mean(&self) -> Rgb {
        const GRID: u32 = 64;
        let mut sum = glam::DVec3::ZERO;
        let mut add = |colour: Rgb| sum += colour.0.as_dvec3();
        let (width, height) = if self.to_uv == Mat3::IDENTITY {
            let (width, height) = (self.image.width(), self.image.height());
            for y in 0..height {
                (0..width).for_each(|x| add(self.image.rgb(x, y)));
            }
            (width, height)
        } else {
            for i in 0..GRID * GRID {
                let place = Vec2::new((i % GRID) as f32, (i / GRID) as f32) + 0.5;
                add(self.colour(place / GRID as f32));
            }
            (GRID, GRID)
        };
        Rgb((sum / (f64::from(width) * f64::from(height))).as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Texels;

    /// Texels .1 .2 over .4 .8.
    fn image() -> Arc<image::Bitmap> {
        let grey = [0.1, 0.2, 0.4, 0.8];
        let texels = grey.into_iter().flat_map(|v| [v, v, v]).collect();
        Arc::new(image::Bitmap::new(2, 2, 3, Texels::Float(texels)).unwrap())
    }

    fn check(texture: &Bitmap, lookups: &[([f32; 2], f32)]) {
        for (uv, expected) in lookups {
            let found = texture.colour(Vec2::from_array(*uv)).r();
            assert!(
                (found - expected).abs() < 1e-5,
                "{found} at {uv:?} of {texture:?}"
            );
            assert!((texture.value(Vec2::from_array(*uv)) - expected).abs() < 1e-5);
        }
    }

    fn along_u(values: &[(f32, f32)]) -> Vec<([f32; 2], f32)> {
        values.iter().map(|(u, v)| ([*u, 0.25], *v)).collect()
    }

    /// What Mitsuba 3.9.1 returns for the same picture.
    #[test]
    fn lookups_are_those_of_mitsuba() {
        use Filter::{Bilinear, Nearest};
        let texture = |filter, wrap| Bitmap::new(image(), filter, wrap, Mat3::IDENTITY);
        let centres = [
            ([0.25, 0.25], 0.1),
            ([0.75, 0.25], 0.2),
            ([0.25, 0.75], 0.4),
            ([0.75, 0.75], 0.8),
        ];
        check(&texture(Nearest, Wrap::Repeat), &centres);
        check(&texture(Bilinear, Wrap::Repeat), &centres);
        check(&texture(Bilinear, Wrap::Clamp), &[([0.5, 0.5], 0.375)]);
        let u = [-0.9, -0.25, -0.1, 0.0, 0.4, 1.0, 1.1, 1.75];
        let rows: [(Filter, Wrap, [f32; 8]); 5] = [
            (
                Nearest,
                Wrap::Repeat,
                [0.1, 0.2, 0.2, 0.1, 0.1, 0.1, 0.1, 0.2],
            ),
            (
                Nearest,
                Wrap::Mirror,
                [0.2, 0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0.1],
            ),
            (
                Bilinear,
                Wrap::Repeat,
                [0.13, 0.2, 0.17, 0.15, 0.13, 0.15, 0.13, 0.2],
            ),
            (
                Bilinear,
                Wrap::Mirror,
                [0.2, 0.1, 0.1, 0.1, 0.13, 0.2, 0.2, 0.1],
            ),
            (
                Bilinear,
                Wrap::Clamp,
                [0.1, 0.1, 0.1, 0.1, 0.13, 0.2, 0.2, 0.2],
            ),
        ];
        for (filter, wrap, values) in rows {
            let lookups: Vec<_> = u.into_iter().zip(values).collect();
            check(&texture(filter, wrap), &along_u(&lookups));
        }
    }

    #[test]
    fn zero_and_one_stand_beyond_the_border() {
        let texture = |wrap| Bitmap::new(image(), Filter::Bilinear, wrap, Mat3::IDENTITY);
        let inside = [(0.25, 0.1), (0.75, 0.2)];
        check(&texture(Wrap::Zero), &along_u(&inside));
        check(
            &texture(Wrap::Zero),
            &along_u(&[(0.0, 0.05), (-0.5, 0.0), (7.0, 0.0)]),
        );
        check(
            &texture(Wrap::One),
            &along_u(&[(0.0, 0.55), (-0.5, 1.0), (1e9, 1.0)]),
        );
    }

    /// As Mitsuba 3.9.1 has it: coordinates are transformed, not the picture.
    #[test]
    fn to_uv_moves_the_coordinates() {
        let texture = |to_uv| Bitmap::new(image(), Filter::Nearest, Wrap::Repeat, to_uv);
        let shifted = texture(Mat3::from_translation(Vec2::new(0.5, 0.0)));
        check(&shifted, &[([0.25, 0.25], 0.2), ([0.75, 0.75], 0.4)]);
        let halved = texture(Mat3::from_scale(Vec2::new(2.0, 1.0)));
        check(
            &halved,
            &along_u(&[(0.2, 0.1), (0.3, 0.2), (0.6, 0.1), (0.9, 0.2)]),
        );
        let turned = texture(Mat3::from_angle(std::f32::consts::FRAC_PI_2));
        check(
            &turned,
            &[
                ([0.25, 0.25], 0.2),
                ([0.75, 0.25], 0.8),
                ([0.75, 0.75], 0.4),
            ],
        );
    }

    /// What `eval_1_grad` of Mitsuba 3.9.1 returns for the same picture; for the turned one, what its
    /// `eval_1` returns a little beside, since it applies the transposed map to gradients.
    #[test]
    fn gradients_are_those_of_mitsuba_and_of_differences() {
        let heights = vec![0.1, 0.25, 0.4, 0.35, 0.8, 0.2];
        let heights = Arc::new(image::Bitmap::new(3, 2, 1, Texels::Float(heights)).unwrap());
        let texture = |filter, to_uv| Bitmap::new(heights.clone(), filter, Wrap::Repeat, to_uv);
        let plain = texture(Filter::Bilinear, Mat3::IDENTITY);
        let scale = Mat3::from_scale(Vec2::new(2.0, 3.0));
        let turned = Mat3::from_angle(30.0_f32.to_radians()) * scale;
        let turned = texture(Filter::Bilinear, turned);
        for (texture, uv, expected) in [
            (&plain, [0.3, 0.7], [1.26, 0.74]),
            (&plain, [0.4, 0.4], [0.72, 0.92]),
            (&plain, [0.9, 0.1], [-0.495, 0.22]),
            (&turned, [0.3, 0.7], [0.143_6, -3.745_4]),
        ] {
            let (uv, expected) = (Vec2::from_array(uv), Vec2::from_array(expected));
            let found = texture.gradient(uv);
            assert!(
                (found - expected).length() < 1e-4,
                "{found} is not {expected}"
            );
            let slope = |axis: Vec2| {
                (texture.value(uv + axis * 1e-3) - texture.value(uv - axis * 1e-3)) / 2e-3
            };
            let differences = Vec2::new(slope(Vec2::X), slope(Vec2::Y));
            assert!((found - differences).length() < 1e-3, "{differences}");
        }
        let steps = texture(Filter::Nearest, Mat3::IDENTITY);
        assert_eq!(steps.gradient(Vec2::new(0.3, 0.7)), Vec2::ZERO);
    }

    #[test]
    fn means_follow_what_is_seen() {
        let texture = |to_uv| Bitmap::new(image(), Filter::Nearest, Wrap::Repeat, to_uv);
        let near = |texture: &Bitmap, mean: f32| {
            assert!(
                (texture.mean().g() - mean).abs() < 1e-6,
                "{:?}",
                texture.mean()
            );
        };
        near(&texture(Mat3::IDENTITY), 0.375);
        near(&texture(Mat3::from_scale(Vec2::splat(0.5))), 0.1);
        near(&texture(Mat3::from_scale(Vec2::splat(2.0))), 0.375);
    }

    #[test]
    fn colour_channels_are_decoded_and_a_mask_is_its_one_channel() {
        let bytes = image::Bitmap::new(1, 1, 4, Texels::U8(vec![255, 128, 0, 7])).unwrap();
        let texture = |image| {
            Bitmap::new(
                Arc::new(image),
                Filter::Bilinear,
                Wrap::Repeat,
                Mat3::IDENTITY,
            )
        };
        let colour = texture(bytes).colour(Vec2::new(0.3, 0.9));
        assert!(
            (colour.g() - 0.215_86).abs() < 1e-5 && colour.r() == 1.0,
            "{colour:?}"
        );
        let mask = image::Bitmap::new(1, 1, 1, Texels::Float(vec![0.3])).unwrap();
        assert_eq!(texture(mask.clone()).value(Vec2::ZERO), 0.3);
        assert_eq!(texture(mask).colour(Vec2::ZERO), Rgb::grey(0.3));
    }
}
