//! Knots, rings, coils and shells.

use std::f64::consts::{PI, TAU};

use super::mesh::Mesh;
use super::sweep::{Tube, circle, round_ends, superellipse};
use super::vector::{Vec3, add, mix, mul, smoothstep};

/// A smooth curve through points (Catmull-Rom), t in 0–1.
pub(super) fn spline(points: &[Vec3], t: f64) -> Vec3 {
    let last = points.len() - 1;
    let at = t.clamp(0.0, 1.0) * last as f64;
    let i = (at as usize).min(last - 1);
    let x = at - i as f64;
    let [a, b] = [points[i.saturating_sub(1)], points[i]];
    let [c, d] = [points[i + 1], points[(i + 2).min(last)]];
    std::array::from_fn(|k| {
        let (m, n) = ((c[k] - a[k]) / 2.0, (d[k] - b[k]) / 2.0);
        let (x2, x3) = (x * x, x * x * x);
        b[k] * (2.0 * x3 - 3.0 * x2 + 1.0)
            + m * (x3 - 2.0 * x2 + x)
            + c[k] * (3.0 * x2 - 2.0 * x3)
            + n * (x3 - x2)
    })
}

/// A trefoil of a fluted rope.
pub(super) fn trefoil() -> Mesh {
    let tube = Tube {
        along: 400,
        around: 42,
        closed: true,
    };
    let curve = |t: f64| {
        let a = TAU * t;
        [
            a.sin() + 2.0 * (2.0 * a).sin(),
            a.cos() - 2.0 * (2.0 * a).cos(),
            -1.2 * (3.0 * a).sin(),
        ]
    };
    let rope = |t: f64, angle: f64| {
        let strands = (6.0 * angle + 30.0 * TAU * t).cos();
        circle(0.5 * (1.0 + 0.09 * strands), angle)
    };
    tube.sweep(curve, rope).fitted()
}

/// A knot on a torus, twice around and five times through, of a square bar that turns.
pub(super) fn torus_knot() -> Mesh {
    let tube = Tube {
        along: 480,
        around: 32,
        closed: true,
    };
    let curve = |t: f64| {
        let a = TAU * t;
        let r = 1.6 + 0.75 * (5.0 * a).cos();
        [
            r * (2.0 * a).cos(),
            r * (2.0 * a).sin(),
            0.75 * (5.0 * a).sin(),
        ]
    };
    tube.sweep(curve, |t, angle| {
        superellipse([0.3, 0.3], 6.0, 10.0 * PI / 2.0 * t, angle)
    })
    .fitted()
}

/// A figure-eight knot, standing.
pub(super) fn figure_eight() -> Mesh {
    let tube = Tube {
        along: 420,
        around: 32,
        closed: true,
    };
    let curve = |t: f64| {
        let a = TAU * t;
        let r = 2.0 + (2.0 * a).cos();
        [r * (3.0 * a).cos(), r * (3.0 * a).sin(), (4.0 * a).sin()]
    };
    tube.sweep(curve, |_, angle| circle(0.42, angle)).fitted()
}

/// Three rings, no two of which hold each other, while all three do.
pub(super) fn borromean() -> Mesh {
    let mut rings = Mesh::default();
    for axis in 0..3 {
        let tube = Tube {
            along: 160,
            around: 28,
            closed: true,
        };
        let curve = |t: f64| {
            let (sin, cos) = (TAU * t).sin_cos();
            let mut point = [0.0; 3];
            point[axis] = 1.5 * cos;
            point[(axis + 1) % 3] = 0.85 * sin;
            point
        };
        rings.append(tube.sweep(curve, |_, angle| circle(0.2, angle)));
    }
    rings.fitted()
}

/// A strip with three half turns, thick and with round edges: it has one side.
pub(super) fn mobius() -> Mesh {
    let tube = Tube {
        along: 340,
        around: 44,
        closed: true,
    };
    let curve = |t: f64| {
        let (sin, cos) = (TAU * t).sin_cos();
        [sin, cos, 0.0]
    };
    tube.sweep(curve, |t, angle| {
        superellipse([0.42, 0.075], 3.5, 3.0 * PI * t, angle)
    })
    .fitted()
}

/// A coil of wire.
pub(super) fn spring() -> Mesh {
    let tube = Tube {
        along: 600,
        around: 22,
        closed: false,
    };
    let curve = |t: f64| {
        let (sin, cos) = (6.5 * TAU * t).sin_cos();
        // The end turns lie flat.
        let height = 2.2 * mix(t, smoothstep(0.0, 1.0, t), 0.9);
        [0.62 * cos, height, 0.62 * sin]
    };
    tube.sweep(curve, |t, angle| circle(0.12 * round_ends(0.006, t), angle))
        .fitted()
}

/// A slender leaf of metal, bent a little, as a bird that rises.
pub(super) fn bird() -> Mesh {
    let tube = Tube {
        along: 200,
        around: 56,
        closed: false,
    };
    let curve = |t: f64| [0.16 * (2.6 * t - 0.4).sin(), 2.6 * t, 0.0];
    let outline = [
        [0.0; 3],
        [0.17, 0.0, 0.0],
        [0.125, 0.0, 0.0],
        [0.075, 0.0, 0.0],
        [0.1, 0.0, 0.0],
        [0.17, 0.0, 0.0],
        [0.225, 0.0, 0.0],
        [0.235, 0.0, 0.0],
        [0.2, 0.0, 0.0],
        [0.13, 0.0, 0.0],
        [0.0; 3],
    ];
    let section = |t: f64, angle: f64| {
        let width = spline(&outline, t)[0].max(0.0);
        superellipse([width, width * mix(1.0, 0.72, t)], 2.0, 0.0, angle)
    };
    tube.sweep(curve, section).fitted()
}

/// A serpent that lies in coils and lifts its head; its scales are of the mesh.
pub(super) fn serpent() -> Mesh {
    const TURNS: usize = 3;
    let mut path: Vec<Vec3> = (0..=TURNS * 12)
        .map(|i| {
            let t = i as f64 / (TURNS * 12) as f64;
            let (sin, cos) = (TAU * TURNS as f64 * t).sin_cos();
            let radius = mix(1.15, 0.62, t);
            [
                radius * cos,
                mix(0.12, 0.92, t) - 0.1 * (1.0 - smoothstep(0.0, 0.5, t)),
                radius * sin,
            ]
        })
        .collect();
    path.extend([
        [0.46, 1.05, 0.3],
        [0.2, 1.26, 0.34],
        [-0.02, 1.55, 0.2],
        [-0.06, 1.88, 0.02],
        [0.02, 2.16, 0.0],
        [0.24, 2.34, 0.12],
        [0.58, 2.31, 0.29],
        [0.94, 2.16, 0.45],
    ]);
    let body = |t: f64| {
        let tail = smoothstep(-0.02, 0.34, t);
        let neck = mix(1.0, 0.62, smoothstep(0.72, 0.9, t));
        let head = 1.0 + 0.65 * smoothstep(0.92, 0.958, t) * (1.0 - smoothstep(0.958, 1.0, t));
        let ends = round_ends(0.02, t).min(1.0);
        0.25 * tail * neck * head * ends
    };
    let section = |t: f64, angle: f64| {
        let (across, along) = (7.0 * angle, 105.0 * PI * t);
        let scale = ((across + along).cos() * (across - along).cos())
            .abs()
            .sqrt();
        let smooth = 1.0 - smoothstep(0.93, 0.96, t);
        circle(body(t) * (1.0 + 0.13 * smooth * (scale - 0.5)), angle)
    };
    let tube = Tube {
        along: 700,
        around: 54,
        closed: false,
    };
    let mut serpent = tube.sweep(|t| spline(&path, t), section);
    for side in [-1.0, 1.0] {
        let eye = [0.55 - 0.075 * side, 2.4, 0.275 + 0.155 * side];
        serpent.append(Mesh::ball(10, |d| add(eye, mul(d, 0.05))).outwards());
    }
    serpent.fitted()
}

/// A shell that grows as it winds: the tube's middle and half-axes go with `size`.
struct Shell {
    turns: f64,
    growth: f64,
    /// Half-axes of the tube in the winding plane and across, for a size of 1.
    tube: [f64; 2],
    /// How far it climbs along its axis, for a size of 1.
    climb: f64,
}

impl Shell {
    /// The surface, out on the outside and back on the inside, whose wall is a tenth of the tube.
    fn mesh(&self, along: usize, ornament: impl Fn(f64, f64) -> f64) -> Mesh {
        let surface = |u: f64, v: f64| {
            let out = (u / 0.86).min(1.0);
            let back = ((u - 0.86) / 0.14).max(0.0);
            let turn = self.turns * out - 0.55 * back.powf(1.5);
            let size = (self.growth * (turn - self.turns)).exp();
            let thin = 1.0 - 0.1 * smoothstep(0.0, 0.1, back);
            let ends = (1.0 - (1.0 - (u / 0.01).min(1.0)).powi(2)).sqrt()
                * (1.0 - smoothstep(0.6, 1.0, back));
            let (sin, cos) = (TAU * v).sin_cos();
            // The lip is plain, and so is the inside.
            let carve = 1.0 + ornament(turn, TAU * v) * (1.0 - smoothstep(0.96, 0.995, out));
            let [a, b] = self.tube.map(|x| x * thin * ends * carve);
            let far = size * (1.0 + a * cos);
            let (y, x) = (TAU * turn).sin_cos();
            [far * x, far * y, size * (b * sin - self.climb)]
        };
        Mesh::grid(along, 52, surface).outwards()
    }
}

/// A ribbed shell in one plane.
pub(super) fn ammonite() -> Mesh {
    let shell = Shell {
        turns: 4.2,
        growth: 0.62,
        tube: [0.32, 0.27],
        climb: 0.0,
    };
    let ribs = |turn: f64, angle: f64| {
        let lean = turn + 0.012 * angle.cos();
        0.055 * (26.0 * TAU * lean).sin() * (0.6 + 0.4 * angle.cos())
    };
    shell.mesh(360, ribs).fitted()
}

/// A whelk: a shell with knobs on its shoulder, standing on its mouth.
pub(super) fn conch() -> Mesh {
    let shell = Shell {
        turns: 5.6,
        growth: 0.5,
        tube: [0.92, 1.35],
        climb: 2.9,
    };
    let knobs = |turn: f64, angle: f64| {
        let shoulder = (1.0 - (angle - 0.9).abs() / 0.5).max(0.0);
        let around = (0.5 + 0.5 * (9.0 * TAU * turn).cos()).powi(3);
        0.3 * shoulder * shoulder * around + 0.012 * (14.0 * angle).cos()
    };
    let upright = |[x, y, z]: Vec3| [x, z, -y];
    shell.mesh(360, knobs).moved(upright).fitted()
}
