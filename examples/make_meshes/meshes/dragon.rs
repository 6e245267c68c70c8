//! A dragon that spreads its wings: one level set, of a body along a spine and of limbs that grow out of it.

use std::f64::consts::{PI, TAU};

use super::implicit::{Region, Sheet, carve, coarse_first, ellipsoid, join, rod, within};
use super::mesh::Mesh;
use super::tubes::spline;
use super::vector::{Vec3, add, cross, dot, length, mul, smoothstep, sub, unit};

/// From the tip of the tail to the head: points of the spine, and how thick the body is there.
const SPINE: [(Vec3, f64); 17] = [
    ([0.42, 0.05, 1.02], 0.012),
    ([0.08, 0.045, 1.1], 0.03),
    ([-0.36, 0.06, 1.0], 0.045),
    ([-0.82, 0.075, 0.74], 0.063),
    ([-1.16, 0.1, 0.42], 0.085),
    ([-1.26, 0.17, 0.1], 0.11),
    ([-1.08, 0.31, -0.08], 0.15),
    ([-0.78, 0.48, -0.08], 0.2),
    ([-0.44, 0.61, -0.02], 0.255),
    ([-0.1, 0.68, 0.0], 0.265),
    ([0.23, 0.78, 0.0], 0.285),
    ([0.5, 0.99, 0.0], 0.22),
    ([0.6, 1.24, -0.02], 0.16),
    ([0.55, 1.49, 0.0], 0.13),
    ([0.56, 1.71, 0.06], 0.115),
    ([0.69, 1.85, 0.15], 0.11),
    ([0.86, 1.87, 0.24], 0.09),
];

/// A wing, on the side of positive z: shoulder, elbow, wrist, the tips of its fingers, and where it
/// meets the flank.
const SHOULDER: Vec3 = [0.2, 0.98, 0.14];
const ELBOW: Vec3 = [-0.08, 1.4, 0.42];
const WRIST: Vec3 = [0.1, 1.86, 0.7];
const TIPS: [Vec3; 4] = [
    [-0.42, 2.36, 1.32],
    [-0.98, 1.94, 1.5],
    [-1.2, 1.36, 1.3],
    [-1.02, 0.92, 0.82],
];
const FLANK: Vec3 = [-0.46, 0.8, 0.16];

pub(super) fn dragon() -> Mesh {
    let region = Region {
        low: [-1.38, -0.06, -1.66],
        high: [1.4, 2.48, 1.66],
        cells: 170,
    };
    let body = Body::new();
    let whole = |p: Vec3| {
        let q = [p[0], p[1], p[2].abs()];
        let legs = within(p, [-0.02, 0.42, 0.0], 0.95, legs);
        let wing = within(q, [-0.5, 1.58, 0.82], 1.2, wing);
        let head = within(p, [0.92, 1.88, 0.28], 0.66, head);
        let trunk = join(body.distance(p), join(legs, wing, 0.05), 0.07);
        let dragon = join(trunk, head, 0.05).min(body.crest(p));
        // It stands on the floor.
        carve(dragon, p[1], 0.01)
    };
    region.surface(coarse_first(&region, 3, whole)).fitted()
}

/// A place on the spine.
struct Vertebra {
    t: f64,
    point: Vec3,
    /// Across the spine, towards the back.
    back: Vec3,
    radius: f64,
}

/// The body from tail to neck, with scales and a crest.
struct Body {
    points: Vec<Vec3>,
    radii: Vec<Vec3>,
    vertebrae: Vec<Vertebra>,
    spikes: Vec<[Vec3; 2]>,
}

impl Body {
    fn new() -> Self {
        const COUNT: usize = 160;
        let mut body = Self {
            points: SPINE.iter().map(|(p, _)| *p).collect(),
            radii: SPINE.iter().map(|(_, r)| [*r, 0.0, 0.0]).collect(),
            vertebrae: Vec::new(),
            spikes: Vec::new(),
        };
        body.vertebrae = (0..=COUNT)
            .map(|i| body.vertebra(i as f64 / COUNT as f64))
            .collect();
        body.spikes = (4..47).map(|i| body.spike(f64::from(i) / 49.0)).collect();
        body
    }

    fn vertebra(&self, t: f64) -> Vertebra {
        const STEP: f64 = 1e-4;
        let point = spline(&self.points, t);
        let along = unit(sub(
            spline(&self.points, t + STEP),
            spline(&self.points, t - STEP),
        ));
        // Up on the trunk, backwards on the neck.
        let towards = [-0.5, 1.0, 0.0];
        let back = unit(sub(towards, mul(along, dot(towards, along))));
        let radius = spline(&self.radii, t)[0];
        Vertebra {
            t,
            point,
            back,
            radius,
        }
    }

    /// The vertebra next to a point.
    fn nearest(&self, p: Vec3) -> Vertebra {
        const STEP: f64 = 1e-3;
        let far = |v: &&Vertebra| length(sub(p, v.point)) - v.radius;
        let start = self
            .vertebrae
            .iter()
            .min_by(|a, b| far(a).total_cmp(&far(b)));
        let mut t = start.map_or(0.0, |v| v.t);
        for _ in 0..3 {
            let square = |t: f64| {
                let to = sub(p, spline(&self.points, t));
                dot(to, to)
            };
            let [before, here, after] = [t - STEP, t, t + STEP].map(square);
            let curve = before - 2.0 * here + after;
            if curve > 0.0 {
                let step = 0.5 * STEP * (before - after) / curve;
                t = (t + step.clamp(-0.01, 0.01)).clamp(0.0, 1.0);
            }
        }
        self.vertebra(t)
    }

    fn distance(&self, p: Vec3) -> f64 {
        let Vertebra {
            t,
            point,
            back,
            radius,
        } = self.nearest(p);
        let to = sub(p, point);
        let side = length(sub(to, mul(back, dot(to, back))));
        let angle = side.atan2(dot(to, back));
        // Scales on the back and the sides, plates across the belly; they end before the head.
        let (across, along) = (5.0 * angle, 48.0 * TAU * t);
        let scale = ((across + along / 2.0).cos() * (across - along / 2.0).cos()).abs();
        let plate = (0.75 * along).cos().abs();
        let belly = smoothstep(2.2, 2.5, angle);
        let relief = (1.0 - belly) * (scale + 0.02).sqrt() + belly * (plate + 0.05).sqrt();
        let plain = smoothstep(0.97, 0.93, t) * smoothstep(0.0, 0.12, t);
        length(to) - radius * (1.0 + 0.075 * plain * (relief - 0.5))
    }

    /// A thorn of the crest.
    fn spike(&self, t: f64) -> [Vec3; 2] {
        let here = self.vertebra(t);
        let behind = self.vertebra(t - 0.012);
        let high = 0.03 + 0.36 * here.radius.min(0.19) + 0.05 * (PI * t).sin();
        let foot = add(here.point, mul(here.back, 0.86 * here.radius));
        let lean = unit(sub(behind.point, here.point));
        let tip = add(
            add(here.point, mul(here.back, here.radius + high)),
            mul(lean, 0.75 * high),
        );
        [foot, tip]
    }

    fn crest(&self, p: Vec3) -> f64 {
        let thorn = |[foot, tip]: &[Vec3; 2]| {
            let wide = 0.3 * length(sub(*tip, *foot));
            rod(p, *foot, *tip, [wide, 0.008])
        };
        self.spikes.iter().map(thorn).fold(f64::MAX, f64::min)
    }
}

/// A chain of rods; each is a point, and how thick the limb is there.
fn limb(p: Vec3, joints: &[(Vec3, f64)], k: f64) -> f64 {
    let bones = joints.windows(2).map(|pair| {
        let [(a, r), (b, s)] = [pair[0], pair[1]];
        rod(p, a, b, [r, s])
    });
    bones.fold(f64::MAX, |d, bone| {
        if d == f64::MAX {
            bone
        } else {
            join(d, bone, k)
        }
    })
}

fn legs(p: Vec3) -> f64 {
    let side = p[2].signum();
    let q = [p[0], p[1], p[2].abs()];
    // One forefoot stands before the other.
    let step = 0.09 * side;
    let fore = [
        ([0.3, 0.72, 0.16], 0.17),
        ([0.17, 0.42, 0.33], 0.105),
        ([0.34 + step, 0.14, 0.35], 0.066),
        ([0.44 + step, 0.055, 0.36], 0.068),
    ];
    let hind = [
        ([-0.46, 0.56, 0.14], 0.24),
        ([-0.2, 0.38, 0.38], 0.14),
        ([-0.52, 0.17, 0.4], 0.074),
        ([-0.36, 0.055, 0.41], 0.072),
    ];
    let mut d = join(limb(q, &fore, 0.09), limb(q, &hind, 0.09), 0.02);
    for foot in [fore[3].0, hind[3].0] {
        for spread in [-0.45, 0.0, 0.45] {
            let ahead = |far: f64, y: f64| [foot[0] + far, y, foot[2] + spread * far];
            let toe = [
                (foot, 0.055),
                (ahead(0.12, 0.06), 0.04),
                (ahead(0.19, 0.035), 0.036),
            ];
            d = join(d, limb(q, &toe, 0.02), 0.03);
            let claw = [(ahead(0.2, 0.045), 0.024), (ahead(0.3, 0.008), 0.006)];
            d = d.min(limb(q, &claw, 0.01));
        }
    }
    d
}

fn wing(p: Vec3) -> f64 {
    let arm = [(SHOULDER, 0.1), (ELBOW, 0.056), (WRIST, 0.045)];
    let mut d = limb(p, &arm, 0.05);
    let thumb = add(WRIST, [0.13, 0.12, 0.02]);
    d = join(d, rod(p, WRIST, thumb, [0.035, 0.007]), 0.03);
    for tip in TIPS {
        // Fingers bend down a little towards their tips.
        let knuckle = add(mul(add(WRIST, tip), 0.5), [0.03, 0.07, 0.05]);
        let finger = [(WRIST, 0.036), (knuckle, 0.026), (tip, 0.011)];
        d = join(d, limb(p, &finger, 0.03), 0.02);
    }
    let sheet = |a, b, c, scallop| {
        let sheet = Sheet {
            corners: [a, b, c],
            thick: 0.018,
            bulge: -0.025,
            scallop,
        };
        sheet.distance(p)
    };
    for pair in TIPS.windows(2) {
        d = join(d, sheet(WRIST, pair[0], pair[1], 0.3), 0.015);
    }
    d = join(d, sheet(WRIST, TIPS[3], ELBOW, 0.0), 0.015);
    d = join(d, sheet(ELBOW, TIPS[3], FLANK, 0.22), 0.015);
    join(d, sheet(ELBOW, FLANK, SHOULDER, 0.0), 0.015)
}

/// The head, in a frame of its own: forwards, up, and to either side.
fn head(p: Vec3) -> f64 {
    let skull = [0.9, 1.88, 0.26];
    let ahead = unit([0.8, -0.24, 0.62]);
    let beside = unit(cross(ahead, [0.0, 1.0, 0.0]));
    let up = cross(beside, ahead);
    let to = sub(p, skull);
    let q = [dot(to, ahead), dot(to, up), dot(to, beside).abs()];
    let mut d = face(q);
    // The lower jaw hangs open; a beard, and teeth above and below.
    let jaw = [
        ([-0.02, -0.08, 0.05], 0.06),
        ([0.14, -0.17, 0.032], 0.042),
        ([0.31, -0.225, 0.0], 0.032),
    ];
    d = join(d, limb(q, &jaw, 0.04), 0.035);
    d = join(
        d,
        rod(q, [0.3, -0.235, 0.0], [0.27, -0.33, 0.0], [0.024, 0.005]),
        0.02,
    );
    for (x, long) in [(0.35, 0.075), (0.28, 0.05), (0.21, 0.05)] {
        let z = 0.05 - 0.09 * (x - 0.21);
        d = d.min(rod(
            q,
            [x, -0.06, z],
            [x - 0.01, -0.07 - long, z],
            [0.018, 0.004],
        ));
    }
    d = d.min(rod(
        q,
        [0.3, -0.21, 0.02],
        [0.305, -0.135, 0.024],
        [0.017, 0.004],
    ));
    join(d, horns(q), 0.02)
}

/// Skull, nose, brow, cheek and eye.
fn face(q: Vec3) -> f64 {
    let mut d = join(
        ellipsoid(q, [-0.01, 0.0, 0.0], [0.155, 0.115, 0.12]),
        rod(q, [0.1, 0.01, 0.0], [0.36, -0.02, 0.0], [0.082, 0.052]),
        0.06,
    );
    d = join(
        d,
        ellipsoid(q, [0.37, 0.015, 0.028], [0.05, 0.036, 0.03]),
        0.025,
    );
    d = join(
        d,
        rod(q, [0.0, 0.1, 0.075], [0.16, 0.075, 0.075], [0.034, 0.02]),
        0.025,
    );
    d = join(
        d,
        ellipsoid(q, [0.0, -0.05, 0.09], [0.09, 0.07, 0.05]),
        0.04,
    );
    d = carve(
        d,
        ellipsoid(q, [0.395, 0.03, 0.038], [0.016, 0.012, 0.012]),
        0.01,
    );
    d = carve(
        d,
        ellipsoid(q, [0.1, 0.042, 0.105], [0.048, 0.03, 0.03]),
        0.02,
    );
    join(
        d,
        ellipsoid(q, [0.1, 0.042, 0.082], [0.03, 0.026, 0.024]),
        0.005,
    )
}

fn horns(q: Vec3) -> f64 {
    let horn = [
        ([-0.08, 0.08, 0.06], 0.05),
        ([-0.2, 0.17, 0.1], 0.038),
        ([-0.35, 0.2, 0.15], 0.026),
        ([-0.52, 0.16, 0.17], 0.008),
    ];
    let cheek = [([-0.04, -0.04, 0.09], 0.04), ([-0.23, -0.09, 0.2], 0.007)];
    let ear = [([-0.08, 0.03, 0.1], 0.036), ([-0.27, 0.05, 0.22], 0.007)];
    let d = join(limb(q, &horn, 0.03), limb(q, &cheek, 0.01), 0.01);
    join(d, limb(q, &ear, 0.01), 0.01)
}
