//! Histograms of directions against densities, and integrals over the sphere.
//!
//! The sphere is cut into cells of (cos θ, φ) that are small where a pilot run finds many
//! directions: a lobe of any width is resolved, and each cell's integral is easy.

use std::f64::consts::{PI, TAU};

use lumiflow::math::Local;
use lumiflow::math::statistics::chi_square_p;
use lumiflow::random::Stream;

use crate::support::effort::samples;

/// Directions of the pilot run.
const PILOT: usize = 8_000;
/// Directions of the histogram; the proof takes more.
const COUNT: u32 = 40_000;
/// A part of the sphere with more directions of the pilot run than this is more than one cell.
const CROWDED: usize = 40;
/// A cell with more directions than this is integrated in pieces: a rule of few points must not
/// overlook the corner where they all are.
const UNEVEN: usize = 6;
/// Cuts above each other that are made anyway: the horizon, where densities jump, some azimuths.
const LEAST_CUTS: u32 = 6;
/// Cuts above each other at most.
const MOST_CUTS: u32 = 40;
/// Error of the integral over a cell at which refinement stops.
const TOLERANCE: f64 = 1e-6;
/// Times that a piece is quartered at most to integrate over it.
const MOST_REFINEMENTS: u32 = 10;

/// A rectangle of (cos θ, φ).
#[derive(Clone, Copy)]
struct Rectangle {
    low: [f64; 2],
    high: [f64; 2],
}

impl Rectangle {
    fn halves(self, axis: usize) -> [Self; 2] {
        let mut halves = [self, self];
        let middle = 0.5 * (self.low[axis] + self.high[axis]);
        halves[0].high[axis] = middle;
        halves[1].low[axis] = middle;
        halves
    }

    /// Integral of `f` over solid angle by a product rule of 16 points.
    fn estimate(self, f: &dyn Fn(Local) -> f64) -> f64 {
        // Gauss-Legendre with four points on [-1, 1].
        const RULE: [(f64, f64); 4] = [
            (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
            (-0.339_981_043_584_856_26, 0.652_145_154_862_546_2),
            (0.339_981_043_584_856_26, 0.652_145_154_862_546_2),
            (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        ];
        let half = [0, 1].map(|axis| 0.5 * (self.high[axis] - self.low[axis]));
        let middle = [0, 1].map(|axis| 0.5 * (self.high[axis] + self.low[axis]));
        let mut sum = 0.0;
        for (x, weight_x) in RULE {
            for (y, weight_y) in RULE {
                let cos = middle[0] + half[0] * x;
                let azimuth = middle[1] + half[1] * y;
                sum += weight_x * weight_y * f(direction(cos, azimuth));
            }
        }
        sum * half[0] * half[1]
    }

    /// Integral of `f` over solid angle, refined until halving changes it by less than
    /// [`TOLERANCE`].
    fn integrate(self, f: &dyn Fn(Local) -> f64, coarse: f64, depth: u32) -> f64 {
        let quarters = self
            .halves(0)
            .into_iter()
            .flat_map(|half| half.halves(1))
            .map(|quarter| (quarter, quarter.estimate(f)));
        let quarters: Vec<_> = quarters.collect();
        let fine: f64 = quarters.iter().map(|(_, estimate)| estimate).sum();
        // A corner that reaches into the density's support can lie between the points.
        let seen = fine != 0.0 || depth + 3 <= MOST_REFINEMENTS;
        if depth == 0 || seen && (fine - coarse).abs() < TOLERANCE {
            return fine;
        }
        quarters
            .into_iter()
            .map(|(quarter, estimate)| quarter.integrate(f, estimate, depth - 1))
            .sum()
    }
}

fn direction(cos: f64, azimuth: f64) -> Local {
    let sin = ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt();
    let (y, x) = azimuth.sin_cos();
    Local::new((sin * x) as f32, (sin * y) as f32, cos as f32)
}

fn coordinates(direction: Local) -> [f64; 2] {
    let v = direction.0.as_dvec3();
    [v.z, v.y.atan2(v.x)]
}

enum Node {
    Cell(usize),
    Cut {
        axis: usize,
        at: f64,
        below: Box<Node>,
        above: Box<Node>,
    },
}

/// The sphere, cut into cells, each of one or more pieces.
pub(crate) struct Cells {
    root: Node,
    cells: Vec<Vec<Rectangle>>,
}

impl Cells {
    /// Cuts the sphere into cells that hold few of the given directions each.
    pub(crate) fn around(directions: impl IntoIterator<Item = Local>) -> Self {
        let mut points: Vec<_> = directions.into_iter().map(coordinates).collect();
        let sphere = Rectangle {
            low: [-1.0, -PI],
            high: [1.0, PI],
        };
        let mut cells = Vec::new();
        let root = cut(sphere, &mut points, 0, &mut cells);
        Self { root, cells }
    }

    fn find(&self, direction: Local) -> usize {
        let point = coordinates(direction);
        let mut node = &self.root;
        loop {
            match node {
                Node::Cell(index) => return *index,
                Node::Cut {
                    axis,
                    at,
                    below,
                    above,
                } => node = if point[*axis] < *at { below } else { above },
            }
        }
    }

    /// Integral over each cell, by solid angle.
    fn integrals<'a>(&'a self, f: &'a dyn Fn(Local) -> f64) -> impl Iterator<Item = f64> + 'a {
        self.cells.iter().map(move |cell| {
            let piece = |piece: &Rectangle| piece.integrate(f, piece.estimate(f), MOST_REFINEMENTS);
            cell.iter().map(piece).sum()
        })
    }

    /// Integral over the sphere, by solid angle.
    pub(crate) fn integral(&self, f: impl Fn(Local) -> f64) -> f64 {
        self.integrals(&f).sum()
    }
}

/// Cuts a part of the sphere into cells.
fn cut(
    part: Rectangle,
    points: &mut [[f64; 2]],
    depth: u32,
    cells: &mut Vec<Vec<Rectangle>>,
) -> Node {
    if depth >= LEAST_CUTS && (points.len() <= CROWDED || depth == MOST_CUTS) {
        let mut pieces = Vec::new();
        cut_cell(part, points, depth, &mut pieces);
        cells.push(pieces);
        return Node::Cell(cells.len() - 1);
    }
    let (axis, middle) = best_cut(part, points, depth);
    let [low, high] = part.halves(axis);
    let (left, right) = points.split_at_mut(middle);
    Node::Cut {
        axis,
        at: high.low[axis],
        below: Box::new(cut(low, left, depth + 1, cells)),
        above: Box::new(cut(high, right, depth + 1, cells)),
    }
}

/// Cuts a cell into pieces: until few directions are in each, and those not in a corner of it, where
/// a lobe much narrower than the piece would lie between the points of the rule.
fn cut_cell(part: Rectangle, points: &mut [[f64; 2]], depth: u32, pieces: &mut Vec<Rectangle>) {
    if points.len() < 2 || depth == MOST_CUTS {
        pieces.push(part);
        return;
    }
    let (axis, middle) = best_cut(part, points, depth);
    let on_one_side = middle == 0 || middle == points.len();
    if points.len() <= UNEVEN && !on_one_side {
        pieces.push(part);
        return;
    }
    let (left, right) = points.split_at_mut(middle);
    let [low, high] = part.halves(axis);
    cut_cell(low, left, depth + 1, pieces);
    cut_cell(high, right, depth + 1, pieces);
}

/// The coordinate whose halves differ most in their number of points, and that of the lower half;
/// the points of the lower half are moved to the front.
fn best_cut(part: Rectangle, points: &mut [[f64; 2]], depth: u32) -> (usize, usize) {
    let at = [0, 1].map(|axis| 0.5 * (part.low[axis] + part.high[axis]));
    let below = [0, 1].map(|axis| points.iter().filter(|p| p[axis] < at[axis]).count());
    let unevenness = below.map(|count| (2 * count).abs_diff(points.len()));
    let turn = (depth % 2) as usize;
    let axis = if depth < LEAST_CUTS || unevenness[0] == unevenness[1] {
        turn
    } else {
        usize::from(unevenness[1] > unevenness[0])
    };
    points.sort_unstable_by_key(|p| p[axis] >= at[axis]);
    (axis, below[axis])
}

/// Chance (Pearson's χ²) that a sampler's directions come from the density it claims.
///
/// - `sample`: one direction, or `None` where the sampler makes none or a Dirac.
/// - `density`: in 1/sr, over the whole sphere; what it lacks to one is the chance of `None`.
pub(crate) fn direction_p(
    stream: &mut Stream,
    mut sample: impl FnMut(&mut Stream) -> Option<Local>,
    density: impl Fn(Local) -> f64,
) -> f64 {
    let cells = Cells::around(
        (0..PILOT)
            .filter_map(|_| sample(stream))
            .collect::<Vec<_>>(),
    );
    let mut observed = vec![0.0; cells.cells.len() + 1];
    let outside = cells.cells.len();
    let count = samples(COUNT);
    for _ in 0..count {
        let index = sample(stream).map_or(outside, |direction| cells.find(direction));
        observed[index] += 1.0;
    }
    let count = f64::from(count);
    let mut expected: Vec<f64> = cells.integrals(&density).map(|p| p * count).collect();
    let missing = 1.0 - expected.iter().sum::<f64>() / count;
    if missing < -1e-3 {
        return 0.0;
    }
    // Not less than the error of the integrals: one odd direction is no miracle.
    expected.push(missing.max(1e-6) * count);
    chi_square_p(&observed, &expected).unwrap_or(1.0)
}

#[test]
fn integrals_over_the_sphere_are_accurate() {
    let everywhere = Cells::around([]);
    let area = everywhere.integral(|_| 1.0);
    assert!((area - 2.0 * TAU).abs() < 1e-9);
    let cosines = everywhere.integral(|d| f64::from(d.cos().max(0.0)));
    assert!((cosines - PI).abs() < 1e-6);
}
