//! Many paths that go on together, edge by edge.
//!
//! All rays of an edge are traced at once, in packets. Each path does what it would do alone, with its
//! own random numbers, and adds up its estimate in the same order: the bits are those of a path alone,
//! whoever the companions are.

use super::path::{Connection, PathTracer, Walk};
use super::pixel::{Estimate, first_hit};
use super::render::Counters;
use crate::accel::{Hit, Ray};
use crate::scene::Scene;

/// Paths that go on together.
pub(super) struct Wave<'s> {
    tracer: &'s PathTracer,
    scene: &'s Scene,
    walks: Vec<Walk>,
    /// Indices of the walks that are still under way.
    active: Vec<u32>,
    /// The ray of each of these, and what it meets.
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Light that walks get where rays are free, with their indices.
    connections: Vec<(u32, Connection)>,
    occluded: Vec<bool>,
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
            active: Vec::with_capacity(count),
            rays: Vec::with_capacity(count),
            hits: Vec::with_capacity(count),
            connections: Vec::with_capacity(count),
            occluded: Vec::with_capacity(count),
        }
    }

    /// Adds a path with the ray that it begins with.
    #[inline]
    pub(super) fn add(&mut self, walk: Walk, ray: Ray) {
        self.active.push(self.walks.len() as u32);
        self.walks.push(walk);
        self.rays.push(ray);
    }

    /// Follows all paths to their ends; returns their estimates.
    pub(super) fn run(mut self, counters: &mut Counters) -> Vec<Estimate> {
        let mut depth = 1;
        while !self.active.is_empty() && self.tracer.allows(depth) {
            self.find_hits(depth, counters);
            self.advance(depth);
            depth += 1;
            self.collect_light(counters);
        }
        self.walks.into_iter().map(|walk| walk.estimate).collect()
    }

    fn find_hits(&mut self, depth: u32, counters: &mut Counters) {
        if self.tracer.sees_through_emitters(depth) {
            let rays = self.rays.iter_mut();
            self.hits.clear();
            self.hits
                .extend(rays.map(|ray| first_hit(self.scene, ray, true, counters)));
        } else {
            counters.rays += self.rays.len() as u64;
            self.scene.accel().intersect_all(&self.rays, &mut self.hits);
        }
    }

    /// Lets every walk go on by an edge, and keeps those that have another one before them.
    ///
    /// - `depth`: edges of the paths that end at their rays' other ends.
    fn advance(&mut self, depth: u32) {
        let (tracer, scene) = (self.tracer, self.scene);
        let mut kept = 0;
        self.connections.clear();
        for (lane, hit) in self.hits.iter().enumerate() {
            let index = self.active[lane];
            let walk = &mut self.walks[index as usize];
            let ray = &self.rays[lane];
            let Some(hit) = hit else {
                tracer.escape(scene, depth, walk, ray);
                continue;
            };
            let surface = scene.interaction(ray, hit);
            if !tracer.arrive(scene, depth, walk, &surface) {
                continue;
            }
            if let Some(connection) = tracer.connect(scene, walk, &surface) {
                self.connections.push((index, connection));
            }
            if let Some(next) = tracer.depart(depth, walk, &surface) {
                self.active[kept] = index;
                self.rays[kept] = next;
                kept += 1;
            }
        }
        self.active.truncate(kept);
        self.rays.truncate(kept);
    }

    /// Adds the light of the sampled emitters that nothing hides.
    fn collect_light(&mut self, counters: &mut Counters) {
        counters.rays += self.connections.len() as u64;
        let rays = self.connections.iter().map(|(_, light)| &light.ray);
        self.scene.accel().are_occluded(rays, &mut self.occluded);
        for ((index, light), occluded) in self.connections.iter().zip(&self.occluded) {
            if !occluded {
                self.walks[*index as usize].estimate.radiance += light.radiance;
            }
        }
    }
}
