//! Vessels and columns: outlines turned about the y axis.

use std::f64::consts::TAU;

use super::mesh::Mesh;
use super::sweep::{Tube, superellipse};
use super::tubes::spline;
use super::vector::{Vec3, smoothstep};

/// Turns `outline(t)`, a radius and a height, about the axis; `flute(angle, t)` scales the radius.
fn turned(
    around: usize,
    along: usize,
    outline: impl Fn(f64) -> [f64; 2],
    flute: impl Fn(f64, f64) -> f64,
) -> Mesh {
    let surface = |u: f64, v: f64| {
        let angle = TAU * u;
        let [radius, y] = outline(v);
        let radius = radius.max(0.0) * flute(angle, v);
        [radius * angle.cos(), y, radius * angle.sin()]
    };
    Mesh::grid(around, along, surface).outwards()
}

/// A smooth outline through points that are radius and height.
fn smooth<const N: usize>(points: [[f64; 2]; N]) -> impl Fn(f64) -> [f64; 2] {
    let points: Vec<Vec3> = points.iter().map(|[r, y]| [*r, *y, 0.0]).collect();
    move |t| {
        let [r, y, _] = spline(&points, t);
        [r, y]
    }
}

/// An outline of straight lines, each in `pieces` steps when cut `pieces` × (points − 1) times.
fn straight<const N: usize>(points: [[f64; 2]; N]) -> impl Fn(f64) -> [f64; 2] {
    move |t| {
        let at = t * (N - 1) as f64;
        // Rounding must not move a corner off the grid.
        let at = if (at - at.round()).abs() < 1e-9 {
            at.round()
        } else {
            at
        };
        let i = (at as usize).min(N - 2);
        let x = at - i as f64;
        std::array::from_fn(|k| points[i][k] * (1.0 - x) + points[i + 1][k] * x)
    }
}

/// A vase with leaves that wind around it; its wall is thick, so that it can be of glass.
pub(super) fn vase() -> Mesh {
    let outline = smooth([
        [0.0, 0.0],
        [0.34, 0.0],
        [0.4, 0.06],
        [0.5, 0.35],
        [0.62, 0.75],
        [0.6, 1.1],
        [0.4, 1.42],
        [0.27, 1.66],
        [0.31, 1.86],
        [0.46, 2.0],
        [0.43, 1.99],
        [0.27, 1.84],
        [0.22, 1.66],
        [0.34, 1.42],
        [0.53, 1.1],
        [0.54, 0.75],
        [0.42, 0.35],
        [0.3, 0.14],
        [0.0, 0.1],
    ]);
    let leaves = |angle: f64, t: f64| {
        let outside = 1.0 - smoothstep(0.44, 0.5, t);
        let belly = smoothstep(0.1, 0.2, t) * outside;
        1.0 + 0.055 * belly * (14.0 * angle + 9.0 * t).sin()
    };
    turned(192, 90, outline, leaves).fitted()
}

/// A wine glass.
pub(super) fn goblet() -> Mesh {
    let outline = smooth([
        [0.0, 0.0],
        [0.42, 0.0],
        [0.44, 0.025],
        [0.3, 0.06],
        [0.09, 0.13],
        [0.05, 0.3],
        [0.05, 0.5],
        [0.075, 0.66],
        [0.05, 0.8],
        [0.06, 0.92],
        [0.3, 1.05],
        [0.46, 1.3],
        [0.48, 1.6],
        [0.41, 1.98],
        [0.395, 2.0],
        [0.38, 1.98],
        [0.445, 1.6],
        [0.42, 1.33],
        [0.27, 1.12],
        [0.0, 1.04],
    ]);
    turned(96, 114, outline, |_, _| 1.0).fitted()
}

/// A bowl with a wavy rim.
pub(super) fn bowl() -> Mesh {
    let outline = smooth([
        [0.0, 0.0],
        [0.3, 0.0],
        [0.34, 0.05],
        [0.3, 0.1],
        [0.55, 0.22],
        [0.85, 0.48],
        [1.0, 0.78],
        [0.985, 0.8],
        [0.94, 0.78],
        [0.79, 0.52],
        [0.5, 0.3],
        [0.2, 0.2],
        [0.0, 0.18],
    ]);
    let petals = |angle: f64, t: f64| {
        let rim = smoothstep(0.25, 0.5, t) * (1.0 - smoothstep(0.7, 0.95, t));
        1.0 + 0.07 * rim * (8.0 * angle).cos()
    };
    turned(160, 84, outline, petals).fitted()
}

/// A tall jar with two handles.
pub(super) fn amphora() -> Mesh {
    let outline = smooth([
        [0.0, 0.0],
        [0.22, 0.0],
        [0.24, 0.05],
        [0.12, 0.12],
        [0.22, 0.3],
        [0.46, 0.75],
        [0.6, 1.2],
        [0.52, 1.55],
        [0.25, 1.78],
        [0.16, 2.0],
        [0.16, 2.25],
        [0.27, 2.36],
        [0.26, 2.42],
        [0.17, 2.4],
        [0.12, 2.25],
        [0.12, 2.0],
        [0.2, 1.7],
        [0.0, 1.5],
    ]);
    let rings = |_: f64, t: f64| 1.0 + 0.012 * (150.0 * t).sin() * (1.0 - smoothstep(0.4, 0.5, t));
    let mut jar = turned(120, 102, outline, rings);
    for side in [-1.0, 1.0] {
        let path = [
            [0.1, 2.24, 0.0],
            [0.36, 2.3, 0.0],
            [0.56, 2.12, 0.0],
            [0.56, 1.8, 0.0],
            [0.42, 1.5, 0.0],
        ];
        let tube = Tube {
            along: 60,
            around: 24,
            closed: false,
        };
        let handle = tube.sweep(
            |t| spline(&path, t).map(|x| x * side),
            |t, angle| {
                // The ends are inside of the jar, and closed there.
                let width = if t > 0.0 && t < 1.0 { 1.0 } else { 0.0 };
                superellipse([0.05 * width, 0.085 * width], 2.5, 0.0, angle)
            },
        );
        jar.append(handle.moved(|[x, y, z]| [x, y * side, z]).outwards());
    }
    jar.fitted()
}

/// An urn with a lid and gadroons.
pub(super) fn urn() -> Mesh {
    let outline = smooth([
        [0.0, 0.0],
        [0.4, 0.0],
        [0.4, 0.08],
        [0.2, 0.16],
        [0.13, 0.3],
        [0.3, 0.42],
        [0.62, 0.7],
        [0.7, 1.0],
        [0.6, 1.22],
        [0.52, 1.3],
        [0.66, 1.4],
        [0.64, 1.46],
        [0.45, 1.55],
        [0.26, 1.66],
        [0.1, 1.78],
        [0.07, 1.84],
        [0.12, 1.92],
        [0.1, 2.0],
        [0.0, 2.04],
    ]);
    let gadroons = |angle: f64, t: f64| {
        let low = smoothstep(0.27, 0.3, t) * (1.0 - smoothstep(0.38, 0.44, t));
        let lid = smoothstep(0.62, 0.66, t) * (1.0 - smoothstep(0.7, 0.76, t));
        1.0 + 0.07 * low * (20.0 * angle).sin().abs() + 0.06 * lid * (12.0 * angle).sin().abs()
    };
    turned(200, 72, outline, gadroons).fitted()
}

/// A column that winds about its axis.
pub(super) fn column() -> Mesh {
    let surface = |u: f64, v: f64| {
        let angle = TAU * u;
        let shaft = smoothstep(0.06, 0.14, v) * (1.0 - smoothstep(0.86, 0.94, v));
        let ring = |at: f64| (1.0 - ((v - at) / 0.022).powi(2)).max(0.0).sqrt();
        let radius = 0.3 + 0.1 * ring(0.03) + 0.05 * ring(0.075) + 0.05 * ring(0.925);
        let radius = radius + 0.1 * smoothstep(0.94, 0.97, v);
        let radius = radius * (1.0 + 0.07 * shaft * (4.0 * (angle - 9.0 * v)).cos());
        let (lean, turn) = (0.13 * shaft, 4.0 * TAU * v);
        let end = if v > 0.0 && v < 1.0 { 1.0 } else { 0.0 };
        [
            end * (radius * angle.cos() + lean * turn.cos()),
            // The first and the last row close the ends.
            3.0 * ((180.0 * v - 1.0) / 178.0).clamp(0.0, 1.0),
            end * (radius * angle.sin() + lean * turn.sin()),
        ]
    };
    Mesh::grid(80, 180, surface).outwards().fitted()
}

/// A fluted column with base and capital, 1 high and 0.12 thick. Not fitted; it has edges.
pub(super) fn pilaster() -> Mesh {
    const POINTS: [[f64; 2]; 17] = [
        [0.0, 0.0],
        [0.082, 0.0],
        [0.082, 0.025],
        [0.075, 0.028],
        [0.08, 0.04],
        [0.075, 0.052],
        [0.064, 0.056],
        [0.06, 0.062],
        [0.06, 0.08],
        [0.052, 0.9],
        [0.052, 0.915],
        [0.06, 0.922],
        [0.06, 0.93],
        [0.074, 0.95],
        [0.084, 0.955],
        [0.084, 1.0],
        [0.0, 1.0],
    ];
    let shaft = |y: f64| smoothstep(0.08, 0.11, y) * (1.0 - smoothstep(0.87, 0.9, y));
    let outline = straight(POINTS);
    let flute = |angle: f64, t: f64| {
        let [_, y] = straight(POINTS)(t);
        1.0 - 0.09 * shaft(y) * (12.0 * angle).sin().abs()
    };
    turned(144, 16 * 4, outline, flute)
}
