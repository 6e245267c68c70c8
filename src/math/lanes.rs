//! Four numbers, directions or colours at once, one in each lane.
//!
//! What has a namesake for one does in every lane what that does, step by step, so that the bits are the
//! same.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};
use std::ops::{Add, Mul, Neg, Sub};

use super::Vec3;
use super::warp::sin_cos_of_eighth;
pub use glam::{BVec4A as LaneMask, Vec4, Vec4 as Lanes};

/// How many there are.
pub const LANES: usize = 4;

/// A vector in each lane.
#[derive(Clone, Copy, Debug)]
pub struct Vec3Lanes {
    /// First parts.
    pub x: Lanes,
    /// Second parts.
    pub y: Lanes,
    /// Third parts.
    pub z: Lanes,
}

/// Something for each lane.
///
/// Not [`std::array::from_fn`], which the compiler does not always write out.
#[inline(always)]
pub fn each<T>(mut of_lane: impl FnMut(usize) -> T) -> [T; LANES] {
    [of_lane(0), of_lane(1), of_lane(2), of_lane(3)]
}

/// A number for each lane.
#[inline(always)]
pub fn gather(of_lane: impl FnMut(usize) -> f32) -> Lanes {
    Lanes::from_array(each(of_lane))
}

/// The lanes for which something holds.
#[inline(always)]
pub fn mask(of_lane: impl FnMut(usize) -> bool) -> LaneMask {
    let [a, b, c, d] = each(of_lane);
    LaneMask::new(a, b, c, d)
}

/// Columns of four rows, one of each lane.
#[inline(always)]
pub fn transpose(rows: [Vec4; LANES]) -> [Lanes; LANES] {
    let [a, b, c, d] = rows;
    let columns = glam::Mat4::from_cols(a, b, c, d).transpose();
    [
        columns.x_axis,
        columns.y_axis,
        columns.z_axis,
        columns.w_axis,
    ]
}

impl Vec3Lanes {
    /// The same vector in each lane.
    #[inline(always)]
    pub fn splat(vector: Vec3) -> Self {
        Self {
            x: Lanes::splat(vector.x),
            y: Lanes::splat(vector.y),
            z: Lanes::splat(vector.z),
        }
    }

    /// A vector for each lane.
    #[inline(always)]
    pub fn gather(of_lane: impl FnMut(usize) -> Vec3) -> Self {
        let vectors = each(of_lane);
        Self {
            x: gather(|lane| vectors[lane].x),
            y: gather(|lane| vectors[lane].y),
            z: gather(|lane| vectors[lane].z),
        }
    }

    /// Vectors from rows of one lane each, and the last number of each row.
    #[inline(always)]
    pub fn of_rows(rows: [Vec4; LANES]) -> (Self, Lanes) {
        let [x, y, z, last] = transpose(rows);
        (Self { x, y, z }, last)
    }

    /// The vectors of all lanes, each followed by a number.
    #[inline(always)]
    pub fn rows(self, last: Lanes) -> [Vec4; LANES] {
        transpose([self.x, self.y, self.z, last])
    }

    /// The vectors of all lanes.
    #[inline(always)]
    pub fn vectors(self) -> [Vec3; LANES] {
        let rows = self.rows(Lanes::ZERO);
        each(|lane| rows[lane].truncate())
    }

    /// As [`Vec3::dot`].
    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// As [`Vec3::length_squared`].
    #[inline(always)]
    pub fn length_squared(self) -> Lanes {
        self.dot(self)
    }

    /// Those of one where the mask is set, else those of the other.
    #[inline(always)]
    pub fn select(mask: LaneMask, then: Self, otherwise: Self) -> Self {
        Self {
            x: Lanes::select(mask, then.x, otherwise.x),
            y: Lanes::select(mask, then.y, otherwise.y),
            z: Lanes::select(mask, then.z, otherwise.z),
        }
    }

    /// The product part by part.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self {
            x: self.x * other.x,
            y: self.y * other.y,
            z: self.z * other.z,
        }
    }
}

impl Add for Vec3Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }
}

impl Sub for Vec3Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }
}

impl Neg for Vec3Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            x: -self.x,
            y: -self.y,
            z: -self.z,
        }
    }
}

impl Mul<Lanes> for Vec3Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: Lanes) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }
}

/// The direction of [`Frame::around`](super::Frame::around) and
/// [`Frame::to_world`](super::Frame::to_world): one that is written in some frame around a unit normal,
/// in world space.
#[inline(always)]
pub fn to_world(normal: Vec3Lanes, local: Vec3Lanes) -> Vec3Lanes {
    let one = Lanes::ONE;
    let sign = one.copysign(normal.z);
    let a = -one / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3Lanes {
        x: one + sign * normal.x * normal.x * a,
        y: sign * b,
        z: -sign * normal.x,
    };
    let bitangent = Vec3Lanes {
        x: b,
        y: sign + normal.y * normal.y * a,
        z: -normal.y,
    };
    tangent * local.x + bitangent * local.y + normal * local.z
}

/// As [`warp::uniform_triangle`](super::warp::uniform_triangle).
#[inline(always)]
pub fn uniform_triangle([u, v]: [Lanes; 2]) -> [Lanes; 2] {
    let root = (Lanes::ONE - u).max(Lanes::ZERO).sqrt();
    [Lanes::ONE - root, root * v]
}

/// As [`warp::cosine_hemisphere`](super::warp::cosine_hemisphere).
#[inline(always)]
pub fn cosine_hemisphere(u: [Lanes; 2]) -> Vec3Lanes {
    let [x, y] = uniform_disk(u);
    let z = (Lanes::ONE - (x * x + y * y))
        .max(Lanes::splat(1e-12))
        .sqrt();
    Vec3Lanes { x, y, z }
}

/// As [`warp::cosine_hemisphere_density`](super::warp::cosine_hemisphere_density).
#[inline(always)]
pub fn cosine_hemisphere_density(cos: Lanes) -> Lanes {
    cos.max(Lanes::ZERO) * FRAC_1_PI
}

#[inline(always)]
fn uniform_disk([u, v]: [Lanes; 2]) -> [Lanes; 2] {
    let a = 2.0 * u - Lanes::ONE;
    let b = 2.0 * v - Lanes::ONE;
    let is_high = (a * a).cmple(b * b);
    let (radius, across) = (Lanes::select(is_high, b, a), Lanes::select(is_high, a, b));
    let (sin, cos) = sin_cos_of_eighth(FRAC_PI_4 * (across / radius));
    let (along, across) = (radius * cos, radius * sin);
    let is_middle = radius.cmpeq(Lanes::ZERO);
    let x = Lanes::select(is_high, across, along);
    let y = Lanes::select(is_high, along, across);
    [
        Lanes::select(is_middle, Lanes::ZERO, x),
        Lanes::select(is_middle, Lanes::ZERO, y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Frame, Local, Vec2, warp};

    fn bits(v: Vec3) -> [u32; 3] {
        v.to_array().map(f32::to_bits)
    }

    /// Numbers in `[0, 1)`, the limits and the middle among them, four pairs at a time.
    fn pairs() -> impl Iterator<Item = [Vec2; LANES]> {
        let numbers: Vec<f32> = (0..32)
            .map(|i| i as f32 / 32.0)
            .chain([1e-9, 0.499_999_97, 0.500_000_06, warp::ONE_MINUS_EPSILON])
            .collect();
        let count = numbers.len();
        (0..count * count).map(move |first| {
            each(|lane| {
                let index = (first + lane * 251) % (count * count);
                Vec2::new(numbers[index / count], numbers[index % count])
            })
        })
    }

    fn by_lane(pairs: [Vec2; LANES]) -> [Lanes; 2] {
        [gather(|lane| pairs[lane].x), gather(|lane| pairs[lane].y)]
    }

    #[test]
    fn four_samples_are_the_samples_alone_to_the_bit() {
        for pairs in pairs() {
            let direction = cosine_hemisphere(by_lane(pairs));
            let density = cosine_hemisphere_density(direction.z);
            let triangle = uniform_triangle(by_lane(pairs));
            for (lane, u) in pairs.into_iter().enumerate() {
                let alone = warp::cosine_hemisphere(u);
                assert_eq!(bits(direction.vectors()[lane]), bits(alone), "{u}");
                let alone = warp::cosine_hemisphere_density(alone.z);
                assert_eq!(density[lane].to_bits(), alone.to_bits(), "{u}");
                let alone = warp::uniform_triangle(u).to_array().map(f32::to_bits);
                assert_eq!(triangle.map(|part| part[lane].to_bits()), alone, "{u}");
            }
        }
    }

    #[test]
    fn four_directions_leave_their_frames_as_they_do_alone() {
        for pairs in pairs() {
            let normals = pairs.map(warp::uniform_sphere);
            let local = cosine_hemisphere(by_lane(pairs));
            let world = to_world(Vec3Lanes::gather(|lane| normals[lane]), local);
            for (lane, normal) in normals.into_iter().enumerate() {
                let local = Local(local.vectors()[lane]);
                let alone = Frame::around(normal).to_world(local);
                assert_eq!(bits(world.vectors()[lane]), bits(alone));
            }
        }
    }

    #[test]
    fn rows_and_lanes_change_places() {
        let rows = each(|row| gather(|column| (10 * row + column) as f32));
        let columns = transpose(rows);
        assert!((0..LANES).all(|i| (0..LANES).all(|j| columns[i][j] == rows[j][i])));
        let (vectors, last) = Vec3Lanes::of_rows(rows);
        assert_eq!(vectors.rows(last), rows);
        assert_eq!(vectors.vectors()[2], Vec3::new(20.0, 21.0, 22.0));
        assert_eq!(
            vectors.dot(vectors)[1],
            vectors.vectors()[1].length_squared()
        );
    }
}
