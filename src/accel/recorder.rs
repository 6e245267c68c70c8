//! A tracer that keeps every ray that it is asked about, for measurements of the tracer alone.

use std::mem;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{Accel, Hit, MemoryUse, RawPackets, Ray};
use crate::math::Vec3;

/// What is asked about a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// What it meets first.
    Closest,
    /// Whether it meets anything.
    Occlusion,
}

/// Rays that a tracer was asked about, in the order of asking.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    rays: Vec<Ray>,
    /// For each call what was asked, and of how many rays.
    calls: Vec<(Query, u32)>,
}

impl Recording {
    /// Number of rays.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// True when nothing was asked.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// The calls, with the rays of each: one, or those that were traced together.
    pub fn calls(&self) -> impl Iterator<Item = (Query, &[Ray])> {
        let mut rest = self.rays.as_slice();
        self.calls.iter().map(move |(query, count)| {
            let (rays, later) = rest.split_at(*count as usize);
            rest = later;
            (*query, rays)
        })
    }

    /// The rays of one kind of question.
    pub fn rays(&self, query: Query) -> Vec<Ray> {
        let calls = self.calls().filter(|(asked, _)| *asked == query);
        calls.flat_map(|(_, rays)| rays).copied().collect()
    }

    /// The same in Embree's packets, filled as the rays were asked about.
    pub fn packets(&self, query: Query) -> RawPackets {
        let calls = self.calls().filter(|(asked, _)| *asked == query);
        RawPackets::new(calls.map(|(_, rays)| rays))
    }

    fn add(&mut self, query: Query, rays: &[Ray]) {
        self.rays.extend_from_slice(rays);
        self.calls.push((query, rays.len() as u32));
    }
}

/// Hands questions on to a tracer, and keeps them.
#[derive(Debug)]
pub(super) struct Recorder {
    inner: Accel,
    kept: Mutex<Recording>,
}

impl Recorder {
    pub(super) fn new(inner: Accel) -> Self {
        Self {
            inner,
            kept: Mutex::default(),
        }
    }

    /// The tracer that answers.
    pub(super) fn inner(&self) -> &Accel {
        &self.inner
    }

    /// What was asked since the last time.
    pub(super) fn take(&self) -> Recording {
        mem::take(&mut *self.kept())
    }

    fn kept(&self) -> MutexGuard<'_, Recording> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// As [`Accel::memory`].
    pub(super) fn memory(&self) -> MemoryUse {
        self.inner.memory()
    }

    /// As [`Accel::intersect`].
    pub(super) fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.kept().add(Query::Closest, &[*ray]);
        self.inner.intersect(ray)
    }

    /// As [`Accel::is_occluded`].
    pub(super) fn is_occluded(&self, ray: &Ray) -> bool {
        self.kept().add(Query::Occlusion, &[*ray]);
        self.inner.is_occluded(ray)
    }

    /// As [`Accel::intersect_all`].
    pub(super) fn intersect_all(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.kept().add(Query::Closest, rays);
        self.inner.intersect_all(rays, hits);
    }

    /// As [`Accel::are_occluded`].
    pub(super) fn are_occluded<'r>(
        &self,
        rays: impl IntoIterator<Item = &'r Ray>,
        occluded: &mut Vec<bool>,
    ) {
        let rays: Vec<Ray> = rays.into_iter().copied().collect();
        self.kept().add(Query::Occlusion, &rays);
        // Of a type that does not contain that of the caller's iterator: both forms call each other.
        self.inner.are_occluded(rays.as_slice(), occluded);
    }

    /// As [`Accel::bounding_box`].
    pub(super) fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        self.inner.bounding_box()
    }
}
