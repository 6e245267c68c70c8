//! Steps of chains, one kind of mutation at a time.

use criterion::{Criterion, Throughput};
use lumiflow::mutation::Chain;

use crate::chains::{CASES, Start};
use crate::cpu::CpuTime;
use crate::scenes;

pub(crate) fn add(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("mutation");
    group.throughput(Throughput::Elements(Start::steps()));
    for (mutation, name, scene_name) in CASES {
        let (scene, view) = scenes::load(&scenes::file_of(scene_name));
        let start = Start::new(&scene, &view.sensor, mutation);
        let mut chain = Chain::default();
        assert!(start.run(&mut chain) > 0, "{name} goes somewhere");
        group.bench_function(format!("{name}, {scene_name}"), |bencher| {
            bencher.iter(|| start.run(&mut chain));
        });
    }
    group.finish();
}
