//! Pictures by bidirectional path tracing and by light tracing are those of path tracing.

use lumiflow::bsdf::Conductor;
use lumiflow::film::{Filter, FilterKind, Window};
use lumiflow::integrator::PixelSettings;
use lumiflow::math::{Mat4, Vec3};
use lumiflow::random::SamplerKind;

use crate::determinism::{bits, cut, on_threads};
use crate::support::effort::{level, samples, seed};
use crate::support::hard_scenes::{self, View};
use crate::support::render::{Replicas, integrator, mean, picture, run, settings, tiles};
use crate::support::scenes::{camera, cornell, cornell_camera, part, scene, sphere};
use crate::support::stages::SIDE;
use crate::support::two_sided_light::{
    caustic, lamp, metals, outdoors, patterned, points, seen_by, through_a_lens, turned,
    turned_mirror,
};

const REPLICAS: u64 = 16;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

fn replicas(view: &View, text: &str, first: u64, passes: u32) -> Replicas {
    Replicas::new(seed(first), REPLICAS, |seed| {
        let settings = settings(seed, SIDE);
        let image = picture(&view.scene, &view.sensor, text, settings, samples(passes));
        tiles(&image, 4)
    })
}

/// Compares integrators, which all get the same options besides their own, with path tracing.
fn check(view: &View, common: &str, others: &[&str]) -> Result<(), String> {
    let plain = replicas(view, &format!("path {common}"), 1, 64);
    let errors: Vec<String> = others
        .iter()
        .filter_map(|other| {
            let found = replicas(view, &format!("{other} {common}"), 501, 16);
            let verdict = found.check_same(&plain, level(LEVEL));
            verdict
                .err()
                .map(|e| format!("{}, {other}: {e}", view.name))
        })
        .collect();
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors.join("\n"))
    }
}

const BOTH: [&str; 2] = ["bdpt rr_depth=2", "ptracer rr_depth=3"];

#[test]
fn pictures_are_those_of_path_tracing() -> Result<(), String> {
    let views = [
        caustic(),
        metals(),
        turned(),
        patterned(),
        points(),
        outdoors(),
        through_a_lens(),
        seen_by("orthographic"),
        seen_by("spherical"),
    ];
    let errors: Vec<String> = views
        .iter()
        .filter_map(|view| check(view, "max_depth=5", &BOTH).err())
        .collect();
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors.join("\n"))
    }
}

#[test]
fn ways_to_weigh_and_to_leave_out_change_only_the_noise() -> Result<(), String> {
    let view = hard_scenes::indirect(SIDE);
    check(
        &view,
        "max_depth=5",
        &[
            "bdpt mis=balance",
            "bdpt mis_power=0.5 rr_depth=1",
            "bdpt mis=maximum",
            "bdpt light_image=false",
            "bdpt sample_direct=false",
            "bdpt sample_direct=false light_image=false mis=maximum",
            "bdpt connection_roulette=1",
            "ptracer",
        ],
    )
}

#[test]
fn mirrors_and_glass_are_seen_as_by_path_tracing() -> Result<(), String> {
    for view in [
        hard_scenes::glass_caustic(SIDE, 1.0),
        hard_scenes::body_in_glass(SIDE),
        hard_scenes::plastics(SIDE),
        hard_scenes::bumpy_mirror(SIDE),
        turned_mirror(),
        hard_scenes::many_lights(SIDE),
    ] {
        check(
            &view,
            "max_depth=6",
            &["bdpt rr_depth=2 connection_roulette=0.1"],
        )?;
    }
    Ok(())
}

/// Chains whose seeds come from both sides.
const SEEDED: [&str; 5] = [
    "erpt seeds=bdpt rr_depth=2 chain_length=20 mutations_per_sample=4",
    "erpt seeds=bdpt rr_depth=2 flow=detailed chain_length=3 separate_direct=false",
    "erpt seeds=bdpt rr_depth=3 chain_length=10 mutations_per_sample=4 direct_samples=1",
    "pmc-er seeds=bdpt rr_depth=2 population=100 rounds=3 mutations=5 mutations_per_sample=4",
    "mlt seeds=bdpt rr_depth=2 mutations_per_pixel=4 chains=20 luminance_samples=256",
];

#[test]
fn chains_from_seeds_of_both_sides_are_those_of_path_tracing() -> Result<(), String> {
    for view in [
        hard_scenes::indirect(SIDE),
        hard_scenes::glass_caustic(SIDE, 1.0),
        points(),
        through_a_lens(),
    ] {
        check(&view, "max_depth=5", &SEEDED)?;
    }
    Ok(())
}

#[test]
fn rules_of_paths_are_kept() -> Result<(), String> {
    for rules in ["hide_emitters=true", "strict_normals=true"] {
        check(&metals(), &format!("max_depth=4 {rules}"), &BOTH)?;
    }
    Ok(())
}

#[test]
fn pictures_that_are_not_the_same_are_told_apart() {
    let view = hard_scenes::indirect(SIDE);
    let found = |text: &str| replicas(&view, text, 501, 16);
    let plain = replicas(&view, "path max_depth=5", 1, 64);
    for wrong in ["bdpt max_depth=3", "ptracer max_depth=3"] {
        assert!(found(wrong).check_same(&plain, level(LEVEL)).is_err());
    }
}

/// How much energy there is more in pictures by some options than by others, as a share, and its error.
fn gain(plain: &str, other: &str) -> (f64, f64) {
    let view = hard_scenes::indirect(SIDE);
    let picture = |seed, text: &str| {
        let settings = settings(seed, SIDE);
        mean(&picture(
            &view.scene,
            &view.sensor,
            text,
            settings,
            samples(32),
        ))
    };
    let found = Replicas::new(seed(60), REPLICAS, |seed| {
        let (plain, other) = (picture(seed, plain), picture(seed, other));
        vec![other / plain - 1.0]
    });
    let (mean, variance) = found.summary()[0];
    (mean, variance.sqrt())
}

/// Another renderer gains 4 % where its Russian roulette is on: of connections, or of subpaths.
#[test]
fn roulette_keeps_the_energy() {
    for (plain, other) in [
        ("rr_depth=2", "rr_depth=2 connection_roulette=0.1"),
        ("rr_depth=2", "rr_depth=2 connection_roulette=1"),
        ("rr_depth=2", "rr_depth=2 connection_roulette=3"),
        ("rr_depth=100", "rr_depth=1"),
        ("rr_depth=100", "rr_depth=2"),
        ("rr_depth=100", "rr_depth=5"),
    ] {
        let text = |options: &str| format!("bdpt max_depth=7 {options}");
        let (gain, error) = gain(&text(plain), &text(other));
        assert!(error > 0.0 && error < 0.008, "4 % must show: {error}");
        assert!(gain.abs() < 4.0 * error, "{other}: {gain} ± {error}");
        assert!((gain + 0.04).abs() > 4.0 * error, "{gain} ± {error}");
    }
}

/// What is lost beyond some edges is less than what the other renderer gains, and found.
#[test]
fn a_few_per_cent_of_energy_are_found() {
    let (gain, error) = gain("bdpt max_depth=7", "bdpt max_depth=5");
    assert!(gain > -0.08 && gain < -5.0 * error, "{gain} ± {error}");
}

#[test]
fn layers_of_techniques_add_up_to_the_image() {
    let view = points();
    let algorithm = integrator("bdpt technique_edges=3");
    for filter in filters() {
        let settings = PixelSettings {
            filter,
            own_layers: vec!["techniques".to_owned()],
            ..settings(5, SIDE)
        };
        let rendered = run(&view.scene, &view.sensor, &*algorithm, settings, 16);
        let mut sums = vec![0.0; rendered.means[0].len()];
        let mut with_light = Vec::new();
        for ((layer, _), values) in rendered.layers.iter().zip(&rendered.means).skip(1) {
            let light: f32 = values.iter().sum();
            if light > 0.0 {
                with_light.push(layer.name.clone());
            }
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += f64::from(*value);
            }
        }
        // Lights are points: no ray meets them, and the lens sees none of them.
        let names = ["s1t1", "s0t2", "s2t1", "s1t2", "s0t3", "longer"];
        assert_eq!(with_light, names.map(|name| format!("techniques.{name}")));
        for (sum, value) in sums.iter().zip(&rendered.means[0]) {
            assert!((sum - f64::from(*value)).abs() <= 1e-5 * sum.abs().max(1e-3));
        }
    }
}

fn film(filter: Filter, sampler: SamplerKind) -> PixelSettings {
    PixelSettings {
        filter,
        sampler,
        alpha: true,
        aovs: lumiflow::integrator::Aov::NAMES
            .map(|(_, aov)| aov)
            .to_vec(),
        ..settings(42, 37)
    }
}

fn filters() -> [Filter; 2] {
    let gaussian = FilterKind::Gaussian { stddev: 0.5 };
    [
        Filter::pixel_box(),
        Filter::new(gaussian).expect("a filter"),
    ]
}

const RENDERS: [&str; 5] = [
    "bdpt max_depth=6 connection_roulette=0.5",
    "bdpt max_depth=4 light_image=false",
    "bdpt max_depth=4 sample_direct=false rr_depth=1",
    "ptracer max_depth=6",
    "erpt seeds=bdpt max_depth=5 chain_length=4 mutations_per_sample=2",
];

#[test]
fn any_number_of_threads_makes_the_same_bits() {
    let scene = cornell(Mat4::IDENTITY);
    let sensor = cornell_camera(Mat4::IDENTITY, 37);
    for text in RENDERS {
        let algorithm = integrator(text);
        for (filter, sampler) in filters()
            .into_iter()
            .zip([SamplerKind::Independent, SamplerKind::Sobol])
        {
            let passes = sampler.group() + 1;
            let render = || run(&scene, &sensor, &*algorithm, film(filter, sampler), passes);
            let one = on_threads(1, render);
            assert!(one.counters.rays > 0 && one.counters.rejected == 0);
            for threads in [2, 3, 7] {
                let other = on_threads(threads, render);
                assert_eq!(other.counters, one.counters);
                assert!(bits(&other) == bits(&one), "{text}, {threads} threads");
            }
        }
    }
}

#[test]
fn a_window_shows_what_the_whole_film_shows_there() {
    let scene = cornell(Mat4::IDENTITY);
    let sensor = cornell_camera(Mat4::IDENTITY, 37);
    let corner = |x, y, width, height| Window {
        x,
        y,
        width,
        height,
    };
    // A window leaves out the seeds of chains outside of it.
    for text in RENDERS.into_iter().filter(|text| !text.starts_with("erpt")) {
        let algorithm = integrator(text);
        let render = |settings| run(&scene, &sensor, &*algorithm, settings, 3);
        for filter in filters() {
            let whole = film(filter, SamplerKind::Stratified);
            let all = render(whole.clone());
            for window in [
                corner(0, 0, 5, 37),
                corner(11, 23, 17, 9),
                corner(36, 36, 1, 1),
            ] {
                let part = render(PixelSettings {
                    window,
                    ..whole.clone()
                });
                assert!(
                    cut(&part, window) == cut(&all, window),
                    "{text}, {window:?}"
                );
            }
        }
    }
}

#[test]
fn mirrors_show_nothing_to_light_subpaths() {
    let mirror = part(
        sphere(Vec3::new(0.0, 0.5, 0.0), 0.45),
        Conductor::new(None, 0.9),
    );
    let scene = scene([mirror, lamp(Vec3::new(0.3, 1.8, 0.0))], |_| {});
    let sensor = camera(Vec3::new(0.0, 0.5, 3.0), Vec3::Y * 0.5, 12.0, SIDE);
    let seen = |text: &str| mean(&picture(&scene, &sensor, text, settings(3, SIDE), 64));
    assert_eq!(seen("ptracer"), 0.0);
    let (path, both) = (seen("path"), seen("bdpt"));
    assert!((both / path - 1.0).abs() < 0.1, "{both}, {path}");
}

/// Beside the film pixels are small, and what is seen there is bright: it must not decide about what light
/// on the film is rounded to.
#[test]
fn light_beside_the_film_does_not_coarsen_the_film() {
    let unit = |text: &str, view: &View| {
        let algorithm = integrator(text);
        let render = algorithm.start(&view.scene, &view.sensor, settings(1, SIDE));
        render.units()[0].value()
    };
    for view in [outdoors(), points(), metals()] {
        let expected = unit("path", &view);
        for text in ["bdpt", "ptracer"] {
            let ratio = unit(text, &view) / expected;
            assert!(
                (0.2..5.0).contains(&ratio),
                "{}, {text}: {ratio}",
                view.name
            );
        }
    }
}
