//! Linear Rec.709 colour, the unit of every radiometric quantity in the renderer.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, DivAssign, Index, Mul, MulAssign, Neg, Sub, SubAssign};

use glam::Vec3;

/// A linear Rec.709 triple: a reflectance, a radiance or a throughput, as the context says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb(pub Vec3);

impl Rgb {
    /// No light, or a surface that reflects none.
    pub const BLACK: Self = Self(Vec3::ZERO);
    /// One in each channel.
    pub const WHITE: Self = Self(Vec3::ONE);
    /// The weights of [`Rgb::luminance`]: the Y row of the Rec.709 matrix, as Mitsuba prints it.
    pub const LUMINANCE_WEIGHTS: Vec3 = Vec3::new(0.212_671, 0.715_160, 0.072_169);

    /// Makes a colour from its red, green and blue parts.
    #[inline]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }

    /// Makes a grey: the same value in each channel.
    #[inline]
    pub const fn grey(value: f32) -> Self {
        Self(Vec3::splat(value))
    }

    /// Red part.
    #[inline]
    pub fn r(self) -> f32 {
        self.0.x
    }

    /// Green part.
    #[inline]
    pub fn g(self) -> f32 {
        self.0.y
    }

    /// Blue part.
    #[inline]
    pub fn b(self) -> f32 {
        self.0.z
    }

    /// Relative luminance Y.
    #[inline]
    pub fn luminance(self) -> f32 {
        self.0.dot(Self::LUMINANCE_WEIGHTS)
    }

    /// The largest of the three channels.
    #[inline]
    pub fn max_channel(self) -> f32 {
        self.0.max_element()
    }

    /// The mean of the three channels.
    #[inline]
    pub fn mean(self) -> f32 {
        self.0.element_sum() / 3.0
    }

    /// True when every channel is exactly zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0 == Vec3::ZERO
    }

    /// True when no channel is infinite or not a number.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// Limits each channel to `[low, high]`.
    #[inline]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        Self(self.0.clamp(Vec3::splat(low), Vec3::splat(high)))
    }

    /// Applies `f` to each channel.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.0.x), f(self.0.y), f(self.0.z))
    }

    /// The channels in the order red, green, blue.
    #[inline]
    pub fn to_array(self) -> [f32; 3] {
        self.0.to_array()
    }
}

impl From<[f32; 3]> for Rgb {
    #[inline]
    fn from(channels: [f32; 3]) -> Self {
        Self(Vec3::from_array(channels))
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    #[inline]
    fn index(&self, channel: usize) -> &f32 {
        &self.0[channel]
    }
}

impl Sum for Rgb {
    fn sum<I: Iterator<Item = Self>>(colours: I) -> Self {
        colours.fold(Self::BLACK, Add::add)
    }
}

impl Neg for Rgb {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

macro_rules! channelwise {
    ($($trait:ident $method:ident, $assign_trait:ident $assign_method:ident;)*) => {$(
        impl $trait for Rgb {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
        impl $assign_trait for Rgb {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                self.0.$assign_method(other.0);
            }
        }
    )*};
}

channelwise! {
    Add add, AddAssign add_assign;
    Sub sub, SubAssign sub_assign;
    Mul mul, MulAssign mul_assign;
    Div div, DivAssign div_assign;
}

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }
}

impl Mul<Rgb> for f32 {
    type Output = Rgb;
    #[inline]
    fn mul(self, colour: Rgb) -> Rgb {
        Rgb(colour.0 * self)
    }
}

impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, factor: f32) {
        self.0 *= factor;
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f32) -> Self {
        Self(self.0 / divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminance_of_white_is_one() {
        assert!((Rgb::WHITE.luminance() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn channels_stay_apart() {
        let a = Rgb::new(1.0, 2.0, 4.0);
        assert_eq!(a * a, Rgb::new(1.0, 4.0, 16.0));
        assert_eq!(a / 2.0, Rgb::new(0.5, 1.0, 2.0));
        assert_eq!([a, a].into_iter().sum::<Rgb>(), 2.0 * a);
        assert_eq!(a.max_channel(), 4.0);
    }
}
