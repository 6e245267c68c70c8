//! Triangles that share vertices.

use glam::Vec3A;

use super::mesh::MeshData;
use super::{Derivatives, ShapeHit, ShapeModel, SurfacePoint};
use crate::accel::{Geometry, IndexBuffer, VertexBuffer};
use crate::math::distribution::Discrete;
use crate::math::{AreaDensity, Vec2, Vec3, warp};

/// A triangle mesh whose vertex and index buffers the tracer shares.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: VertexBuffer,
    triangles: IndexBuffer,
    normals: Option<Vec<Vec3>>,
    uvs: Option<Vec<Vec2>>,
    /// Chooses a triangle by area; only meshes that emit have one.
    by_area: Option<Discrete>,
    area: f64,
    /// Density of a point that is uniform on the mesh.
    density: AreaDensity,
    /// Whether points know how they change with the texture coordinates.
    derivatives: bool,
}

impl TriangleMesh {
    /// Makes a mesh.
    ///
    /// - `normals`, `uvs`: one a vertex, where the mesh has them; normals of any length.
    ///
    /// Indices must lie within `vertices` (the reader has checked them).
    pub fn new(
        vertices: VertexBuffer,
        triangles: IndexBuffer,
        normals: Option<Vec<Vec3>>,
        uvs: Option<Vec<Vec2>>,
    ) -> Self {
        let mut mesh = Self {
            vertices,
            triangles,
            normals,
            uvs,
            by_area: None,
            area: 0.0,
            density: AreaDensity::default(),
            derivatives: false,
        };
        mesh.area = mesh.triangle_areas().sum();
        mesh.density = AreaDensity((1.0 / mesh.area) as f32);
        mesh
    }

    /// The vertex positions, in world space.
    pub fn vertices(&self) -> &VertexBuffer {
        &self.vertices
    }

    /// The triangles' vertex indices.
    pub fn triangles(&self) -> &IndexBuffer {
        &self.triangles
    }

    /// Makes points know how they change with the texture coordinates, as anisotropic materials and
    /// bumps need; shading frames then follow the coordinates.
    pub fn follow_coordinates(&mut self) {
        self.derivatives = true;
    }

    fn triangle_areas(&self) -> impl Iterator<Item = f64> + '_ {
        self.triangles.as_slice().iter().map(|triangle| {
            let [a, b, c] = self.corners(*triangle).map(|p| p.as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        })
    }

    #[inline]
    fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        let vertices = self.vertices.as_slice();
        triangle.map(|i| Vec3::from_array(vertices[i as usize]))
    }

    /// The point of a triangle at the barycentrics of its second and third vertex.
    #[inline(always)]
    fn point(&self, primitive: u32, barycentrics: Vec2) -> SurfacePoint {
        let triangle = self.triangles.as_slice()[primitive as usize];
        let [a, b, c] = self.corners(triangle).map(Vec3A::from);
        let (b1, b2) = (barycentrics.x, barycentrics.y);
        let (to_b, to_c) = (b - a, c - a);
        let mut position = a + to_b * b1 + to_c * b2;
        let extent = a.abs().max(b.abs()).max(c.abs()).max_element();
        let error = SurfacePoint::error_bound(extent);
        let across = to_b.cross(to_c);
        let step = step_from_edges(b1.min(b2).min(1.0 - b1 - b2), [to_b, to_c, across], error);
        if step > 0.0 {
            let middle = a + (to_b + to_c) * (1.0 / 3.0);
            position += (middle - position) * step;
        }
        let (to_b, to_c) = (Vec3::from(to_b), Vec3::from(to_c));
        let mut geometric_normal = unit_or(across.into(), Vec3::Z);
        let mut shading_normal = geometric_normal;
        if let Some(normals) = &self.normals {
            let [na, nb, nc] = triangle.map(|i| normals[i as usize]);
            let interpolated = na * (1.0 - b1 - b2) + nb * b1 + nc * b2;
            shading_normal = unit_or(interpolated, geometric_normal);
            // The file's normals say which side is the front, whatever the winding.
            if shading_normal.dot(geometric_normal) < 0.0 {
                geometric_normal = -geometric_normal;
            }
        }
        let uv = match &self.uvs {
            Some(uvs) => {
                let [ua, ub, uc] = triangle.map(|i| uvs[i as usize]);
                ua * (1.0 - b1 - b2) + ub * b1 + uc * b2
            }
            None => barycentrics,
        };
        let derivatives = if self.derivatives {
            let [by_u, by_v] = self.derivatives(triangle, to_b, to_c);
            Derivatives::new(shading_normal, by_u, by_v)
        } else {
            Derivatives::NONE
        };
        SurfacePoint {
            position: position.into(),
            geometric_normal,
            shading_normal,
            derivatives,
            uv,
            error,
        }
    }

    /// ∂p/∂u and ∂p/∂v; zero where the texture coordinates do not span the plane.
    fn derivatives(&self, triangle: [u32; 3], to_b: Vec3, to_c: Vec3) -> [Vec3; 2] {
        let Some(uvs) = &self.uvs else {
            return [to_b, to_c];
        };
        let [ua, ub, uc] = triangle.map(|i| uvs[i as usize]);
        let (du, dv) = (ub - ua, uc - ua);
        let determinant = du.x * dv.y - du.y * dv.x;
        if determinant == 0.0 {
            return [Vec3::ZERO; 2];
        }
        [to_b * dv.y - to_c * du.y, to_c * du.x - to_b * dv.x].map(|d| d / determinant)
    }
}

/// How far, as a share of the way to its middle, a point of a triangle must move so that rounding
/// cannot have put it beyond an edge, and so behind the wall that stands there; mostly zero.
///
/// - `least`: smallest of the point's three barycentrics.
/// - `spans`: the edges from the first corner, and their cross product.
/// - `error`: bound on the error of the point's position, in metres.
#[inline]
fn step_from_edges(least: f32, spans: [Vec3A; 3], error: f32) -> f32 {
    let [to_b, to_c, across] = spans;
    // Distances from edges are barycentrics times heights, and heights are at least the cross
    // product's length over the longest edge.
    let needed = 2.0 * error * to_b.abs().max(to_c.abs()).element_sum();
    let squared = across.length_squared();
    if least * least * squared >= needed * needed {
        return 0.0;
    }
    // All of the middle's barycentrics are a third.
    (3.0 * needed / squared.sqrt()).min(1.0)
}

impl From<MeshData> for TriangleMesh {
    /// Hands the buffers over; the mesh must have passed [`MeshData::validate`].
    fn from(mesh: MeshData) -> Self {
        let normals = mesh.normals.map(vectors);
        let uvs = mesh
            .uvs
            .map(|uvs| uvs.into_iter().map(Vec2::from_array).collect());
        let vertices = VertexBuffer::new(mesh.positions);
        Self::new(vertices, IndexBuffer::new(mesh.indices), normals, uvs)
    }
}

fn vectors(arrays: Vec<[f32; 3]>) -> Vec<Vec3> {
    arrays.into_iter().map(Vec3::from_array).collect()
}

impl ShapeModel for TriangleMesh {
    fn geometry(&self) -> Geometry {
        Geometry::Triangles(self.vertices.clone(), self.triangles.clone())
    }

    fn prepare_sampling(&mut self) -> bool {
        let areas: Vec<f64> = self.triangle_areas().collect();
        self.by_area = Discrete::new(&areas);
        self.by_area.is_some()
    }

    #[inline]
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
        self.point(hit.primitive, hit.barycentrics)
    }

    fn area(&self) -> f64 {
        self.area
    }

    #[inline(always)]
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
        let choice = self.by_area.as_ref().map(|by_area| by_area.sample(u.x));
        let (primitive, u) = match choice {
            Some(choice) => (choice.index as u32, Vec2::new(choice.remainder, u.y)),
            None => (0, u),
        };
        let point = self.point(primitive, warp::uniform_triangle(u));
        (point, self.density)
    }
}

/// A vector scaled to unit length; `fallback` where it has none.
#[inline]
fn unit_or(vector: Vec3, fallback: Vec3) -> Vec3 {
    let length_squared = vector.length_squared();
    if length_squared > 0.0 {
        vector * (1.0 / length_squared.sqrt())
    } else {
        fallback
    }
}
