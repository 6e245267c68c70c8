//! How far a perturbation moves: densities that depend on the distance only, so that a move and its
//! way back are equally likely.

use std::f64::consts::{PI, TAU};

use crate::math::{Frame, Local, Vec2, Vec3, warp};

/// Offsets on the image plane, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RasterKernel {
    /// Uniform in a square.
    ///
    /// Source: Cline et al. 2005, Sec. 4.3.
    Square {
        /// Length of its sides.
        side: f32,
    },
    /// Uniform in a disk.
    ///
    /// Source: Lai et al. 2007, Sec. 4.2.
    Disk {
        /// Its radius.
        radius: f32,
    },
    /// A uniform azimuth, and a distance whose logarithm is uniform.
    ///
    /// Source: Veach & Guibas 1997, Sec. 5.3.
    Logarithmic {
        /// Smallest distance, positive.
        inner: f32,
        /// Largest distance.
        outer: f32,
    },
}

impl RasterKernel {
    /// The offset of two uniform numbers.
    #[inline]
    pub fn offset(self, u: Vec2) -> Vec2 {
        match self {
            Self::Square { side } => (u - 0.5) * side,
            Self::Disk { radius } => warp::uniform_disk(u) * radius,
            Self::Logarithmic { inner, outer } => around(u.y) * logarithmic(u.x, inner, outer),
        }
    }

    /// Density of an offset, for each square pixel.
    pub fn density(self, offset: Vec2) -> f64 {
        match self {
            Self::Square { side } => {
                let inside = offset.abs().max_element() <= 0.5 * side;
                f64::from(u8::from(inside)) / f64::from(side).powi(2)
            }
            Self::Disk { radius } => {
                let inside = offset.length() <= radius;
                f64::from(u8::from(inside)) / (PI * f64::from(radius).powi(2))
            }
            Self::Logarithmic { inner, outer } => {
                let distance = f64::from(offset.length());
                logarithmic_density(distance, inner, outer) / (TAU * distance)
            }
        }
    }
}

/// Angles by which a direction is turned, in radians, about a uniform azimuth; the logarithm of the
/// angle is uniform.
///
/// Source: Veach & Guibas 1997, Sec. 5.3; Cline et al. 2005, Sec. 4.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleKernel {
    /// Smallest angle, positive.
    pub inner: f32,
    /// Largest angle, at most π.
    pub outer: f32,
}

impl Default for AngleKernel {
    fn default() -> Self {
        Self {
            inner: 1e-4,
            outer: 0.1,
        }
    }
}

impl AngleKernel {
    /// The angle of a uniform number.
    #[inline]
    pub fn angle(self, u: f32) -> f32 {
        logarithmic(u, self.inner, self.outer)
    }

    /// Density of a turn by `angle`, in 1/sr.
    pub fn density(self, angle: f64) -> f64 {
        logarithmic_density(angle, self.inner, self.outer) / (TAU * angle.sin())
    }
}

/// A number between `inner` and `outer` whose logarithm is uniform.
#[inline]
fn logarithmic(u: f32, inner: f32, outer: f32) -> f32 {
    outer * (-(outer / inner).ln() * u).exp()
}

fn logarithmic_density(x: f64, inner: f32, outer: f32) -> f64 {
    let (inner, outer) = (f64::from(inner), f64::from(outer));
    if (inner..=outer).contains(&x) {
        1.0 / (x * (outer / inner).ln())
    } else {
        0.0
    }
}

/// Turns a unit direction by an angle about a uniform azimuth.
///
/// - `u`: uniform in `[0, 1)`.
#[inline]
pub fn turned(direction: Vec3, angle: f32, u: f32) -> Vec3 {
    let (sin, cos) = angle.sin_cos();
    let aside = around(u) * sin;
    let turned = Frame::around(direction).to_world(Local::new(aside.x, aside.y, cos));
    turned.normalize()
}

/// The unit vector at a part of a full turn.
#[inline]
fn around(u: f32) -> Vec2 {
    let (sin, cos) = (u * std::f32::consts::TAU).sin_cos();
    Vec2::new(cos, sin)
}
