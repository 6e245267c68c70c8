//! Populations move energy about and leave the mean picture as it is; what was published does not.

use crate::support::effort::{is_proof, samples};
use crate::support::hard_scenes::{
    View, body_in_glass, bumpy_mirror, glass_caustic, indirect, many_lights, mirror_caustic,
    out_of_focus, plastics,
};
use crate::support::render::{mean, picture, settings};
use crate::support::same_mean::{Reference, SIDE, Way};
use crate::support::stages::stage_of;
use lumiflow::film::{Filter, FilterKind};
use lumiflow::integrator::PixelSettings;

/// Populations so small that members are eliminated, and kernels so large that much is refused.
const WAYS: [&str; 6] = [
    "rounds=4 mutations=4 radii=2,5",
    "rounds=12 mutations=1 radii=1,3,9 map_cell=4 direct_samples=1 reach_power=1",
    "rounds=2 mutations=16 radii=4 expected_values=false separate_direct=false resampling_rate=0.8",
    "rounds=3 mutations=4 radii=2,6 proposal_density=mixture map_cell=4",
    "rounds=1 mutations=8 transfer=balance radii=2,5",
    "rounds=3 mutations=3 transfer=balance adaptation=off max_members=2 radii=3",
];

fn way(options: &str, passes: u32) -> Way {
    Way {
        options: format!("pmc-er population=40 mutations_per_sample=20 {options}"),
        passes,
    }
}

/// Checks some ways with one scene, so that three scenes see all of them; all for the proof.
///
/// - `number`: of the scene.
fn check(number: usize, view: &View) -> Result<(), String> {
    let chosen = WAYS
        .iter()
        .enumerate()
        .filter(|(index, _)| is_proof() || index % 3 == number % 3);
    let passes = if is_proof() { 24 } else { 6 };
    let ways = chosen.map(|(_, options)| way(options, passes));
    Reference::new(view).check_all(view, ways)
}

#[test]
fn diffuse_light_stays_the_same() -> Result<(), String> {
    check(0, &indirect(SIDE))
}

#[test]
fn caustics_stay_the_same() -> Result<(), String> {
    check(1, &glass_caustic(SIDE, 1.0))?;
    check(2, &mirror_caustic(SIDE))
}

#[test]
fn bodies_in_glass_stay_the_same() -> Result<(), String> {
    check(2, &body_in_glass(SIDE))
}

#[test]
fn many_lobes_stay_the_same() -> Result<(), String> {
    check(0, &plastics(SIDE))?;
    check(1, &bumpy_mirror(SIDE))
}

#[test]
fn what_is_out_of_focus_stays_the_same() -> Result<(), String> {
    check(1, &out_of_focus(SIDE))
}

#[test]
fn light_from_everywhere_stays_the_same() -> Result<(), String> {
    check(2, &many_lights(SIDE))
}

/// Life by energy, as published: brighter where seeds are strong.
#[test]
fn the_published_scheme_is_found_to_be_biased() {
    let view = indirect(SIDE);
    let reference = Reference::new(&view);
    let options = "pmc-er scheme=lai population=1000 mutations_per_sample=40 mutations=2 radii=2,5";
    let way = Way {
        options: options.to_owned(),
        passes: samples(8),
    };
    let found = reference.check(&view, &view, &way);
    println!("{found:?}");
    assert!(found.is_err());
}

/// Wide filters need samples beside the film, whose directions a spherical sensor sees on the film, too.
#[test]
fn seeds_beside_a_spherical_film_keep_their_energy() {
    let stage = stage_of("spherical");
    let wide = || PixelSettings {
        filter: Filter::new(FilterKind::Gaussian { stddev: 0.8 }).expect("a filter"),
        ..settings(12, SIDE)
    };
    let look = |text: &str| mean(&picture(&stage.scene, &stage.sensor, text, wide(), 64));
    let expected = look("path max_depth=6");
    assert!(expected > 0.0);
    for text in ["erpt max_depth=6", "pmc-er max_depth=6"] {
        let found = look(text);
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{text}: {found}, not {expected}"
        );
    }
}
