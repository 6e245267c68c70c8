//! Metropolis sampling leaves the mean picture as it is, however short its passes are.

use crate::support::effort::is_proof;
use crate::support::hard_scenes::{
    View, body_in_glass, bumpy_mirror, glass_caustic, indirect, many_lights, mirror_caustic,
    out_of_focus, plastics,
};
use crate::support::render::{mean, picture, settings};
use crate::support::same_mean::{Reference, SIDE, Way};
use crate::support::stages::stage_of;
use lumiflow::film::{Filter, FilterKind};
use lumiflow::integrator::PixelSettings;

/// Bootstrap sets so small that a seed is often one of few, and chains of very different lengths.
const WAYS: [&str; 6] = [
    "pssmlt mutations_per_pixel=20 chains=64",
    "pssmlt mutations_per_pixel=20 chains=3 deposits=expected direct_samples=2",
    "pssmlt mutations_per_pixel=20 chains=100 deposits=expected target=path p_large=0.1",
    "pssmlt mutations_per_pixel=20 chains=500 deposits=expected p_large=0 step_largest=0.2 separate_direct=false",
    "pssmlt mutations_per_pixel=10 chains=20 p_large=0.8 rr_depth=2",
    "pssmlt mutations_per_pixel=20 chains=30 deposits=expected target=path separate_direct=false",
];

/// Checks some ways with one scene, so that three scenes see all of them; all for the proof.
///
/// - `number`: of the scene.
fn check(number: usize, view: &View) -> Result<(), String> {
    let chosen = WAYS
        .iter()
        .enumerate()
        .filter(|(index, _)| is_proof() || index % 3 == number % 3);
    let passes = if is_proof() { 24 } else { 4 };
    let ways = chosen.map(|(_, options)| Way {
        options: (*options).to_owned(),
        passes,
    });
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
    check(0, &body_in_glass(SIDE))
}

#[test]
fn many_lobes_stay_the_same() -> Result<(), String> {
    check(1, &plastics(SIDE))?;
    check(2, &bumpy_mirror(SIDE))
}

#[test]
fn what_is_out_of_focus_stays_the_same() -> Result<(), String> {
    check(1, &out_of_focus(SIDE))
}

#[test]
fn light_from_everywhere_stays_the_same() -> Result<(), String> {
    check(2, &many_lights(SIDE))
}

#[test]
fn samples_that_make_or_lose_light_are_found() {
    let view = indirect(SIDE);
    let reference = Reference::new(&view);
    let way = |options: &str| Way {
        options: format!("{}{options}", WAYS[0]),
        passes: 4,
    };
    assert_eq!(reference.check(&view, &view, &way("")), Ok(()));
    // The longest paths are left out.
    assert!(reference.check(&view, &view, &way(" max_depth=5")).is_err());
}

/// Wide filters need samples beside the film, whose directions a spherical sensor sees on the film, too.
#[test]
fn paths_beside_a_spherical_film_keep_their_energy() {
    let stage = stage_of("spherical");
    let wide = || PixelSettings {
        filter: Filter::new(FilterKind::Gaussian { stddev: 0.8 }).expect("a filter"),
        ..settings(12, SIDE)
    };
    let look = |text: &str| mean(&picture(&stage.scene, &stage.sensor, text, wide(), 64));
    let expected = look("path max_depth=6");
    assert!(expected > 0.0);
    let found = look("pssmlt max_depth=6");
    assert!(
        (found / expected - 1.0).abs() < 0.03,
        "{found}, not {expected}"
    );
}
