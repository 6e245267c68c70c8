//! Surfaces given by a function that is negative inside, as quadrilaterals.
//!
//! Each cell of a grid that the surface goes through gets one point, and each edge of the grid that it
//! cuts one face between the points of the four cells around it ("surface nets"). The points are then
//! moved onto the surface.

use std::collections::HashMap;

use super::mesh::Mesh;
use super::vector::{Vec3, add, cross, dot, length, mul, sub};

/// A box, and into how many cells its longest side is cut.
pub(super) struct Region {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    pub(super) cells: usize,
}

impl Region {
    pub(super) fn surface(&self, inside: impl Fn(Vec3) -> f64) -> Mesh {
        let extent = sub(self.high, self.low);
        let cell = extent.into_iter().fold(0.0, f64::max) / self.cells as f64;
        let count = extent.map(|x| (x / cell).ceil() as usize + 1);
        let place = |i: [usize; 3]| add(self.low, mul(i.map(|i| i as f64), cell));
        let index = |[x, y, z]: [usize; 3]| (z * count[1] + y) * count[0] + x;
        let all = (0..count[2])
            .flat_map(|z| (0..count[1]).flat_map(move |y| (0..count[0]).map(move |x| [x, y, z])));
        let all: Vec<[usize; 3]> = all.collect();
        let values: Vec<f64> = all.iter().map(|i| inside(place(*i))).collect();

        let mut mesh = Mesh::default();
        let mut points: HashMap<usize, usize> = HashMap::new();
        let mut point_of = |mesh: &mut Mesh, at: [usize; 3]| {
            *points.entry(index(at)).or_insert_with(|| {
                let middle = crossing(at, |i| values[index(i)]);
                let start = add(self.low, mul(middle, cell));
                mesh.points.push(moved_onto(start, cell, &inside));
                mesh.points.len() - 1
            })
        };
        for &at in &all {
            for axis in 0..3 {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut next = at;
                next[axis] += 1;
                if next[axis] >= count[axis] || at[b] == 0 || at[c] == 0 {
                    continue;
                }
                let (here, there) = (values[index(at)] < 0.0, values[index(next)] < 0.0);
                if here == there {
                    continue;
                }
                let around = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| {
                    let mut cell = at;
                    cell[b] -= i;
                    cell[c] -= j;
                    point_of(&mut mesh, cell)
                });
                let [p, q, r, s] = around;
                mesh.faces
                    .push(if here { [p, q, r, s] } else { [p, s, r, q] });
            }
        }
        mesh.outwards()
    }
}

/// The mean of the points where the surface cuts the edges of a cell, in cells.
fn crossing(at: [usize; 3], value: impl Fn([usize; 3]) -> f64) -> Vec3 {
    let corner = |n: usize| [at[0] + (n & 1), at[1] + ((n >> 1) & 1), at[2] + (n >> 2)];
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for n in 0..8 {
        for axis in [1, 2, 4] {
            if n & axis != 0 {
                continue;
            }
            let [a, b] = [corner(n), corner(n | axis)];
            let [from, to] = [value(a), value(b)];
            if (from < 0.0) != (to < 0.0) {
                let t = from / (from - to);
                let [a, b] = [a, b].map(|c| c.map(|i| i as f64));
                sum = add(sum, add(mul(a, 1.0 - t), mul(b, t)));
                count += 1.0;
            }
        }
    }
    mul(sum, 1.0 / f64::max(count, 1.0))
}

/// A point near a surface, moved onto it by Newton's method, no further than a cell.
fn moved_onto(start: Vec3, cell: f64, inside: &impl Fn(Vec3) -> f64) -> Vec3 {
    let step = 1e-3 * cell;
    let mut point = start;
    for _ in 0..4 {
        let slope: Vec3 = std::array::from_fn(|axis| {
            let mut ahead = [0.0; 3];
            ahead[axis] = step;
            (inside(add(point, ahead)) - inside(sub(point, ahead))) / (2.0 * step)
        });
        let steep = dot(slope, slope);
        if steep < 1e-12 {
            break;
        }
        let way = mul(slope, -inside(point) / steep);
        let far = length(way);
        point = add(point, mul(way, (0.4 * cell / far.max(1e-30)).min(1.0)));
    }
    if length(sub(point, start)) < 0.9 * cell {
        point
    } else {
        start
    }
}

/// The union of two bodies, with a fillet of about `k` between them.
pub(super) fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k / 4.0
}

/// The first body without the second, with the edge rounded by about `k`.
pub(super) fn carve(a: f64, b: f64, k: f64) -> f64 {
    -join(-a, b, k)
}

/// About the distance to an ellipsoid.
pub(super) fn ellipsoid(p: Vec3, middle: Vec3, axes: Vec3) -> f64 {
    let d = sub(p, middle);
    let scaled: Vec3 = std::array::from_fn(|i| d[i] / axes[i]);
    let twice: Vec3 = std::array::from_fn(|i| d[i] / (axes[i] * axes[i]));
    let (near, slope) = (length(scaled), length(twice));
    if slope < 1e-9 {
        return -axes.into_iter().fold(f64::MAX, f64::min);
    }
    near * (near - 1.0) / slope
}

/// The distance to a rod with round ends, thick `r` at one end and `s` at the other.
pub(super) fn rod(p: Vec3, a: Vec3, b: Vec3, [r, s]: [f64; 2]) -> f64 {
    let (along, to) = (sub(b, a), sub(p, a));
    let t = (dot(to, along) / dot(along, along)).clamp(0.0, 1.0);
    length(sub(to, mul(along, t))) - (r + (s - r) * t)
}

/// The same function, asked only near its surface: elsewhere its value at the middle of a block of
/// cells stands for the block. It must be about a distance.
///
/// - `block`: cells along a block's side.
pub(super) fn coarse_first(
    region: &Region,
    block: usize,
    inside: impl Fn(Vec3) -> f64,
) -> impl Fn(Vec3) -> f64 {
    let extent = sub(region.high, region.low);
    let longest = extent.into_iter().fold(0.0, f64::max);
    let side = block as f64 * longest / region.cells as f64;
    let count = extent.map(|x| (x / side).ceil() as usize + 2);
    let low = sub(region.low, [side / 2.0; 3]);
    let middle = |i: [usize; 3]| add(low, mul(i.map(|i| i as f64 + 0.5), side));
    let blocks: Vec<f64> = (0..count[0] * count[1] * count[2])
        .map(|n| {
            [
                n % count[0],
                n / count[0] % count[1],
                n / (count[0] * count[1]),
            ]
        })
        .map(|i| inside(middle(i)))
        .collect();
    move |p| {
        let at: [usize; 3] = std::array::from_fn(|axis| {
            let i = ((p[axis] - low[axis]) / side) as usize;
            i.min(count[axis] - 1)
        });
        let rough = blocks[(at[2] * count[1] + at[1]) * count[0] + at[0]];
        if rough.abs() > 1.5 * side {
            rough
        } else {
            inside(p)
        }
    }
}

/// A body that lies in a ball; well outside of it, the ball's distance stands for the body's.
pub(super) fn within(p: Vec3, middle: Vec3, radius: f64, body: impl Fn(Vec3) -> f64) -> f64 {
    let far = length(sub(p, middle)) - radius;
    if far > 0.2 { far } else { body(p) }
}

/// A skin over a triangle.
pub(super) struct Sheet {
    pub(super) corners: [Vec3; 3],
    /// Half of its thickness.
    pub(super) thick: f64,
    /// How far its middle stands out of the plane of the corners.
    pub(super) bulge: f64,
    /// How far the edge across from the first corner is cut in, as a part of the height over it.
    pub(super) scallop: f64,
}

impl Sheet {
    /// About the distance to it.
    pub(super) fn distance(&self, p: Vec3) -> f64 {
        let [a, b, c] = self.corners;
        let normal = cross(sub(b, a), sub(c, a));
        let twice = length(normal);
        let weight = |from: Vec3, to: Vec3| {
            dot(cross(sub(to, from), sub(p, from)), normal) / (twice * twice)
        };
        let parts = [weight(b, c), weight(c, a), weight(a, b)];
        let heights = [sub(c, b), sub(a, c), sub(b, a)].map(|side| twice / length(side));
        let held = parts.map(|x| x.clamp(0.0, 1.0));
        let bulge = self.bulge * 27.0 * held[0] * held[1] * held[2];
        let off = (dot(sub(p, a), normal) / twice - bulge).abs() - self.thick;
        let sum = (held[1] + held[2]).max(1e-9);
        let cut = self.scallop * 4.0 * held[1] * held[2] / (sum * sum);
        let beyond = [cut - parts[0], -parts[1], -parts[2]];
        (0..3).fold(off, |d, i| d.max(beyond[i] * heights[i]))
    }
}
