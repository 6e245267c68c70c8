//! Tubes: a section carried along a curve.

use std::f64::consts::TAU;

use super::mesh::Mesh;
use super::vector::{Vec3, add, cross, dot, mul, sub, unit};

/// How a tube is cut into faces, and whether its curve is closed.
pub(super) struct Tube {
    pub(super) along: usize,
    pub(super) around: usize,
    pub(super) closed: bool,
}

impl Tube {
    /// Carries `section(t, angle)`, a point of the plane across the curve, along `curve(t)`, t in 0–1.
    ///
    /// The plane turns as little as it can; a closed curve's is turned evenly so that it fits at the end.
    pub(super) fn sweep(
        &self,
        curve: impl Fn(f64) -> Vec3,
        section: impl Fn(f64, f64) -> [f64; 2],
    ) -> Mesh {
        let times: Vec<f64> = (0..=self.along)
            .map(|i| i as f64 / self.along as f64)
            .collect();
        let frames = self.frames(&curve, &times);
        let rows = times.iter().zip(&frames).map(|(&t, [side, up])| {
            let ring = (0..=self.around).map(|j| {
                let [x, y] = section(t, TAU * j as f64 / self.around as f64);
                add(curve(t), add(mul(*side, x), mul(*up, y)))
            });
            ring.collect()
        });
        Mesh::rows(&rows.collect::<Vec<_>>()).outwards()
    }

    /// Two unit vectors across the curve at each of the times.
    fn frames(&self, curve: &impl Fn(f64) -> Vec3, times: &[f64]) -> Vec<[Vec3; 2]> {
        const STEP: f64 = 1e-5;
        let tangent = |t: f64| {
            let (before, after) = match self.closed {
                true => (t - STEP, t + STEP),
                false => ((t - STEP).max(0.0), (t + STEP).min(1.0)),
            };
            unit(sub(curve(after), curve(before)))
        };
        let across = |side: Vec3, along: Vec3| unit(sub(side, mul(along, dot(side, along))));
        let first = tangent(times[0]);
        let start = if first[1].abs() < 0.9 {
            [0.0, 1.0, 0.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let mut side = across(start, first);
        let mut sides = Vec::with_capacity(times.len());
        for &t in times {
            side = across(side, tangent(t));
            sides.push(side);
        }
        let over = |side: Vec3| dot(cross(first, sides[0]), side).atan2(dot(sides[0], side));
        let turn = if self.closed { -over(side) } else { 0.0 };
        let pairs = times.iter().zip(&sides).map(|(&t, &side)| {
            let up = cross(tangent(t), side);
            let (sin, cos) = (turn * t).sin_cos();
            [
                add(mul(side, cos), mul(up, sin)),
                add(mul(up, cos), mul(side, -sin)),
            ]
        });
        pairs.collect()
    }
}

/// A circle.
pub(super) fn circle(radius: f64, angle: f64) -> [f64; 2] {
    [radius * angle.cos(), radius * angle.sin()]
}

/// A superellipse, turned by an angle: a square with round corners for a power of 4 or so.
pub(super) fn superellipse([a, b]: [f64; 2], power: f64, turn: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let scale = (cos.abs().powf(power) + sin.abs().powf(power)).powf(-1.0 / power);
    let (x, y) = (a * scale * cos, b * scale * sin);
    let (sin, cos) = turn.sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

/// The radius of a rod with round ends, as a part of its greatest: `end` is the length of an end in `t`.
pub(super) fn round_ends(end: f64, t: f64) -> f64 {
    let x = (t.min(1.0 - t) / end).clamp(0.0, 1.0);
    (1.0 - (1.0 - x).powi(2)).sqrt()
}
