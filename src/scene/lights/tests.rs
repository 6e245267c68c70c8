//! Choices of emitters.

use super::*;
use crate::emitter::{Constant, Point};

fn points(count: usize) -> Lights {
    let point =
        |i: usize| Point::new(Vec3::new(i as f32, 0.0, 0.0), Rgb::grey(1.0 + i as f32)).into();
    Lights::new((0..count).map(point).collect())
}

#[test]
fn choices_have_the_probability_they_say() {
    let from = Vec3::new(0.2, 1.0, 0.0);
    for count in [1, 2, 7, WEIGHED, WEIGHED + 1, 40] {
        let lights = points(count);
        let n = 20_000;
        let mut counts = vec![0; count];
        for i in 0..n {
            let u = (i as f32 + 0.5) / n as f32;
            let choice = lights.choose(from, u).unwrap();
            counts[choice.index] += 1;
            assert!((0.0..1.0).contains(&choice.remainder));
            let probability = lights.probability(EmitterId(choice.index as u32), from);
            assert!((choice.probability - probability).abs() < 1e-6);
        }
        for (index, found) in counts.into_iter().enumerate() {
            let expected = lights.probability(EmitterId(index as u32), from) * n as f32;
            assert!(
                (found as f32 - expected).abs() < 3.0,
                "{count}: {found}, {expected}"
            );
            assert!(found > 0, "no emitter is forgotten");
        }
    }
    assert!(points(0).choose(from, 0.5).is_none());
}

#[test]
fn rays_come_from_emitters_in_proportion_to_their_power() {
    for count in [1, 3, 20] {
        let lights = points(count);
        let total: f64 = lights.emitters().iter().map(EmitterModel::power).sum();
        let n = 20_000;
        let mut counts = vec![0; count];
        for i in 0..n {
            let u = (i as f32 + 0.5) / n as f32;
            let half = Vec2::splat(0.5);
            let chosen = lights.sample_emission(u, half, half).unwrap();
            counts[chosen.emitter.0 as usize] += 1;
            let said = lights.emission_probability(chosen.emitter);
            assert_eq!(chosen.probability, said);
        }
        for (emitter, found) in lights.emitters().iter().zip(counts) {
            let share = 0.9 * emitter.power() / total + 0.1 / count as f64;
            let expected = share * f64::from(n);
            assert!(
                (f64::from(found) - expected).abs() < 3.0,
                "{found}, {expected}"
            );
        }
    }
    let none = points(0).sample_emission(0.5, Vec2::ZERO, Vec2::ZERO);
    assert!(none.is_none());
}

#[test]
fn near_lights_are_preferred_and_broken_sums_are_survived() {
    let lights = points(3);
    let near = lights.probability(EmitterId(2), Vec3::new(2.0, 0.1, 0.0));
    assert!(near > 0.9, "{near}");
    let lights = Lights::new(vec![
        Constant::new(Rgb::grey(f32::MAX)).into(),
        Constant::new(Rgb::grey(f32::MAX)).into(),
    ]);
    assert_eq!(lights.probability(EmitterId(0), Vec3::ZERO), 0.5);
}

#[test]
fn choices_lead_back_to_their_numbers() {
    let from = Vec3::new(0.2, 1.0, 0.0);
    for count in [1, 2, 7, WEIGHED, WEIGHED + 1, 40] {
        let lights = points(count);
        for i in 0..500 {
            // Such a light makes no use of its numbers: what is left of them is spare.
            let u = Vec2::new((i as f32 + 0.5) / 500.0, 0.25);
            let choice = lights.choose(from, u.x).unwrap();
            let id = EmitterId(choice.index as u32);
            let invert = |place| {
                let spare = Vec2::new(place, u.y);
                lights
                    .invert_toward(id, (from, Vec3::Y), None, spare)
                    .unwrap()
            };
            assert!(invert(choice.remainder).distance(u) < 1e-5, "{count}: {u}");
            for place in [0.0, 0.5, warp::ONE_MINUS_EPSILON] {
                let found = lights.choose(from, invert(place).x).unwrap();
                assert_eq!(found.index, choice.index);
                let number = lights.invert_emission_choice(id, place).unwrap();
                let half = Vec2::splat(0.5);
                let chosen = lights.sample_emission(number, half, half).unwrap();
                assert_eq!(chosen.emitter, id);
            }
        }
    }
}
