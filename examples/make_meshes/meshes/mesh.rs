//! A mesh of quadrilaterals and triangles, and its file.

use std::collections::HashMap;

use super::vector::{Vec3, add, cross, dot, mul, sub, unit};

/// Corners of a face; the last two are the same for a triangle.
type Face = [usize; 4];

/// Points and faces.
#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(super) points: Vec<Vec3>,
    pub(super) faces: Vec<Face>,
}

impl Mesh {
    /// A surface over the unit square, in `nu` × `nv` cells; points that coincide are joined.
    pub(super) fn grid(nu: usize, nv: usize, surface: impl Fn(f64, f64) -> Vec3) -> Self {
        let rows = (0..=nu).map(|i| {
            let u = i as f64 / nu as f64;
            (0..=nv).map(|j| surface(u, j as f64 / nv as f64)).collect()
        });
        Self::rows(&rows.collect::<Vec<_>>())
    }

    /// Rows of points, with faces between neighbours; points that coincide are joined.
    pub(super) fn rows(rows: &[Vec<Vec3>]) -> Self {
        let width = rows[0].len();
        let mut mesh = Self {
            points: rows.concat(),
            faces: Vec::new(),
        };
        for i in 0..rows.len() - 1 {
            for j in 0..width - 1 {
                let at = i * width + j;
                mesh.faces.push([at, at + width, at + width + 1, at + 1]);
            }
        }
        mesh.welded()
    }

    /// A surface over the directions of a sphere, each side of a cube in `n` × `n` cells.
    pub(super) fn ball(n: usize, surface: impl Fn(Vec3) -> Vec3) -> Self {
        let mut whole = Self::default();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                whole.append(Self::grid(n, n, |u, v| {
                    // Equal angles make cells of about equal size.
                    let [a, b] = [u, v].map(|t| ((t - 0.5) * std::f64::consts::FRAC_PI_2).tan());
                    let mut direction = [0.0; 3];
                    direction[axis] = side;
                    direction[(axis + 1) % 3] = a;
                    direction[(axis + 2) % 3] = b * side;
                    surface(unit(direction))
                }));
            }
        }
        whole.welded()
    }

    /// Adds another mesh, without joining anything.
    pub(super) fn append(&mut self, other: Self) {
        let first = self.points.len();
        self.points.extend(other.points);
        self.faces
            .extend(other.faces.iter().map(|f| f.map(|i| i + first)));
    }

    /// Joins points that coincide, and drops the faces that this leaves without area.
    pub(super) fn welded(&self) -> Self {
        const NEAR: f64 = 1e-7;
        let mut cells: HashMap<[i64; 3], usize> = HashMap::new();
        let mut mesh = Self::default();
        let mut place = Vec::with_capacity(self.points.len());
        for point in &self.points {
            let cell = point.map(|x| (x / NEAR).round() as i64);
            let around = (0..27).map(|n| [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1]);
            let found = around
                .map(|d| [cell[0] + d[0], cell[1] + d[1], cell[2] + d[2]])
                .find_map(|c| cells.get(&c).copied());
            place.push(found.unwrap_or_else(|| {
                cells.insert(cell, mesh.points.len());
                mesh.points.push(*point);
                mesh.points.len() - 1
            }));
        }
        for face in &self.faces {
            let mut corners = face.map(|i| place[i]).to_vec();
            corners.dedup();
            if corners.first() == corners.last() {
                corners.pop();
            }
            match corners[..] {
                [a, b, c, d] if a != c && b != d => mesh.faces.push([a, b, c, d]),
                [a, b, c] => mesh.faces.push([a, b, c, c]),
                _ => {}
            }
        }
        mesh
    }

    /// The mesh with its points moved.
    pub(super) fn moved(mut self, to: impl Fn(Vec3) -> Vec3) -> Self {
        for point in &mut self.points {
            *point = to(*point);
        }
        self
    }

    /// The triangles, as corners.
    fn corners(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.faces.iter().flat_map(|&[a, b, c, d]| {
            let second = (c != d).then_some([a, c, d]);
            std::iter::once([a, b, c]).chain(second)
        })
    }

    /// How many triangles there are.
    pub(crate) fn triangles(&self) -> usize {
        self.corners().count()
    }

    /// Six times the volume, negative where the faces look inwards.
    fn volume(&self) -> f64 {
        let middle = mul(
            self.points.iter().fold([0.0; 3], |sum, p| add(sum, *p)),
            1.0 / self.points.len() as f64,
        );
        self.corners()
            .map(|corners| corners.map(|i| sub(self.points[i], middle)))
            .map(|[a, b, c]| dot(a, cross(b, c)))
            .sum()
    }

    /// A closed mesh with its faces looking outwards.
    pub(super) fn outwards(mut self) -> Self {
        if self.volume() < 0.0 {
            self.faces.iter_mut().for_each(|[a, b, c, d]| match c == d {
                true => std::mem::swap(a, b),
                false => std::mem::swap(b, d),
            });
        }
        self
    }

    /// The mesh on the plane y = 0, centred over the origin, with 1 as its longest side.
    pub(super) fn fitted(self) -> Self {
        let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
        for point in &self.points {
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        let size = sub(high, low).into_iter().fold(0.0, f64::max);
        let foot = [(low[0] + high[0]) / 2.0, low[1], (low[2] + high[2]) / 2.0];
        self.moved(|p| mul(sub(p, foot), 1.0 / size))
    }

    /// As a PLY file: little-endian floats, indices of 16 bits where these do.
    pub(crate) fn to_ply(&self) -> Vec<u8> {
        let short = self.points.len() <= 1 << 16;
        let index = if short { "ushort" } else { "uint" };
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\ncomment lumiflow, examples/make_meshes\n\
             element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {}\nproperty list uchar {index} vertex_indices\nend_header\n",
            self.points.len(),
            self.faces.len(),
        )
        .into_bytes();
        for x in self.points.iter().flatten() {
            bytes.extend((*x as f32).to_le_bytes());
        }
        for face in &self.faces {
            let count = if face[2] == face[3] { 3 } else { 4 };
            bytes.push(count as u8);
            for corner in &face[..count] {
                let four = (*corner as u32).to_le_bytes();
                bytes.extend(&four[..if short { 2 } else { 4 }]);
            }
        }
        bytes
    }
}
