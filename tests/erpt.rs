//! Chains keep the energy of their seeds, whatever happens to them.

use lumiflow::bsdf::{Conductor, Dielectric, Diffuse, Mask, Plastic, RelativeIor, TwoSided};
use lumiflow::emitter::{Beam, Constant, Directional, Emitter, Point, Spot};
use lumiflow::integrator::{Counters, Rendered};
use lumiflow::math::{Mat4, Rgb, Vec2, Vec3};
use lumiflow::path::{CAPACITY, Heuristic, Path, PathRules, PathSpace, PathTracing};
use lumiflow::random::{PixelAddress, Purpose, Sampler, SamplerKind};
use lumiflow::scene::{Scene, SceneBuilder};
use lumiflow::sensor::{Sensor, SensorModel};

use crate::support::hard_scenes::{
    View, body_in_glass, bumpy_mirror, glass_caustic, hall_of_mirrors, indirect, many_lights,
    mirror_caustic, out_of_focus, plastics,
};
use crate::support::render::{
    Replicas, image, integrator, mean, picture, pixel_integrator, run, settings, tiles,
};
use crate::support::scenes::{camera, part, rectangle, scene, sphere};

const SIDE: u32 = 16;
/// Chance that a right program fails one of these tests with another seed.
const LEVEL: f64 = 1e-3;

fn views() -> Vec<View> {
    vec![
        indirect(SIDE),
        glass_caustic(SIDE, 1.0),
        mirror_caustic(SIDE),
        body_in_glass(SIDE),
        plastics(SIDE),
        bumpy_mirror(SIDE),
        out_of_focus(SIDE),
        many_lights(SIDE),
    ]
}

fn rendered(view: &View, text: &str, passes: u32) -> Rendered {
    let algorithm = integrator(text);
    let settings = settings(31, SIDE);
    run(
        &view.scene,
        &view.sensor,
        algorithm.as_ref(),
        settings,
        passes,
    )
}

fn relative(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

/// Glass, plastic and a half-open mask over a diffuse floor.
fn still_life(more: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 3.0, Vec3::X * 3.0);
    let pane = rectangle(Vec3::new(0.9, 0.5, 0.3), Vec3::X * 0.4, Vec3::Y * 0.5);
    let white = TwoSided::new(Diffuse::new(0.7), None).expect("the material reflects");
    let parts = [
        part(floor, Diffuse::new(Rgb::new(0.6, 0.5, 0.4))),
        part(
            sphere(Vec3::new(-0.6, 0.5, 0.0), 0.5),
            Dielectric::new(ior, 1.0, 1.0),
        ),
        part(
            sphere(Vec3::new(0.3, 0.4, -0.6), 0.4),
            Plastic::new(ior, 1.0, Rgb::new(0.2, 0.5, 0.7), true),
        ),
        part(
            sphere(Vec3::new(1.2, 0.5, -0.6), 0.5),
            Conductor::new(None, 0.9),
        ),
        part(pane, Mask::new(Rgb::new(0.3, 0.5, 0.7), white)),
    ];
    scene(parts, more)
}

fn still_life_camera() -> Sensor {
    camera(
        Vec3::new(0.3, 1.6, 3.5),
        Vec3::new(0.2, 0.4, 0.0),
        45.0,
        SIDE,
    )
}

/// Every view, and a scene under each kind of light.
fn lit_views() -> Vec<View> {
    let place = Vec3::new(0.5, 2.5, 1.0);
    let turned = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2 + 0.3);
    let down = Mat4::from_translation(place) * turned;
    let spot = Spot::new(down, Rgb::grey(8.0), Beam::new(0.7), None);
    let sun = Directional::new(Vec3::new(-0.3, -1.0, -0.4), Rgb::grey(2.0));
    let lights: [(&str, Emitter); 4] = [
        ("environment", Constant::new(Rgb::new(0.5, 0.6, 0.8)).into()),
        ("point light", Point::new(place, Rgb::grey(6.0)).into()),
        ("spot light", spot.expect("the light shines").into()),
        ("directional light", sun.expect("the light shines").into()),
    ];
    let mut views = views();
    views.extend(lights.into_iter().map(|(name, light)| View {
        name,
        scene: still_life(|builder| {
            builder.add_emitter(light);
        }),
        sensor: still_life_camera(),
    }));
    views
}

/// Sum of the energies of all paths of a camera sample, and its alpha.
fn traced(
    (view, tracing, rules): (&View, PathTracing, PathRules),
    raster: Vec2,
    mut sampler: Sampler,
) -> (Rgb, f32) {
    let space = PathSpace::new(&view.scene, &view.sensor, rules);
    let mut path = Path::default();
    let ray = view.sensor.sample_ray(raster, sampler.next_2d());
    let mut sum = Rgb::BLACK;
    let camera = (raster, &ray);
    let alpha = tracing.trace(&space, &mut path, camera, &mut sampler, &mut |found| {
        sum += found.energy;
        let fits = found.edges < CAPACITY as u32;
        assert_eq!(found.path.is_some(), fits);
        if let Some(path) = found.path {
            assert_eq!((path.edges() as u32, path.raster()), (found.edges, raster));
            assert!(
                path.luminance() > 0.0,
                "{}: {}",
                view.name,
                path.signature()
            );
        }
    });
    (sum, alpha)
}

/// Ways of tracing: the path tracer's options, and what they mean to the tracer that hands out paths.
fn tracings() -> [(&'static str, PathTracing, PathRules); 3] {
    let tracing = |max_depth: u32, rr_depth: u32, heuristic: Heuristic| PathTracing {
        max_depth,
        rr_depth,
        heuristic,
    };
    let hiding = PathRules {
        hide_emitters: true,
        ..PathRules::default()
    };
    let strict = PathRules {
        strict_normals: true,
        ..PathRules::default()
    };
    [
        (
            "path",
            tracing(u32::MAX, 5, Heuristic::Power),
            PathRules::default(),
        ),
        (
            "path max_depth=4 rr_depth=2 mis=balance hide_emitters=true",
            tracing(4, 2, Heuristic::Balance),
            hiding,
        ),
        (
            "path rr_depth=1 mis=maximum strict_normals=true",
            tracing(u32::MAX, 1, Heuristic::Maximum),
            strict,
        ),
    ]
}

/// The numbers of a pixel's sample.
fn numbers(pixel: u32) -> Sampler {
    let address = PixelAddress {
        seed: 32,
        purpose: Purpose::Check,
        pixel,
        sample: 0,
    };
    Sampler::new(SamplerKind::Independent, address)
}

#[test]
fn energies_of_a_sample_add_up_to_the_path_tracers_estimate() {
    for view in lit_views() {
        let mut lit = 0;
        for (text, tracing, rules) in tracings() {
            let tracer = pixel_integrator(text);
            for pixel in 0..SIDE * SIDE {
                let mut sampler = numbers(pixel);
                let corner = Vec2::new((pixel % SIDE) as f32, (pixel / SIDE) as f32);
                let raster = corner + sampler.next_2d();
                let (sum, alpha) = traced((&view, tracing, rules), raster, sampler.clone());
                let ray = view.sensor.sample_ray(raster, sampler.next_2d());
                let mut counters = Counters::default();
                let estimate = tracer.estimate(&view.scene, &ray, &mut sampler, &mut counters);
                let radiance = estimate.radiance;
                let difference = (sum - radiance).map(f32::abs).max_channel();
                assert!(
                    difference <= 1e-4 * radiance.max_channel() && alpha == estimate.alpha,
                    "{}, {text}, pixel {pixel}: {sum:?}, {estimate:?}",
                    view.name
                );
                lit += u32::from(!radiance.is_black());
            }
        }
        assert!(lit > SIDE * SIDE, "{}: {lit}", view.name);
    }
}

/// All ways of spreading, with so small deposits that every seed reaches the cap of its chains, and none
/// is put to Russian roulette.
const CAPPED: [&str; 5] = [
    "chain_length=7",
    "chain_length=1",
    "chain_length=7 expected_values=false",
    "flow=detailed chain_length=5",
    "flow=iterated flow_depth=3 flow_proposals=2",
];

/// The image by path tracing and by chains of the same seeds.
fn both(view: &View, options: &str, passes: u32) -> (Vec<Rgb>, Rendered) {
    let text = format!("erpt separate_direct=false max_depth=6 {options}");
    let path = rendered(view, "path max_depth=6", passes);
    (image(&path), rendered(view, &text, passes))
}

#[test]
fn seeds_that_reach_the_cap_of_their_chains_keep_their_energy() {
    for view in views() {
        for way in CAPPED {
            let options = format!("deposition_energy=1e-20 max_chains=3 {way}");
            let (seeds, chains) = both(&view, &options, 1);
            assert!(chains.counters.chains > 0 && chains.counters.mutation_count() > 1000);
            let (found, expected) = (mean(&image(&chains)), mean(&seeds));
            let error = relative(found, expected);
            assert!(error < 1e-5, "{}, {way}: {found}, {expected}", view.name);
        }
    }
}

#[test]
fn without_mutations_every_path_stays_where_it_is() {
    let off = "lens_perturbation=false multi_chain_perturbation=false caustic_perturbation=false";
    for view in views() {
        let (seeds, chains) = both(&view, off, 4);
        assert_eq!(chains.counters.mutation_count(), 0);
        assert_eq!(chains.counters.chains, 0);
        for (pixel, (found, expected)) in image(&chains).iter().zip(&seeds).enumerate() {
            let difference = (*found - *expected).map(f32::abs).max_channel();
            assert!(
                difference <= 1e-5 * expected.max_channel() + 1e-9,
                "{}, pixel {pixel}: {found:?}, {expected:?}",
                view.name
            );
        }
    }
}

#[test]
fn paths_that_no_mutation_applies_to_stay_where_they_are() {
    // With the caustic perturbation alone, light of the environment cannot be moved.
    let view = View {
        name: "environment",
        scene: still_life(|builder| {
            builder.add_emitter(Constant::new(Rgb::WHITE));
        }),
        sensor: still_life_camera(),
    };
    let only = "lens_perturbation=false multi_chain_perturbation=false deposition_energy=1e-20";
    let (seeds, chains) = both(&view, &format!("{only} max_chains=2 chain_length=5"), 2);
    assert!(chains.counters.mutation_count() > 0);
    let error = relative(mean(&image(&chains)), mean(&seeds));
    assert!(error < 1e-5, "{error}");
}

#[test]
fn paths_beyond_the_capacity_keep_their_energy() -> Result<(), String> {
    let view = hall_of_mirrors(SIDE);
    let render =
        |text: &str, seed: u64| picture(&view.scene, &view.sensor, text, settings(seed, SIDE), 1);
    let depth = "max_depth=120 rr_depth=200";
    let whole = mean(&render(&format!("path {depth}"), 1));
    let short = mean(&render("path max_depth=31 rr_depth=200", 1));
    assert!(short < 0.9 * whole, "{short}, {whole}");
    for options in ["chain_length=10", "flow=detailed chain_length=4"] {
        let text = format!(
            "erpt separate_direct=false {depth} mutations_per_sample=10 luminance_samples=256 {options}"
        );
        let difference = |seed: u64, text: &str| {
            let chains = tiles(&render(text, seed), 8);
            let seeds = tiles(&render(&format!("path {depth}"), seed), 8);
            let values = chains.iter().zip(&seeds).map(|(a, b)| a - b + whole);
            values.collect()
        };
        let replicas = Replicas::new(1, 32, |seed| difference(seed, &text));
        replicas
            .check(&[whole; 4], LEVEL)
            .map_err(|error| format!("{options}: {error}"))?;
        // Without the paths that do not fit, a tenth of the light or more would be missing.
        let text = text.replace("max_depth=120", "max_depth=31");
        let cut = Replicas::new(1, 32, |seed| difference(seed, &text));
        assert!(cut.check(&[whole; 4], LEVEL).is_err());
    }
    Ok(())
}

#[test]
fn seeds_as_bright_as_fireflies_keep_their_energy() {
    // A tiny lamp that only scattering finds, behind glass: hardly any sample finds it, at a thousand
    // times the mean energy.
    let ior = RelativeIor::new(1.5, 1.0).expect("the indices are positive");
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 2.0, Vec3::X * 2.0);
    let bulb = Vec3::new(0.0, 1.5, 0.0);
    let lamp = part(sphere(bulb, 0.04), Diffuse::new(0.0));
    let parts = [
        part(floor, Diffuse::new(0.7)),
        part(sphere(bulb, 0.08), Dielectric::new(ior, 1.0, 1.0)),
        lamp.glowing(Rgb::grey(1e4)),
    ];
    let view = View {
        name: "fireflies",
        scene: scene(parts, |_| {}),
        sensor: camera(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO, 50.0, SIDE),
    };
    for cap in [1, 10] {
        let options = format!("max_chains={cap} chain_length=20 mutations_per_sample=2000");
        let (seeds, chains) = both(&view, &options, 8);
        let brightest = seeds.iter().map(|c| f64::from(c.luminance()));
        let brightest = brightest.fold(0.0, f64::max);
        assert!(brightest > 20.0 * mean(&seeds), "{brightest}");
        let (found, expected) = (mean(&image(&chains)), mean(&seeds));
        let error = relative(found, expected);
        assert!(error < 0.01, "cap {cap}: {found}, {expected}");
    }
}
