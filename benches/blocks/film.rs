//! Estimates that land on the film.

use criterion::{Criterion, Throughput};
use lumiflow::film::{Canvas, Filter, FilterKind, PassBuffer, Unit, Window};
use lumiflow::math::Vec2;
use lumiflow::random::{Purpose, Stream};

use crate::cpu::CpuTime;
use crate::scenes::SIDE;

const ESTIMATES: usize = 4096;

pub(crate) fn add(criterion: &mut Criterion<CpuTime>) {
    let mut random = Stream::new(1, Purpose::Check, 0, 0);
    let places = (0..ESTIMATES).map(|_| random.next_vec2() * SIDE as f32);
    let places: Vec<Vec2> = places.collect();
    let gaussian = Filter::new(FilterKind::Gaussian { stddev: 0.5 }).expect("a filter");
    let window = Window::full(SIDE, SIDE);
    let mut group = criterion.benchmark_group("splat");
    group.throughput(Throughput::Elements(ESTIMATES as u64));
    for (name, filter) in [("box", Filter::pixel_box()), ("gaussian", gaussian)] {
        let buffer = PassBuffer::new(window, 3, Unit::for_magnitude(1.0));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for raster in &places {
                    buffer.add(&filter, *raster, [0.5, 0.25, 0.125]);
                }
            });
        });
        assert_eq!(buffer.rejected(), 0);
    }
    group.finish();
}
