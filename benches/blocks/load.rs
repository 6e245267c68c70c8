//! Scenes, from file to tracer.

use criterion::Criterion;

use crate::cpu::CpuTime;
use crate::scenes;

pub(crate) fn add(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("load");
    group.sample_size(10);
    for name in ["cornell-box", "dragon"] {
        let file = scenes::file_of(name);
        group.bench_function(name, |bencher| {
            bencher.iter(|| scenes::load(&file));
        });
    }
    group.finish();
}
