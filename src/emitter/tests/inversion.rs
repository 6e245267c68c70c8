//! Samples of every emitter lead back to numbers that make them, and those are uniform.

use super::*;
use crate::math::statistics::{sidak, two_samples_p};

/// The numbers of a sample, and those that lead back to it.
struct RoundTrip {
    given: Vec<Vec2>,
    /// `None` where there are none.
    found: Option<Vec<Vec2>>,
    /// Distance between what was sampled and what the numbers found make.
    off: f32,
}

/// How the numbers found are spoilt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    None,
    /// Two numbers are exchanged.
    Exchanged,
    /// What is left open is always the same.
    NoSpare,
}

impl Mistake {
    fn spoil(self, u: Vec2) -> Vec2 {
        match self {
            Self::Exchanged => Vec2::new(u.y, u.x),
            _ => u,
        }
    }

    fn spare(self, stream: &mut Stream) -> Vec2 {
        match self {
            Self::NoSpare => Vec2::splat(0.3),
            _ => pair(stream),
        }
    }
}

/// From a point towards the emitter; `None` where a sample shows nothing.
fn toward(
    emitter: &Emitter,
    from: Vec3,
    stream: &mut Stream,
    mistake: Mistake,
) -> Option<RoundTrip> {
    let given = pair(stream);
    let sample = emitter.sample_toward(from, given)?;
    let at = sample.surface.as_ref();
    let found = emitter.invert_toward(from, sample.direction, at, mistake.spare(stream));
    let found = found.map(|u| mistake.spoil(u));
    let again = found.and_then(|u| emitter.sample_toward(from, u));
    let off = |again: EmitterSample| again.direction.distance(sample.direction);
    Some(RoundTrip {
        given: vec![given],
        found: found.map(|u| vec![u]),
        off: again.map_or(f32::INFINITY, off),
    })
}

/// Along the emitter's rays.
fn emitted(emitter: &Emitter, stream: &mut Stream, mistake: Mistake) -> Option<RoundTrip> {
    let given = [pair(stream), pair(stream)];
    let made = emitter.sample_emission(given[0], given[1])?;
    let ray = RayOfLight {
        through: made.origin + made.direction * stream.next_f32(),
        direction: made.direction,
    };
    let spares = [mistake.spare(stream), mistake.spare(stream)];
    let found = emitter.invert_emission(made.surface.as_ref(), ray, spares);
    let found = found.map(|found| found.map(|u| mistake.spoil(u)));
    let again = found.and_then(|[point, direction]| emitter.sample_emission(point, direction));
    let off = |again: EmittedRay| {
        let turned = again.direction.distance(made.direction);
        turned.max(again.origin.distance(made.origin))
    };
    Some(RoundTrip {
        given: given.to_vec(),
        found: found.map(|found| found.to_vec()),
        off: again.map_or(f32::INFINITY, off),
    })
}

/// What round trips have come to.
#[derive(Debug)]
struct Verdict {
    /// Number of samples.
    count: u32,
    /// Share of them that do not come back.
    lost: f64,
    /// Chance (Pearson's χ²) that numbers found are spread like those given; of two pairs, the smaller one.
    p: f64,
}

fn judge(mut trip: impl FnMut(&mut Stream) -> Option<RoundTrip>) -> Verdict {
    const SIDE: usize = 8;
    const FAR: f32 = 2e-3;
    let mut stream = Stream::new(29, Purpose::Check, 0, 0);
    let (mut count, mut lost) = (0, 0);
    // Of either pair, cells of numbers given and found.
    let mut cells = [[[0.0; SIDE * SIDE]; 2]; 2];
    for _ in 0..12_000 {
        let Some(trip) = trip(&mut stream) else {
            continue;
        };
        count += 1;
        lost += u32::from(trip.off.is_nan() || trip.off > FAR);
        // Samples apart for both, or the two counts would depend on each other.
        let which = (count % 2) as usize;
        let numbers = if which == 0 {
            Some(trip.given)
        } else {
            trip.found
        };
        for (cells, u) in cells.iter_mut().zip(numbers.unwrap_or_default()) {
            assert!(u.cmpge(Vec2::ZERO).all() && u.cmplt(Vec2::ONE).all(), "{u}");
            let cell = (u * SIDE as f32).as_uvec2();
            cells[which][cell.x as usize + SIDE * cell.y as usize] += 1.0;
        }
    }
    let p = |cells: &[[f64; SIDE * SIDE]; 2]| two_samples_p(&cells[0], &cells[1]).unwrap_or(1.0);
    Verdict {
        count,
        lost: f64::from(lost) / f64::from(count.max(1)),
        p: cells.iter().map(p).fold(1.0, f64::min),
    }
}

/// Verdicts on all ways to sample an emitter that show something.
fn verdicts(emitter: &Emitter, mistake: Mistake) -> Vec<Verdict> {
    let toward = FROM.map(|from| judge(|stream| toward(emitter, from, stream, mistake)));
    let emitted = judge(|stream| emitted(emitter, stream, mistake));
    assert!(emitted.count > 1000, "{emitted:?}");
    let all = toward.into_iter().chain([emitted]);
    all.filter(|verdict| verdict.count > 0).collect()
}

#[test]
fn samples_lead_back_to_numbers_that_make_them() {
    let examples = examples();
    let level = sidak(0.01, 6 * examples.len());
    for (index, emitter) in examples.iter().enumerate() {
        for verdict in verdicts(emitter, Mistake::None) {
            let is_right = verdict.lost < 2e-3 && verdict.p > level;
            assert!(
                is_right,
                "example {index}, {:?}: {verdict:?}",
                emitter.class()
            );
        }
    }
}

#[test]
fn planted_errors_of_inverses_are_found() {
    let found = |emitter: &Emitter, mistake| {
        let verdicts = verdicts(emitter, mistake);
        verdicts.iter().any(|v| v.lost > 0.1 || v.p < 1e-9)
    };
    for (index, emitter) in examples().iter().enumerate() {
        // A single ray takes any numbers.
        let takes_numbers = !matches!(emitter, Emitter::Collimated(_));
        let is_found = found(emitter, Mistake::Exchanged);
        assert_eq!(is_found, takes_numbers, "example {index}");
        // The sun may be all there is, or the sky, and then nothing is left open.
        if matches!(emitter, Emitter::SunSky(_)) {
            continue;
        }
        let leaves_open = !matches!(
            emitter,
            Emitter::Area(_) | Emitter::Constant(_) | Emitter::Envmap(_)
        );
        let is_found = found(emitter, Mistake::NoSpare);
        assert_eq!(is_found, leaves_open, "example {index}");
    }
}
