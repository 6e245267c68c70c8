//! Tori, balls and panels that a formula bends.

use std::f64::consts::{PI, TAU};

use super::mesh::Mesh;
use super::vector::{Vec3, add, cross, length, mul, signed_power, smoothstep, sub, unit};

/// A torus, lying.
pub(super) fn torus() -> Mesh {
    let surface = |u: f64, v: f64| {
        let ((sin, cos), (up, out)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let far = 1.0 + 0.42 * out;
        [far * cos, 0.42 * up, far * sin]
    };
    Mesh::grid(176, 88, surface).outwards().fitted()
}

/// A torus with a star as its section, which winds.
pub(super) fn supertorus() -> Mesh {
    let surface = |u: f64, v: f64| {
        let ((sin, cos), angle) = ((TAU * u).sin_cos(), TAU * v);
        let lobes = 1.0 + 0.26 * (5.0 * angle + 4.0 * TAU * u).cos();
        let (y, x) = (angle.sin() * 0.46 * lobes, angle.cos() * 0.46 * lobes);
        [(1.0 + x) * cos, (1.0 + x) * sin, y]
    };
    Mesh::grid(256, 64, surface).outwards().fitted()
}

/// A ball drawn out into six points.
pub(super) fn star() -> Mesh {
    let pointed = |d: Vec3| {
        let p = d.map(|x| signed_power(x, 2.6));
        // A point up, and the others turned a little out of the room's directions.
        let (sin, cos) = 0.5_f64.sin_cos();
        [p[0] * cos - p[2] * sin, p[1], p[0] * sin + p[2] * cos]
    };
    Mesh::ball(44, pointed).outwards().fitted()
}

/// A ball with petals.
pub(super) fn blossom() -> Mesh {
    let petals = |d: Vec3| {
        let angle = d[2].atan2(d[0]);
        let flat = (1.0 - d[1] * d[1]).max(0.0);
        let waves = (5.0 * angle + 2.4 * d[1]).cos() * flat.powf(1.5);
        mul(d, 1.0 + 0.42 * waves + 0.22 * (3.0 * PI * d[1]).cos())
    };
    Mesh::ball(48, petals).outwards().fitted()
}

/// A brain coral: a ball with furrows.
pub(super) fn coral() -> Mesh {
    let furrows = |d: Vec3| {
        let [x, y, z] = add(
            d,
            [
                0.18 * (5.0 * d[1] + 1.0).sin(),
                0.18 * (6.0 * d[2]).sin(),
                0.18 * (5.5 * d[0] + 2.0).sin(),
            ],
        )
        .map(|x| 9.5 * x);
        let gyroid = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        let ridge = (1.4 * gyroid).tanh();
        mul(
            d,
            1.0 + 0.065 * ridge + 0.05 * (2.0 * d[0] + 3.0 * d[1]).sin(),
        )
    };
    Mesh::ball(52, furrows).outwards().fitted()
}

/// A wheel with slanting teeth, standing; it has edges.
pub(super) fn gear() -> Mesh {
    const TEETH: f64 = 28.0;
    let tooth = |angle: f64, y: f64| {
        let wave = (TEETH * (angle + 0.32 * y)).cos();
        1.0 + 0.075 * (2.6 * wave).clamp(-1.0, 1.0)
    };
    // Radius and height; radii above 0.9 are those of the teeth.
    let mut outline: Vec<[f64; 2]> = vec![
        [0.2, -0.2],
        [0.22, -0.22],
        [0.36, -0.22],
        [0.38, -0.2],
        [0.4, -0.09],
        [0.76, -0.09],
        [0.78, -0.18],
        [0.96, -0.18],
    ];
    outline.extend((0..=6).map(|i| [1.0, -0.16 + 0.32 * f64::from(i) / 6.0]));
    outline.extend([
        [0.96, 0.18],
        [0.78, 0.18],
        [0.76, 0.09],
        [0.4, 0.09],
        [0.38, 0.2],
        [0.36, 0.22],
        [0.22, 0.22],
        [0.2, 0.2],
        [0.2, -0.2],
    ]);
    let steps = 28 * 16;
    let rows = (0..=steps).map(|i| {
        let angle = TAU * f64::from(i) / f64::from(steps);
        let point = |&[r, y]: &[f64; 2]| {
            let r = if r > 0.9 { r * tooth(angle, y) } else { r };
            [r * angle.cos(), r * angle.sin(), y]
        };
        outline.iter().map(point).collect()
    });
    Mesh::rows(&rows.collect::<Vec<_>>()).outwards().fitted()
}

/// A bottle without an inside, its wall made thick: the surface is gone around twice, off it by half of
/// the thickness, which makes a closed surface with an inside.
pub(super) fn klein_bottle() -> Mesh {
    let bottle = |u: f64, v: f64| {
        let ((s, c), (sv, cv)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let x =
            3.0 * cv - 30.0 * s + 90.0 * c.powi(4) * s - 60.0 * c.powi(6) * s + 5.0 * c * cv * s;
        let y = 3.0 * cv - 3.0 * c * c * cv - 48.0 * c.powi(4) * cv + 48.0 * c.powi(6) * cv
            - 60.0 * s
            + 5.0 * c * cv * s
            - 5.0 * c.powi(3) * cv * s
            - 80.0 * c.powi(5) * cv * s
            + 80.0 * c.powi(7) * cv * s;
        [
            -2.0 / 15.0 * c * x,
            -1.0 / 15.0 * s * y,
            2.0 / 15.0 * (3.0 + 5.0 * c * s) * sv,
        ]
    };
    let surface = |u: f64, v: f64| {
        let step = 1e-5;
        let du = sub(bottle(u + step, v), bottle(u - step, v));
        let dv = sub(bottle(u, v + step), bottle(u, v - step));
        add(bottle(u, v), mul(unit(cross(du, dv)), 0.045))
    };
    Mesh::grid(280, 52, surface).outwards().fitted()
}

/// A square panel in the plane z = 0 with a height over it, which falls to 0 at the edge.
fn panel(cells: usize, height: impl Fn(f64, f64) -> f64) -> Mesh {
    let surface = |u: f64, v: f64| {
        let inside = u.min(1.0 - u).min(v.min(1.0 - v));
        let edge = smoothstep(0.0, 0.012, inside);
        [
            u - 0.5,
            v - 0.5,
            edge * (0.02 + height(2.0 * u - 1.0, 2.0 * v - 1.0)),
        ]
    };
    Mesh::grid(cells, cells, surface)
}

/// A relief: rings of waves from three stones.
pub(super) fn relief_ripples() -> Mesh {
    panel(110, |x, y| {
        let stones = [[-0.4, 0.35], [0.5, 0.1], [-0.1, -0.6]];
        let waves = stones.map(|[a, b]| {
            let far = length([x - a, y - b, 0.0]);
            (24.0 * far).cos() / (1.0 + 3.0 * far)
        });
        0.03 + 0.022 * waves.iter().sum::<f64>()
    })
}

/// A relief: the head of a sunflower.
pub(super) fn relief_sunflower() -> Mesh {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let seeds: Vec<[f64; 2]> = (0..240)
        .map(|i| {
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            let far = 0.88 * (f64::from(i) / 240.0).sqrt();
            [far * cos, far * sin]
        })
        .collect();
    panel(120, move |x, y| {
        let far = length([x, y, 0.0]);
        let size = 0.054 * (0.75 + 0.45 * far);
        let seed = |[a, b]: &[f64; 2]| {
            let d = length([x - a, y - b, 0.0]) / size;
            (1.0 - d * d).max(0.0).sqrt() * size
        };
        let dish = 0.05 * smoothstep(1.0, 0.2, far);
        dish + 0.75 * seeds.iter().map(seed).fold(0.0, f64::max)
    })
}

/// A relief: ribbons over and under each other.
pub(super) fn relief_weave() -> Mesh {
    panel(120, |x, y| {
        let ribbon = |across: f64, along: f64| {
            let (at, along) = (4.0 * across, 4.0 * along);
            let place = at - at.floor() - 0.5;
            let over = if at.floor().rem_euclid(2.0) < 1.0 {
                1.0
            } else {
                -1.0
            };
            let round = (1.0 - (place / 0.44).powi(4)).max(0.0).sqrt();
            if round > 0.0 {
                0.03 * round - 0.022 * over * (PI * along).cos()
            } else {
                -0.02
            }
        };
        0.02 + ribbon(x, y).max(ribbon(y, x + 0.25))
    })
}

/// A round mirror, facing +y, hollow and with a few waves; the scenes scale its height.
pub(super) fn rippled_mirror() -> Mesh {
    let surface = |u: f64, v: f64| {
        let (sin, cos) = (TAU * u).sin_cos();
        let [x, z] = [v * cos, v * sin];
        let waves = (4.1 * x + 1.7 * z + 0.4).sin() + (3.2 * z - 2.3 * x + 1.1).sin();
        [x, 0.12 * v * v + 0.035 * waves, z]
    };
    Mesh::grid(144, 48, surface)
}

/// A cushion, as high as wide: scenes flatten it.
pub(super) fn cushion() -> Mesh {
    let surface = |d: Vec3| {
        let sum: f64 = d.iter().map(|x| x.abs().powi(5)).sum();
        let [x, y, z] = mul(d, sum.powf(-0.2));
        let seam = 1.0 - 0.22 * (x.powi(4) + z.powi(4)) / 2.0;
        let folds = 1.0 + 0.012 * ((5.0 * x + 2.0 * z).sin() + (4.0 * z - 3.0 * x).sin());
        [x, y * seam * folds, z]
    };
    Mesh::ball(28, surface).outwards().fitted()
}
