//! Directions to shapes against their densities.

use super::*;
use crate::math::{Frame, Local, warp};

/// The directions that a χ² test sorts into cells: a cone around the shape.
struct View {
    from: Vec3,
    frame: Frame,
    one_minus_cos: f32,
}

const CELLS: usize = 16;
const SUB_CELLS: usize = 24;

impl View {
    /// The cone in which `from` sees all of `shape`.
    fn new(from: Vec3, shape: &Shape) -> Self {
        let mut stream = stream(4);
        let points: Vec<Vec3> = (0..2000)
            .map(|_| shape.sample_area(pair(&mut stream)).0.position)
            .collect();
        let centre = points.iter().sum::<Vec3>() / points.len() as f32;
        let axis = (centre - from).normalize();
        let one_minus_cos = |p: &Vec3| {
            let direction = (*p - from).normalize();
            // Exact for narrow cones, too.
            let half = (direction - axis).length_squared() / 2.0;
            half * 1.1
        };
        let opening = points.iter().map(one_minus_cos).fold(0.0, f32::max);
        Self {
            from,
            frame: Frame::around(axis),
            one_minus_cos: opening.min(2.0),
        }
    }

    /// Counts of a sampler's directions in cells, and what the density expects: the sum over all
    /// crossings of a direction, each times `fault` of it. The last cell is outside of the view.
    fn histogram(
        &self,
        shape: &Shape,
        fault: impl Fn(&SurfacePoint) -> f64,
    ) -> (Vec<f64>, Vec<f64>) {
        let count = 20_000;
        let mut observed = vec![0.0; CELLS * CELLS + 1];
        let mut stream = stream(0);
        for _ in 0..count {
            let sample = shape.sample_toward(self.from, pair(&mut stream));
            observed[sample.map_or(CELLS * CELLS, |(point, _)| self.cell(&point))] += 1.0;
        }
        let solid_angle = f64::from(TAU * self.one_minus_cos);
        let fine = CELLS * SUB_CELLS;
        let weight = f64::from(count) * solid_angle / (fine * fine) as f64;
        let mut expected = vec![0.0; CELLS * CELLS + 1];
        for (i, j) in (0..fine).flat_map(|i| (0..fine).map(move |j| (i, j))) {
            let u = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / fine as f32;
            let local = Local(warp::uniform_cone(u, self.one_minus_cos));
            let direction = self.frame.to_world(local);
            let density: f64 = crossings(shape, self.from, direction)
                .iter()
                .map(|p| f64::from(shape.density_toward(self.from, p).0) * fault(p))
                .sum();
            expected[(i / SUB_CELLS) * CELLS + j / SUB_CELLS] += density * weight;
        }
        expected[CELLS * CELLS] = f64::from(count) - expected.iter().sum::<f64>();
        (observed, expected)
    }

    fn cell(&self, point: &SurfacePoint) -> usize {
        let direction = (point.position - self.from).normalize();
        let local = self.frame.to_local(direction).0;
        let u = warp::uniform_cone_inverse(local, self.one_minus_cos);
        if u.y >= 1.0 {
            return CELLS * CELLS;
        }
        (u.x * CELLS as f32) as usize * CELLS + (u.y * CELLS as f32) as usize
    }
}

fn views(shape: &Shape) -> Vec<View> {
    let mut from = vec![Vec3::new(0.1, 0.2, -1.2), Vec3::new(-2.0, 1.0, -0.5)];
    if let Shape::Sphere(s) = shape {
        let off_axis = Vec3::new(0.6, 0.0, 0.8) * s.radius();
        from.extend([0.5, 1.05, 1000.0].map(|factor| s.centre() + off_axis * factor));
    }
    if let Shape::Cylinder(_) = shape {
        from.push(Vec3::new(0.1, 0.15, 1.9));
    }
    from.into_iter().map(|p| View::new(p, shape)).collect()
}

#[test]
fn directions_follow_their_density() {
    for shape in examples() {
        if matches!(shape, Shape::Cylinder(_)) {
            // Its density has poles at the silhouettes, which the quadrature cannot see.
            continue;
        }
        for view in views(&shape) {
            let (observed, expected) = view.histogram(&shape, |_| 1.0);
            // The quadrature can miss the corner of a shape that reaches into a cell.
            let seen = |i: &usize| *i < CELLS * CELLS && expected[*i] >= 5.0;
            let (cells, outside): (Vec<usize>, Vec<usize>) = (0..=CELLS * CELLS).partition(seen);
            let from = view.from;
            for i in outside {
                let (o, e) = (observed[i], expected[i]);
                assert!(
                    o + e.abs() < 100.0,
                    "{o} for {e} in cell {i} from {from} to {shape:?}"
                );
            }
            let pick = |counts: &[f64]| cells.iter().map(|i| counts[*i]).collect::<Vec<_>>();
            let p = chi_square_p(&pick(&observed), &pick(&expected)).unwrap();
            assert!(p > LEVEL, "p = {p} from {from} to {shape:?}");
        }
    }
}

impl View {
    /// What the directions of this view are summed up by.
    fn moments(&self, direction: Vec3) -> [f64; 4] {
        let local = self.frame.to_local(direction).0 / self.one_minus_cos.sqrt();
        [1.0, local.x, local.y, local.x * local.x].map(f64::from)
    }

    /// Moments of the directions that a shape covers, every crossing that can be sampled counted.
    fn covered(&self, shape: &Shape) -> [f64; 4] {
        let fine = 300_u32;
        let solid_angle = f64::from(TAU * self.one_minus_cos) / f64::from(fine * fine);
        let mut sums = [0.0; 4];
        for (i, j) in (0..fine).flat_map(|i| (0..fine).map(move |j| (i, j))) {
            let u = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / fine as f32;
            let local = Local(warp::uniform_cone(u, self.one_minus_cos));
            let direction = self.frame.to_world(local);
            let counted = crossings(shape, self.from, direction)
                .iter()
                .filter(|p| shape.density_toward(self.from, p).0 > 0.0)
                .count();
            for (sum, moment) in sums.iter_mut().zip(self.moments(direction)) {
                *sum += moment * counted as f64 * solid_angle;
            }
        }
        sums
    }

    /// The same from samples: mean and its error, for each moment.
    fn estimated(&self, shape: &Shape) -> [(f64, f64); 4] {
        let count = 20_000_u32;
        let mut stream = stream(5);
        let (mut sums, mut squares) = ([0.0; 4], [0.0; 4]);
        for _ in 0..count {
            let Some((point, density)) = shape.sample_toward(self.from, pair(&mut stream)) else {
                continue;
            };
            let direction = (point.position - self.from).normalize();
            for (k, moment) in self.moments(direction).into_iter().enumerate() {
                let value = moment / f64::from(density.0);
                sums[k] += value;
                squares[k] += value * value;
            }
        }
        [0, 1, 2, 3].map(|k| {
            let mean = sums[k] / f64::from(count);
            let variance = squares[k] / f64::from(count) - mean * mean;
            (mean, (variance.max(0.0) / f64::from(count)).sqrt())
        })
    }
}

/// One over the density integrates the directions. Has no poles where the density has them.
#[test]
fn inverse_densities_measure_the_solid_angle() {
    for shape in examples() {
        for view in views(&shape) {
            let exact = view.covered(&shape);
            for (k, (mean, error)) in view.estimated(&shape).into_iter().enumerate() {
                // The floor is the error of the quadrature.
                let z = (mean - exact[k]) / (error + 1e-3 * exact[0]);
                let from = view.from;
                assert!(
                    z.abs() < 4.0,
                    "moment {k}: z = {z} from {from} to {shape:?}"
                );
            }
        }
    }
}

#[test]
fn a_density_that_is_wrong_on_one_half_is_caught() {
    for shape in examples() {
        if matches!(shape, Shape::Cylinder(_)) {
            continue;
        }
        let middle = shape.sample_area(Vec2::splat(0.5)).0.position.x;
        let fault = |p: &SurfacePoint| if p.position.x > middle { 1.1 } else { 0.9 };
        let (observed, expected) = views(&shape)[0].histogram(&shape, fault);
        let cells = CELLS * CELLS;
        let p = chi_square_p(&observed[..cells], &expected[..cells]).unwrap();
        assert!(p < 1e-6, "p = {p} for {shape:?}");
    }
}

#[test]
fn the_density_of_a_sample_is_the_one_reported_for_it() {
    for shape in examples() {
        for view in views(&shape) {
            let mut stream = stream(1);
            for _ in 0..500 {
                let Some((point, density)) = shape.sample_toward(view.from, pair(&mut stream))
                else {
                    continue;
                };
                let again = shape.density_toward(view.from, &point);
                assert!(
                    (again.0 - density.0).abs() <= 2e-3 * density.0,
                    "{again:?} {density:?} from {} to {shape:?}",
                    view.from
                );
            }
        }
    }
}

/// Share of samples that do not lead back to their own numbers, or not to themselves; `spoil` changes the
/// numbers found.
fn lost(
    shape: &Shape,
    sample: impl Fn(Vec2) -> Option<SurfacePoint>,
    invert: impl Fn(&SurfacePoint) -> Option<Vec2>,
    spoil: impl Fn(Vec2) -> Vec2,
) -> f64 {
    let mut stream = stream(7);
    let size = shape.area().sqrt() as f32;
    let (mut count, mut lost) = (0, 0);
    for _ in 0..4000 {
        let u = pair(&mut stream);
        let Some(point) = sample(u) else { continue };
        count += 1;
        let found = invert(&point).map(&spoil);
        let is_same = found.is_some_and(|found| {
            let off = (found - u).abs();
            // The parts of a turn are a ring.
            let off = off.min(1.0 - off).max_element();
            let again = sample(found);
            off < 0.01 && again.is_some_and(|p| p.position.distance(point.position) < 2e-3 * size)
        });
        lost += u32::from(!is_same);
    }
    f64::from(lost) / f64::from(count)
}

#[test]
fn samples_lead_back_to_their_numbers() {
    let spoilt = |u: Vec2| Vec2::new(u.y, u.x);
    for shape in examples() {
        let by_area = |u| Some(shape.sample_area(u).0);
        let back = |point: &SurfacePoint| shape.invert_area(point);
        let share = lost(&shape, by_area, back, |u| u);
        assert!(share < 0.01, "{share} of the points of {shape:?}");
        assert!(lost(&shape, by_area, back, spoilt) > 0.5, "{shape:?}");
        for view in views(&shape) {
            let from = view.from;
            let toward = |u| shape.sample_toward(from, u).map(|(point, _)| point);
            let back = |point: &SurfacePoint| shape.invert_toward(from, point);
            let share = lost(&shape, toward, back, |u| u);
            assert!(share < 0.01, "{share} of {shape:?} from {from}");
            assert!(lost(&shape, toward, back, spoilt) > 0.5, "{shape:?}");
        }
    }
}
