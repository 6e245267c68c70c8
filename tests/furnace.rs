//! White furnaces: in an enclosure whose every surface emits what it does not reflect, radiance is
//! the same everywhere, and bodies that lose no light cannot be seen.

use lumiflow::bsdf::{
    Bsdf, BsdfModel, Conductor, Dielectric, Diffuse, DiffuseTransmitter, Mask, MicrofacetKind,
    Mixture, Null, Plastic, RelativeIor, RoughConductor, RoughDielectric, Roughness,
    ThinDielectric, TwoSided,
};
use lumiflow::emitter::Constant;
use lumiflow::math::{Mat4, Rgb, Vec3};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::sensor::Sensor;

use crate::support::effort::{level, samples, seed};
use crate::support::render::{Replicas, mean, picture, settings, tiles};
use crate::support::scenes::{
    Part, camera, cornell, cornell_camera, cuboid, hollow_sphere, part, rectangle, scene, sphere,
    walls,
};

const SIDE: u32 = 16;
const REPLICAS: u64 = 16;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

/// Every way to weigh techniques, with early and late Russian roulette.
const VARIANTS: [&str; 6] = [
    "mis=balance rr_depth=1",
    "mis=balance rr_depth=5",
    "mis=power rr_depth=1",
    "mis=power rr_depth=5",
    "mis=maximum rr_depth=1",
    "mis=maximum rr_depth=5",
];

fn replicas(scene: &Scene, sensor: &Sensor, text: &str, passes: u32) -> Replicas {
    let passes = samples(passes);
    Replicas::new(seed(100), REPLICAS, |seed| {
        tiles(
            &picture(scene, sensor, text, settings(seed, SIDE), passes),
            8,
        )
    })
}

/// Checks that a scene has one radiance wherever the camera looks.
fn check(scene: &Scene, sensor: &Sensor, text: &str, radiance: f64) -> Result<(), String> {
    let found = replicas(scene, sensor, text, 4);
    found
        .check(&[radiance; 4], level(LEVEL))
        .map_err(|error| format!("{text}: {error}"))
}

const ALBEDO: Rgb = Rgb::new(0.8, 0.5, 0.3);

/// A diffuse surface that emits what it does not reflect, times `excess`.
fn wall(shape: impl Into<lumiflow::shape::Shape>, excess: f32) -> Part {
    part(shape, Diffuse::new(ALBEDO)).glowing((Rgb::WHITE - ALBEDO) * excess)
}

fn spherical_furnace(excess: f32) -> (Scene, Sensor) {
    let shell = wall(hollow_sphere(Vec3::new(0.2, 0.1, 0.0), 1.5), excess);
    let from = Vec3::new(0.8, 0.3, 0.4);
    (
        scene([shell], |_| {}),
        camera(from, Vec3::ZERO, 100.0, SIDE),
    )
}

/// A box with two bodies in it.
fn cubic_furnace() -> (Scene, Sensor) {
    let bodies = [
        wall(
            cuboid(Vec3::new(-0.5, -0.6, -0.4), Vec3::new(0.2, 0.4, 0.3)),
            1.0,
        ),
        wall(sphere(Vec3::new(0.4, -0.3, -0.2), 0.4), 1.0),
    ];
    let walls = walls(Mat4::IDENTITY).map(|shape| wall(shape, 1.0));
    let scene = scene(walls.into_iter().chain(bodies), |_| {});
    (
        scene,
        camera(
            Vec3::new(0.1, 0.5, 0.9),
            Vec3::new(0.0, -0.3, -0.2),
            80.0,
            SIDE,
        ),
    )
}

#[test]
fn enclosures_in_balance_have_radiance_one() -> Result<(), String> {
    let furnaces = [spherical_furnace(1.0), cubic_furnace()];
    for (scene, sensor) in &furnaces {
        for variant in VARIANTS {
            check(scene, sensor, &format!("path {variant}"), 1.0)?;
        }
    }
    Ok(())
}

/// Chains under every flow rule.
const CHAINS: [&str; 12] = [
    "erpt chain_length=20 mutations_per_sample=20",
    "erpt chain_length=5 mutations_per_sample=20 expected_values=false separate_direct=false",
    "erpt flow=detailed chain_length=3 separate_direct=false",
    "erpt flow=iterated flow_depth=3 mutations_per_sample=4 direct_samples=4",
    "pmc-er population=100 rounds=3 mutations=5 mutations_per_sample=20",
    "pmc-er population=100 transfer=balance mutations_per_sample=10 separate_direct=false",
    "mlt mutations_per_pixel=20 luminance_samples=256",
    "mlt mutations_per_pixel=20 luminance_samples=256 bidirectional_weight=5 separate_direct=false",
    "pssmlt mutations_per_pixel=20 luminance_samples=256",
    "pssmlt bidirectional=true mutations_per_pixel=5 luminance_samples=256",
    "pssmlt mutations_per_pixel=20 luminance_samples=256 deposits=expected target=path separate_direct=false",
    "mmlt mutations_per_pixel=20 luminance_samples=256 separate_direct=false",
];

#[test]
fn chains_keep_enclosures_in_balance() -> Result<(), String> {
    for (scene, sensor) in &[spherical_furnace(1.0), cubic_furnace()] {
        for text in CHAINS {
            check(scene, sensor, text, 1.0)?;
        }
    }
    let (scene, sensor) = cubic_furnace();
    let text = format!("{} max_depth=6", CHAINS[0]);
    assert!(check(&scene, &sensor, &text, 1.0).is_err());
    Ok(())
}

/// Paths from both sides.
const BIDIRECTIONAL: [&str; 5] = [
    "bdpt rr_depth=1 mis=balance",
    "bdpt rr_depth=3",
    "bdpt rr_depth=2 mis=maximum",
    "bdpt rr_depth=2 connection_roulette=0.5",
    "bdpt rr_depth=2 sample_direct=false mis_power=1.5",
];

#[test]
fn paths_from_both_sides_keep_enclosures_in_balance() -> Result<(), String> {
    for (scene, sensor) in &[spherical_furnace(1.0), cubic_furnace()] {
        for text in BIDIRECTIONAL.into_iter().chain(["ptracer rr_depth=2"]) {
            check(scene, sensor, text, 1.0)?;
        }
        let radiance = Rgb::WHITE - ALBEDO.map(|a| a.powi(3));
        for text in ["bdpt max_depth=3 mis=balance", "ptracer max_depth=3"] {
            check(scene, sensor, text, f64::from(radiance.luminance()))?;
        }
    }
    let (scene, sensor) = cubic_furnace();
    assert!(check(&scene, &sensor, "bdpt max_depth=5", 1.0).is_err());
    Ok(())
}

#[test]
fn paths_from_both_sides_do_not_see_glass_that_loses_nothing() -> Result<(), String> {
    let inside = wall(sphere(Vec3::new(0.1, 0.1, 0.0), 0.5), 1.5 * 1.5);
    for bodies in [vec![], vec![inside]] {
        let shell = part(sphere(Vec3::ZERO, 1.0), glass());
        let (scene, sensor) = under_white_sky(bodies.into_iter().chain([shell]));
        for text in BIDIRECTIONAL {
            check(&scene, &sensor, text, 1.0)?;
        }
    }
    Ok(())
}

#[test]
fn chains_do_not_see_glass_that_loses_nothing() -> Result<(), String> {
    for bsdf in [glass(), Dielectric::new(ior(1.0, 1.33), 1.0, 1.0)] {
        let (scene, sensor) = under_white_sky([part(sphere(Vec3::ZERO, 1.0), bsdf)]);
        for text in CHAINS {
            check(&scene, &sensor, text, 1.0)?;
        }
    }
    // What it shows of a diffuse body inside of it, it shows in balance.
    let inside = wall(sphere(Vec3::new(0.1, 0.1, 0.0), 0.5), 1.5 * 1.5);
    let (scene, sensor) = under_white_sky([part(sphere(Vec3::ZERO, 1.0), glass()), inside]);
    for text in CHAINS {
        check(&scene, &sensor, text, 1.0)?;
    }
    Ok(())
}

#[test]
fn a_limit_of_depth_leaves_out_what_it_should() -> Result<(), String> {
    let furnaces = [spherical_furnace(1.0), cubic_furnace()];
    for (scene, sensor) in &furnaces {
        for (depth, heuristic) in [(1, "power"), (2, "balance"), (3, "maximum"), (7, "power")] {
            let radiance = Rgb::WHITE - ALBEDO.map(|a| a.powi(depth));
            let text = format!("path max_depth={depth} rr_depth=2 mis={heuristic}");
            check(scene, sensor, &text, f64::from(radiance.luminance()))?;
        }
        let radiance = Rgb::WHITE - ALBEDO * ALBEDO;
        let text = "direct emitter_samples=2 bsdf_samples=3";
        check(scene, sensor, text, f64::from(radiance.luminance()))?;
    }
    Ok(())
}

#[test]
fn enclosures_out_of_balance_are_found() {
    // Two per cent too much emission.
    let (scene, sensor) = spherical_furnace(1.02);
    assert!(check(&scene, &sensor, "path", 1.0).is_err());
    // A path tracer that stops too early.
    let (scene, sensor) = cubic_furnace();
    assert!(check(&scene, &sensor, "path max_depth=6", 1.0).is_err());
}

/// Bodies around the origin, under a sky of radiance one.
fn under_white_sky(bodies: impl IntoIterator<Item = Part>) -> (Scene, Sensor) {
    let sky = |builder: &mut SceneBuilder| {
        builder.add_emitter(Constant::new(Rgb::WHITE));
    };
    let sensor = camera(Vec3::new(0.5, 1.0, 3.0), Vec3::ZERO, 45.0, SIDE);
    (scene(bodies, sky), sensor)
}

fn ior(interior: f32, exterior: f32) -> RelativeIor {
    RelativeIor::new(interior, exterior).expect("the indices are positive")
}

fn glass() -> Dielectric {
    Dielectric::new(ior(1.5, 1.0), 1.0, 1.0)
}

/// Materials that lose no light: those of closed bodies, and those that panes can have, too.
///
/// Glass with holes is not one of them. It loses no power, but what enters through a hole and leaves
/// by refraction is brighter by the square of the index, and the other way about it is darker: only
/// the mean over all rays that meet the body is one.
fn lossless() -> (Vec<Bsdf>, Vec<Bsdf>) {
    let two_sided = |bsdf: Bsdf| TwoSided::new(bsdf, None).expect("the material reflects");
    let white = two_sided(Diffuse::new(1.0).into());
    let mirror = Conductor::new(None, 1.0);
    let closed = vec![
        glass().into(),
        Dielectric::new(ior(1.0, 1.33), 1.0, 1.0).into(),
        mirror.clone().into(),
        Diffuse::new(1.0).into(),
        Plastic::new(ior(1.5, 1.0), 1.0, 1.0, true).into(),
    ];
    let thin = vec![
        ThinDielectric::new(ior(1.5, 1.0), 1.0, 1.0).into(),
        two_sided(mirror.into()).into(),
        white.clone().into(),
        Null.into(),
        Mask::new(0.5, white).into(),
        Mask::new(Rgb::new(0.9, 0.5, 0.2), Null).into(),
        DiffuseTransmitter::new(1.0).into(),
        Mixture::blend(0.3, DiffuseTransmitter::new(1.0), Null).into(),
    ];
    (closed, thin)
}

#[test]
fn bodies_that_lose_nothing_are_invisible() -> Result<(), String> {
    let (closed, thin) = lossless();
    for bsdf in closed.into_iter().chain(thin) {
        let name = bsdf.name();
        let (scene, sensor) = under_white_sky([part(sphere(Vec3::ZERO, 1.0), bsdf.clone())]);
        // Roulette from the first edge on makes even smooth glass noisy.
        for variant in ["rr_depth=1 mis=balance", "rr_depth=5"] {
            let found = check(&scene, &sensor, &format!("path {variant}"), 1.0);
            found.map_err(|error| format!("{name}: {error}"))?;
        }
    }
    Ok(())
}

#[test]
fn panes_that_lose_nothing_are_invisible_from_both_sides() -> Result<(), String> {
    let (_, thin) = lossless();
    for bsdf in thin {
        for front in [1.0, -1.0] {
            let pane = rectangle(Vec3::ZERO, Vec3::X * front, Vec3::Y);
            let (scene, sensor) = under_white_sky([part(pane, bsdf.clone())]);
            let found = check(&scene, &sensor, "path", 1.0);
            found.map_err(|error| format!("{} from side {front}: {error}", bsdf.name()))?;
        }
    }
    Ok(())
}

#[test]
fn glass_in_glass_and_a_body_in_glass_are_invisible() -> Result<(), String> {
    let outer = || part(sphere(Vec3::ZERO, 1.0), glass());
    let bubble = part(
        sphere(Vec3::new(0.1, 0.1, 0.0), 0.6),
        Dielectric::new(ior(1.0, 1.5), 1.0, 1.0),
    );
    let (scene, sensor) = under_white_sky([outer(), bubble]);
    check(&scene, &sensor, "path rr_depth=3", 1.0)?;

    let centre = Vec3::new(0.1, 0.1, 0.0);
    let body = |excess: f32| {
        // In glass, radiance in balance is greater by the square of the index.
        let inside = wall(sphere(centre, 0.5), 1.5 * 1.5 * excess);
        under_white_sky([outer(), inside])
    };
    let (scene, sensor) = body(1.0);
    for variant in VARIANTS {
        check(&scene, &sensor, &format!("path {variant}"), 1.0)?;
    }
    let (scene, sensor) = body(1.1);
    assert!(check(&scene, &sensor, "path", 1.0).is_err());
    Ok(())
}

#[test]
fn no_material_makes_light() {
    for (number, bsdf) in Bsdf::examples().into_iter().enumerate() {
        let name = format!("{} (example {number})", bsdf.name());
        let (scene, sensor) = under_white_sky([part(sphere(Vec3::ZERO, 1.0), bsdf)]);
        let image = picture(&scene, &sensor, "path", settings(7, SIDE), 64);
        let radiance = mean(&image);
        assert!((0.0..1.003).contains(&radiance), "{name}: {radiance}");
    }
}

#[test]
fn rough_bodies_lose_only_what_masking_hides() {
    let rough = |alpha: f32| -> [Bsdf; 2] {
        let roughness = Roughness::isotropic(MicrofacetKind::Ggx, alpha);
        let glass = RoughDielectric::new(roughness.clone(), ior(1.5, 1.0), 1.0, 1.0);
        [
            RoughConductor::new(roughness, None, 1.0).into(),
            glass.expect("the indices differ").into(),
        ]
    };
    // Light that is reflected more than once between the facets is lost.
    for (alpha, least) in [(0.01, 0.995), (0.1, 0.96), (0.5, 0.7)] {
        for bsdf in rough(alpha) {
            let name = bsdf.name();
            let (scene, sensor) = under_white_sky([part(sphere(Vec3::ZERO, 1.0), bsdf)]);
            let image = picture(&scene, &sensor, "path", settings(8, SIDE), 64);
            let radiance = mean(&image);
            assert!(
                (least..1.002).contains(&radiance),
                "{name}, {alpha}: {radiance}"
            );
        }
    }
}

#[test]
fn direct_light_is_a_path_of_two_edges() -> Result<(), String> {
    let scene = cornell(Mat4::IDENTITY);
    let sensor = cornell_camera(Mat4::IDENTITY, SIDE);
    let path = replicas(&scene, &sensor, "path max_depth=2", 16);
    for text in [
        "direct",
        "direct emitter_samples=3 bsdf_samples=0",
        "direct emitter_samples=1 bsdf_samples=4 mis=balance",
        "direct emitter_samples=0 bsdf_samples=8",
    ] {
        let direct = replicas(&scene, &sensor, text, 16);
        path.check_same(&direct, level(LEVEL))
            .map_err(|error| format!("{text}: {error}"))?;
    }
    let longer = replicas(&scene, &sensor, "path max_depth=3", 16);
    assert!(path.check_same(&longer, level(LEVEL)).is_err());
    Ok(())
}
