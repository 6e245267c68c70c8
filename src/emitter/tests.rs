//! Every emitter's samples against its densities, its radiance and its power.

mod emission;
mod inversion;

use super::*;
use crate::math::statistics::chi_square_p;
use crate::math::warp;
use crate::random::{Purpose, Stream};
use crate::shape::brute_force::crossings;

/// Level of each χ² test: the family of about twenty then errs with 1 %, once and for all seeds.
const LEVEL: f64 = 5e-4;

const BOUNDS: SceneBounds = SceneBounds {
    centre: Vec3::ZERO,
    radius: 3.0,
};

fn examples() -> Vec<Emitter> {
    let mut all = Emitter::examples();
    for emitter in &mut all {
        emitter.set_scene_bounds(BOUNDS);
    }
    all
}

/// Points on different sides of the examples, outside of them.
const FROM: [Vec3; 2] = [Vec3::new(0.9, 0.4, 1.4), Vec3::new(-1.3, -0.6, 1.8)];

fn pair(stream: &mut Stream) -> Vec2 {
    let x = stream.next_f32();
    Vec2::new(x, stream.next_f32())
}

/// Radiance that arrives from a direction and density of sampling it, everything visible.
fn arriving(emitter: &Emitter, from: Vec3, toward: Vec3) -> (f64, f64) {
    let Emitter::Area(area) = emitter else {
        let radiance = f64::from(emitter.environment_radiance(toward).luminance());
        let density = f64::from(emitter.environment_density(toward).0);
        return (radiance, if radiance > 0.0 { density } else { 0.0 });
    };
    let mut sum = (0.0, 0.0);
    for at in crossings(area.shape(), from, toward) {
        let radiance = f64::from(emitter.radiance(&at, -toward).luminance());
        if radiance > 0.0 {
            sum.0 += radiance;
            sum.1 += f64::from(emitter.density_toward(from, &at).0);
        }
    }
    sum
}

const CELLS: [usize; 2] = [24, 12];
const SUB_CELLS: usize = 24;

fn cell(direction: Vec3) -> usize {
    let u = warp::uniform_sphere_inverse(direction).min(Vec2::splat(warp::ONE_MINUS_EPSILON));
    (u.x * CELLS[0] as f32) as usize * CELLS[1] + (u.y * CELLS[1] as f32) as usize
}

/// Calls `visit` with the directions of a fine grid and the solid angle of each.
fn all_directions(mut visit: impl FnMut(Vec3, f64)) {
    let fine = CELLS.map(|count| count * SUB_CELLS);
    let solid_angle = 4.0 * std::f64::consts::PI / (fine[0] * fine[1]) as f64;
    for (i, j) in (0..fine[0]).flat_map(|i| (0..fine[1]).map(move |j| (i, j))) {
        let u = Vec2::new(
            (i as f32 + 0.5) / fine[0] as f32,
            (j as f32 + 0.5) / fine[1] as f32,
        );
        visit(warp::uniform_sphere(u), solid_angle);
    }
}

/// χ² of the directions to an emitter against its density times `fault` of the direction, and what
/// part of the samples ended where nothing is expected.
fn p_value(emitter: &Emitter, from: Vec3, fault: impl Fn(Vec3) -> f64) -> (f64, f64) {
    const COUNT: u32 = 20_000;
    let outside = CELLS[0] * CELLS[1];
    let mut observed = vec![0.0; outside + 1];
    let mut stream = Stream::new(21, Purpose::Check, 0, 0);
    for _ in 0..COUNT {
        let sample = emitter.sample_toward(from, pair(&mut stream));
        observed[sample.map_or(outside, |sample| cell(sample.direction))] += 1.0;
    }
    let mut expected = vec![0.0; outside + 1];
    all_directions(|direction, solid_angle| {
        let (_, density) = arriving(emitter, from, direction);
        expected[cell(direction)] += density * fault(direction) * solid_angle * f64::from(COUNT);
    });
    expected[outside] = f64::from(COUNT) - expected.iter().sum::<f64>();
    // Cells that only the tip of a shape reaches are beyond the quadrature: they join the outside.
    let (mut kept_observed, mut kept_expected) = (Vec::new(), Vec::new());
    let mut missed = observed[outside] - expected[outside];
    for (o, e) in observed.into_iter().zip(expected).take(outside) {
        if e >= 5.0 {
            kept_observed.push(o);
            kept_expected.push(e);
        } else {
            missed += o - e;
        }
    }
    let p = chi_square_p(&kept_observed, &kept_expected).unwrap();
    (p, missed.abs() / f64::from(COUNT))
}

#[test]
fn directions_follow_their_density() {
    for emitter in examples() {
        if emitter.class().is_dirac() {
            continue;
        }
        for from in FROM {
            let (p, missed) = p_value(&emitter, from, |_| 1.0);
            assert!(missed < 0.005, "{missed} from {from} to {emitter:?}");
            assert!(p > LEVEL, "p = {p} from {from} to {emitter:?}");
        }
    }
}

#[test]
fn a_density_that_is_wrong_by_a_tenth_is_caught() {
    for emitter in examples() {
        if emitter.class().is_dirac() {
            continue;
        }
        let middle = emitter.sample_toward(FROM[0], Vec2::splat(0.5)).unwrap();
        let plane = middle.direction.any_orthogonal_vector();
        // Wrong in stripes, so that the sum stays about right.
        let fault = |d: Vec3| {
            if (d.dot(plane) * 8.0).sin() > 0.0 {
                1.1
            } else {
                0.9
            }
        };
        let (p, _) = p_value(&emitter, FROM[0], fault);
        assert!(p < 1e-4, "p = {p} for {emitter:?}");
    }
}

/// Mean of a sampled quantity and the error of that mean.
fn estimate(count: u32, mut sample: impl FnMut(&mut Stream) -> f64) -> (f64, f64) {
    let mut stream = Stream::new(22, Purpose::Check, 0, 0);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let value = sample(&mut stream);
        sum += value;
        squares += value * value;
    }
    let mean = sum / f64::from(count);
    let variance = squares / f64::from(count) - mean * mean;
    (mean, (variance.max(0.0) / f64::from(count)).sqrt())
}

#[test]
fn radiance_over_density_integrates_the_radiance() {
    for emitter in examples() {
        if emitter.class().is_dirac() {
            continue;
        }
        for from in FROM {
            let mut exact = 0.0;
            all_directions(|direction, solid_angle| {
                exact += arriving(&emitter, from, direction).0 * solid_angle;
            });
            let (mean, error) = estimate(20_000, |stream| {
                let sample = emitter.sample_toward(from, pair(stream));
                sample.map_or(0.0, |s| f64::from(s.radiance.luminance() / s.density.0))
            });
            // The floor is the error of the quadrature at edges.
            let z = (mean - exact) / (error + 1e-3 * exact);
            assert!(z.abs() < 4.0, "{mean} ± {error} for {exact} at {emitter:?}");
        }
    }
}

#[test]
fn samples_are_what_density_and_radiance_say() {
    for emitter in examples() {
        let mut stream = Stream::new(23, Purpose::Check, 0, 0);
        for i in 0..500 {
            let from = FROM[i % 2];
            let Some(sample) = emitter.sample_toward(from, pair(&mut stream)) else {
                continue;
            };
            assert!((sample.direction.length() - 1.0).abs() < 1e-5);
            assert_eq!(sample.is_dirac, emitter.class().is_dirac());
            let infinite = matches!(
                emitter.class(),
                EmitterClass::Directional | EmitterClass::Environment
            );
            assert_eq!(sample.target.is_none(), infinite);
            if let Some(target) = sample.target {
                let direction = (target - from).normalize();
                assert!((direction - sample.direction).length() < 1e-4);
            }
            if emitter.class() == EmitterClass::Environment {
                let density = emitter.environment_density(sample.direction).0;
                assert!(
                    (density / sample.density.0 - 1.0).abs() < 1e-4,
                    "{emitter:?}"
                );
                let radiance = emitter.environment_radiance(sample.direction);
                let miss = (radiance - sample.radiance).0.abs().max_element();
                assert!(miss <= 1e-4 * sample.radiance.max_channel(), "{emitter:?}");
            }
        }
    }
}

/// What flows outwards through a sphere around a finite light, or through the scene from an
/// infinite one, estimated from its samples.
#[test]
fn power_is_what_flows_out() {
    const COUNT: u32 = 60_000;
    for emitter in examples() {
        let (flow, error) = match emitter.class() {
            EmitterClass::Area | EmitterClass::Point => {
                let radius = 3.0;
                let area = 4.0 * std::f64::consts::PI * f64::from(radius * radius);
                estimate(COUNT, |stream| {
                    let outwards = warp::uniform_sphere(pair(stream));
                    let sample = emitter.sample_toward(outwards * radius, pair(stream));
                    sample.map_or(0.0, |s| {
                        let irradiance = s.radiance.luminance() / s.density.0;
                        area * f64::from(irradiance * -s.direction.dot(outwards))
                    })
                })
            }
            // No point can ask for it.
            EmitterClass::Collimated => continue,
            EmitterClass::Directional | EmitterClass::Environment => {
                let disk = std::f64::consts::PI * f64::from(BOUNDS.radius).powi(2);
                estimate(COUNT, |stream| {
                    let sample = emitter.sample_toward(Vec3::ZERO, pair(stream));
                    let arriving = |s: EmitterSample| s.radiance.luminance() / s.density.0;
                    disk * f64::from(sample.map_or(0.0, arriving))
                })
            }
        };
        let power = emitter.power();
        let z = (flow - power) / (error + 2e-3 * power);
        assert!(
            z.abs() < 4.0,
            "{flow} ± {error}, but power {power} of {emitter:?}"
        );
    }
}
