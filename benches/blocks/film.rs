//! Estimates that land on the film.

use criterion::{Criterion, Throughput};
use lumiflow::film::{Canvas, Filter, FilterKind, PassBuffer, Tile, Unit, Window};
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
            bencher.iter(|| splat(&buffer, &filter, &places));
        });
        // As integrators do it.
        let corners = ((0, 0), (SIDE as i32, SIDE as i32));
        let tile = Tile::new(&buffer, corners, filter.is_pixel_box());
        group.bench_function(format!("{name}, tile"), |bencher| {
            bencher.iter(|| splat(&tile, &filter, &places));
        });
        drop(tile);
        assert_eq!(buffer.rejected(), 0);
    }
    group.finish();
}

fn splat(on: &impl Canvas, filter: &Filter, places: &[Vec2]) {
    for raster in places {
        on.add(filter, *raster, [0.5, 0.25, 0.125]);
    }
}
