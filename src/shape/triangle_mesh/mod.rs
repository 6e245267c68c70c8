//! Triangles that share vertices.

mod facet;
mod lanes;
#[cfg(test)]
mod tests;

pub use lanes::{SurfaceLanes, Triangle};

use facet::{Facet, unit_or};

use super::mesh::MeshData;
use super::{Derivatives, ShapeHit, ShapeMemory, ShapeModel, SurfacePoint};
use crate::accel::{Geometry, IndexBuffer, VertexBuffer};
use crate::math::distribution::Discrete;
use crate::math::{AreaDensity, TriangleChart, Vec2, Vec3, warp};

/// Meshes of up to so many triangles can keep what the points of each triangle share: 64 bytes a
/// triangle, about as much as the tracer itself takes. Larger ones work it out anew for each point.
const PREPARED: usize = 1 << 16;

/// Normals that differ by less from a triangle's own are that, but for rounding.
const FLAT: f32 = 1e-6;

/// A triangle mesh whose vertex and index buffers the tracer shares.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: VertexBuffer,
    triangles: IndexBuffer,
    /// One a triangle, or none.
    facets: Vec<Facet>,
    normals: Option<Vec<Vec3>>,
    uvs: Option<Vec<Vec2>>,
    /// Whether points know their coordinates, and not their barycentrics in their place.
    coordinates: bool,
    /// Chooses a triangle by area; only meshes that emit have one.
    by_area: Option<Discrete>,
    area: f64,
    /// Density of a point that is uniform on the mesh.
    density: AreaDensity,
    /// Whether points know how they change with the texture coordinates.
    derivatives: bool,
    /// Where points get their coordinates from instead of `uvs`.
    chart: Option<TriangleChart>,
}

impl TriangleMesh {
    /// Makes a mesh.
    ///
    /// - `normals`, `uvs`: one a vertex, where the mesh has them; normals of any length. Those of flat
    ///   meshes are not kept.
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
            facets: Vec::new(),
            normals: None,
            uvs,
            coordinates: true,
            by_area: None,
            area: 0.0,
            density: AreaDensity::default(),
            derivatives: false,
            chart: None,
        };
        mesh.normals = normals.filter(|normals| !mesh.is_flat(normals));
        mesh.area = mesh.triangle_areas().sum();
        mesh.density = AreaDensity((1.0 / mesh.area) as f32);
        mesh
    }

    /// Whether normals are those of the triangles, so that there is nothing to interpolate: a rectangle, a
    /// cube, a wall.
    fn is_flat(&self, normals: &[Vec3]) -> bool {
        self.triangles.as_slice().iter().all(|triangle| {
            let normal = Facet::new(self.corners(*triangle)).normal.truncate();
            triangle.iter().all(|i| {
                let difference = unit_or(normals[*i as usize], Vec3::ZERO) - normal;
                difference.length_squared() <= FLAT * FLAT
            })
        })
    }

    /// Keeps what the points of each triangle share, for speed; the points stay the same.
    ///
    /// - `most`: for how many triangles there is room.
    ///
    /// Returns how many are prepared: all or none.
    pub fn prepare_points(&mut self, most: usize) -> usize {
        let triangles = self.triangles.as_slice();
        if triangles.len() <= most.min(PREPARED) {
            self.facets = triangles
                .iter()
                .map(|triangle| Facet::new(self.corners(*triangle)))
                .collect();
        }
        self.facets.len()
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

    /// Leaves the coordinates out of points, for speed: where neither the material nor the light there asks for
    /// them. [`ShapeModel::coordinates`] still knows them.
    pub fn omit_coordinates(&mut self) {
        self.coordinates = false;
    }

    /// Gives points the places of a [`TriangleChart`] as their coordinates, for textures that ask
    /// where on the mesh they are; derivatives stay those by the texture coordinates.
    pub fn use_chart(&mut self) {
        self.chart = Some(TriangleChart::new(self.triangles.as_slice().len()));
    }

    /// The texture coordinates, one a vertex.
    pub fn uvs(&self) -> Option<&[Vec2]> {
        self.uvs.as_deref()
    }

    fn triangle_areas(&self) -> impl Iterator<Item = f64> + '_ {
        self.triangles.as_slice().iter().map(|triangle| {
            let [a, b, c] = self.corners(*triangle).map(|p| p.as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        })
    }

    /// Chooses a triangle by area; returns what is left of the numbers, too.
    #[inline(always)]
    fn choose_triangle(&self, u: Vec2) -> (u32, Vec2) {
        match self.by_area.as_ref().map(|by_area| by_area.sample(u.x)) {
            Some(choice) => (choice.index as u32, Vec2::new(choice.remainder, u.y)),
            None => (0, u),
        }
    }

    #[inline]
    fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        let vertices = self.vertices.as_slice();
        triangle.map(|i| Vec3::from_array(vertices[i as usize]))
    }

    /// The point of a triangle at the barycentrics of its second and third vertex.
    #[inline(always)]
    fn point(&self, primitive: u32, barycentrics: Vec2) -> SurfacePoint {
        let mut point = SurfacePoint::bare(Vec3::ZERO);
        self.put_point(primitive, barycentrics, &mut point);
        point
    }

    /// The point of a triangle at the barycentrics of its second and third vertex, put in its place.
    ///
    /// - `point`: becomes it.
    #[inline(always)]
    pub fn put_point(&self, primitive: u32, barycentrics: Vec2, point: &mut SurfacePoint) {
        match self.facets.get(primitive as usize) {
            Some(facet) => *point = self.point_of(facet, primitive, barycentrics),
            None => *point = self.unprepared_point(primitive, barycentrics),
        }
    }

    /// [`TriangleMesh::point`] for large meshes.
    #[inline(never)]
    fn unprepared_point(&self, primitive: u32, barycentrics: Vec2) -> SurfacePoint {
        let triangle = self.triangles.as_slice()[primitive as usize];
        let facet = Facet::new(self.corners(triangle));
        self.point_of(&facet, primitive, barycentrics)
    }

    #[inline(always)]
    fn point_of(&self, facet: &Facet, primitive: u32, barycentrics: Vec2) -> SurfacePoint {
        let (b1, b2) = (barycentrics.x, barycentrics.y);
        let mut geometric_normal = facet.normal.truncate();
        let mut shading_normal = geometric_normal;
        if let Some(normals) = &self.normals {
            let triangle = self.triangles.as_slice()[primitive as usize];
            let [na, nb, nc] = triangle.map(|i| normals[i as usize]);
            let interpolated = na * (1.0 - b1 - b2) + nb * b1 + nc * b2;
            shading_normal = unit_or(interpolated, geometric_normal);
            // The file's normals say which side is the front, whatever the winding.
            if shading_normal.dot(geometric_normal) < 0.0 {
                geometric_normal = -geometric_normal;
            }
        }
        let derivatives = if self.derivatives {
            let [by_u, by_v] = self.derivatives(facet, primitive);
            Derivatives::new(shading_normal, by_u, by_v)
        } else {
            Derivatives::NONE
        };
        SurfacePoint {
            position: facet.position(b1, b2),
            geometric_normal,
            shading_normal,
            derivatives,
            uv: if self.coordinates {
                self.uv_at(primitive, barycentrics)
            } else {
                barycentrics
            },
            error: facet.error(),
        }
    }

    /// Surface coordinates at the barycentrics of a triangle's second and third vertex.
    #[inline(always)]
    pub fn uv_at(&self, primitive: u32, barycentrics: Vec2) -> Vec2 {
        match &self.uvs {
            _ if self.chart.is_some() => self.place(primitive, barycentrics),
            Some(uvs) => {
                let (b1, b2) = (barycentrics.x, barycentrics.y);
                let triangle = self.triangles.as_slice()[primitive as usize];
                let [ua, ub, uc] = triangle.map(|i| uvs[i as usize]);
                ua * (1.0 - b1 - b2) + ub * b1 + uc * b2
            }
            None => barycentrics,
        }
    }

    /// Barycentrics of the point of a triangle's plane below a position, moved into the triangle.
    fn barycentrics(&self, primitive: u32, position: Vec3) -> Vec2 {
        let [a, b, c] = self.corners(self.triangles.as_slice()[primitive as usize]);
        let [to_b, to_c, offset] = [b, c, position].map(|p| (p - a).as_dvec3());
        let across = to_b.cross(to_c);
        let area = across.length_squared();
        let b1 = offset.cross(to_c).dot(across) / area;
        let b2 = to_b.cross(offset).dot(across) / area;
        let inside = Vec2::new(b1 as f32, b2 as f32).max(Vec2::ZERO);
        inside / inside.element_sum().max(1.0)
    }

    /// The place of a point in the chart.
    #[cold]
    fn place(&self, primitive: u32, barycentrics: Vec2) -> Vec2 {
        let chart = self.chart;
        chart.map_or(barycentrics, |chart| chart.place(primitive, barycentrics))
    }

    /// ∂p/∂u and ∂p/∂v; zero where the texture coordinates do not span the plane.
    #[inline(never)]
    fn derivatives(&self, facet: &Facet, primitive: u32) -> [Vec3; 2] {
        let [to_b, to_c] = facet.edges().map(Vec3::from);
        let Some(uvs) = &self.uvs else {
            return [to_b, to_c];
        };
        let triangle = self.triangles.as_slice()[primitive as usize];
        let [ua, ub, uc] = triangle.map(|i| uvs[i as usize]);
        let (du, dv) = (ub - ua, uc - ua);
        let determinant = du.x * dv.y - du.y * dv.x;
        if determinant == 0.0 {
            return [Vec3::ZERO; 2];
        }
        [to_b * dv.y - to_c * du.y, to_c * du.x - to_b * dv.x].map(|d| d / determinant)
    }
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

    fn memory(&self) -> ShapeMemory {
        let (vertices, triangles) = (self.vertices.as_slice(), self.triangles.as_slice());
        let normals = self.normals.as_deref().map_or(0, size_of_val);
        let uvs = self.uvs.as_deref().map_or(0, size_of_val);
        let by_area = self.by_area.as_ref().map_or(0, Discrete::memory);
        let own = normals + uvs + size_of_val(self.facets.as_slice()) + by_area;
        ShapeMemory {
            shared: (size_of_val(vertices) + size_of_val(triangles)) as u64,
            own: own as u64,
        }
    }

    fn prepare_sampling(&mut self) -> bool {
        let areas: Vec<f64> = self.triangle_areas().collect();
        self.by_area = Discrete::new(&areas);
        self.by_area.is_some()
    }

    fn coordinates(&self, point: &SurfacePoint, primitive: u32) -> Vec2 {
        if self.coordinates {
            point.uv
        } else {
            self.uv_at(primitive, point.uv)
        }
    }

    #[inline(always)]
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
        self.point(hit.primitive, hit.barycentrics)
    }

    fn area(&self) -> f64 {
        self.area
    }

    #[inline(always)]
    fn sample_area(&self, u: Vec2) -> (SurfacePoint, AreaDensity) {
        let (primitive, u) = self.choose_triangle(u);
        let point = self.point(primitive, warp::uniform_triangle(u));
        (point, self.density)
    }

    /// Asks each triangle whether it holds the point: a point does not tell its triangle, and what
    /// emits has few.
    fn invert_area(&self, point: &SurfacePoint) -> Option<Vec2> {
        let by_area = self.by_area.as_ref()?;
        let mut nearest: Option<(f32, u32, Vec2)> = None;
        for primitive in 0..self.triangles.as_slice().len() as u32 {
            let barycentrics = self.barycentrics(primitive, point.position);
            let there = self.point(primitive, barycentrics);
            let distance = there.position.distance_squared(point.position);
            let is_front = there.geometric_normal.dot(point.geometric_normal) > 0.0;
            if is_front && nearest.is_none_or(|(least, ..)| distance < least) {
                nearest = Some((distance, primitive, barycentrics));
            }
        }
        let (_, primitive, barycentrics) = nearest?;
        let u = warp::into_unit_square(warp::uniform_triangle_inverse(barycentrics));
        Some(Vec2::new(by_area.invert(primitive as usize, u.x)?, u.y))
    }
}
