//! Points of four triangles at once.

use super::{Facet, TriangleMesh};
use crate::accel::RayLanes;
use crate::math::lanes::{LANES, Lanes, Vec3Lanes, each, gather, uniform_triangle};
use crate::math::{AreaDensity, Vec2, Vec3};

/// A triangle of a mesh, as far as points on it must look it up.
#[derive(Clone, Debug)]
pub struct Triangle {
    facet: Facet,
    /// Whether the mesh has normals to interpolate.
    is_smooth: bool,
    /// Normals of the corners; zero where it has none.
    normals: [Vec3; 3],
}

/// A point on a surface in each lane: what [`SurfacePoint`](crate::shape::SurfacePoint) has for one,
/// without texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceLanes {
    /// World-space positions.
    pub position: Vec3Lanes,
    /// Unit normals of the true geometry.
    pub geometric_normal: Vec3Lanes,
    /// Unit normals of the shaded surface.
    pub shading_normal: Vec3Lanes,
    /// Bounds on the errors of the positions, in m.
    pub error: Lanes,
}

impl TriangleMesh {
    /// Whether points have no derivatives, so that [`SurfaceLanes`] says all about them but their texture
    /// coordinates.
    #[inline(always)]
    pub fn is_plain(&self) -> bool {
        !self.derivatives
    }

    /// Looks a triangle up.
    #[inline(always)]
    pub fn triangle(&self, primitive: u32) -> Triangle {
        let facet = self.facets.get(primitive as usize);
        let normals = self.normals.as_ref().map_or([Vec3::ZERO; 3], |normals| {
            self.triangles.as_slice()[primitive as usize].map(|i| normals[i as usize])
        });
        Triangle {
            facet: facet.map_or_else(|| self.unprepared_facet(primitive), Facet::clone),
            is_smooth: self.normals.is_some(),
            normals,
        }
    }

    #[inline(never)]
    fn unprepared_facet(&self, primitive: u32) -> Facet {
        Facet::new(self.corners(self.triangles.as_slice()[primitive as usize]))
    }

    /// As [`ShapeModel::sample_area`](crate::shape::ShapeModel::sample_area), with numbers for each lane.
    #[inline(always)]
    pub fn sample_areas(&self, u: [Vec2; LANES]) -> (SurfaceLanes, AreaDensity) {
        let chosen = each(|lane| self.choose_triangle(u[lane]));
        let triangles = each(|lane| self.triangle(chosen[lane].0));
        let u = [
            gather(|lane| chosen[lane].1.x),
            gather(|lane| chosen[lane].1.y),
        ];
        let points = SurfaceLanes::at(triangles.each_ref(), uniform_triangle(u));
        (points, self.density)
    }
}

impl SurfaceLanes {
    /// The points of triangles at the barycentrics of their second and third corners.
    #[inline(always)]
    pub fn at(triangles: [&Triangle; LANES], [b1, b2]: [Lanes; 2]) -> Self {
        let facets = each(|lane| &triangles[lane].facet);
        let (corner, error) = Vec3Lanes::of_rows(each(|lane| facets[lane].corner_and_error));
        let (to_b, least) = Vec3Lanes::of_rows(each(|lane| facets[lane].to_b_and_least));
        let (to_c, _) = Vec3Lanes::of_rows(each(|lane| facets[lane].to_c));
        let (normal, _) = Vec3Lanes::of_rows(each(|lane| facets[lane].normal));
        let b0 = Lanes::ONE - b1 - b2;

        let mut position = corner + to_b * b1 + to_c * b2;
        let is_near_edge = b1.min(b2).min(b0).cmplt(least);
        if is_near_edge.any() {
            let middle = corner + (to_b + to_c) * Lanes::splat(1.0 / 3.0);
            let inward = (3.0 * least).min(Lanes::ONE);
            let moved = position + (middle - position) * inward;
            position = Vec3Lanes::select(is_near_edge, moved, position);
        }

        let (mut shading_normal, mut geometric_normal) = (normal, normal);
        if triangles.iter().any(|triangle| triangle.is_smooth) {
            let of_corner = |i: usize| Vec3Lanes::gather(|lane| triangles[lane].normals[i]);
            let interpolated = of_corner(0) * b0 + of_corner(1) * b1 + of_corner(2) * b2;
            shading_normal = unit_or(interpolated, normal);
            let is_turned = shading_normal.dot(normal).cmplt(Lanes::ZERO);
            geometric_normal = Vec3Lanes::select(is_turned, -normal, normal);
        }
        Self {
            position,
            geometric_normal,
            shading_normal,
            error,
        }
    }

    /// As [`SurfacePoint::ray_origin`](crate::shape::SurfacePoint::ray_origin).
    #[inline(always)]
    pub fn ray_origin(&self, direction: Vec3Lanes) -> Vec3Lanes {
        let side = self.error.copysign(self.geometric_normal.dot(direction));
        self.position + self.geometric_normal * side
    }

    /// As [`SurfacePoint::ray_toward`](crate::shape::SurfacePoint::ray_toward).
    #[inline(always)]
    pub fn rays_toward(&self, direction: Vec3Lanes) -> RayLanes {
        RayLanes {
            origin: self.ray_origin(direction),
            direction,
            far: Lanes::INFINITY,
        }
    }

    /// As [`SurfacePoint::ray_to`](crate::shape::SurfacePoint::ray_to).
    #[inline(always)]
    pub fn rays_to(&self, target: Vec3Lanes) -> RayLanes {
        let origin = self.ray_origin(target - self.position);
        RayLanes {
            origin,
            direction: target - origin,
            far: Lanes::ONE,
        }
    }
}

/// As [`facet::unit_or`](super::facet::unit_or).
#[inline(always)]
fn unit_or(vector: Vec3Lanes, fallback: Vec3Lanes) -> Vec3Lanes {
    let length_squared = vector.length_squared();
    let unit = vector * (Lanes::ONE / length_squared.sqrt());
    Vec3Lanes::select(length_squared.cmpgt(Lanes::ZERO), unit, fallback)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Mat4;
    use crate::shape::mesh::MeshData;
    use crate::shape::{ShapeModel, SurfacePoint, primitives};

    fn bits(v: Vec3) -> [u32; 3] {
        v.to_array().map(f32::to_bits)
    }

    fn assert_same(lanes: &SurfaceLanes, points: &[SurfacePoint; LANES]) {
        for (lane, point) in points.iter().enumerate() {
            let position = lanes.position.vectors()[lane];
            assert_eq!(bits(position), bits(point.position), "{point:?}");
            let normal = lanes.geometric_normal.vectors()[lane];
            assert_eq!(bits(normal), bits(point.geometric_normal), "{point:?}");
            let normal = lanes.shading_normal.vectors()[lane];
            assert_eq!(bits(normal), bits(point.shading_normal), "{point:?}");
            assert_eq!(lanes.error[lane].to_bits(), point.error.to_bits());
        }
        let [out, aside] = [Vec3::new(0.3, -0.5, 0.2), Vec3::new(-40.0, 2.0, 0.1)];
        let ways = lanes.rays_toward(Vec3Lanes::splat(out)).rays();
        let ends = lanes.rays_to(Vec3Lanes::splat(aside)).rays();
        for (lane, point) in points.iter().enumerate() {
            assert_eq!(ways[lane], point.ray_toward(out));
            assert_eq!(ends[lane], point.ray_to(aside));
        }
    }

    /// A flat cube, one that never had normals, one whose normals point in, one with slanted normals, each with and without prepared
    /// points.
    fn meshes() -> Vec<TriangleMesh> {
        let mut placed = primitives::cube();
        placed.transform(Mat4::from_rotation_x(0.7) * Mat4::from_scale(Vec3::new(3.0, 0.1, 7.0)));
        let mut bare = placed.clone();
        bare.remove_normals();
        let mut inside_out = placed.clone();
        for normal in inside_out.normals.iter_mut().flatten() {
            *normal = normal.map(|c| -c);
        }
        let mut slanted = placed.clone();
        for (index, normal) in slanted.normals.iter_mut().flatten().enumerate() {
            normal[index % 3] += 0.4;
        }
        let prepared = |data: &MeshData, most: usize| {
            let mut mesh = TriangleMesh::from(data.clone());
            mesh.prepare_points(most);
            mesh.prepare_sampling();
            mesh
        };
        [placed, bare, inside_out, slanted]
            .iter()
            .flat_map(|data| [prepared(data, 0), prepared(data, 100)])
            .collect()
    }

    #[test]
    fn four_points_are_the_points_alone_to_the_bit() {
        // The middle, corners, edges, and so near to an edge that the point is moved.
        let numbers = [0.0, 1e-7, 0.25, 1.0 / 3.0, 0.5, 0.999_999, 1.0];
        let places: Vec<Vec2> = numbers
            .iter()
            .flat_map(|x| numbers.map(|y| Vec2::new(*x, y * (1.0 - x))))
            .collect();
        for mesh in meshes() {
            for (index, places) in places.windows(LANES).enumerate() {
                let primitives = each(|lane| ((index * 5 + lane * 7) % 12) as u32);
                let triangles = primitives.map(|primitive| mesh.triangle(primitive));
                let barycentrics = [gather(|lane| places[lane].x), gather(|lane| places[lane].y)];
                let lanes = SurfaceLanes::at(triangles.each_ref(), barycentrics);
                let points = each(|lane| mesh.point(primitives[lane], places[lane]));
                assert_same(&lanes, &points);
                let (lanes, density) = mesh.sample_areas(each(|lane| places[lane]));
                let alone = each(|lane| mesh.sample_area(places[lane]));
                assert_same(&lanes, &alone.map(|(point, _)| point));
                assert!(alone.iter().all(|(_, alone)| *alone == density));
            }
        }
    }
}
