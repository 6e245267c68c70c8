//! Textures on the triangles of one mesh.

use std::sync::Arc;

use super::{Texture, TextureModel};
use crate::accel::IndexBuffer;
use crate::math::{Rgb, TriangleChart, Vec2};

/// The triangles of a mesh whose points have the places of a [`TriangleChart`] as their coordinates.
///
/// Gradients are by the mesh's own texture coordinates, as its points' derivatives are.
#[derive(Clone, Debug)]
pub struct MeshSurface {
    chart: TriangleChart,
    triangles: IndexBuffer,
    /// Texture coordinates, one a vertex; barycentrics stand in for them.
    uvs: Option<Arc<[Vec2]>>,
}

/// A point of a mesh.
struct Place {
    triangle: u32,
    corners: [u32; 3],
    barycentrics: Vec2,
}

impl MeshSurface {
    /// Makes the surface.
    ///
    /// - `uvs`: one a vertex, where the mesh has them.
    pub fn new(triangles: IndexBuffer, uvs: Option<Arc<[Vec2]>>) -> Self {
        Self {
            chart: TriangleChart::new(triangles.as_slice().len()),
            triangles,
            uvs,
        }
    }

    /// The texture coordinates at a place of the chart.
    #[inline]
    pub(super) fn uv_at(&self, place: Vec2) -> Vec2 {
        self.uv(&self.locate(place))
    }

    /// A place of the chart; one beside it becomes the first triangle.
    #[inline]
    fn locate(&self, place: Vec2) -> Place {
        let (triangle, barycentrics) = self.chart.locate(place);
        let corners = self.triangles.as_slice().get(triangle as usize);
        Place {
            triangle: corners.map_or(0, |_| triangle),
            corners: corners.copied().unwrap_or_default(),
            barycentrics,
        }
    }

    /// The texture coordinates of a point.
    #[inline]
    fn uv(&self, place: &Place) -> Vec2 {
        let Some(uvs) = &self.uvs else {
            return place.barycentrics;
        };
        let [a, b, c] = place.corners.map(|i| uvs[i as usize]);
        let Vec2 { x, y } = place.barycentrics;
        a * (1.0 - x - y) + b * x + c * y
    }

    /// Derivatives by barycentrics as such by texture coordinates; zero where these do not span the
    /// triangle.
    fn by_uv(&self, place: &Place, by_barycentrics: Vec2) -> Vec2 {
        let Some(uvs) = &self.uvs else {
            return by_barycentrics;
        };
        let [a, b, c] = place.corners.map(|i| uvs[i as usize]);
        let (to_b, to_c) = (b - a, c - a);
        let determinant = to_b.perp_dot(to_c);
        if determinant == 0.0 {
            return Vec2::ZERO;
        }
        let Vec2 { x, y } = by_barycentrics;
        Vec2::new(x * to_c.y - y * to_b.y, y * to_b.x - x * to_c.x) / determinant
    }
}

/// Values that a mesh carries, one a vertex or one a face.
#[derive(Clone, Debug)]
pub struct MeshAttribute {
    surface: MeshSurface,
    values: Arc<[Rgb]>,
    by_face: bool,
}

impl MeshAttribute {
    /// Makes the texture.
    ///
    /// - `values`: one a vertex of the mesh, linear between them; with `by_face`, one a triangle.
    pub fn new(surface: MeshSurface, values: Arc<[Rgb]>, by_face: bool) -> Self {
        Self {
            surface,
            values,
            by_face,
        }
    }

    /// The values at the corners of a triangle.
    #[inline]
    fn corners(&self, place: &Place) -> [Rgb; 3] {
        let indices = if self.by_face {
            [place.triangle; 3]
        } else {
            place.corners
        };
        indices.map(|i| self.values.get(i as usize).copied().unwrap_or(Rgb::BLACK))
    }
}

impl TextureModel for MeshAttribute {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        let place = self.surface.locate(uv);
        let [a, b, c] = self.corners(&place);
        let Vec2 { x, y } = place.barycentrics;
        // As a sum of differences, equal corners give just their value.
        a + (b - a) * x + (c - a) * y
    }

    fn gradient(&self, uv: Vec2) -> Vec2 {
        let place = self.surface.locate(uv);
        let [a, b, c] = self.corners(&place).map(Rgb::luminance);
        self.surface.by_uv(&place, Vec2::new(b - a, c - a))
    }

    /// Mean of all values, whatever the size of their triangles.
    fn mean(&self) -> Rgb {
        let sum: glam::DVec3 = self.values.iter().map(|value| value.0.as_dvec3()).sum();
        Rgb((sum / self.values.len().max(1) as f64).as_vec3())
    }

    fn without_negatives(&self) -> Option<Self> {
        let clamped = |value: &Rgb| super::clamped(*value).unwrap_or(*value);
        let is_negative = |value: &Rgb| super::clamped(*value).is_some();
        self.values.iter().any(is_negative).then(|| Self {
            values: self.values.iter().map(clamped).collect(),
            ..self.clone()
        })
    }
}

/// A texture that is looked up at the texture coordinates of a mesh.
#[derive(Clone, Debug)]
pub struct OnMesh {
    surface: MeshSurface,
    nested: Box<Texture>,
}

impl OnMesh {
    /// Makes the texture.
    pub fn new(surface: MeshSurface, nested: Texture) -> Self {
        Self {
            surface,
            nested: Box::new(nested),
        }
    }
}

impl TextureModel for OnMesh {
    #[inline]
    fn colour(&self, uv: Vec2) -> Rgb {
        self.nested.colour(self.surface.uv_at(uv))
    }

    #[inline]
    fn value(&self, uv: Vec2) -> f32 {
        self.nested.value(self.surface.uv_at(uv))
    }

    fn gradient(&self, uv: Vec2) -> Vec2 {
        self.nested.gradient(self.surface.uv_at(uv))
    }

    fn mean(&self) -> Rgb {
        self.nested.mean()
    }

    fn is_constant(&self) -> bool {
        self.nested.is_constant()
    }

    fn of_numbers(self) -> Self {
        Self {
            nested: Box::new(self.nested.of_numbers()),
            ..self
        }
    }

    fn without_negatives(&self) -> Option<Self> {
        let nested = self.nested.without_negatives()?;
        Some(Self::new(self.surface.clone(), nested))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles that share an edge, with slanted texture coordinates.
    fn surface() -> MeshSurface {
        let uvs = [[0.0, 0.0], [2.0, 0.5], [0.5, 3.0], [2.5, 3.5]];
        let triangles = IndexBuffer::new(vec![[0, 1, 2], [1, 3, 2]]);
        MeshSurface::new(triangles, Some(uvs.map(Vec2::from_array).into()))
    }

    fn place(triangle: u32, x: f32, y: f32) -> Vec2 {
        TriangleChart::new(2).place(triangle, Vec2::new(x, y))
    }

    #[test]
    fn values_of_vertices_are_linear_between_them_and_those_of_faces_even() {
        let values = [0.1, 0.4, 0.9, 0.3].map(Rgb::grey);
        let smooth = MeshAttribute::new(surface(), values.into(), false);
        for (triangle, x, y, expected) in [
            (0, 0.0, 0.0, 0.1),
            (0, 1.0, 0.0, 0.4),
            (1, 1.0, 0.0, 0.3),
            (1, 0.25, 0.5, 0.4 * 0.25 + 0.3 * 0.25 + 0.9 * 0.5),
        ] {
            let found = smooth.colour(place(triangle, x, y)).r();
            assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
        }
        let even = MeshAttribute::new(surface(), values[..2].into(), true);
        assert_eq!(even.colour(place(1, 0.3, 0.4)), values[1]);
        assert_eq!(even.gradient(place(1, 0.3, 0.4)), Vec2::ZERO);
        assert!((smooth.mean().r() - 0.425).abs() < 1e-6);
    }

    /// A gradient by texture coordinates, times how these change, is how the value changes.
    #[test]
    fn gradients_are_those_of_differences() {
        let values = [0.1, 0.4, 0.9, 0.3].map(Rgb::grey);
        let smooth = MeshAttribute::new(surface(), values.into(), false);
        for triangle in [0, 1] {
            let at = |x, y| place(triangle, x, y);
            let gradient = smooth.gradient(at(0.3, 0.3));
            let surface = surface();
            let uv = |place| surface.uv(&surface.locate(place));
            for (x, y) in [(0.55, 0.3), (0.3, 0.55)] {
                let step = uv(at(x, y)) - uv(at(0.3, 0.3));
                let change = smooth.value(at(x, y)) - smooth.value(at(0.3, 0.3));
                assert!((gradient.dot(step) - change).abs() < 1e-5, "{change}");
            }
        }
    }

    #[test]
    fn other_textures_are_looked_up_at_the_coordinates_of_the_mesh() {
        use crate::math::Mat3;
        use crate::texture::Checkerboard;
        let colours = [Rgb::grey(0.2), Rgb::grey(0.7)];
        let board = Checkerboard::new(colours, Mat3::IDENTITY);
        let on_mesh = OnMesh::new(surface(), board.clone().into());
        for (triangle, x, y, u, v) in [(0, 0.5, 0.0, 1.0, 0.25), (1, 0.0, 0.1, 1.85, 0.75)] {
            let found = on_mesh.colour(place(triangle, x, y));
            assert_eq!(found, board.colour(Vec2::new(u, v)));
        }
    }
}
