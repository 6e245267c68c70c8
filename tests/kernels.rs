//! Moves have the densities that they claim.

use std::f64::consts::TAU;

use lumiflow::math::statistics::sidak;
use lumiflow::math::{Vec2, Vec3};
use lumiflow::mutation::{AngleKernel, RasterKernel, turned};
use lumiflow::random::{Purpose, Stream};

use crate::support::effort::{level, samples, seed};
use crate::support::grid::Grid;

/// Chance that offsets come from a kernel's density, by logarithm of the distance and azimuth, or by
/// their two axes.
fn raster_p(kernel: RasterKernel, claim: RasterKernel, stream: &mut Stream) -> f64 {
    let count = samples(60_000);
    if let RasterKernel::Logarithmic { inner, outer } = kernel {
        let grid = Grid {
            low: [f64::from(inner).ln() - 0.1, -0.5 * TAU],
            high: [f64::from(outer).ln() + 0.1, 0.5 * TAU],
        };
        let point = || {
            let offset = kernel.offset(stream.next_vec2()).as_dvec2();
            Some([offset.length().ln(), offset.y.atan2(offset.x)])
        };
        return grid.p(count, point, |[log, azimuth]| {
            let distance = log.exp();
            let offset = glam::DVec2::from_angle(azimuth) * distance;
            claim.density(offset.as_vec2()) * distance * distance
        });
    }
    let grid = Grid {
        low: [-3.0; 2],
        high: [3.0; 2],
    };
    let point = || Some(kernel.offset(stream.next_vec2()).as_dvec2().to_array());
    grid.p(count, point, |[x, y]| {
        claim.density(Vec2::new(x as f32, y as f32))
    })
}

#[test]
fn raster_offsets_have_their_density() {
    let kernels = [
        RasterKernel::Square { side: 4.0 },
        RasterKernel::Disk { radius: 2.5 },
        RasterKernel::Logarithmic {
            inner: 0.1,
            outer: 10.0,
        },
    ];
    let level = sidak(level(0.01), kernels.len());
    for (index, kernel) in kernels.into_iter().enumerate() {
        let mut stream = Stream::new(seed(60), Purpose::Check, index as u32, 0);
        let p = raster_p(kernel, kernel, &mut stream);
        assert!(p > level, "{kernel:?}: p = {p:.1e}");
        let offset = kernel.offset(stream.next_vec2());
        assert_eq!(kernel.density(offset), kernel.density(-offset));
    }
    let mut stream = Stream::new(seed(61), Purpose::Check, 0, 0);
    let (narrow, wide) = (kernels[1], RasterKernel::Disk { radius: 2.6 });
    assert!(raster_p(narrow, wide, &mut stream) < 1e-6);
}

/// Chance that turned directions have the kernel's density, by logarithm of the angle and azimuth.
fn turn_p(direction: Vec3, kernel: AngleKernel, claim: AngleKernel, stream: &mut Stream) -> f64 {
    let axis = direction.as_dvec3();
    let (aside, across) = axis.any_orthonormal_pair();
    let grid = Grid {
        low: [f64::from(claim.inner).ln() - 0.1, -0.5 * TAU],
        high: [f64::from(claim.outer).ln() + 0.1, 0.5 * TAU],
    };
    let point = || {
        let angle = kernel.angle(stream.next_f32());
        let turned = turned(direction, angle, stream.next_f32()).as_dvec3();
        let angle = axis.cross(turned).length().atan2(axis.dot(turned));
        Some([angle.ln(), across.dot(turned).atan2(aside.dot(turned))])
    };
    grid.p(samples(60_000), point, |[log, _]| {
        let angle = log.exp();
        claim.density(angle) * angle.sin() * angle
    })
}

#[test]
fn turned_directions_have_their_density() {
    let kernels = [
        AngleKernel::default(),
        AngleKernel {
            inner: 0.02,
            outer: 2.0,
        },
    ];
    let directions = [
        Vec3::Z,
        Vec3::NEG_Z,
        Vec3::X,
        Vec3::new(0.48, -0.6, 0.64),
        Vec3::new(0.0, 1e-3, -1.0).normalize(),
    ];
    let level = sidak(level(0.01), kernels.len() * directions.len());
    for (index, kernel) in kernels.into_iter().enumerate() {
        for (other, direction) in directions.into_iter().enumerate() {
            let mut stream = Stream::new(seed(62), Purpose::Check, index as u32, other as u32);
            let p = turn_p(direction, kernel, kernel, &mut stream);
            assert!(p > level, "{kernel:?} around {direction}: p = {p:.1e}");
        }
    }
    let mut stream = Stream::new(seed(63), Purpose::Check, 0, 0);
    let wide = AngleKernel {
        outer: 2.1,
        ..kernels[1]
    };
    assert!(turn_p(Vec3::X, kernels[1], wide, &mut stream) < 1e-6);
}
