//! Emitted rays against their densities, and against the light that arrives at points.

use super::*;
use crate::math::Frame;

/// One point of the unit square for each of two pairs of coordinates of a ray.
struct Coordinates {
    /// Of the direction: on the whole sphere, around the normal of a surface.
    direction: Vec2,
    /// Of the point on the disk across a ray from infinity.
    place: Vec2,
    ray: EmittedRay,
}

fn sample(emitter: &Emitter, stream: &mut Stream) -> Option<Coordinates> {
    let u_point = pair(stream);
    let ray = emitter.sample_emission(u_point, pair(stream))?;
    let local = match &ray.surface {
        Some(at) => local_to(at.geometric_normal, ray.direction),
        None => ray.direction,
    };
    let from_centre = local_to(-ray.direction, ray.origin - BOUNDS.centre) / BOUNDS.radius;
    Some(Coordinates {
        direction: warp::uniform_sphere_inverse(local),
        place: warp::uniform_disk_inverse(from_centre.truncate()),
        ray,
    })
}

fn local_to(normal: Vec3, v: Vec3) -> Vec3 {
    let frame = Frame::around(normal);
    Vec3::new(frame.tangent.dot(v), frame.bitangent.dot(v), v.dot(normal))
}

fn cell_of(u: Vec2) -> usize {
    let u = u.clamp(Vec2::ZERO, Vec2::splat(warp::ONE_MINUS_EPSILON));
    (u.x * CELLS[0] as f32) as usize * CELLS[1] + (u.y * CELLS[1] as f32) as usize
}

/// χ² of the directions of rays against their density times `fault` of the direction, and the share of
/// the rays that are too many.
fn direction_p_value(emitter: &Emitter, fault: impl Fn(Vec3) -> f64) -> (f64, f64) {
    const COUNT: u32 = 20_000;
    let mut observed = vec![0.0; CELLS[0] * CELLS[1]];
    let mut stream = Stream::new(24, Purpose::Check, 0, 0);
    let surface = emitter
        .sample_emission(Vec2::splat(0.4), Vec2::splat(0.4))
        .and_then(|ray| ray.surface);
    let mut made = 0.0;
    for _ in 0..COUNT {
        if let Some(found) = sample(emitter, &mut stream) {
            observed[cell_of(found.direction)] += 1.0;
            made += 1.0;
        }
    }
    let mut expected = vec![0.0; CELLS[0] * CELLS[1]];
    all_directions(|local, solid_angle| {
        let direction = surface.map_or(local, |at| {
            let frame = Frame::around(at.geometric_normal);
            frame.tangent * local.x + frame.bitangent * local.y + frame.normal * local.z
        });
        // Directions of which nothing comes may be left out.
        if emitter.class() == EmitterClass::Environment
            && emitter.environment_radiance(-direction).is_black()
        {
            return;
        }
        let density = emitter.emission_density(surface.as_ref(), direction);
        let density = f64::from(density.direction.0) * fault(local);
        expected[cell_of(warp::uniform_sphere_inverse(local))] +=
            density * solid_angle * f64::from(COUNT);
    });
    let surplus = made / expected.iter().sum::<f64>() - 1.0;
    let kept = observed.iter().zip(&expected).filter(|(_, e)| **e >= 5.0);
    let (observed, expected): (Vec<f64>, Vec<f64>) = kept.map(|(o, e)| (*o, *e)).unzip();
    // Cells that only the edge of a cone reaches are beyond the quadrature.
    let scale = observed.iter().sum::<f64>() / expected.iter().sum::<f64>();
    let expected: Vec<f64> = expected.iter().map(|e| e * scale).collect();
    (chi_square_p(&observed, &expected).unwrap(), surplus)
}

/// Whether rays go into directions that have a density, not one direction alone.
fn has_directions(emitter: &Emitter) -> bool {
    !matches!(
        emitter.class(),
        EmitterClass::Directional | EmitterClass::Collimated
    )
}

#[test]
fn emitted_directions_follow_their_density() {
    for emitter in examples().iter().filter(|e| has_directions(e)) {
        let (p, surplus) = direction_p_value(emitter, |_| 1.0);
        assert!(surplus.abs() < 0.02, "{surplus} for {emitter:?}");
        assert!(p > LEVEL, "p = {p} for {emitter:?}");
    }
}

#[test]
fn a_density_of_emission_that_is_wrong_by_a_tenth_is_caught() {
    for emitter in examples().iter().filter(|e| has_directions(e)) {
        let ray = emitter.sample_emission(Vec2::splat(0.4), Vec2::splat(0.5));
        let ray = ray.unwrap();
        let plane = match &ray.surface {
            Some(_) => Vec3::X,
            None => ray.direction.any_orthogonal_vector(),
        };
        let fault = |d: Vec3| {
            if (d.dot(plane) * 8.0).sin() > 0.0 {
                1.1
            } else {
                0.9
            }
        };
        let (p, _) = direction_p_value(emitter, fault);
        assert!(p < 1e-3, "p = {p} for {emitter:?}");
    }
}

#[test]
fn rays_from_infinity_are_uniform_on_the_disk() {
    let is_infinite = |e: &&Emitter| {
        matches!(
            e.class(),
            EmitterClass::Directional | EmitterClass::Environment
        )
    };
    for emitter in examples().iter().filter(is_infinite) {
        let mut observed = vec![0.0; CELLS[0] * CELLS[1]];
        let mut stream = Stream::new(25, Purpose::Check, 0, 0);
        let mut made = 0.0;
        while made < 20_000.0 {
            let Some(found) = sample(emitter, &mut stream) else {
                continue;
            };
            observed[cell_of(found.place)] += 1.0;
            made += 1.0;
            // It starts before all that it could meet.
            let before = (found.ray.origin - BOUNDS.centre).dot(found.ray.direction);
            assert!(before < -BOUNDS.radius, "{before}");
        }
        let expected = vec![made / observed.len() as f64; observed.len()];
        let p = chi_square_p(&observed, &expected).unwrap();
        assert!(p > LEVEL, "p = {p} for {emitter:?}");
        let area = std::f64::consts::PI * f64::from(BOUNDS.radius).powi(2);
        let density = emitter.emission_density(None, Vec3::X).point.0;
        assert!((f64::from(density) * area - 1.0).abs() < 1e-5);
    }
}

#[test]
fn rays_have_the_density_that_they_are_made_with() {
    for emitter in examples() {
        let mut stream = Stream::new(26, Purpose::Check, 0, 0);
        for _ in 0..500 {
            let Some(found) = sample(&emitter, &mut stream) else {
                continue;
            };
            let ray = found.ray;
            let said = emitter.emission_density(ray.surface.as_ref(), ray.direction);
            let same = |a: f32, b: f32| (a / b - 1.0).abs() < 1e-4;
            assert!(
                same(said.point.0, ray.density.point.0)
                    && same(said.direction.0, ray.density.direction.0),
                "{said:?}, {ray:?} of {emitter:?}"
            );
            assert!((ray.direction.length() - 1.0).abs() < 1e-5);
            let value = match emitter.class() {
                EmitterClass::Area => emitter.radiance(&ray.surface.unwrap(), ray.direction),
                EmitterClass::Point => emitter.intensity(ray.direction),
                EmitterClass::Environment => emitter.environment_radiance(-ray.direction),
                EmitterClass::Directional | EmitterClass::Collimated => ray.value,
            };
            let miss = (value - ray.value).0.abs().max_element();
            assert!(miss <= 1e-4 * ray.value.max_channel(), "{emitter:?}");
        }
    }
}

/// The mean of what rays carry is the power, and what of it passes through a disk is what arrives there.
#[test]
fn rays_carry_the_light_that_arrives() {
    const COUNT: u32 = 100_000;
    let disks = [
        (Vec3::new(0.9, 0.4, 1.4), Vec3::new(-0.6, -0.2, -1.0)),
        (Vec3::new(-1.0, -0.6, 0.8), Vec3::new(0.9, 0.5, -0.6)),
    ];
    let radius = 0.45_f32;
    for emitter in examples() {
        let (power, error) = estimate(COUNT, |stream| {
            let found = sample(&emitter, stream);
            found.map_or(0.0, |found| f64::from(found.ray.power().luminance()))
        });
        let z = (power - emitter.power()) / (error + 2e-3 * power);
        assert!(z.abs() < 4.0, "{power} ± {error} for {emitter:?}");
        // No point of a disk can ask for the light of one ray.
        let can_ask = emitter.class().is_connectable();
        for (centre, normal) in disks.into_iter().filter(|_| can_ask) {
            let normal = normal.normalize();
            let (through, error) = estimate(COUNT, |stream| {
                let Some(found) = sample(&emitter, stream) else {
                    return 0.0;
                };
                let ray = found.ray;
                let cos = ray.direction.dot(normal);
                let distance = (centre - ray.origin).dot(normal) / cos;
                let miss = (ray.origin + ray.direction * distance).distance(centre);
                if cos > 0.0 && distance > 0.0 && miss < radius {
                    f64::from(ray.power().luminance())
                } else {
                    0.0
                }
            });
            let area = std::f32::consts::PI * radius * radius;
            let frame = Frame::around(normal);
            let (arriving, other) = estimate(COUNT, |stream| {
                let place = warp::uniform_disk(pair(stream)) * radius;
                let from = centre + frame.tangent * place.x + frame.bitangent * place.y;
                let seen = emitter.sample_toward(from, pair(stream));
                seen.map_or(0.0, |s| {
                    let cos = (-s.direction).dot(normal).max(0.0);
                    f64::from(s.radiance.luminance() * cos * area / s.density.0)
                })
            });
            let z =
                (through - arriving) / (error.hypot(other) + 2e-3 * arriving + f64::MIN_POSITIVE);
            assert!(
                z.abs() < 4.0,
                "{through} ± {error}, {arriving} ± {other} for {emitter:?}"
            );
        }
    }
}
