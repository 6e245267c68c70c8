//! Whatever only changes how paths are found leaves the picture as it is.

use lumiflow::bsdf::Diffuse;
use lumiflow::emitter::{Constant, Point};
use lumiflow::film::{Filter, FilterKind};
use lumiflow::integrator::PixelSettings;
use lumiflow::math::{Mat4, Rgb, Vec3};
use lumiflow::random::SamplerKind;
use lumiflow::scene::{Scene, SceneBuilder};

use crate::support::effort::{self, level, samples};
use crate::support::render::{Replicas, mean, picture, settings, tiles};
use crate::support::scenes::{
    camera, faceted_sphere, hollow_sphere, part, scene, studio, studio_camera,
};

const SIDE: u32 = 24;
const REPLICAS: u64 = 16;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

fn replicas(scene: &Scene, text: &str, sampler: SamplerKind, seed: u64) -> Replicas {
    let sensor = studio_camera(SIDE);
    Replicas::new(effort::seed(seed), REPLICAS, |seed| {
        let settings = PixelSettings {
            sampler,
            ..settings(seed, SIDE)
        };
        tiles(&picture(scene, &sensor, text, settings, samples(16)), 8)
    })
}

/// Compares with plain path tracing of the same scene.
fn check(scene: &Scene, text: &str, sampler: SamplerKind) -> Result<(), String> {
    let plain = replicas(
        &studio(1.0, |_| {}),
        "path max_depth=6",
        SamplerKind::Independent,
        1,
    );
    let other = replicas(scene, text, sampler, 1001);
    plain
        .check_same(&other, level(LEVEL))
        .map_err(|error| format!("{text}, {sampler:?}: {error}"))
}

#[test]
fn heuristics_and_roulette_change_only_the_noise() -> Result<(), String> {
    let scene = studio(1.0, |_| {});
    for text in [
        "path max_depth=6 mis=balance rr_depth=1",
        "path max_depth=6 mis=maximum rr_depth=2",
        "path max_depth=6 mis=power rr_depth=100",
    ] {
        check(&scene, text, SamplerKind::Independent)?;
    }
    assert!(check(&scene, "path max_depth=3", SamplerKind::Independent).is_err());
    assert!(
        check(
            &studio(1.03, |_| {}),
            "path max_depth=6",
            SamplerKind::Independent
        )
        .is_err()
    );
    Ok(())
}

#[test]
fn samplers_change_only_the_noise() -> Result<(), String> {
    let scene = studio(1.0, |_| {});
    for sampler in [SamplerKind::Stratified, SamplerKind::Sobol] {
        check(&scene, "path max_depth=6", sampler)?;
    }
    Ok(())
}

#[test]
fn lights_that_are_out_change_only_the_noise() -> Result<(), String> {
    // Few lights are chosen by their influence, many by their power.
    for count in [1, 5, 20] {
        let scene = studio(1.0, |builder| {
            for i in 0..count {
                let place = Vec3::new(i as f32, 1.0, 0.0);
                builder.add_emitter(Point::new(place, Rgb::BLACK));
            }
        });
        check(&scene, "path max_depth=6", SamplerKind::Independent)?;
    }
    Ok(())
}

#[test]
fn twice_the_light_is_twice_the_picture_to_the_last_bit() {
    let sensor = studio_camera(SIDE);
    let render = |strength: f32| {
        let scene = studio(strength, |_| {});
        picture(&scene, &sensor, "path", settings(4, SIDE), 4)
    };
    let (once, twice) = (render(1.0), render(2.0));
    assert!(mean(&once) > 0.1);
    assert!(
        once.iter()
            .zip(&twice)
            .all(|(once, twice)| *once * 2.0 == *twice)
    );
}

#[test]
fn smooth_normals_hardly_change_how_much_light_there_is() {
    let sky = |builder: &mut SceneBuilder| {
        builder.add_emitter(Constant::new(Rgb::WHITE));
    };
    let sensor = camera(Vec3::new(0.0, 0.5, 4.0), Vec3::ZERO, 12.0, SIDE);
    let albedo = |rings: u32, text: &str| {
        let scene = scene(
            [part(
                faceted_sphere(rings, Mat4::IDENTITY),
                Diffuse::new(0.8),
            )],
            sky,
        );
        mean(&picture(&scene, &sensor, text, settings(5, SIDE), 64))
    };
    for (rings, loss) in [(8, 0.05), (32, 0.005)] {
        let found = albedo(rings, "path");
        assert!(
            (0.8 * (1.0 - loss)..0.802).contains(&found),
            "{rings} rings: {found}"
        );
        let strict = albedo(rings, "path strict_normals=true");
        assert!(
            (0.8 * (1.0 - 2.0 * loss)..found + 1e-3).contains(&strict),
            "{strict}, {found}"
        );
    }
}

const FILTERS: [FilterKind; 6] = [
    FilterKind::Box { radius: 0.5 },
    FilterKind::Tent { radius: 1.0 },
    FilterKind::Gaussian { stddev: 0.5 },
    FilterKind::Mitchell {
        b: 1.0 / 3.0,
        c: 1.0 / 3.0,
    },
    FilterKind::CatmullRom,
    FilterKind::Lanczos { lobes: 3.0 },
];

#[test]
fn filters_keep_the_mean_and_do_not_darken_borders() {
    let glow = part(hollow_sphere(Vec3::ZERO, 2.0), Diffuse::new(0.0)).glowing(Rgb::grey(0.5));
    let scene = scene([glow], |_| {});
    let sensor = camera(Vec3::new(0.5, 0.0, 0.5), Vec3::ZERO, 60.0, SIDE);
    let render = |kind: FilterKind, text: &str| {
        let filter = Filter::new(kind).expect("a filter");
        let settings = PixelSettings {
            filter,
            sampler: SamplerKind::Sobol,
            ..settings(6, SIDE)
        };
        picture(&scene, &sensor, text, settings, 64)
    };
    let distance = mean(&render(FILTERS[0], "depth"));
    for kind in FILTERS {
        let flat = render(kind, "path max_depth=1");
        let centre = flat[flat.len() / 2].luminance();
        assert!((centre - 0.5).abs() < 1e-5, "{kind:?}: {centre}");
        for (index, pixel) in flat.iter().enumerate() {
            let value = pixel.luminance();
            assert!(
                (value - centre).abs() < 1e-5,
                "{kind:?}, pixel {index}: {value}, {centre}"
            );
        }
        let found = mean(&render(kind, "depth"));
        assert!(
            (found / distance - 1.0).abs() < 0.01,
            "{kind:?}: {found}, {distance}"
        );
    }
}
