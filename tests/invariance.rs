//! Chains of any length, under any flow rule, move energy about and leave the mean picture as it is.

use crate::support::effort::is_proof;
use crate::support::hard_scenes::{
    View, body_in_glass, bumpy_mirror, glass_caustic, indirect, many_lights, mirror_caustic,
    out_of_focus, plastics,
};
use crate::support::same_mean::{Reference, SIDE, Way};

/// The flow rules, each with chains of four lengths, shortest first.
fn ways() -> [[Way; 4]; 4] {
    let equal = |expected: bool| {
        [(1, 30, 6), (10, 30, 6), (100, 50, 3), (1000, 100, 3)].map(
            |(length, mutations, passes)| Way {
                options: format!(
                    "erpt chain_length={length} mutations_per_sample={mutations} expected_values={expected}"
                ),
                passes,
            },
        )
    };
    let detailed = [(1, 24), (10, 6), (100, 2), (1000, 1)].map(|(proposals, passes)| Way {
        options: format!("erpt flow=detailed chain_length={proposals}"),
        passes,
    });
    let iterated = [(1, 1, 16), (1, 4, 6), (2, 3, 6), (1, 8, 3)].map(|(proposals, depth, passes)| Way {
        options: format!(
            "erpt flow=iterated flow_proposals={proposals} flow_depth={depth} mutations_per_sample=10"
        ),
        passes,
    });
    [equal(true), equal(false), detailed, iterated]
}

/// Options that change how paths are mutated, or which ones. Large moves make errors large.
const MUTATIONS: [&str; 4] = [
    "direct_samples=1 lens_size=12 angle_largest=0.5",
    "separate_direct=false lens_shape=log lens_size=8",
    "direct_samples=1 caustic_pixels=8 lens_shape=disk lens_size=6",
    "direct_samples=1 mutation_choice=mixture lai_lens_perturbation=true angle_largest=0.5",
];

/// The ways to try with one scene: all of them for the proof, else one of each flow rule, so that
/// four scenes see all of them.
///
/// - `scene`: its number.
fn ways_for(scene: usize) -> Vec<Way> {
    let mut chosen = Vec::new();
    for (flow, ways) in ways().into_iter().enumerate() {
        for (length, mut way) in ways.into_iter().enumerate() {
            // A thousand proposals from every seed take too long.
            let is_slow = flow == 2 && length == 3;
            if is_proof() || (length == (scene + flow) % 4 && !is_slow) {
                let mutations = MUTATIONS[(scene + scene / 4 + length) % 4];
                way.options = format!("{} {mutations}", way.options);
                if is_proof() && !is_slow {
                    way.passes *= 4;
                }
                chosen.push(way);
            }
        }
    }
    chosen
}

fn check(scene: usize, view: &View) -> Result<(), String> {
    Reference::new(view).check_all(view, ways_for(scene))
}

#[test]
fn diffuse_light_stays_the_same() -> Result<(), String> {
    check(0, &indirect(SIDE))
}

#[test]
fn caustics_of_glass_stay_the_same() -> Result<(), String> {
    check(1, &glass_caustic(SIDE, 1.0))
}

#[test]
fn caustics_of_mirrors_stay_the_same() -> Result<(), String> {
    check(2, &mirror_caustic(SIDE))
}

#[test]
fn bodies_in_glass_stay_the_same() -> Result<(), String> {
    check(3, &body_in_glass(SIDE))
}

#[test]
fn plastic_stays_the_same() -> Result<(), String> {
    check(4, &plastics(SIDE))
}

#[test]
fn bumpy_mirrors_stay_the_same() -> Result<(), String> {
    check(5, &bumpy_mirror(SIDE))
}

#[test]
fn what_is_out_of_focus_stays_the_same() -> Result<(), String> {
    check(6, &out_of_focus(SIDE))
}

#[test]
fn light_from_everywhere_stays_the_same() -> Result<(), String> {
    check(7, &many_lights(SIDE))
}

#[test]
fn chains_that_make_or_lose_light_are_found() {
    let view = glass_caustic(SIDE, 1.0);
    let reference = Reference::new(&view);
    let way = |options: &str| Way {
        options: options.to_owned(),
        passes: 2,
    };
    // Three per cent too much.
    let brighter = glass_caustic(SIDE, 1.03);
    let options = "erpt chain_length=10 mutations_per_sample=30 separate_direct=false";
    assert!(reference.check(&brighter, &view, &way(options)).is_err());
    // Caustics are left out.
    let options = format!("{options} max_depth=3");
    assert!(reference.check(&view, &view, &way(&options)).is_err());
}
