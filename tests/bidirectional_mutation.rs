//! The bidirectional mutation: the density of its proposals, by integrals of them, and its balance.

use lumiflow::math::statistics::{sidak, two_sided_p};
use lumiflow::mutation::{BidirectionalMutation, Move, SectionFault};
use lumiflow::path::{Event, Path, PathSpace, Weighing};

use crate::support::effort::{level, samples, seed};
use crate::support::factors::factors;
use crate::support::moments::Mean;
use crate::support::seeds::{TRACING, from_both_sides, numbers, space, trace, trace_both_sides};
use crate::support::stages::{SIDE, Stage, moves, stage_of, stages};
use crate::support::two_sided_light::beams;

/// Longest paths, in edges.
const MOST: usize = TRACING.max_depth as usize;

/// What is integrated for each number of edges: all light, that of the left half of the film, that which
/// meets a mirror or glass on its way, and that which does so next to the light.
const PARTS: usize = 4;

fn parts(path: &Path, energy: f64) -> [f64; PARTS] {
    let vertices = path.vertices();
    let only = |claim: bool| if claim { energy } else { 0.0 };
    [
        energy,
        only(path.raster().x < 0.5 * SIDE as f32),
        only(vertices.iter().any(|v| v.event.is_dirac())),
        only(path.edges() > 1 && vertices[path.edges() - 1].event.is_dirac()),
    ]
}

type Table = [[Mean; PARTS]; MOST + 1];

/// Means over samples, of each number of edges.
///
/// - `sample`: hands out the paths of a sample, with their energies.
fn tally(count: u32, mut sample: impl FnMut(u32, &mut dyn FnMut(&Path, f64))) -> Table {
    let mut table = Table::default();
    for index in 0..count {
        let mut sums = [[0.0; PARTS]; MOST + 1];
        sample(index, &mut |path, energy| {
            let row = &mut sums[path.edges()];
            let values = parts(path, energy);
            row.iter_mut().zip(values).for_each(|(sum, v)| *sum += v);
        });
        for (row, sums) in table.iter_mut().zip(sums) {
            row.iter_mut().zip(sums).for_each(|(mean, v)| mean.add(v));
        }
    }
    table
}

/// The light of paths of each number of edges, as path tracing finds it.
fn traced(stage: &Stage, (seed, count): (u64, u32)) -> Table {
    let space = space(stage);
    let mut path = Path::default();
    tally(count, |sample, add| {
        trace(&space, &TRACING, (seed, sample), &mut path, &mut |found| {
            if let Some(path) = found.path {
                add(path, found.luminance());
            }
        });
    })
}

/// The same, as subpaths from both sides find it.
fn found_from_both_sides(stage: &Stage, (seed, count): (u64, u32)) -> Table {
    let space = space(stage);
    let tracing = from_both_sides(Weighing::Square);
    let mut path = Path::default();
    tally(count, |sample, add| {
        trace_both_sides(&tracing, &space, (seed, sample), |both, found| {
            if both.assemble(&space, found, &mut path) {
                add(&path, f64::from(found.energy().luminance()));
            }
        });
    })
}

/// The same, by paths that the mutation makes when nothing stays.
fn made_afresh(
    stage: &Stage,
    mutation: &mut BidirectionalMutation,
    (seed, count): (u64, u32),
) -> Table {
    let space = space(stage);
    let settings = moves();
    let mut table = Table::default();
    let mut path = Path::default();
    for (edges, row) in table.iter_mut().enumerate().skip(2) {
        for sample in 0..count {
            let mut random = numbers(seed + edges as u64, sample);
            let made = mutation.sample_afresh(&space, &settings, (edges, &mut path), &mut random);
            let energy = made.map_or(0.0, |energy| energy / settings.domain.pixels());
            let values = match made {
                Ok(_) => parts(&path, energy),
                Err(_) => [0.0; PARTS],
            };
            row.iter_mut().zip(values).for_each(|(mean, v)| mean.add(v));
        }
    }
    table
}

/// The z-scores of all entries that either way has found often enough.
fn differences(a: &Table, b: &Table) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for edges in 2..=MOST {
        for part in 0..PARTS {
            let (a, b) = (&a[edges][part], &b[edges][part]);
            let is_known = |m: &Mean| m.sum > 0.0 && m.variance().sqrt() < 0.1 * m.mean();
            if is_known(a) && is_known(b) {
                found.push((format!("{edges} edges, part {part}"), a.z_against(b)));
            }
        }
    }
    found
}

#[test]
fn fresh_paths_of_every_length_bring_the_light_that_path_tracing_finds() {
    let count = samples(30_000);
    let mut all = Vec::new();
    for (index, stage) in stages().iter().enumerate() {
        let seed = seed(3000 + 20 * index as u64);
        let mut mutation = BidirectionalMutation::new(1, MOST);
        let traced = traced(stage, (seed, count));
        let afresh = made_afresh(stage, &mut mutation, (seed + 1, count));
        let found = differences(&traced, &afresh);
        println!("{}: {found:.2?}", stage.name);
        let of_stage = |(what, z): (String, f64)| (format!("{}, {what}", stage.name), z);
        all.extend(found.into_iter().map(of_stage));
    }
    assert!(all.len() > 60, "{} values", all.len());
    let level = sidak(level(1e-3), all.len());
    for (what, z) in all {
        assert!(two_sided_p(z) > level, "{what}: z = {z:.2}");
    }
}

/// Light of points and beams that mirrors or glass send on, which path tracing does not find.
#[test]
fn fresh_paths_bring_the_light_that_is_found_from_both_sides() {
    let count = samples(60_000);
    let mut all = Vec::new();
    let names = ["point and spot", "open air", "glass ball"];
    let stages = names.map(stage_of).into_iter().chain([beams().into()]);
    for stage in stages {
        let name = stage.name;
        let both = found_from_both_sides(&stage, (seed(3500), count));
        let new = || BidirectionalMutation::new(1, MOST);
        let mut mutation = new().among_seeds_of_both_sides();
        let afresh = made_afresh(&stage, &mut mutation, (seed(3501), count));
        let found = differences(&both, &afresh);
        println!("{name}: {found:.2?}");
        all.extend(found);
        if ["point and spot", "beams"].contains(&name) {
            let without = made_afresh(&stage, &mut new(), (seed(3501), count));
            let lost = differences(&both, &without);
            assert!(lost.iter().any(|(_, z)| z.abs() > 6.0), "{lost:.2?}");
        }
    }
    assert!(all.len() > 12, "{} values", all.len());
    let level = sidak(level(1e-3), all.len());
    for (what, z) in all {
        assert!(two_sided_p(z) > level, "{what}: z = {z:.2}");
    }
}

/// Names of functions of a path.
const NAMES: [&str; 10] = [
    "edges",
    "Dirac events",
    "luminance",
    "raster x",
    "raster y",
    "image cosine",
    "image distance²",
    "first edge²",
    "last edge²",
    "last cosine",
];

fn functions(space: &PathSpace<'_>, path: &Path) -> [f64; NAMES.len()] {
    let of = factors(space, path);
    let vertices = path.vertices();
    let last = path.edges();
    let edge = |a: usize, b: usize| space.edge(&vertices[a], &vertices[b]).expect("an edge");
    let dirac = vertices.iter().filter(|v| v.event.is_dirac()).count();
    let (to_light, last_squared) = edge(last - 1, last);
    let is_lamp = matches!(vertices[last].event, Event::Emission(_));
    assert!(is_lamp, "a path ends at a light");
    [
        last as f64,
        dirac as f64,
        of[15],
        of[16],
        of[17],
        of[0],
        of[1],
        f64::from(edge(1, 2).1).ln(),
        f64::from(last_squared).ln(),
        f64::from(vertices[last].geometric_cos(to_light))
            .max(1e-3)
            .ln(),
    ]
}

/// The flow of each function along with the energy that the mutation moves, in standard errors.
fn flow(
    stage: &Stage,
    mutation: &mut BidirectionalMutation,
    (seed, count): (u64, u32),
) -> (u64, Vec<(&'static str, f64)>) {
    let space = space(stage);
    let settings = moves();
    let mut means = [Mean::default(); NAMES.len()];
    let (mut path, mut proposal) = (Path::default(), Path::default());
    let mut proposals = 0;
    for sample in 0..count {
        let mut random = numbers(seed, sample);
        let mut sums = [0.0; NAMES.len()];
        trace(&space, &TRACING, (seed, sample), &mut path, &mut |found| {
            let energy = found.luminance();
            let Some(x) = found.path.filter(|x| energy > 0.0 && mutation.applies(x)) else {
                return;
            };
            let paths = (x, &mut proposal);
            let Ok(ratio) = mutation.propose(&space, &settings, paths, &mut random) else {
                return;
            };
            proposals += 1;
            let acceptance = if ratio.is_finite() {
                ratio.min(1.0)
            } else {
                0.0
            };
            let (from, to) = (functions(&space, x), functions(&space, &proposal));
            for (sum, (from, to)) in sums.iter_mut().zip(from.into_iter().zip(to)) {
                *sum += energy * acceptance * (to - from).clamp(-3.0, 3.0);
            }
        });
        means.iter_mut().zip(sums).for_each(|(mean, v)| mean.add(v));
    }
    let z = NAMES.into_iter().zip(means).filter_map(|(name, mean)| {
        let deviation = mean.variance().sqrt();
        (deviation > 0.0).then(|| (name, mean.mean() / deviation))
    });
    (proposals, z.collect())
}

fn mutation() -> BidirectionalMutation {
    BidirectionalMutation::new(2, MOST)
}

#[test]
fn energy_flows_back_as_it_flows_away() {
    let mut all = Vec::new();
    for (index, stage) in stages().iter().enumerate() {
        let numbers = (seed(4000 + index as u64), samples(60_000));
        let (proposals, found) = flow(stage, &mut mutation(), numbers);
        println!("{}: {proposals} proposals, {found:.2?}", stage.name);
        let of_stage = |(what, z): (&str, f64)| (format!("{}, {what}", stage.name), z);
        all.extend(found.into_iter().map(of_stage));
    }
    let level = sidak(level(1e-3), all.len());
    for (what, z) in all {
        assert!(two_sided_p(z) > level, "{what}: z = {z:.2}");
    }
}

/// Stages where faults show in what flows, and samples; the one that is left out shows in the light of fresh
/// paths.
const PLANTED: [(SectionFault, &str, u32); 9] = [
    (SectionFault::Deletion, "diffuse box", 40_000),
    (SectionFault::Addition, "diffuse box", 40_000),
    (SectionFault::OneWay, "diffuse box", 40_000),
    (SectionFault::Forward, "diffuse box", 40_000),
    (SectionFault::Connection, "diffuse box", 40_000),
    (SectionFault::Lens, "diffuse box", 40_000),
    (SectionFault::Explicit, "diffuse box", 200_000),
    (SectionFault::Emission, "mirror hall", 200_000),
    (SectionFault::Cosine, "diffuse box", 40_000),
];

#[test]
fn planted_errors_are_found() {
    let level = sidak(1e-3, PLANTED.len() * NAMES.len());
    let worst = |found: &[(&'static str, f64)]| {
        let farthest = found.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        farthest.copied().unwrap_or(("nothing", 0.0))
    };
    println!("| fault | stage | largest | z | right |\n|---|---|---|---|---|");
    let mut missed = Vec::new();
    for (fault, name, count) in PLANTED {
        let stage = stage_of(name);
        let numbers = (seed(77), count);
        let (_, wrong) = flow(&stage, &mut mutation().with_fault(fault), numbers);
        let (_, right) = flow(&stage, &mut mutation(), numbers);
        let ((what, z), (_, clean)) = (worst(&wrong), worst(&right));
        println!("| {fault:?} | {name} | {what} | {z:.1} | {clean:.1} |");
        if two_sided_p(z) > level || two_sided_p(clean) < level {
            missed.push(format!("{fault:?}: {z:.1}, {clean:.1}"));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// The same faults in the integrals of fresh paths: each brings too much or too little light.
#[test]
fn planted_errors_change_the_light_of_fresh_paths() {
    let faults = SectionFault::ALL.into_iter().filter(|fault| {
        // A path that is made from nothing has nothing taken out.
        !matches!(fault, SectionFault::Deletion | SectionFault::Addition)
    });
    for fault in faults {
        let found = ["diffuse box", "mirror hall", "open air"].map(|name| {
            let (stage, seed) = (stage_of(name), seed(5000));
            let mut wrong = BidirectionalMutation::new(1, MOST).with_fault(fault);
            let traced = traced(&stage, (seed, samples(30_000)));
            let afresh = made_afresh(&stage, &mut wrong, (seed + 1, samples(30_000)));
            let found = differences(&traced, &afresh);
            found.iter().map(|(_, z)| z.abs()).fold(0.0, f64::max)
        });
        println!("{fault:?}: {found:.1?}");
        let largest = found.into_iter().fold(0.0, f64::max);
        assert!(two_sided_p(largest) < 1e-6, "{fault:?}: {found:.1?}");
    }
}

#[test]
fn proposals_are_paths() {
    let mut random = numbers(seed(8), 0);
    let tolerance = lumiflow::path::Tolerance::default();
    let mut moved = 0;
    for stage in stages() {
        let space = space(&stage);
        let settings = moves();
        let mut chain = lumiflow::mutation::Chain::default();
        let mut mutation = mutation();
        let mut path = Path::default();
        let mut broken = 0_u32;
        for sample in 0..300 {
            trace(
                &space,
                &TRACING,
                (seed(9), sample),
                &mut path,
                &mut |found| {
                    let Some(x) = found.path.filter(|x| mutation.applies(x)) else {
                        return;
                    };
                    chain.start(x);
                    for _ in 0..4 {
                        let by = (&mut mutation, |_: &Path| 1.0);
                        let made = chain.propose_bidirectional(&space, &settings, by, &mut random);
                        let Some(proposed) = made else { continue };
                        let is_accepted = random.next_f32() < proposed.acceptance as f32;
                        chain.settle(proposed, is_accepted);
                        if is_accepted {
                            moved += 1;
                            let verified = chain.current().verify(&space, &tolerance);
                            if let Err(error) = verified {
                                broken += 1;
                                println!(
                                    "{}: {}: {error}",
                                    stage.name,
                                    chain.current().signature()
                                );
                            }
                        }
                    }
                },
            );
        }
        let all = chain.statistics[Move::Bidirectional.index()].accepted;
        println!("{}: {broken} of {all} broken", stage.name);
        assert!(
            f64::from(broken) <= 0.002 * all as f64 + 1.0,
            "{}",
            stage.name
        );
    }
    assert!(moved > 1000, "{moved}");
}
