//! Rays that are recorded are those that were asked about, and find the same whoever traces them.

use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

use lumiflow::accel::{Query, RawRays, Recording, Tally};
use lumiflow::integrator;
use lumiflow::math::Mat4;
use lumiflow::scene::Scene;
use lumiflow::sensor::Sensor;

use crate::determinism::{bits, on_threads};
use crate::support::render::settings;
use crate::support::scenes::{cornell, cornell_camera, studio, studio_camera};

const SIDE: u32 = 16;

/// Renders with and without recording, and compares the pictures; returns the scene with what was asked
/// after the preparations.
fn record(make: &(dyn Fn() -> Scene + Sync), sensor: &Sensor, text: &str) -> (Scene, Recording) {
    let algorithm = crate::support::render::integrator(text);
    let render = |scene: &Scene| {
        let work = algorithm.start(scene, sensor, settings(5, SIDE));
        // What was asked to prepare is not counted.
        let _ = scene.accel().take_recording();
        let never = AtomicBool::default();
        integrator::render(
            &*work,
            |_| true,
            &never,
            &Default::default(),
            |step| {
                if step.passes < 6 {
                    ControlFlow::Continue(())
                } else {
                    ControlFlow::Break(())
                }
            },
        )
    };
    let plain = on_threads(1, || render(&make()));
    let scene = make().recording();
    let recorded = on_threads(1, || render(&scene));
    assert_eq!(bits(&plain), bits(&recorded), "{text}");
    assert_eq!(plain.counters, recorded.counters, "{text}");
    let recording = scene.accel().take_recording().expect("rays are kept");
    assert_eq!(recording.len() as u64, recorded.counters.rays, "{text}");
    assert!(scene.accel().take_recording().is_some_and(|r| r.is_empty()));
    (scene, recording)
}

/// What the safe face finds, ray by ray.
fn ours(scene: &Scene, query: Query, rays: &RawRays) -> Tally {
    let mut tally = Tally::default();
    for ray in rays.as_slice() {
        tally.add(match query {
            Query::Closest => scene.intersect(ray).map(|surface| surface.distance),
            Query::Occlusion => scene.accel().is_occluded(ray).then_some(0.0),
        });
    }
    tally
}

/// What Embree finds in a loop of its own.
fn raw(scene: &Scene, query: Query, rays: &RawRays) -> Tally {
    let found = match query {
        Query::Closest => scene.accel().raw_closest(rays),
        Query::Occlusion => scene.accel().raw_occluded(rays),
    };
    found.expect("the tracer is Embree")
}

/// What Embree finds in packets, filled as the render asked.
fn raw_packets(scene: &Scene, query: Query, recording: &Recording) -> Tally {
    let packets = recording.packets(query);
    let found = match query {
        Query::Closest => scene.accel().raw_closest_packets(&packets),
        Query::Occlusion => scene.accel().raw_occluded_packets(&packets),
    };
    found.expect("the tracer is Embree, and has no curves")
}

#[test]
fn replayed_rays_find_what_they_found() {
    let box_camera = cornell_camera(Mat4::IDENTITY, SIDE);
    let studio_view = studio_camera(SIDE);
    let in_box = || cornell(Mat4::IDENTITY);
    let in_studio = || studio(1.0, |_| {});
    for (make, sensor, text) in [
        (&in_box as &(dyn Fn() -> Scene + Sync), &box_camera, "path"),
        (&in_box, &box_camera, "erpt mutations_per_sample=20"),
        (&in_studio, &studio_view, "path"),
        (&in_studio, &studio_view, "erpt mutations_per_sample=20"),
    ] {
        let (scene, recording) = record(make, sensor, text);
        for query in [Query::Closest, Query::Occlusion] {
            let all = recording.rays(query);
            let rays = RawRays::new(&all);
            let (found, expected) = (ours(&scene, query, &rays), raw(&scene, query, &rays));
            assert_eq!(found, expected, "{text}, {query:?}");
            assert!(found.hits > 100, "{text}, {query:?}: {found:?}");
            assert_eq!(
                found,
                raw_packets(&scene, query, &recording),
                "{text}, {query:?}"
            );
            // The rays that were left out are no hits.
            let mut everything = Tally::default();
            for ray in &all {
                everything.add(match query {
                    Query::Closest => scene.hit(ray).map(|hit| hit.distance),
                    Query::Occlusion => scene.accel().is_occluded(ray).then_some(0.0),
                });
            }
            assert_eq!(everything, found, "{text}, {query:?}");
        }
        let asked: usize = recording.calls().map(|(_, rays)| rays.len()).sum();
        assert_eq!(asked, recording.len());
        let together = recording.calls().any(|(_, rays)| rays.len() > 1);
        assert_eq!(together, text == "path", "{text}");
    }
}

#[test]
fn a_ray_too_few_is_found() {
    let sensor = cornell_camera(Mat4::IDENTITY, SIDE);
    let (scene, recording) = record(&|| cornell(Mat4::IDENTITY), &sensor, "path");
    let rays = recording.rays(Query::Closest);
    let hits = rays.iter().position(|ray| scene.hit(ray).is_some());
    let mut fewer = rays.clone();
    fewer.remove(hits.expect("some ray hits"));
    let whole = raw(&scene, Query::Closest, &RawRays::new(&rays));
    assert_ne!(ours(&scene, Query::Closest, &RawRays::new(&fewer)), whole);
}

#[test]
fn nothing_is_kept_unless_asked_for() {
    let scene = cornell(Mat4::IDENTITY);
    assert_eq!(scene.accel().take_recording(), None);
}
