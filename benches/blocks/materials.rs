//! Materials: all examples of each model, in several directions.

use std::collections::BTreeMap;
use std::hint::black_box;

use criterion::{Criterion, Throughput};
use lumiflow::bsdf::{Bsdf, BsdfModel, Transport};
use lumiflow::math::{Local, Vec2, Vec3, warp};
use lumiflow::random::{Purpose, Stream};
use lumiflow::shape::{Derivatives, SurfacePoint};

use crate::cpu::CpuTime;

/// Questions of each example.
const QUESTIONS: usize = 64;

/// What a material is asked.
struct Question {
    wi: Local,
    wo: Local,
    u_lobe: f32,
    u: Vec2,
}

pub(crate) fn add(criterion: &mut Criterion<CpuTime>) {
    let mut models: BTreeMap<&'static str, Vec<Bsdf>> = BTreeMap::new();
    for bsdf in Bsdf::examples() {
        models.entry(bsdf.name()).or_default().push(bsdf);
    }
    let (at, questions) = (surface_point(), questions());
    for (name, examples) in &models {
        let mut group = criterion.benchmark_group(format!("bsdf/{name}"));
        group.throughput(Throughput::Elements((examples.len() * QUESTIONS) as u64));
        group.bench_function("sample", |bencher| {
            bencher.iter(|| {
                for bsdf in examples {
                    for Question { wi, u_lobe, u, .. } in &questions {
                        black_box(bsdf.sample(*wi, &at, Transport::Radiance, *u_lobe, *u));
                    }
                }
            });
        });
        group.bench_function("eval", |bencher| {
            bencher.iter(|| {
                for bsdf in examples {
                    for Question { wi, wo, .. } in &questions {
                        black_box(bsdf.eval_with_density(*wi, *wo, &at, Transport::Radiance));
                    }
                }
            });
        });
        group.finish();
    }
}

/// From above mostly, to all directions.
fn questions() -> Vec<Question> {
    let mut random = Stream::new(1, Purpose::Check, 0, 0);
    let one = |index: usize| {
        let above = Local(warp::cosine_hemisphere(random.next_vec2()));
        Question {
            wi: if index % 8 == 0 {
                above.flipped()
            } else {
                above
            },
            wo: Local(warp::uniform_sphere(random.next_vec2())),
            u_lobe: random.next_f32(),
            u: random.next_vec2(),
        }
    };
    (0..QUESTIONS).map(one).collect()
}

/// A point of a horizontal surface, whose coordinates are skew.
fn surface_point() -> SurfacePoint {
    SurfacePoint {
        position: Vec3::ZERO,
        geometric_normal: Vec3::Z,
        shading_normal: Vec3::Z,
        derivatives: Derivatives::new(Vec3::Z, Vec3::new(1.5, 0.0, 0.0), Vec3::new(0.4, 0.8, 0.0)),
        uv: Vec2::new(0.3, 0.7),
        error: 1e-6,
    }
}
