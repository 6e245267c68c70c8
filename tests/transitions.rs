//! Mutations propose with the densities that they claim.

use lumiflow::bsdf::{Conductor, Diffuse};
use lumiflow::emitter::Point;
use lumiflow::math::statistics::{sidak, two_sided_p};
use lumiflow::math::{Rgb, Vec2, Vec3};
use lumiflow::mutation::{
    AngleKernel, CausticKernel, Mutate, Mutation, Perturbation, RasterKernel, log_transition,
};
use lumiflow::path::{Path, PathSpace};
use lumiflow::random::{Purpose, Stream};
use lumiflow::sensor::{Sensor, SensorModel};

use crate::support::effort::{level, samples, seed};
use crate::support::grid::Grid;
use crate::support::scenes::{camera, part, rectangle, scene};
use crate::support::seeds::{TRACING, space, trace};
use crate::support::stages::{SIDE, Stage, lens_camera, moves, moves_in_pixels};

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

/// Whether moves of the raster position stay on the film, and no vertex is near the edges where floor or
/// ceiling meet the mirror: beyond them there is nothing to propose.
fn is_in_the_middle(path: &Path) -> bool {
    let off = path.raster() - 0.5 * SIDE as f32;
    let from_edge = |at: Vec3| at.y.min(4.0 - at.y) + at.z + 2.0;
    let inner = &path.vertices()[1..path.edges()];
    let is_free = inner.iter().all(|v| from_edge(v.position()) > 0.3);
    is_free && off.abs().max_element() < 3.0
}

/// A path of a stage by its signature, seen in the middle of the film, with light to spare.
fn path_of(space: &PathSpace<'_>, signature: &str) -> Path {
    let (mut path, mut chosen) = (Path::default(), None);
    for sample in 0..20_000 {
        trace(space, &TRACING, (64, sample), &mut path, &mut |found| {
            let Some(path) = found.path else { return };
            let steps = path.vertices()[1..path.edges()].windows(2);
            let is_wide = steps
                .map(|pair| pair[0].position().distance(pair[1].position()))
                .all(|length| (0.7..5.0).contains(&length));
            let is_wanted = path.signature().to_string() == signature;
            if is_wanted && is_wide && is_in_the_middle(path) {
                chosen.get_or_insert(path.clone());
            }
        });
        if chosen.is_some() {
            break;
        }
    }
    chosen.unwrap_or_else(|| panic!("{signature}: there is no such path"))
}

/// A set of paths with its measure.
type Cell<'c> = (f64, &'c dyn Fn(&Path) -> bool);

/// Proposals of a mutation from one path; each may lie in some of the cells.
///
/// The mean of `1 / T` over the proposals in a cell is the cell's measure. Returns the means in
/// standard errors from it.
fn cell_z(
    space: &PathSpace<'_>,
    (mutation, settings): (Mutation, &Perturbation),
    from: &Path,
    cells: &[Cell<'_>],
    stream: &mut Stream,
) -> Vec<f64> {
    let count = samples(250_000);
    let site = mutation.site(from).expect("the mutation applies");
    let mut sums = vec![(0.0, 0.0); cells.len()];
    let mut proposal = from.clone();
    for _ in 0..count {
        let paths = (from, &mut proposal);
        let proposed = mutation.propose(space, settings, site, paths, stream);
        for ((sum, square), (_, is_inside)) in sums.iter_mut().zip(cells) {
            if proposed.is_err() || !is_inside(&proposal) {
                continue;
            }
            let density = log_transition(mutation, space, settings, (from, &proposal));
            let density = density.unwrap_or_else(|| panic!("{mutation:?} made what it cannot"));
            let edges = dirac_edges(mutation, space, &proposal, site.last_changed);
            let weight = edges / density.exp();
            *sum += weight;
            *square += weight * weight;
        }
        proposal.set_raster(from.raster());
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
    let site = mutation.site(&x).expect("the mutation applies");
    let proposed = (0..1_000).any(|_| {
        y.copy_from(&x);
        let proposed = mutation.propose(&space, &settings, site, (&x, &mut y), stream);
        proposed.is_ok() && is_in_the_middle(&y)
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
        let cells: Vec<Cell<'_>> = squares
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
        inner: 0.001,
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
    let view = (Vec3::new(0.0, 2.0, 2.0), Vec3::new(0.0, 0.0, -2.0));
    let stage = Stage {
        sensor: lens_camera(view, 70.0, 0.1, 2.5),
        ..mirror_room()
    };
    let space = space(&stage);
    let mut stream = Stream::new(seed(66), Purpose::Check, 0, 0);
    let settings = Perturbation {
        raster: RasterKernel::Square { side: 0.01 },
        lens: 0.4,
        ..moves()
    };
    // Nothing is in the way: every move on the lens is possible.
    let mut from = path_of(&space, "EDP");
    let middle = space.sensor.lens_point(Vec2::new(0.1, -0.2));
    from.vertices_mut()[0].point.position = middle;
    let old = space.sensor.lens_coordinates(middle);
    let mut proposal = from.clone();
    let site = Mutation::Lens.site(&from).expect("the mutation applies");
    let mut rejected = 0_u32;
    let point = || {
        proposal.copy_from(&from);
        let paths = (&from, &mut proposal);
        let proposed = Mutation::Lens.propose(&space, &settings, site, paths, &mut stream);
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
