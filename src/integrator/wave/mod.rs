//! Many paths that go on together, edge by edge.
//!
//! All rays of an edge are traced at once, in packets. Each path does what it would do alone, with its
//! own random numbers, and adds up its estimate in the same order: the bits are those of a path alone,
//! whoever the companions are.

mod aim;
mod diffuse;

use self::diffuse::DiffuseVertex;
use super::path::{Connection, PathTracer};
use super::pixel::{Estimate, first_hit};
use super::render::Counters;
use super::walk::Walk;
use crate::accel::{Hit, Ray};
use crate::scene::Scene;

/// Paths that go on together.
pub(super) struct Wave<'s> {
    tracer: &'s PathTracer,
    scene: &'s Scene,
    walks: Vec<Walk<'s>>,
    edges: Edges,
    /// What the ray of each edge meets.
    hits: Vec<Option<Hit>>,
    outcome: Outcome,
    occluded: Vec<bool>,
}

/// The edges that are to be traced.
struct Edges {
    /// Indices of their walks.
    walks: Vec<u32>,
    rays: Vec<Ray>,
}

/// What comes of the vertices of an edge.
struct Outcome {
    /// Light that walks get where rays are free, with their indices.
    connections: Vec<(u32, Connection)>,
    /// The edges after.
    next: Edges,
}

impl Edges {
    fn with_capacity(count: usize) -> Self {
        Self {
            walks: Vec::with_capacity(count),
            rays: Vec::with_capacity(count),
        }
    }

    #[inline(always)]
    fn push(&mut self, walk: u32, ray: Ray) {
        self.walks.push(walk);
        self.rays.push(ray);
    }

    fn clear(&mut self) {
        self.walks.clear();
        self.rays.clear();
    }
}

impl<'s> Wave<'s> {
    /// No paths yet.
    ///
    /// - `count`: how many there will be, for the memory they take.
    pub(super) fn new(tracer: &'s PathTracer, scene: &'s Scene, count: usize) -> Self {
        Self {
            tracer,
            scene,
            walks: Vec::with_capacity(count),
            edges: Edges::with_capacity(count),
            hits: Vec::with_capacity(count),
            outcome: Outcome {
                connections: Vec::with_capacity(count),
                next: Edges::with_capacity(count),
            },
            occluded: Vec::with_capacity(count),
        }
    }

    /// Adds a path with the ray that it begins with.
    #[inline]
    pub(super) fn add(&mut self, walk: Walk<'s>, ray: Ray) {
        self.edges.push(self.walks.len() as u32, ray);
        self.walks.push(walk);
    }

    /// Follows all paths to their ends; returns their estimates.
    pub(super) fn run(mut self, counters: &mut Counters) -> Vec<Estimate> {
        let mut depth = 1;
        while !self.edges.rays.is_empty() && self.tracer.allows(depth) {
            self.find_hits(depth, counters);
            self.advance(depth);
            std::mem::swap(&mut self.edges, &mut self.outcome.next);
            depth += 1;
            self.collect_light(counters);
        }
        self.walks.into_iter().map(|walk| walk.estimate).collect()
    }

    fn find_hits(&mut self, depth: u32, counters: &mut Counters) {
        let rays = &mut self.edges.rays;
        if self.tracer.sees_through_emitters(depth) {
            self.hits.clear();
            self.hits.extend(
                rays.iter_mut()
                    .map(|ray| first_hit(self.scene, ray, true, counters)),
            );
        } else {
            counters.rays += rays.len() as u64;
            self.scene.accel().intersect_all(rays, &mut self.hits);
        }
    }

    /// Lets every walk go on by an edge.
    ///
    /// - `depth`: edges of the paths that end at their rays' other ends.
    fn advance(&mut self, depth: u32) {
        let at = (self.tracer, self.scene, depth);
        let (walks, outcome) = (&mut self.walks, &mut self.outcome);
        outcome.connections.clear();
        outcome.next.clear();
        let takes_diffuse = self.tracer.connects_and_departs(depth);
        let mut diffuse = Vec::with_capacity(self.hits.len());
        let edges = self.edges.walks.iter().zip(&self.edges.rays);
        for ((walk, ray), hit) in edges.zip(&self.hits) {
            let Some(hit) = hit else {
                let walk = &mut walks[*walk as usize];
                self.tracer.escape(self.scene, depth, walk, ray);
                continue;
            };
            let vertex = takes_diffuse.then(|| DiffuseVertex::at(self.scene, *walk, ray, hit));
            if let Some(vertex) = vertex.flatten() {
                diffuse.push(vertex);
            } else {
                advance_alone(at, (*walk, ray, hit), walks, outcome);
            }
        }
        diffuse::advance_all(at, &mut diffuse, walks, outcome);
    }

    /// Adds the light of the sampled emitters that nothing hides.
    fn collect_light(&mut self, counters: &mut Counters) {
        let connections = &self.outcome.connections;
        counters.rays += connections.len() as u64;
        let rays = connections.iter().map(|(_, light)| &light.ray);
        self.scene.accel().are_occluded(rays, &mut self.occluded);
        for ((index, light), occluded) in connections.iter().zip(&self.occluded) {
            if !occluded {
                self.walks[*index as usize].estimate.radiance += light.radiance;
            }
        }
    }
}

/// Lets a walk go on by an edge that ends at a hit.
#[inline(always)]
fn advance_alone(
    (tracer, scene, depth): (&PathTracer, &Scene, u32),
    (index, ray, hit): (u32, &Ray, &Hit),
    walks: &mut [Walk<'_>],
    outcome: &mut Outcome,
) {
    let walk = &mut walks[index as usize];
    let object = scene.object_at(hit);
    if tracer.passes(object, depth) {
        let onward = |next| outcome.next.push(index, next);
        return tracer.pass(scene, (depth, object), (walk, ray, hit), onward);
    }
    let surface = scene.interaction(ray, hit);
    if !tracer.arrive(scene, depth, walk, &surface) {
        return;
    }
    if let Some(connection) = tracer.connect(scene, walk, &surface) {
        outcome.connections.push((index, connection));
    }
    if let Some(next) = tracer.depart(depth, walk, &surface) {
        outcome.next.push(index, next);
    }
}
