//! Where an instance stands.

use glam::{DMat3, DVec3};

use super::affine::{axes_and_origin, rows};
use super::{Derivatives, ShapeError, ShapeHit, SurfacePoint};
use crate::math::{Mat4, Vec3};

/// An affine map that places shapes in the world: it may stretch, shear and mirror.
///
/// There can be millions, so that nothing is kept that a hit can work out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Images of the three axes.
    axes: [Vec3; 3],
    /// Image of the origin.
    origin: Vec3,
}

impl Placement {
    /// Makes the placement.
    ///
    /// # Errors
    /// [`ShapeError::Flat`] where `to_world` has no inverse, [`ShapeError::NotFinite`].
    pub fn new(to_world: Mat4) -> Result<Self, ShapeError> {
        let ([x, y, z], origin) = axes_and_origin(to_world)?;
        let inverse = DMat3::from_cols(x, y, z).inverse();
        if !inverse.is_finite() {
            return Err(ShapeError::Flat);
        }
        Ok(Self {
            axes: [x, y, z].map(|axis| axis.as_vec3()),
            origin: origin.as_vec3(),
        })
    }

    /// The map, by rows, as the tracer takes it.
    pub fn to_world(&self) -> [[f32; 4]; 3] {
        rows(self.axes, self.origin)
    }

    /// A hit in the space of the shapes.
    #[inline]
    pub fn to_object(&self, hit: &ShapeHit) -> ShapeHit {
        let inverse = self.linear().inverse();
        let from_origin = hit.position.as_dvec3() - self.origin.as_dvec3();
        ShapeHit {
            position: (inverse * from_origin).as_vec3(),
            ..*hit
        }
    }

    /// A point of a shape, in the world.
    ///
    /// Normals go by the inverse transpose and stay on their side where the map mirrors.
    #[inline(never)]
    pub fn place(&self, point: &SurfacePoint) -> SurfacePoint {
        let linear = self.linear();
        let inverse = linear.inverse();
        let normal = |n: Vec3| (inverse.transpose() * n.as_dvec3()).normalize();
        let mut geometric_normal = normal(point.geometric_normal);
        let shading_normal = normal(point.shading_normal).as_vec3();
        let origin = self.origin.as_dvec3();
        let position = linear * point.position.as_dvec3() + origin;
        let error = self.error(point, position, geometric_normal, &inverse);
        // As for meshes: shading normals say which side is the front.
        if geometric_normal.dot(shading_normal.as_dvec3()) < 0.0 {
            geometric_normal = -geometric_normal;
        }
        let derivatives = point.derivatives.in_surface(point);
        let derivatives = derivatives.map_or(Derivatives::NONE, |derivatives| {
            let [by_u, by_v] = derivatives.map(|d| (linear * d.as_dvec3()).as_vec3());
            Derivatives::new(shading_normal, by_u, by_v)
        });
        SurfacePoint {
            position: position.as_vec3(),
            geometric_normal: geometric_normal.as_vec3(),
            shading_normal,
            derivatives,
            uv: point.uv,
            error,
        }
    }

    #[inline]
    fn linear(&self) -> DMat3 {
        let [x, y, z] = self.axes.map(Vec3::as_dvec3);
        DMat3::from_cols(x, y, z)
    }

    /// Bound on the distance between a placed point and where the tracer sees its surface, in m.
    ///
    /// To the point's own error, which the map stretches across the surface, comes that of the
    /// tracer: it takes rays into the shapes' space, where a coordinate errs with the size of the
    /// products that it is the sum of. Across the surface, the errors of the three coordinates
    /// count as far as the normal leans towards the images of their axes.
    #[inline]
    fn error(&self, point: &SurfacePoint, position: DVec3, normal: DVec3, inverse: &DMat3) -> f32 {
        let leaning = self.linear().transpose() * normal;
        let size = position.abs() + self.origin.as_dvec3().abs();
        let products = inverse.abs() * size;
        let own = leaning.length() * f64::from(point.error);
        own as f32 + SurfacePoint::error_bound(leaning.abs().dot(products) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::shape::mesh::MeshData;
    use crate::shape::{ShapeModel, TriangleMesh, primitives};

    fn maps() -> [Mat4; 4] {
        let turn = Mat4::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 0.9);
        let away = Mat4::from_translation(Vec3::new(3.0, -2.0, 0.5));
        let stretch = Mat4::from_scale(Vec3::new(2.0, 0.3, 1.0));
        let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        [
            turn,
            away * turn * stretch,
            away * stretch * turn,
            away * mirror * stretch,
        ]
    }

    /// A mesh with smooth normals and crooked texture coordinates.
    fn crooked() -> MeshData {
        let mut data = primitives::cube();
        for uv in data.uvs.iter_mut().flatten() {
            *uv = [uv[0] + 0.3 * uv[1], uv[1] * 0.5];
        }
        data.normals = Some(
            data.positions
                .iter()
                .map(|p| Vec3::from_array(*p).normalize().to_array())
                .collect(),
        );
        data
    }

    fn mesh(data: MeshData) -> TriangleMesh {
        let mut mesh = TriangleMesh::from(data);
        mesh.follow_coordinates();
        mesh
    }

    #[test]
    fn placed_points_are_those_of_the_mesh_that_was_moved() {
        let corner = ShapeHit {
            primitive: 3,
            // Right at a vertex both have the file's normal there, and points keep off the edges.
            barycentrics: Vec2::new(1.0, 0.0),
            position: Vec3::ZERO,
        };
        let placed_mesh = mesh(crooked());
        for to_world in maps() {
            let mut data = crooked();
            data.transform(to_world);
            let moved = mesh(data);
            let found = Placement::new(to_world)
                .unwrap()
                .place(&placed_mesh.surface_at(&corner));
            let expected = moved.surface_at(&corner);
            let near = |a: Vec3, b: Vec3| a.distance(b) < 2e-4;
            assert!(near(found.position, expected.position), "{to_world}");
            assert!(near(found.geometric_normal, expected.geometric_normal));
            assert!(near(found.shading_normal, expected.shading_normal));
            assert_eq!(found.uv, expected.uv);
            for by_uv in [Vec2::X, Vec2::Y] {
                let (a, b) = (found.gradient(by_uv), expected.gradient(by_uv));
                assert!(a.unwrap().distance(b.unwrap()) < 1e-4, "{a:?}, not {b:?}");
            }
            let frame = (found.shading_frame(), expected.shading_frame());
            assert!(frame.0.tangent.distance(frame.1.tangent) < 1e-5);
        }
    }

    #[test]
    fn hits_come_back_into_the_space_of_the_shapes() {
        for to_world in maps() {
            let position = Vec3::new(0.3, -0.8, 0.2);
            let hit = ShapeHit {
                primitive: 0,
                barycentrics: Vec2::ZERO,
                position: to_world.transform_point3(position),
            };
            let back = Placement::new(to_world).unwrap().to_object(&hit);
            assert!(back.position.distance(position) < 1e-5, "{}", back.position);
        }
    }

    #[test]
    fn maps_without_an_inverse_are_refused() {
        let flat = Mat4::from_scale(Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(Placement::new(flat), Err(ShapeError::Flat));
        let infinite = Mat4::from_scale(Vec3::splat(f32::INFINITY));
        assert_eq!(Placement::new(infinite), Err(ShapeError::NotFinite));
    }
}
