//! Metropolis sampling leaves the mean picture as it is, however short its passes are.

use crate::support::effort::{is_proof, level, samples, seed};
use crate::support::hard_scenes::{
    View, body_in_glass, bumpy_mirror, glass_caustic, indirect, many_lights, mirror_caustic,
    out_of_focus, plastics,
};
use crate::support::render::{Replicas, mean, picture, settings};
use crate::support::same_mean::{Reference, SIDE, Way};
use crate::support::stages::stage_of;
use lumiflow::film::{Filter, FilterKind, Window};
use lumiflow::integrator::PixelSettings;
use lumiflow::math::Rgb;

/// Bootstrap sets so small that a seed is often one of few, and chains of very different lengths.
const WAYS: [&str; 12] = [
    "pssmlt mutations_per_pixel=20 chains=64",
    "pssmlt mutations_per_pixel=20 chains=3 deposits=expected direct_samples=2",
    "pssmlt mutations_per_pixel=20 chains=100 deposits=expected target=path p_large=0.1",
    "pssmlt mutations_per_pixel=20 chains=500 deposits=expected p_large=0 step_largest=0.2 separate_direct=false",
    "pssmlt mutations_per_pixel=10 chains=20 p_large=0.8 rr_depth=2",
    "pssmlt mutations_per_pixel=20 chains=30 deposits=expected target=path separate_direct=false",
    "mlt mutations_per_pixel=20 chains=40 lens_size=8 angle_largest=0.5",
    "mlt mutations_per_pixel=20 chains=8 bidirectional_weight=4 separate_direct=false",
    "mlt mutations_per_pixel=20 chains=200 bidirectional_mutation=false mutation_choice=mixture lai_lens_perturbation=true",
    "mlt mutations_per_pixel=20 chains=40 noise_aware=true expected_values=false",
    "pssmlt mutations_per_pixel=20 chains=40 noise_aware=true",
    "mlt mutations_per_pixel=20 chains=100 lens_perturbation=false multi_chain_perturbation=false caustic_perturbation=false",
];

/// Checks some ways with one scene, so that three scenes see all of them; all for the proof.
///
/// - `number`: of the scene.
fn check(number: usize, view: &View) -> Result<(), String> {
    let chosen = WAYS
        .iter()
        .enumerate()
        .filter(|(index, _)| is_proof() || index % 3 == number % 3);
    let ways = chosen.map(|(_, options)| Way {
        options: (*options).to_owned(),
        // Maps of noise change after two passes, and after two more.
        passes: match options.contains("noise_aware") {
            _ if is_proof() => 24,
            true => 5,
            false => 3,
        },
    });
    Reference::new(view).check_all(view, ways)
}

const BOTH_SIDES: [&str; 5] = [
    "pssmlt bidirectional=true mutations_per_pixel=10 chains=40 noise_aware=true",
    "pssmlt bidirectional=true mutations_per_pixel=10 chains=40 deposits=expected separate_direct=false",
    "mmlt mutations_per_pixel=20 chains=64 noise_aware=true",
    "mmlt mutations_per_pixel=20 chains=8 separate_direct=false p_large=0.05 rr_depth=3 mis=balance",
    "mmlt mutations_per_pixel=20 chains=500 p_large=0 step_largest=0.2 rr_depth=1 mis=maximum",
];

/// Samples from both sides, among lights that have no paths that only they find.
#[test]
fn samples_from_both_sides_stay_the_same() -> Result<(), String> {
    let way = |options: &str| Way {
        options: options.to_owned(),
        passes: if is_proof() { 24 } else { 2 },
    };
    for view in [indirect(SIDE), glass_caustic(SIDE, 1.0), out_of_focus(SIDE)] {
        Reference::new(&view).check_all(&view, BOTH_SIDES.into_iter().map(way))?;
    }
    Ok(())
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

/// Some light of points and beams is not found by path tracing: chains must not find it either.
#[test]
fn lights_that_no_ray_meets_stay_the_same() -> Result<(), String> {
    for (number, name) in ["point and spot", "open air"].into_iter().enumerate() {
        let stage = stage_of(name);
        let view = View {
            name,
            scene: stage.scene,
            sensor: stage.sensor,
        };
        check(number, &view)?;
    }
    Ok(())
}

#[test]
fn samples_that_make_or_lose_light_are_found() {
    let view = indirect(SIDE);
    let reference = Reference::new(&view);
    let way = |options: &str| Way {
        options: format!("{}{options}", WAYS[0]),
        passes: samples(4),
    };
    assert_eq!(reference.check(&view, &view, &way("")), Ok(()));
    // The longest paths are left out.
    let found = reference.check(&view, &view, &way(" max_depth=5"));
    println!("{found:?}");
    assert!(found.is_err());
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
    for text in ["pssmlt max_depth=6", "mlt max_depth=6", "mmlt max_depth=6"] {
        let found = look(text);
        assert!(
            (found / expected - 1.0).abs() < 0.03,
            "{text}: {found}, not {expected}"
        );
    }
}

/// Mean luminance of the four quarters of a part of an image.
///
/// - `width`: of the image.
fn quarters(image: &[Rgb], width: u32, part: Window) -> Vec<f64> {
    let mut sums = vec![0.0; 4];
    for (x, y) in (0..part.width).flat_map(|x| (0..part.height).map(move |y| (x, y))) {
        let colour = image[((part.y + y) * width + part.x + x) as usize];
        let quarter = 2 * y / part.height * 2 + 2 * x / part.width;
        sums[quarter as usize] += f64::from(colour.luminance());
    }
    sums
}

/// Chains keep to the window, and begin with paths that are seen there; light subpaths come from everywhere.
#[test]
fn a_window_has_the_mean_of_the_whole_film_there() -> Result<(), String> {
    const COUNT: u64 = 12;
    let view = glass_caustic(SIDE, 1.0);
    let window = Window {
        x: SIDE / 4,
        y: SIDE / 3,
        width: SIDE / 2,
        height: SIDE / 2,
    };
    let look =
        |text: &str, settings, passes| picture(&view.scene, &view.sensor, text, settings, passes);
    let whole = |part| {
        Replicas::new(seed(940), COUNT, |seed| {
            let image = look("bdpt max_depth=6", settings(seed, SIDE), 48);
            quarters(&image, SIDE, part)
        })
    };
    let expected = whole(window);
    let elsewhere = whole(Window {
        x: window.x + 2,
        ..window
    });
    for text in ["pssmlt bidirectional=true", "mlt seeds=bdpt", "mmlt"] {
        let text =
            format!("{text} max_depth=6 mutations_per_pixel=20 chains=8 luminance_samples=500");
        let found = Replicas::new(seed(960), COUNT, |seed| {
            let settings = PixelSettings {
                window,
                ..settings(seed, SIDE)
            };
            let all = Window {
                x: 0,
                y: 0,
                ..window
            };
            quarters(&look(&text, settings, 6), window.width, all)
        });
        found
            .check_same(&expected, level(1e-3))
            .map_err(|error| format!("{text}: {error}"))?;
        assert!(found.check_same(&elsewhere, level(1e-3)).is_err(), "{text}");
    }
    Ok(())
}
