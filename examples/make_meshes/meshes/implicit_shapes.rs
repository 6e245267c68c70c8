//! Figures, cages and minimal surfaces.

use super::implicit::{Region, carve, ellipsoid, join, rod};
use super::mesh::Mesh;
use super::vector::{Vec3, length, smoothstep, sub};

/// The head of a woman with her hair tied up, on a small foot.
pub(super) fn bust() -> Mesh {
    let region = Region {
        low: [-0.42, 0.72, -0.36],
        high: [0.42, 1.86, 0.3],
        cells: 128,
    };
    region.surface(|p| join(head(p), torso(p), 0.03)).fitted()
}

fn head([x, y, z]: Vec3) -> f64 {
    // Left and right are alike.
    let p = [x.abs(), y, z];
    let mut d = ellipsoid(p, [0.0, 1.62, -0.03], [0.13, 0.15, 0.165]);
    d = join(
        d,
        ellipsoid(p, [0.0, 1.53, 0.045], [0.1, 0.145, 0.105]),
        0.06,
    );
    d = join(
        d,
        rod(p, [0.0, 1.425, 0.095], [0.02, 1.425, 0.09], [0.036, 0.03]),
        0.05,
    );
    d = join(
        d,
        rod(p, [0.0, 1.607, 0.122], [0.065, 1.6, 0.1], [0.024, 0.018]),
        0.03,
    );
    d = carve(
        d,
        ellipsoid(p, [0.048, 1.575, 0.155], [0.036, 0.022, 0.03]),
        0.025,
    );
    d = join(
        d,
        ellipsoid(p, [0.046, 1.573, 0.108], [0.028, 0.021, 0.028]),
        0.008,
    );
    d = join(
        d,
        ellipsoid(p, [0.066, 1.52, 0.092], [0.032, 0.03, 0.03]),
        0.05,
    );
    d = join(
        d,
        rod(p, [0.0, 1.6, 0.132], [0.0, 1.53, 0.172], [0.013, 0.017]),
        0.022,
    );
    d = join(
        d,
        ellipsoid(p, [0.016, 1.522, 0.152], [0.013, 0.011, 0.015]),
        0.012,
    );
    d = join(
        d,
        ellipsoid(p, [0.008, 1.481, 0.146], [0.03, 0.009, 0.015]),
        0.01,
    );
    d = join(
        d,
        ellipsoid(p, [0.0, 1.465, 0.143], [0.026, 0.011, 0.016]),
        0.008,
    );
    d = join(
        d,
        ellipsoid(p, [0.128, 1.555, -0.02], [0.014, 0.04, 0.026]),
        0.015,
    );
    join(d, hair(p), 0.008)
}

fn hair(p: Vec3) -> f64 {
    let strands = 0.0045 * (95.0 * p[0] + 30.0 * p[1] - 25.0 * p[2]).sin();
    let cap = ellipsoid(p, [0.0, 1.64, -0.045], [0.15, 0.158, 0.178]) - strands;
    // Off the face, with a line that rises towards the middle.
    let line = p[2] - 0.062 + 0.5 * (p[1] - 1.64) - 0.25 * p[0];
    let cap = cap.max(0.8 * line);
    let low = 1.52 + 0.12 * smoothstep(-0.1, 0.06, p[2]) - p[1];
    let cap = cap.max(0.8 * low);
    let turns = 0.006 * (60.0 * (p[1] - 1.69) + 25.0 * p[0]).sin();
    let bun = ellipsoid(p, [0.0, 1.7, -0.225], [0.085, 0.08, 0.072]) - turns;
    join(cap, bun, 0.02)
}

fn torso(p: Vec3) -> f64 {
    let q = [p[0].abs(), p[1], p[2]];
    let neck = rod(q, [0.0, 1.46, -0.035], [0.0, 1.2, -0.06], [0.062, 0.075]);
    let shoulders = rod(q, [0.0, 1.17, -0.06], [0.25, 1.11, -0.065], [0.085, 0.09]);
    let chest = ellipsoid(q, [0.0, 1.05, -0.03], [0.24, 0.2, 0.13]);
    let breast = ellipsoid(q, [0.1, 1.01, 0.06], [0.085, 0.085, 0.075]);
    let body = join(join(neck, shoulders, 0.09), join(chest, breast, 0.05), 0.08);
    // Cut off in a bow, as sculptors do.
    let bow = ellipsoid(q, [0.0, 1.3, -0.03], [0.33, 0.42, 0.3]);
    let body = carve(body, -bow, 0.02);
    let stem = rod(q, [0.0, 0.93, -0.03], [0.0, 0.8, -0.03], [0.06, 0.07]);
    let foot = length([q[0], 0.0, q[2] + 0.03]) - 0.15;
    let foot = carve(foot, 0.045 - (q[1] - 0.79).abs(), 0.012);
    join(join(body, stem, 0.06), foot, 0.03)
}

/// A figure that lies on its elbow, much simplified, with a hole through the body.
pub(super) fn reclining() -> Mesh {
    let region = Region {
        low: [-1.2, -0.08, -0.5],
        high: [1.3, 1.15, 0.5],
        cells: 110,
    };
    let figure = |p: Vec3| {
        let mut d = ellipsoid(p, [-0.62, 0.93, 0.0], [0.12, 0.15, 0.13]);
        d = join(
            d,
            rod(p, [-0.6, 0.84, 0.0], [-0.5, 0.66, 0.0], [0.07, 0.1]),
            0.08,
        );
        d = join(d, ellipsoid(p, [-0.42, 0.5, 0.0], [0.24, 0.27, 0.3]), 0.12);
        for side in [-1.0, 1.0] {
            let shoulder = [-0.5, 0.6, 0.27 * side];
            let elbow = [-0.85, 0.1, 0.3 * side];
            d = join(d, rod(p, shoulder, elbow, [0.12, 0.09]), 0.1);
            d = join(
                d,
                rod(p, elbow, [-0.45, 0.06, 0.26 * side], [0.09, 0.07]),
                0.1,
            );
            let knee = [0.6, 0.62 + 0.12 * side, 0.17 * side];
            d = join(
                d,
                rod(p, [0.12, 0.2, 0.14 * side], knee, [0.19, 0.13]),
                0.16,
            );
            d = join(
                d,
                rod(p, knee, [1.05, 0.07, 0.18 * side], [0.13, 0.08]),
                0.1,
            );
        }
        d = join(
            d,
            rod(p, [-0.4, 0.42, 0.0], [0.15, 0.2, 0.0], [0.2, 0.2]),
            0.14,
        );
        let hole = rod(p, [-0.4, 0.42, -0.6], [-0.4, 0.42, 0.6], [0.1, 0.1]);
        d = carve(d, hole, 0.12);
        carve(d, p[1], 0.02)
    };
    region.surface(figure).fitted()
}

/// A mother and a child, two bodies that grow out of one.
pub(super) fn standing() -> Mesh {
    let region = Region {
        low: [-0.6, -0.08, -0.5],
        high: [0.6, 2.1, 0.55],
        cells: 116,
    };
    let figure = |p: Vec3| {
        let mut d = rod(p, [0.0, 0.0, 0.0], [0.0, 0.7, 0.0], [0.36, 0.27]);
        d = join(
            d,
            rod(p, [0.0, 0.7, 0.0], [-0.04, 1.3, -0.03], [0.25, 0.24]),
            0.2,
        );
        d = join(
            d,
            rod(p, [-0.28, 1.36, -0.02], [0.22, 1.4, -0.04], [0.13, 0.13]),
            0.14,
        );
        d = join(
            d,
            rod(p, [-0.04, 1.4, -0.03], [-0.02, 1.68, 0.0], [0.09, 0.08]),
            0.1,
        );
        d = join(
            d,
            ellipsoid(p, [-0.01, 1.83, 0.03], [0.13, 0.18, 0.155]),
            0.07,
        );
        d = join(
            d,
            rod(p, [-0.3, 1.34, 0.0], [-0.36, 0.98, 0.14], [0.12, 0.09]),
            0.1,
        );
        d = join(
            d,
            rod(p, [-0.36, 0.98, 0.14], [0.1, 0.9, 0.3], [0.09, 0.07]),
            0.08,
        );
        d = join(
            d,
            rod(p, [0.26, 1.36, -0.02], [0.38, 1.02, 0.12], [0.11, 0.08]),
            0.1,
        );
        d = join(
            d,
            rod(p, [0.38, 1.02, 0.12], [0.16, 0.86, 0.3], [0.08, 0.06]),
            0.08,
        );
        // The child in her arms.
        d = join(
            d,
            ellipsoid(p, [0.06, 1.08, 0.26], [0.19, 0.14, 0.14]),
            0.05,
        );
        d = join(d, ellipsoid(p, [-0.1, 1.27, 0.28], [0.1, 0.11, 0.1]), 0.05);
        let folds = 0.014 * (14.0 * p[2].atan2(p[0]) + 2.0 * p[1]).sin();
        d -= folds * smoothstep(0.85, 0.3, p[1]);
        carve(d, p[1], 0.02)
    };
    region.surface(figure).fitted()
}

/// A cage: the edges of a ball of pentagons and hexagons, without its faces.
pub(super) fn buckyball() -> Mesh {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut corners: Vec<Vec3> = Vec::new();
    for [a, b, c] in [
        [0.0, 1.0, 3.0 * golden],
        [1.0, 2.0 + golden, 2.0 * golden],
        [golden, 2.0, 2.0 * golden + 1.0],
    ] {
        for signs in 0..8 {
            let sign = |bit: usize| if (signs >> bit) & 1 == 0 { 1.0 } else { -1.0 };
            let p = [a * sign(0), b * sign(1), c * sign(2)];
            for turn in 0..3 {
                let q: Vec3 = std::array::from_fn(|i| p[(i + turn) % 3]);
                if corners.iter().all(|r| length(sub(*r, q)) > 0.1) {
                    corners.push(q);
                }
            }
        }
    }
    let mut edges = Vec::new();
    for (i, a) in corners.iter().enumerate() {
        for b in &corners[i + 1..] {
            if length(sub(*a, *b)) < 2.1 {
                edges.push([*a, *b]);
            }
        }
    }
    let side = 5.6;
    let region = Region {
        low: [-side; 3],
        high: [side; 3],
        cells: 76,
    };
    let cage = |p: Vec3| {
        // Nothing is near the middle.
        if length(p) < 3.6 {
            return 1.0;
        }
        let near = |[a, b]: &[Vec3; 2]| rod(p, *a, *b, [0.36, 0.36]);
        edges
            .iter()
            .map(near)
            .fold(f64::MAX, |d, e| join(d, e, 0.3))
    };
    region.surface(cage).fitted()
}

/// A ball of the gyroid, the minimal surface that leaves two mazes.
pub(super) fn gyroid() -> Mesh {
    let region = Region {
        low: [-1.08; 3],
        high: [1.08; 3],
        cells: 60,
    };
    let maze = |p: Vec3| {
        let [x, y, z] = p.map(|x| 5.2 * x + 0.4);
        let g = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        let wall = (g * g + 0.01).sqrt() / 5.2 / 1.4 - 0.085;
        -join(-wall, 1.0 - length(p), 0.05)
    };
    region.surface(maze).fitted()
}

/// A ring of saddles: Scherk's tower of holes, bent to a circle and turned by half.
pub(super) fn saddle_ring() -> Mesh {
    let region = Region {
        low: [-1.75, -1.75, -0.75],
        high: [1.75, 1.75, 0.75],
        cells: 84,
    };
    let ring = |[x, y, z]: Vec3| {
        let angle = y.atan2(x);
        let out = length([x, y, 0.0]) - 1.05;
        let (sin, cos) = (0.5 * angle).sin_cos();
        let [a, b] = [out * cos - z * sin, out * sin + z * cos];
        let [p, q] = [a, b].map(|x| 4.6 * x);
        let saddle = p.sinh() * q.sinh() - (6.0 * angle).sin();
        let slope = (p.cosh() * q.sinh()).powi(2) + (p.sinh() * q.cosh()).powi(2);
        let slope = 4.6 * (slope + (6.0 * angle).cos().powi(2)).sqrt();
        let wall = (saddle * saddle + 1e-3).sqrt() / slope.max(0.3) - 0.045;
        -join(-wall, 0.62 - length([a, b, 0.0]), 0.04)
    };
    region.surface(ring).fitted()
}
