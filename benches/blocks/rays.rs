//! Rays of `path`, one at a time and together.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use lumiflow::accel::{Query, Ray};

use crate::cpu::CpuTime;
use crate::{passes, scenes};

/// Few enough that they stay in the processor's cache.
const RAYS: usize = 8192;

/// A few boxes, a mesh in glass, a mesh of many triangles.
const SCENES: [&str; 3] = ["cornell-box", "torus-in-glass", "dragon"];

pub(crate) fn add(criterion: &mut Criterion<CpuTime>) {
    for name in SCENES {
        let (scene, closest, occlusion) = record(name);
        let accel = scene.accel();
        let mut group = criterion.benchmark_group(format!("rays/{name}"));
        group.throughput(Throughput::Elements(RAYS as u64));
        group.bench_function("intersect", |bencher| {
            bencher.iter(|| {
                closest
                    .iter()
                    .filter(|ray| scene.hit(ray).is_some())
                    .count()
            });
        });
        group.bench_function("intersect with surface", |bencher| {
            bencher.iter(|| {
                for ray in &closest {
                    if let Some(surface) = scene.intersect(ray) {
                        black_box(surface.point.position);
                        black_box(surface.point.shading_normal);
                    }
                }
            });
        });
        group.bench_function("intersect_all", |bencher| {
            let mut hits = Vec::with_capacity(RAYS);
            bencher.iter(|| {
                accel.intersect_all(&closest, &mut hits);
                hits.len()
            });
        });
        group.bench_function("occluded", |bencher| {
            let occluded = |ray: &&Ray| accel.is_occluded(ray);
            bencher.iter(|| occlusion.iter().filter(occluded).count());
        });
        group.bench_function("are_occluded", |bencher| {
            let mut occluded = Vec::with_capacity(RAYS);
            bencher.iter(|| {
                accel.are_occluded(&occlusion, &mut occluded);
                occluded.len()
            });
        });
        group.finish();
    }
}

/// A scene, and rays of each kind that path tracing asks about in it.
fn record(name: &str) -> (lumiflow::scene::Scene, Vec<Ray>, Vec<Ray>) {
    let file = scenes::file_of(name);
    let (scene, view) = scenes::load(&file);
    let scene = scene.recording();
    let algorithm = passes::algorithm("path");
    let calls = passes::on_one_thread(|| {
        let render = passes::Passes::new(algorithm.as_ref(), &scene, &view.sensor);
        for pass in 0..16 {
            render.run(pass);
        }
        scene.accel().take_recording().expect("rays are kept")
    });
    let some = |query| {
        let mut rays = calls.rays(query);
        assert!(rays.len() >= RAYS, "{name}: {query:?}, {}", rays.len());
        // From all over the film.
        let step = rays.len() / RAYS;
        rays = rays.into_iter().step_by(step).take(RAYS).collect();
        rays
    };
    let (closest, occlusion) = (some(Query::Closest), some(Query::Occlusion));
    (scenes::load(&file).0, closest, occlusion)
}
