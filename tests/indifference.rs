//! What belongs to the sampler alone changes no chain: selection probabilities of lobes and lights,
//! Russian roulette and the heuristic change energies, and not one bit of a target or an acceptance.

use lumiflow::bsdf::{Bsdf, Diffuse, Plastic, RelativeIor};
use lumiflow::math::{Mat3, Rgb, Vec2, Vec3};
use lumiflow::mutation::{Chain, Choice, Move, Mutate, Mutation};
use lumiflow::path::{Generation, Heuristic, Path, PathSpace, PathTracing, Technique};
use lumiflow::scene::SceneBuilder;
use lumiflow::shape::Shape;
use lumiflow::texture::{Checkerboard, Texture};

use crate::support::effort::samples;
use crate::support::scenes::{camera, rectangle, sphere};
use crate::support::seeds::{TRACING, numbers, space, trace};
use crate::support::stages::{SIDE, Stage, moves};

/// A colour that is the same all over a surface; `hidden` lies beyond it, and changes the mean that
/// samplers look at.
fn colour(seen: Rgb, hidden: f32) -> Texture {
    let scale = Mat3::from_scale(Vec2::splat(0.01));
    Checkerboard::new([seen, Rgb::grey(hidden)], scale).into()
}

/// Plastic bodies under two lamps, with textures whose hidden parts differ.
pub(crate) fn stage(hidden: f32) -> Stage {
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    let plastic = || {
        let base = colour(Rgb::new(0.6, 0.4, 0.3), hidden);
        Plastic::new(ior, colour(Rgb::WHITE, 1.0 - hidden), base, false)
    };
    let mut builder = SceneBuilder::new();
    let mut add = |shape: Shape, bsdf: Bsdf, radiance| {
        let bsdf = builder.add_bsdf(bsdf);
        let added = builder.add_shape(shape, bsdf, radiance);
        added.expect("the shape has an area");
    };
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0);
    add(floor.into(), plastic().into(), None);
    let ball = sphere(Vec3::new(0.0, 0.7, 0.0), 0.5);
    add(ball.into(), plastic().into(), None);
    for (x, hidden) in [(-0.7, hidden), (0.9, 1.0 - hidden)] {
        let lamp = rectangle(Vec3::new(x, 2.0, 0.0), Vec3::X * 0.4, Vec3::Z * 0.6);
        let radiance = colour(Rgb::new(5.0, 4.0, 3.0), 20.0 * hidden);
        add(lamp.into(), Diffuse::new(0.0).into(), Some(radiance));
    }
    Stage {
        name: "plastic",
        scene: builder.build().expect("the tracer takes the geometry"),
        sensor: camera(
            Vec3::new(0.0, 1.6, 2.2),
            Vec3::new(0.0, 0.3, 0.0),
            50.0,
            SIDE,
        ),
    }
}

/// Estimates of a path by both techniques.
fn estimates(space: &PathSpace<'_>, path: &Path, rr_depth: u32) -> [Option<f64>; 2] {
    [Technique::Implicit, Technique::Explicit].map(|technique| {
        let made = Generation {
            technique,
            rr_depth,
        };
        space.estimate(path, made).map(|estimate| estimate.x)
    })
}

/// What a chain does from a path: target, acceptance and place of each proposal.
fn chain_of(space: &PathSpace<'_>, seed: &Path, sample: u32) -> Vec<[u64; 4]> {
    let choice = Choice {
        weights: [1.0; Mutation::COUNT],
        by_rule: false,
    };
    let mut random = numbers(51, sample);
    let mut chain = Chain::default();
    chain.start(seed);
    let mut bits = Vec::new();
    for _ in 0..8 {
        let Some(proposed) = chain.propose(space, &moves(), &choice, &mut random) else {
            bits.push([0; 4]);
            continue;
        };
        let Move::Perturbation(mutation) = proposed.made_by else {
            panic!("no other move was asked for");
        };
        let site = mutation.site(seed).expect("the mutation applies");
        let target = mutation.target(space, &moves(), chain.proposal(), site);
        let raster = chain.proposal().raster().as_dvec2();
        let numbers = [target, proposed.acceptance, raster.x, raster.y];
        bits.push(numbers.map(f64::to_bits));
        let is_accepted = f64::from(random.next_f32()) < proposed.acceptance;
        chain.settle(proposed, is_accepted);
    }
    bits
}

#[test]
fn the_samplers_probabilities_change_no_chain() {
    let (a, b) = (stage(0.1), stage(0.8));
    let (in_a, in_b) = (space(&a), space(&b));
    let mut path = Path::default();
    let (mut compared, mut different) = (0_u32, 0_u32);
    for sample in 0..samples(6_000) {
        trace(&in_a, &TRACING, (50, sample), &mut path, &mut |found| {
            let Some(seed) = found.path else { return };
            let chains = [&in_a, &in_b].map(|space| chain_of(space, seed, sample));
            assert_eq!(chains[0], chains[1], "{}", seed.signature());
            compared += 1;
            let all = [
                estimates(&in_a, seed, 3),
                estimates(&in_b, seed, 3),
                estimates(&in_a, seed, 5),
            ];
            different += u32::from(all[0] != all[1] || all[0] != all[2]);
        });
    }
    assert!(compared > 2_500, "{compared} paths");
    assert!(different > compared / 2, "{different} of {compared}");
}

#[test]
fn roulette_and_heuristic_change_no_chain() {
    let stage = stage(0.1);
    let space = space(&stage);
    // The same numbers make the same paths as long as roulette ends none.
    let tracings =
        [(3, Heuristic::Power), (4, Heuristic::Balance)].map(|(rr_depth, heuristic)| PathTracing {
            rr_depth,
            heuristic,
            ..TRACING
        });
    let mut path = Path::default();
    let (mut compared, mut different) = (0, 0);
    for sample in 0..samples(6_000) {
        let mut runs = tracings.map(|tracing| {
            let mut paths: Vec<(Path, f64)> = Vec::new();
            trace(&space, &tracing, (52, sample), &mut path, &mut |found| {
                let energy = found.luminance();
                paths.extend(found.path.map(|path| (path.clone(), energy)));
            });
            paths
        });
        let [first, second] = &mut runs;
        // Up to three edges, nothing depends on roulette but energies.
        for ((x, energy_x), (y, energy_y)) in first.iter().zip(second) {
            if x.edges() > 3 || y.edges() > 3 || x.value() != y.value() {
                break;
            }
            compared += 1;
            different += u32::from(energy_x != energy_y);
            let chains = [x, y].map(|seed| chain_of(&space, seed, sample));
            assert_eq!(chains[0], chains[1], "{}", x.signature());
        }
    }
    assert!(compared > 2_000, "{compared} paths");
    assert!(different > compared / 8, "{different} of {compared}");
}
