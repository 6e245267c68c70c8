//! Vertices on diffuse meshes, four at a time.
//!
//! Each lane does what [`PathTracer::connect`] and [`PathTracer::depart`] do for one vertex, with the
//! same numbers in the same order: the bits are the same.

use glam::Vec4Swizzles;

use super::Outcome;
use super::aim::Aims;
use crate::accel::{Hit, Ray, RayLanes};
use crate::bsdf::DiffuseLanes;
use crate::integrator::path::{Connection, PathTracer};
use crate::integrator::walk::{Departure, Walk};
use crate::math::lanes::{
    LANES, LaneMask, Lanes, Vec3Lanes, Vec4, each, gather, mask, to_world, transpose,
};
use crate::math::{Rgb, Vec2};
use crate::scene::Scene;
use crate::shape::{Shape, SurfaceLanes, TriangleMesh};

/// A vertex on a mesh that is diffuse, stands in the world and does not glow.
pub(super) struct DiffuseVertex<'s> {
    /// Index of its path.
    walk: u32,
    is_two_sided: bool,
    reflectance: Rgb,
    mesh: &'s TriangleMesh,
    ray: &'s Ray,
    hit: &'s Hit,
    /// For the emitter, and for what is behind.
    numbers: Vec4,
}

impl<'s> DiffuseVertex<'s> {
    /// The vertex where a ray ends; `None` if it is another one.
    #[inline(always)]
    pub(super) fn at(scene: &'s Scene, walk: u32, ray: &'s Ray, hit: &'s Hit) -> Option<Self> {
        if hit.instance.is_some() {
            return None;
        }
        let object = &scene.objects()[hit.geometry as usize];
        let Shape::TriangleMesh(mesh) = &*object.shape else {
            return None;
        };
        if object.emitter.is_some() || !mesh.is_plain() {
            return None;
        }
        let diffuse = object.diffuse?;
        let uv = || mesh.uv_at(hit.primitive, Vec2::new(hit.u, hit.v));
        Some(Self {
            walk,
            is_two_sided: diffuse.is_two_sided,
            reflectance: diffuse.reflectance(|| scene.bsdf(object.bsdf), uv),
            mesh,
            ray,
            hit,
            numbers: Vec4::ZERO,
        })
    }
}

/// A vertex for each lane.
struct Group<'v>([&'v DiffuseVertex<'v>; LANES]);

impl<'v> Group<'v> {
    /// Up to four vertices, and one at least; those that are missing are stood in for by the last.
    #[inline(always)]
    fn new(vertices: &'v [DiffuseVertex<'v>]) -> Self {
        Self(each(|lane| &vertices[lane.min(vertices.len() - 1)]))
    }

    /// The points.
    #[inline(always)]
    fn surfaces(&self) -> SurfaceLanes {
        let triangles = each(|lane| self.0[lane].mesh.triangle(self.0[lane].hit.primitive));
        let barycentrics = [
            gather(|lane| self.0[lane].hit.u),
            gather(|lane| self.0[lane].hit.v),
        ];
        SurfaceLanes::at(triangles.each_ref(), barycentrics)
    }

    /// The materials.
    #[inline(always)]
    fn materials(&self, normal: Vec3Lanes) -> DiffuseLanes {
        let back = -Vec3Lanes::gather(|lane| self.0[lane].ray.direction());
        DiffuseLanes::new(
            Vec3Lanes::gather(|lane| self.0[lane].reflectance.0),
            mask(|lane| self.0[lane].is_two_sided),
            back.dot(normal),
        )
    }
}

/// Lets the paths of vertices go on by an edge.
///
/// - `depth`: edges of the paths that end at the vertices; not the last ones.
pub(super) fn advance_all(
    at: (&PathTracer, &Scene, u32),
    vertices: &mut [DiffuseVertex<'_>],
    walks: &mut [Walk<'_>],
    outcome: &mut Outcome,
) {
    // All at first: the processor makes those of several paths side by side, and no direction waits for its own.
    for vertex in &mut *vertices {
        vertex.numbers = walks[vertex.walk as usize].sampler.next_pairs();
    }
    for group in vertices.chunks(LANES) {
        advance(at, group, walks, outcome);
    }
}

/// Lets the paths of up to four vertices, and of one at least, go on by an edge.
///
/// - `depth`: edges of the paths that end at the vertices; not the last ones.
#[inline(never)]
fn advance(
    (tracer, scene, depth): (&PathTracer, &Scene, u32),
    vertices: &[DiffuseVertex<'_>],
    walks: &mut [Walk<'_>],
    outcome: &mut Outcome,
) {
    let group = Group::new(vertices);
    let surface = group.surfaces();
    let material = group.materials(surface.shading_normal);
    let numbers = each(|lane| group.0[lane].numbers);
    let aims = Aims::sample(scene, surface.position, each(|lane| numbers[lane].xy()));
    let (rays, radiance, found) = connect(tracer, &surface, &material, &aims);
    let states = each(|lane| walks[group.0[lane].walk as usize].state());
    let (throughput, eta) = Vec3Lanes::of_rows(states);
    let (rays, radiance) = (rays.rays(), throughput.times(radiance).vectors());
    let found = found.bitmask();
    for (lane, vertex) in vertices.iter().enumerate() {
        if (found >> lane) & 1 == 1 {
            let (ray, radiance) = (rays[lane], Rgb(radiance[lane]));
            let connection = Connection { ray, radiance };
            outcome.connections.push((vertex.walk, connection));
        }
    }

    let [_, _, u, v] = transpose(numbers);
    let (local, density, scatters) = material.sample([u, v]);
    let direction = to_world(surface.shading_normal, local);
    let rays = surface.rays_toward(direction).rays();
    let states = throughput.times(material.reflectance()).rows(eta);
    let departures = surface.position.rows(density);
    let scatters = scatters.bitmask();
    for (lane, vertex) in vertices.iter().enumerate() {
        let walk = &mut walks[vertex.walk as usize];
        walk.estimate.alpha = 1.0;
        if (scatters >> lane) & 1 == 0 {
            continue;
        }
        walk.set_state(states[lane]);
        walk.departure = Departure {
            position: departures[lane].truncate(),
            density: Some(departures[lane].w),
        };
        if tracer.survives(depth, walk) {
            outcome.next.push(vertex.walk, rays[lane]);
        }
    }
}

/// Light that arrives from emitters where the rays are free, for each one that the path is worth there,
/// and the lanes that have some.
#[inline(always)]
fn connect(
    tracer: &PathTracer,
    surface: &SurfaceLanes,
    material: &DiffuseLanes,
    aims: &Aims,
) -> (RayLanes, Vec3Lanes, LaneMask) {
    let cos_out = aims.direction.dot(surface.shading_normal);
    let (value, own, is_bright) = material.eval_with_density(cos_out);
    let weight = tracer.heuristic().first_weights(aims.density, own);
    let weight = Lanes::select(aims.is_dirac, Lanes::ONE, weight);
    let radiance = value.times(aims.radiance) * (weight / aims.density);
    let mut rays = surface.rays_to(aims.target);
    if aims.is_far.any() {
        let far = surface.rays_toward(aims.direction);
        rays = RayLanes::select(aims.is_far, far, rays);
    }
    (rays, radiance, aims.found & is_bright)
}
