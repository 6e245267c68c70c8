//! Mutations propose with the densities that they claim.

use std::f64::consts::TAU;

use lumiflow::bsdf::{Conductor, Diffuse};
use lumiflow::emitter::Point;
use lumiflow::math::statistics::{chi_square_p, sidak, two_sided_p};
use lumiflow::math::{Rgb, Vec2, Vec3};
use lumiflow::mutation::{
    AngleKernel, CausticKernel, Mutate, Mutation, Perturbation, RasterKernel, log_transition,
    turned,
};
use lumiflow::path::{Path, PathSpace};
use lumiflow::random::{Purpose, Stream};
use lumiflow::sensor::{Sensor, SensorModel};

use crate::support::effort::{level, samples, seed};
use crate::support::scenes::{camera, part, rectangle, scene};
use crate::support::seeds::{TRACING, space, trace};
use crate::support::stages::{SIDE, Stage, moves, moves_in_pixels, stage_of};

/// Cells along each of two coordinates.
const CELLS: usize = 12;
/// Points along each side of a cell in integrals over it.
const POINTS: usize = 24;

/// A rectangle of two coordinates, cut into cells.
struct Grid {
    low: [f64; 2],
    high: [f64; 2],
}

impl Grid {
    /// Cell of a point; the last one is outside.
    fn cell(&self, point: [f64; 2]) -> usize {
        let place = |axis: usize| {
            let size = self.high[axis] - self.low[axis];
            let place = (point[axis] - self.low[axis]) / size * CELLS as f64;
            (0.0..CELLS as f64)
                .contains(&place)
                .then_some(place as usize)
        };
        match (place(0), place(1)) {
            (Some(x), Some(y)) => y * CELLS + x,
            _ => CELLS * CELLS,
        }
    }

    /// Integral of a density over each cell, and what is left to one.
    fn integrals(&self, density: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        let steps = (CELLS * POINTS) as f64;
        let size = [0, 1].map(|axis| (self.high[axis] - self.low[axis]) / steps);
        let mut integrals = vec![0.0; CELLS * CELLS + 1];
        for y in 0..CELLS * POINTS {
            for x in 0..CELLS * POINTS {
                let at = [
                    self.low[0] + (x as f64 + 0.5) * size[0],
                    self.low[1] + (y as f64 + 0.5) * size[1],
                ];
                integrals[self.cell(at)] += density(at) * size[0] * size[1];
            }
        }
        integrals[CELLS * CELLS] = 1.0 - integrals.iter().sum::<f64>();
        integrals
    }

    /// Chance that points come from a density.
    fn p(
        &self,
        count: u32,
        mut point: impl FnMut() -> Option<[f64; 2]>,
        density: impl Fn([f64; 2]) -> f64,
    ) -> f64 {
        let mut observed = vec![0.0; CELLS * CELLS + 1];
        let mut made = 0.0;
        for point in (0..count).filter_map(|_| point()) {
            observed[self.cell(point)] += 1.0;
            made += 1.0;
        }
        let expected = self.integrals(density);
        assert!(expected[CELLS * CELLS].abs() < 2e-3, "the density is one");
        let expected: Vec<f64> = expected.iter().map(|e| e.max(1e-9) * made).collect();
        chi_square_p(&observed, &expected).unwrap_or(1.0)
    }
}

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

/// Floor and ceiling before a plane mirror, lit from a point: nothing hides anything.
fn mirror_room() -> Stage {
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 9.0, Vec3::X * 9.0);
    let ceiling = rectangle(Vec3::Y * 4.0, Vec3::X * 9.0, Vec3::Z * 9.0);
    let mirror = rectangle(Vec3::new(0.0, 4.0, -2.0), Vec3::X * 9.0, Vec3::Y * 4.0);
    let parts = [
        part(floor, Diffuse::new(0.7)),
        part(ceiling, Diffuse::new(0.7)),
        part(mirror, Conductor::new(None, 0.9)),
    ];
    Stage {
        name: "mirror room",
        scene: scene(parts, |builder| {
            builder.add_emitter(Point::new(Vec3::new(0.5, 3.0, 0.5), Rgb::grey(1.0)));
        }),
        sensor: camera(
            Vec3::new(0.0, 2.0, 2.0),
            Vec3::new(0.0, 0.0, -2.0),
            70.0,
            SIDE,
        ),
    }
}

/// A path of a stage by its signature, seen in the middle of the film, with light to spare.
fn path_of(space: &PathSpace<'_>, signature: &str) -> Path {
    let (mut path, mut chosen) = (Path::default(), None);
    for sample in 0..20_000 {
        trace(space, &TRACING, (64, sample), &mut path, &mut |found| {
            let Some(path) = found.path else { return };
            let off = path.raster() - 0.5 * SIDE as f32;
            let steps = path.vertices()[1..path.edges()].windows(2);
            let is_wide = steps
                .map(|pair| pair[0].position().distance(pair[1].position()))
                .all(|length| (0.7..5.0).contains(&length));
            let is_wanted = path.signature().to_string() == signature;
            if is_wanted && is_wide && off.abs().max_element() < 3.0 {
                chosen.get_or_insert(path.clone());
            }
        });
        if chosen.is_some() {
            break;
        }
    }
    chosen.unwrap_or_else(|| panic!("{signature}: there is no such path"))
}

/// Proposals of a mutation from one path; `cell` says in which of the cells one lies.
///
/// The mean of `1 / T` over the proposals in a cell is the cell's measure. Returns the means in
/// standard errors from it.
fn cell_z(
    space: &PathSpace<'_>,
    (mutation, settings): (Mutation, &Perturbation),
    from: &Path,
    cells: &[(f64, &dyn Fn(&Path) -> bool)],
    stream: &mut Stream,
) -> Vec<f64> {
    let count = samples(60_000);
    let last = mutation.last_changed(from).expect("the mutation applies");
    let mut sums = vec![(0.0, 0.0); cells.len()];
    let mut proposal = from.clone();
    for _ in 0..count {
        let proposed = mutation.propose(space, settings, &mut proposal, stream);
        if proposed.is_ok() {
            let density = log_transition(mutation, space, settings, (from, &proposal));
            let density = density.expect("what was proposed can be").exp();
            let weight = dirac_edges(mutation, space, &proposal, last) / density;
            for ((sum, square), (_, is_inside)) in sums.iter_mut().zip(cells) {
                if is_inside(&proposal) {
                    *sum += weight;
                    *square += weight * weight;
                }
            }
        }
        proposal.copy_prefix(from, last);
    }
    let count = f64::from(count);
    let z = |((sum, square), (measure, _)): (&(f64, f64), &(f64, _))| {
        let mean = sum / count;
        let variance = (square / count - mean * mean) / count;
        (mean - measure) / variance.sqrt()
    };
    sums.iter().zip(cells).map(z).collect()
}

/// Density per area of the vertices that a Dirac event before them decides: they are no coordinates.
fn dirac_edges(mutation: Mutation, space: &PathSpace<'_>, path: &Path, last: usize) -> f64 {
    let vertices = path.vertices();
    let is_backward = mutation == Mutation::Caustic;
    (1..last)
        .filter(|index| vertices[*index].event.is_dirac())
        .map(|index| {
            let next = if is_backward { index - 1 } else { index + 1 };
            space.solid_angle_per_area(&vertices[index], &vertices[next])
        })
        .product()
}

/// Whether a vertex lies in a square that is parallel to a wall, by its offset from another point.
fn is_near(path: &Path, vertex: usize, from: Vec3, axes: (Vec3, Vec3), square: [f32; 3]) -> bool {
    let [x, y, half] = square;
    let offset = path.vertices()[vertex].position() - from;
    let inside = |along: Vec3, middle: f32| (offset.dot(along) - middle).abs() < half;
    inside(axes.0, x) && inside(axes.1, y)
}

/// Checks a mutation's density around a path and around a proposal from it.
fn check(
    (mutation, settings): (Mutation, Perturbation),
    signature: &str,
    // Vertices that are free, with the axes of the plane that they lie in.
    free: &[(usize, (Vec3, Vec3))],
    stream: &mut Stream,
) -> Vec<(String, f64)> {
    let stage = mirror_room();
    let space = space(&stage);
    let x = path_of(&space, signature);
    let mut y = x.clone();
    let proposed = (0..100).any(|_| {
        y.copy_from(&x);
        mutation.propose(&space, &settings, &mut y, stream).is_ok()
    });
    assert!(proposed, "{signature}");
    let mut found = Vec::new();
    for from in [&x, &y] {
        let squares = [[0.12, 0.02, 0.05], [-0.03, 0.1, 0.06], [-0.1, -0.1, 0.06]];
        let is_inside: Vec<_> = squares
            .iter()
            .map(|square| {
                move |path: &Path| {
                    free.iter().all(|(vertex, axes)| {
                        let middle = from.vertices()[*vertex].position();
                        is_near(path, *vertex, middle, *axes, *square)
                    })
                }
            })
            .collect();
        let measure = |square: &[f32; 3]| (2.0 * f64::from(square[2])).powi(2 * free.len() as i32);
        let cells: Vec<(f64, &dyn Fn(&Path) -> bool)> = squares
            .iter()
            .zip(&is_inside)
            .map(|(square, is_inside)| (measure(square), is_inside as &dyn Fn(&Path) -> bool))
            .collect();
        let all = cell_z(&space, (mutation, &settings), from, &cells, stream);
        found.extend(all.into_iter().enumerate().map(|(cell, z)| {
            let name = mutation.name();
            (format!("{name} of {signature}, cell {cell}: z = {z:.2}"), z)
        }));
    }
    found
}

const FLOOR: (Vec3, Vec3) = (Vec3::X, Vec3::Z);
const MIRROR: (Vec3, Vec3) = (Vec3::X, Vec3::Y);

fn sensor() -> Sensor {
    mirror_room().sensor
}

#[test]
fn mutations_propose_with_the_density_that_they_claim() {
    let mut stream = Stream::new(seed(65), Purpose::Check, 0, 0);
    let angle = AngleKernel {
        inner: 0.005,
        outer: 0.9,
    };
    let wide = Perturbation {
        angle,
        caustic: CausticKernel::Logarithmic(angle),
        raster: RasterKernel::Square { side: 6.0 },
        ..moves()
    };
    let in_pixels = Perturbation {
        caustic: match moves_in_pixels(&sensor()).caustic {
            CausticKernel::Pixels { angle_of_pixel, .. } => CausticKernel::Pixels {
                pixels: 6.0,
                angle_of_pixel,
            },
            other => other,
        },
        ..wide
    };
    let mut all = Vec::new();
    let mut check = |mutation, settings, signature, free: &[_]| {
        all.extend(check((mutation, settings), signature, free, &mut stream));
    };
    check(Mutation::Lens, wide, "EDP", &[(1, FLOOR)]);
    check(Mutation::Lens, wide, "ESDP", &[(1, MIRROR)]);
    check(
        Mutation::MultiChain,
        wide,
        "EDSDP",
        &[(1, FLOOR), (2, MIRROR)],
    );
    check(Mutation::LaiLens, wide, "EDSDP", &[(1, FLOOR)]);
    check(Mutation::Caustic, wide, "EDSDP", &[(2, MIRROR)]);
    check(Mutation::Caustic, wide, "EDP", &[(1, FLOOR)]);
    check(Mutation::Caustic, in_pixels, "EDSDP", &[(2, MIRROR)]);
    let level = sidak(level(0.01), all.len());
    for (name, z) in all {
        println!("{name}");
        assert!(two_sided_p(z) > level, "{name}");
    }
}

#[test]
fn points_of_the_lens_move_by_a_disk() {
    let stage = stage_of("thin lens");
    let space = space(&stage);
    let mut stream = Stream::new(seed(66), Purpose::Check, 0, 0);
    let settings = Perturbation {
        raster: RasterKernel::Square { side: 0.01 },
        lens: 0.4,
        ..moves()
    };
    // The floor far from the ball: every move in the lens is possible.
    let mut from = path_of(&space, "EDA");
    let middle = space.sensor.lens_point(Vec2::new(0.1, -0.2));
    from.vertices_mut()[0].point.position = middle;
    let old = space.sensor.lens_coordinates(middle);
    let mut proposal = from.clone();
    let mut rejected = 0_u32;
    let point = || {
        proposal.copy_from(&from);
        let proposed = Mutation::Lens.propose(&space, &settings, &mut proposal, &mut stream);
        rejected += u32::from(proposed.is_err());
        proposed.ok()?;
        let new = space
            .sensor
            .lens_coordinates(proposal.vertices()[0].position());
        Some((new - old).as_dvec2().to_array())
    };
    let grid = Grid {
        low: [-0.45; 2],
        high: [0.45; 2],
    };
    let disk = RasterKernel::Disk { radius: 0.4 };
    let p = grid.p(samples(40_000), point, |[x, y]| {
        disk.density(Vec2::new(x as f32, y as f32))
    });
    assert_eq!(rejected, 0);
    assert!(p > level(0.01), "p = {p:.1e}");
}
