//! Paths are what they say, whatever made them: the path tracer, or a long chain of mutations.

use lumiflow::math::{Rgb, Vec3};
use lumiflow::mutation::{
    BidirectionalMutation, CausticPerturbation, Chain, Choice, Choose, Move, Mutate, Mutation,
    Perturbation, Proposed,
};
use lumiflow::path::{Claim, Event, Path, PathRules, PathSpace, PathVertex, Tolerance};
use lumiflow::random::{Purpose, Stream};
use lumiflow::scene::EmitterId;
use lumiflow::sensor::SensorModel;

use crate::indifference::stage as plastic;
use crate::instances::placed;
use crate::support::effort::samples;
use crate::support::scenes::camera;
use crate::support::seeds::{TRACING, numbers, space, trace};
use crate::support::stages::{SIDE, Stage, moves, moves_in_pixels, stage_of, stages};

/// Steps of a chain.
const LENGTH: u32 = 60;

/// Runs chains of one mutation from a stage's paths; hands out every accepted state.
fn states(stage: &Stage, mutation: Mutation, wanted: u32, mut state: impl FnMut(&Path)) -> u32 {
    let space = space(stage);
    let (mut path, mut chain) = (Path::default(), Chain::default());
    let mut weights = [0.0; Mutation::COUNT];
    weights[mutation as usize] = 1.0;
    let choice = Choice {
        weights,
        by_rule: false,
    };
    let mut accepted = 0;
    for sample in 0..30 * wanted {
        let mut random = numbers(31, sample);
        trace(&space, &TRACING, (31, sample), &mut path, &mut |found| {
            let seed = found.path.filter(|seed| choice.choose(seed, 0.0).is_some());
            let Some(seed) = seed.filter(|_| accepted < wanted) else {
                return;
            };
            chain.start(seed);
            for _ in 0..LENGTH {
                let proposed = chain.propose(&space, &moves(), &choice, &mut random);
                let Some(proposed) = proposed else { continue };
                let is_accepted = f64::from(random.next_f32()) < proposed.acceptance;
                chain.settle(proposed, is_accepted);
                if is_accepted {
                    accepted += 1;
                    state(chain.current());
                }
            }
        });
        if accepted >= wanted {
            break;
        }
    }
    accepted
}

#[test]
fn the_tracer_makes_paths_that_are_what_they_say() {
    let tolerance = Tolerance::default();
    let mut count = 0;
    for stage in stages() {
        let space = space(&stage);
        let mut path = Path::default();
        for sample in 0..samples(300) {
            trace(&space, &TRACING, (30, sample), &mut path, &mut |found| {
                let Some(path) = found.path else { return };
                count += 1;
                if let Err(broken) = path.verify(&space, &tolerance) {
                    panic!("{}: {}: {broken}", stage.name, path.signature());
                }
            });
        }
    }
    assert!(count > 3000, "{count}");
}

#[test]
fn chains_go_to_paths_that_are_what_they_say() {
    let tolerance = Tolerance::default();
    let mut totals = [0; Mutation::COUNT];
    for stage in stages() {
        for mutation in Mutation::ALL {
            let space = space(&stage);
            totals[*mutation as usize] += states(&stage, *mutation, samples(1_200), |path| {
                if let Err(broken) = path.verify(&space, &tolerance) {
                    let name = mutation.name();
                    panic!("{} {name}: {}: {broken}", stage.name, path.signature());
                }
            });
        }
    }
    println!("accepted states: {totals:?}");
    assert!(totals.iter().all(|total| *total >= 10_000), "{totals:?}");
}

/// One step of a chain that mixes all mutations, those that change the length of a path too.
fn any_proposal(
    chain: &mut Chain,
    (space, settings): (&PathSpace<'_>, &Perturbation),
    bidirectional: &mut BidirectionalMutation,
    random: &mut Stream,
) -> Option<Proposed> {
    if random.next_f32() < 0.1 {
        let mutation = (bidirectional, |_: &Path| 1.0);
        return chain.propose_bidirectional(space, settings, mutation, random);
    }
    let choice = Choice {
        weights: [1.0; Mutation::COUNT],
        by_rule: false,
    };
    chain.propose(space, settings, &choice, random)
}

#[test]
fn a_proposal_keeps_nothing_of_those_before() {
    let mut made = [0_u32; Mutation::COUNT + 1];
    // Plastic scatters otherwise towards a vertex that has moved, even where it stays.
    for stage in stages().into_iter().chain([plastic(0.1)]) {
        let space = space(&stage);
        let (mut path, mut chain, mut afresh) = Default::default();
        let mut bidirectional = BidirectionalMutation::new(1, 8);
        let settings = [moves(), moves_in_pixels(&stage.sensor)];
        for sample in 0..samples(60) {
            let mut random = numbers(33, sample);
            let settings = &settings[sample as usize % 2];
            trace(&space, &TRACING, (33, sample), &mut path, &mut |found| {
                let Some(seed) = found.path else { return };
                Chain::start(&mut chain, seed);
                for _ in 0..LENGTH {
                    Chain::start(&mut afresh, chain.current());
                    let mut same = random.clone();
                    let again = any_proposal(
                        &mut afresh,
                        (&space, settings),
                        &mut bidirectional,
                        &mut same,
                    );
                    let found = any_proposal(
                        &mut chain,
                        (&space, settings),
                        &mut bidirectional,
                        &mut random,
                    );
                    let what = format!("{} {}", stage.name, seed.signature());
                    assert_eq!(found, again, "{what}");
                    assert_eq!(chain.tried(), afresh.tried(), "{what}");
                    let Some(proposed) = found else { continue };
                    // All that there is of a path, each number to the bit.
                    let all = |path: &Path| format!("{} {:?}", path.raster(), path.vertices());
                    assert_eq!(all(chain.proposal()), all(afresh.proposal()), "{what}");
                    if let Move::Perturbation(mutation) = proposed.made_by {
                        let site = mutation
                            .site(chain.current())
                            .expect("the mutation applies");
                        let behind = |path: &Path| {
                            format!("{:?}", &path.vertices()[site.last_changed + 1..])
                        };
                        assert_eq!(behind(chain.proposal()), behind(chain.current()), "{what}");
                    }
                    made[proposed.made_by.index()] += 1;
                    let is_accepted = f64::from(random.next_f32()) < proposed.acceptance;
                    chain.settle(proposed, is_accepted);
                }
            });
        }
    }
    assert!(made.iter().all(|count| *count > 100), "{made:?}");
}

#[test]
fn vertices_are_made_in_their_place_as_elsewhere() {
    let mut stages = stages();
    stages.push(Stage {
        name: "instances",
        scene: placed(Vec3::ZERO),
        sensor: camera(Vec3::new(0.5, 2.5, 5.0), Vec3::Y, 40.0, SIDE),
    });
    let (mut met, mut on_instances) = ([0_u32; 2], 0_u32);
    for (stage, hide_emitters) in stages
        .iter()
        .flat_map(|stage| [(stage, false), (stage, true)])
    {
        let rules = PathRules {
            hide_emitters,
            ..PathRules::default()
        };
        let space = PathSpace::new(&stage.scene, &stage.sensor, rules);
        let mut random = Stream::new(34, Purpose::Check, 0, 0);
        // What was there before is another vertex, of another kind.
        let mut place = PathVertex::environment(Vec3::X, Rgb::WHITE, EmitterId(7));
        (place.adjoint, place.point.error) = (3.0, 5.0);
        for _ in 0..2_000 {
            let raster = random.next_vec2() * SIDE as f32;
            let camera = stage.sensor.sample_ray(raster, random.next_vec2());
            let (ray, event) = (camera.to_ray(), Event::Finite);
            let before = space.rays();
            let object = space.meet_at(ray, true, event, &mut place);
            let rays = space.rays() - before;
            let elsewhere = space.meet(ray, true);
            assert_eq!(space.rays() - before, 2 * rays);
            let Some(elsewhere) = elsewhere else {
                assert!(object.is_none());
                continue;
            };
            let object = object.expect("both find the surface");
            assert_eq!(object.lobes, elsewhere.lobes);
            let vertex = PathVertex::surface(&elsewhere, event);
            assert_eq!(format!("{place:?}"), format!("{vertex:?}"));
            met[usize::from(vertex.emitter().is_some())] += 1;
            let in_world = stage.scene.objects_in_world().len();
            on_instances += u32::from(vertex.object().is_some_and(|index| index >= in_world));
        }
    }
    assert!(met[0] > 20_000 && met[1] > 100, "{met:?}");
    assert!(on_instances > 500, "{on_instances}");
}

#[test]
fn paths_that_are_not_what_they_say_are_found() {
    let stage = stage_of("mirror hall");
    let space = space(&stage);
    let tolerance = Tolerance::default();
    let mut random = Stream::new(32, Purpose::Check, 0, 0);
    let mut found = Vec::new();
    states(&stage, Mutation::Caustic, 4_000, |path| {
        if !CausticPerturbation::is_caustic(path) {
            return;
        }
        let mut broken = |change: &dyn Fn(&mut Path)| {
            let mut copy = path.clone();
            change(&mut copy);
            found.extend(copy.verify(&space, &tolerance).err().map(|b| b.claim));
        };
        let by = 1.0 + 0.1 * (0.5 + random.next_f32());
        let last = path.edges();
        broken(&|p| p.set_raster(p.raster() + 0.1 * by));
        broken(&|p| p.vertices_mut()[1].value *= by);
        broken(&|p| p.vertices_mut()[2].adjoint *= by);
        broken(&|p| p.vertices_mut()[last].value *= by);
        broken(&|p| p.vertices_mut()[0].event = p.vertices()[1].event);
        broken(&|p| {
            let normal = &mut p.vertices_mut()[2].point.shading_normal;
            *normal = (*normal + Vec3::splat(0.02 * by)).normalize();
        });
    });
    for claim in [
        Claim::Raster,
        Claim::Value,
        Claim::Adjoint,
        Claim::Emission,
        Claim::Shape,
        Claim::Direction,
    ] {
        let count = found.iter().filter(|found| **found == claim).count();
        assert!(count >= 100, "{claim:?} was found {count} times");
    }
}
