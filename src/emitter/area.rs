//! A surface that glows.

use std::f64::consts::PI;
use std::sync::Arc;

use super::emission::{from_surface_density, invert_from_surface};
use super::{EmissionDensity, EmittedRay, EmitterClass, EmitterModel, EmitterSample, RayOfLight};
use crate::math::{AreaDensity, Mat3, Mat4, Rgb, SolidAngleDensity, Vec2, Vec3};
use crate::shape::{Disk, Shape, ShapeModel, Sphere, SurfacePoint, TriangleMesh, primitives};
use crate::texture::{Checkerboard, Texture, TextureModel};

/// Emits from the front of a shape, equally into all directions.
#[derive(Clone, Debug)]
pub struct Area {
    shape: Arc<Shape>,
    radiance: Texture,
    /// Middle of the shape, and the mean squared distance of its points from there.
    centre: Vec3,
    spread: f32,
    /// Radiant intensity of the shape seen face on from afar, as luminance in W·sr⁻¹.
    intensity: f32,
}

/// A mesh that emits one radiance from all of its front.
#[derive(Clone, Copy, Debug)]
pub struct MeshLight<'s> {
    /// The mesh.
    pub mesh: &'s TriangleMesh,
    /// Emitted radiance in W·m⁻²·sr⁻¹.
    pub radiance: Rgb,
}

impl Area {
    /// Makes the light.
    ///
    /// - `shape`: prepared for sampling.
    /// - `radiance`: emitted radiance in W·m⁻²·sr⁻¹.
    pub fn new(shape: Arc<Shape>, radiance: impl Into<Texture>) -> Self {
        let (centre, spread) = middle(&shape);
        let radiance = radiance.into();
        let intensity = shape.area() as f32 * radiance.mean().luminance();
        Self {
            shape,
            radiance,
            centre,
            spread,
            intensity,
        }
    }

    /// The light as a mesh of one radiance, if it is that.
    #[inline]
    pub fn as_mesh(&self) -> Option<MeshLight<'_>> {
        let Shape::TriangleMesh(mesh) = &*self.shape else {
            return None;
        };
        Some(MeshLight {
            mesh,
            radiance: self.radiance.sole_colour()?,
        })
    }

    /// The shape that glows.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }
}

impl Area {
    /// As [`Emitter::sample_toward_then`](super::Emitter::sample_toward_then).
    #[inline(always)]
    pub(super) fn sample_toward_then<R>(
        &self,
        from: Vec3,
        u: Vec2,
        then: impl FnOnce(EmitterSample) -> R,
    ) -> Option<R> {
        if let Shape::TriangleMesh(mesh) = &*self.shape {
            let (point, density) = mesh.sample_toward(from, u)?;
            self.seen(from, point, density).map(then)
        } else {
            self.sample_toward_apart(from, u).map(then)
        }
    }

    /// Out of line: paths have the code of triangles alone right where they need it.
    #[inline(never)]
    fn sample_toward_apart(&self, from: Vec3, u: Vec2) -> Option<EmitterSample> {
        let (point, density) = self.shape.sample_toward(from, u)?;
        self.seen(from, point, density)
    }

    /// The sample of a point of the shape; `None` where it shows its back.
    #[inline(always)]
    fn seen(
        &self,
        from: Vec3,
        point: SurfacePoint,
        density: SolidAngleDensity,
    ) -> Option<EmitterSample> {
        let edge = point.position - from;
        // Before anything that costs more: half of all directions meet the back.
        if point.geometric_normal.dot(edge) >= 0.0 {
            return None;
        }
        let direction = edge * (1.0 / edge.length());
        let radiance = self.radiance.colour(point.uv);
        let target = Some(point.ray_origin(-direction));
        Some(EmitterSample {
            direction,
            target,
            radiance,
            density,
            is_dirac: false,
            surface: Some(point),
        })
    }
}

/// Middle of a shape and the mean squared distance of its points from there, from a few of them.
fn middle(shape: &Shape) -> (Vec3, f32) {
    const SIDE: u32 = 8;
    let points: Vec<Vec3> = (0..SIDE * SIDE)
        .map(|i| (Vec2::new((i % SIDE) as f32, (i / SIDE) as f32) + 0.5) / SIDE as f32)
        .map(|u| shape.sample_area(u).0.position)
        .collect();
    let count = points.len() as f32;
    let centre = points.iter().sum::<Vec3>() / count;
    let spread = points
        .iter()
        .map(|p| p.distance_squared(centre))
        .sum::<f32>()
        / count;
    (centre, spread)
}

impl EmitterModel for Area {
    fn examples() -> Vec<Self> {
        let place = Mat4::from_translation(Vec3::new(0.1, 0.3, 0.2)) * Mat4::from_rotation_y(0.5);
        let squares = Checkerboard::new(
            [Rgb::new(3.0, 1.0, 0.5), Rgb::new(0.5, 2.0, 4.0)],
            Mat3::IDENTITY,
        );
        let mut data = primitives::rectangle();
        data.transform(place);
        let mut rectangle = TriangleMesh::from(data);
        rectangle.prepare_sampling();
        let mut examples = vec![Self::new(Arc::new(rectangle.into()), squares)];
        if let Ok(sphere) = Sphere::new(Vec3::ZERO, 0.6, place) {
            examples.push(Self::new(Arc::new(sphere.into()), Rgb::new(1.0, 2.0, 3.0)));
        }
        if let Ok(disk) = Disk::new(place) {
            examples.push(Self::new(Arc::new(disk.into()), 2.0));
        }
        examples
    }

    fn class(&self) -> EmitterClass {
        EmitterClass::Area
    }

    fn power(&self) -> f64 {
        PI * f64::from(self.intensity)
    }

    #[inline]
    fn influence(&self, from: Vec3) -> f32 {
        let distance_squared = self.centre.distance_squared(from) + self.spread;
        self.intensity / distance_squared.max(1e-20)
    }

    #[inline]
    fn radiance(&self, at: &SurfacePoint, direction: Vec3) -> Rgb {
        if at.geometric_normal.dot(direction) <= 0.0 {
            return Rgb::BLACK;
        }
        self.radiance.colour(at.uv)
    }

    #[inline(always)]
    fn sample_toward(&self, from: Vec3, u: Vec2) -> Option<EmitterSample> {
        self.sample_toward_then(from, u, |sample| sample)
    }

    #[inline]
    fn density_toward(&self, from: Vec3, at: &SurfacePoint) -> SolidAngleDensity {
        self.shape.density_toward(from, at)
    }

    /// Points are uniform by area, whatever the texture.
    #[inline]
    fn sample_emission(&self, u_point: Vec2, u_direction: Vec2) -> Option<EmittedRay> {
        let (point, density) = self.shape.sample_area(u_point);
        let radiance = self.radiance.colour(point.uv);
        let ray = EmittedRay::from_surface(point, density, radiance, u_direction);
        Some(ray)
    }

    #[inline]
    fn emission_density(&self, at: Option<&SurfacePoint>, direction: Vec3) -> EmissionDensity {
        EmissionDensity {
            point: AreaDensity((1.0 / self.shape.area()) as f32),
            direction: at.map_or(SolidAngleDensity::ZERO, |at| {
                from_surface_density(at, direction)
            }),
        }
    }

    fn invert_toward(
        &self,
        from: Vec3,
        _toward: Vec3,
        at: Option<&SurfacePoint>,
        _spare: Vec2,
    ) -> Option<Vec2> {
        self.shape.invert_toward(from, at?)
    }

    fn invert_emission(
        &self,
        at: Option<&SurfacePoint>,
        ray: RayOfLight,
        _spare: [Vec2; 2],
    ) -> Option<[Vec2; 2]> {
        let direction = invert_from_surface(at?, ray.direction)?;
        Some([self.shape.invert_area(at?)?, direction])
    }
}
