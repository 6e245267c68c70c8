//! Samplers can be undone: from a direction back to numbers that make it, and those are uniform.

use lumiflow::bsdf::{BsdfModel, BsdfSample, SampleNumbers, Sampled, Spare, Transport};
use lumiflow::math::Local;
use lumiflow::math::statistics::{sidak, two_samples_p};
use lumiflow::random::{Purpose, Stream};

use crate::support::effort::{level, samples, seed};
use crate::support::faulty::{Fault, Faulty};
use crate::support::materials::{Case, cases, direction, numbers, surface_point};

/// From where a material is looked at, and what for.
type View = (Local, Transport);

fn sample(
    bsdf: &dyn BsdfModel,
    (wi, transport): View,
    numbers: SampleNumbers,
) -> Option<BsdfSample> {
    let SampleNumbers { u_lobe, u } = numbers;
    bsdf.sample(wi, &surface_point(), transport, u_lobe, u)
}

fn what(sample: &BsdfSample) -> Sampled {
    if sample.lobe.is_dirac() {
        Sampled::Dirac(sample.component)
    } else {
        Sampled::Finite(sample.direction)
    }
}

fn uniform(stream: &mut Stream) -> SampleNumbers {
    let (u_lobe, u) = numbers(stream);
    SampleNumbers { u_lobe, u }
}

/// A sample of uniform numbers, those numbers, and numbers that lead back to it.
struct RoundTrip {
    sample: BsdfSample,
    there: SampleNumbers,
    back: Option<SampleNumbers>,
}

fn round_trip(bsdf: &dyn BsdfModel, view: View, stream: &mut Stream) -> Option<RoundTrip> {
    let there = uniform(stream);
    let spare = Spare {
        lobe: stream.next_f32(),
        numbers: uniform(stream),
    };
    let sample = sample(bsdf, view, there)?;
    let back = bsdf.invert(view.0, what(&sample), &surface_point(), view.1, spare);
    Some(RoundTrip {
        sample,
        there,
        back,
    })
}

/// Share of samples that come out elsewhere when they are made anew from the numbers found.
///
/// A few may: where two lobes meet, or where a mirror is so slanted that its normal has no digits.
fn lost(bsdf: &dyn BsdfModel, view: View, stream: &mut Stream) -> f64 {
    const FAR: f32 = 4e-3;
    let (mut count, mut lost) = (0, 0);
    for _ in 0..samples(2000) {
        let Some(trip) = round_trip(bsdf, view, stream) else {
            continue;
        };
        count += 1;
        let again = trip.back.and_then(|numbers| sample(bsdf, view, numbers));
        let is_same = again.is_some_and(|again| {
            let near = again.direction.0.distance(trip.sample.direction.0) < FAR;
            let same_kind = again.lobe.is_dirac() == trip.sample.lobe.is_dirac();
            near && same_kind && again.component == trip.sample.component
        });
        lost += u32::from(!is_same);
    }
    f64::from(lost) / f64::from(count.max(1))
}

/// Chance that the numbers found are spread like those that were given, over 4 × 4 × 4 cells.
fn spread_p(bsdf: &dyn BsdfModel, view: View, stream: &mut Stream) -> Option<f64> {
    const SIDE: usize = 4;
    let cell = |numbers: SampleNumbers| {
        let place = |u: f32| ((u * SIDE as f32) as usize).min(SIDE - 1);
        let across = place(numbers.u.x) + SIDE * place(numbers.u.y);
        place(numbers.u_lobe) + SIDE * across
    };
    let mut given = vec![0.0; SIDE * SIDE * SIDE];
    let mut found = given.clone();
    // Samples apart for both, or the two counts would depend on each other.
    for number in 0..samples(40_000) {
        let Some(trip) = round_trip(bsdf, view, stream) else {
            continue;
        };
        if number % 2 == 0 {
            given[cell(trip.there)] += 1.0;
        } else if let Some(back) = trip.back {
            found[cell(back)] += 1.0;
        }
    }
    two_samples_p(&given, &found)
}

/// Every example from every view; only samplers of normals that turn ask for the transport.
fn all() -> Vec<Case> {
    cases(seed(71))
        .into_iter()
        .filter(|case| {
            let turns = format!("{:?}", case.bsdf).contains("turning: true");
            turns || case.transport == Transport::Radiance
        })
        .collect()
}

#[test]
fn numbers_found_make_the_same_sample() {
    for mut case in all() {
        let share = lost(&case.bsdf, (case.wi, case.transport), &mut case.stream);
        assert!(share < 5e-3, "{}: {share} are lost", case.name);
    }
}

#[test]
fn numbers_found_are_spread_like_those_given() {
    let cases = all();
    let level = sidak(level(0.01), cases.len());
    for mut case in cases {
        let p = spread_p(&case.bsdf, (case.wi, case.transport), &mut case.stream);
        assert!(p.unwrap_or(1.0) > level, "{}: p = {p:?}", case.name);
    }
}

#[test]
fn planted_errors_are_found() {
    let mut stream = Stream::new(seed(72), Purpose::Check, 0, 0);
    let view = (direction(50.0, 70.0), Transport::Radiance);
    for name in [
        "Diffuse",
        "RoughConductor",
        "Principled",
        "RoughCoating",
        "Mixture",
    ] {
        let example = || {
            let all = lumiflow::bsdf::Bsdf::examples();
            all.into_iter().find(|bsdf| bsdf.name() == name).unwrap()
        };
        let faulty = |fault| Faulty {
            bsdf: example(),
            fault,
        };
        let share = lost(&faulty(Fault::Inverse), view, &mut stream);
        assert!(share > 0.1, "{name}: {share}");
        let p = spread_p(&faulty(Fault::SpareLobe), view, &mut stream);
        assert!(p.is_some_and(|p| p < 1e-6), "{name}: {p:?}");
    }
}
