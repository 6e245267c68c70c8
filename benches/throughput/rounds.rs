//! One round of measurements.

use std::hint::black_box;

use cpu_time::ThreadTime;
use lumiflow::accel::{Hit, Query, Ray, Tally};
use lumiflow::math::Vec3;
use lumiflow::scene::Scene;
use lumiflow::shape::SurfacePoint;

use crate::passes::Passes;
use crate::recorded::Recorded;

/// CPU seconds of each way through all rays of a recording, and of the render that they are of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Round {
    /// Closest hits by Embree in a loop of C.
    pub(crate) raw_closest: f64,
    /// Closest hits with the surface there.
    pub(crate) surface: f64,
    /// Closest hits without.
    pub(crate) hit: f64,
    /// Occlusion by Embree in a loop of C.
    pub(crate) raw_occlusion: f64,
    /// Occlusion.
    pub(crate) occlusion: f64,
    /// Closest hits and occlusion by Embree's packets in a loop of C, where the render asks about many rays
    /// at once.
    pub(crate) raw_packets: Option<[f64; 2]>,
    /// Closest hits with the surface, in the calls that they were asked in: many rays at once in `path`.
    pub(crate) surface_as_asked: f64,
    /// Occlusion, likewise.
    pub(crate) occlusion_as_asked: f64,
    /// The render.
    pub(crate) render: f64,
}

impl Round {
    /// The least that Embree took for all rays: one at a time or, where that is how they are asked about,
    /// in packets.
    pub(crate) fn least_raw(&self) -> f64 {
        let [closest, occlusion] = self.raw_packets.unwrap_or([f64::INFINITY; 2]);
        self.raw_closest.min(closest) + self.raw_occlusion.min(occlusion)
    }

    /// Goes every way once.
    pub(crate) fn new(scene: &Scene, recorded: &Recorded, render: &Passes<'_>) -> Self {
        let accel = scene.accel();
        let (closest, occlusion) = (&recorded.closest, &recorded.occlusion);
        let (raw_closest, expected) = timed(|| accel.raw_closest(closest));
        let expected = expected.expect("the tracer is Embree");
        let (surface, found) = timed(|| surfaces(scene, closest.as_slice()));
        assert_eq!(found, expected, "surfaces");
        let (hit, found) = timed(|| hits(scene, closest.as_slice()));
        assert_eq!(found, expected, "hits");
        let closest_packets = recorded.packets.as_ref().map(|[closest, _]| {
            let (seconds, found) = timed(|| accel.raw_closest_packets(closest));
            assert_eq!(found, Some(expected), "packets");
            seconds
        });
        let (surface_as_asked, found) = timed(|| surfaces_as_asked(scene, recorded));
        assert_eq!(found, expected, "surfaces as asked");
        let (raw_occlusion, expected) = timed(|| accel.raw_occluded(occlusion));
        let expected = expected.expect("the tracer is Embree");
        let (occlusion, found) = timed(|| occluded(scene, occlusion.as_slice()));
        assert_eq!(found, expected, "occlusion");
        let occlusion_packets = recorded.packets.as_ref().map(|[_, occlusion]| {
            let (seconds, found) = timed(|| accel.raw_occluded_packets(occlusion));
            assert_eq!(found, Some(expected), "packets");
            seconds
        });
        let (occlusion_as_asked, found) = timed(|| occluded_as_asked(scene, recorded));
        assert_eq!(found, expected, "occlusion as asked");
        let (render, ()) = timed(|| {
            for pass in 0..recorded.passes {
                black_box(render.run(pass));
            }
        });
        Self {
            raw_closest,
            surface,
            hit,
            raw_occlusion,
            occlusion,
            raw_packets: closest_packets.zip(occlusion_packets).map(Into::into),
            surface_as_asked,
            occlusion_as_asked,
            render,
        }
    }
}

/// CPU seconds of this thread, with the result.
fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = ThreadTime::now();
    let found = work();
    (start.elapsed().as_secs_f64(), found)
}

/// Counts a hit; the surface there is computed, and where a path would keep it.
#[inline(always)]
fn add(tally: &mut Tally, scene: &Scene, (ray, hit): (&Ray, &Hit), point: &mut SurfacePoint) {
    tally.add(Some(hit.distance));
    scene.put_surface(ray, hit, point);
    black_box(point);
}

#[inline(never)]
fn surfaces(scene: &Scene, rays: &[Ray]) -> Tally {
    let mut tally = Tally::default();
    let mut point = SurfacePoint::bare(Vec3::ZERO);
    for ray in rays {
        if let Some(hit) = scene.hit(ray) {
            add(&mut tally, scene, (ray, &hit), &mut point);
        }
    }
    tally
}

#[inline(never)]
fn hits(scene: &Scene, rays: &[Ray]) -> Tally {
    let mut tally = Tally::default();
    for ray in rays {
        tally.add(scene.hit(ray).map(|hit| hit.distance));
    }
    tally
}

#[inline(never)]
fn occluded(scene: &Scene, rays: &[Ray]) -> Tally {
    let mut tally = Tally::default();
    for ray in rays {
        tally.hits += u64::from(scene.accel().is_occluded(ray));
    }
    tally
}

#[inline(never)]
fn surfaces_as_asked(scene: &Scene, recorded: &Recorded) -> Tally {
    let mut tally = Tally::default();
    let mut hits: Vec<Option<Hit>> = Vec::new();
    let mut point = SurfacePoint::bare(Vec3::ZERO);
    for (query, rays) in recorded.calls.calls() {
        match (query, rays) {
            (Query::Occlusion, _) => {}
            (Query::Closest, [ray]) => {
                if let Some(hit) = scene.hit(ray) {
                    add(&mut tally, scene, (ray, &hit), &mut point);
                }
            }
            (Query::Closest, rays) => {
                scene.accel().intersect_all(rays, &mut hits);
                for (ray, hit) in rays.iter().zip(&hits) {
                    if let Some(hit) = hit {
                        add(&mut tally, scene, (ray, hit), &mut point);
                    }
                }
            }
        }
    }
    tally
}

#[inline(never)]
fn occluded_as_asked(scene: &Scene, recorded: &Recorded) -> Tally {
    let mut tally = Tally::default();
    let mut occluded = Vec::new();
    for (query, rays) in recorded.calls.calls() {
        match (query, rays) {
            (Query::Closest, _) => {}
            (Query::Occlusion, [ray]) => {
                tally.hits += u64::from(scene.accel().is_occluded(ray));
            }
            (Query::Occlusion, rays) => {
                scene.accel().are_occluded(rays, &mut occluded);
                tally.hits += occluded.iter().filter(|is| **is).count() as u64;
            }
        }
    }
    tally
}
