//! Round curves against a referee in double precision, alone and in packets.

use embree4_sys::{CurveBasis, CurveBuffer, Error, Hit, Ray};

use crate::{Numbers, build, ray};

type Vector = [f64; 3];

fn at(ray: &Ray, distance: f64) -> Vector {
    [0, 1, 2].map(|i| f64::from(ray.origin[i]) + distance * f64::from(ray.direction[i]))
}

fn distance(a: Vector, b: Vector) -> f64 {
    let squares = [0, 1, 2].map(|i| (a[i] - b[i]).powi(2));
    squares.iter().sum::<f64>().sqrt()
}

/// Middle and radius of a segment at a place along it.
fn axis(basis: CurveBasis, points: &[[f32; 4]], along: f64) -> (Vector, f64) {
    let rest = 1.0 - along;
    let weights = match basis {
        CurveBasis::Linear => vec![rest, along],
        CurveBasis::BSpline => vec![
            rest.powi(3) / 6.0,
            (4.0 - 6.0 * along.powi(2) + 3.0 * along.powi(3)) / 6.0,
            (4.0 - 6.0 * rest.powi(2) + 3.0 * rest.powi(3)) / 6.0,
            along.powi(3) / 6.0,
        ],
    };
    let sum = |c: usize| -> f64 {
        let terms = points.iter().zip(&weights);
        terms
            .map(|(point, weight)| f64::from(point[c]) * weight)
            .sum()
    };
    ([sum(0), sum(1), sum(2)], sum(3))
}

/// Signed distance from the surface of all spheres along a segment, and where along it the nearest one
/// lies.
fn depth(basis: CurveBasis, points: &[[f32; 4]], place: Vector) -> (f64, f64) {
    let depth = |along: f64| {
        let (middle, radius) = axis(basis, points, along);
        distance(place, middle) - radius
    };
    let coarse = (0..=32).map(|i| f64::from(i) / 32.0);
    let nearest = coarse.min_by(|a, b| depth(*a).total_cmp(&depth(*b)));
    let nearest = nearest.expect("there are places");
    let (mut low, mut high) = (
        (nearest - 1.0 / 32.0).max(0.0),
        (nearest + 1.0 / 32.0).min(1.0),
    );
    for _ in 0..40 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if depth(a) < depth(b) {
            high = b;
        } else {
            low = a;
        }
    }
    let along = 0.5 * (low + high);
    (depth(along), along)
}

/// Curves of two segments each.
fn random_curves(numbers: &mut Numbers, basis: CurveBasis, tapered: bool) -> (CurveBuffer, usize) {
    let per_segment = basis.points_per_segment();
    let (mut points, mut segments) = (Vec::new(), Vec::new());
    for _ in 0..6 {
        let first = points.len() as u32;
        segments.extend([first, first + 1]);
        let radius = 0.12 + 0.05 * numbers.signed();
        let mut place = numbers.point();
        for _ in 0..=per_segment {
            let step = numbers.point();
            place = [0, 1, 2].map(|i| place[i] + 0.6 * step[i]);
            let taper = if tapered {
                0.03 * numbers.signed()
            } else {
                0.0
            };
            points.push([place[0], place[1], place[2], radius + taper]);
        }
    }
    (CurveBuffer::new(points, segments), per_segment)
}

/// What the referee says of a ray.
enum Verdict {
    Hit(f64),
    Miss,
    /// The ray grazes something, or comes near the end of a curve that may be open.
    Unclear,
}

/// Follows a ray by steps that no surface is nearer than.
fn judged(basis: CurveBasis, curves: &CurveBuffer, per_segment: usize, ray: &Ray) -> Verdict {
    let mut way = 0.0;
    let mut closest = f64::INFINITY;
    for _ in 0..400 {
        let place = at(ray, way);
        let all = curves.segments().iter().map(|first| {
            let first = *first as usize;
            depth(basis, &curves.points()[first..first + per_segment], place)
        });
        let (found, along) = all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("segments");
        let is_end = basis == CurveBasis::BSpline && !(0.02..0.98).contains(&along);
        if found < 1e-7 {
            return if is_end {
                Verdict::Unclear
            } else {
                Verdict::Hit(way)
            };
        }
        if is_end && found < 0.02 {
            return Verdict::Unclear;
        }
        if way > 10.0 {
            break;
        }
        closest = closest.min(found);
        way += found;
    }
    if closest < 1e-4 {
        Verdict::Unclear
    } else {
        Verdict::Miss
    }
}

fn compare(basis: CurveBasis, tapered: bool, tolerance: f64) -> Result<(), Error> {
    let mut numbers = Numbers(17);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..16 {
        let (curves, per_segment) = random_curves(&mut numbers, basis, tapered);
        let scene = build(|builder| builder.add_curves(basis, &curves).map(|_| ()))?;
        for _ in 0..80 {
            let origin = numbers.point().map(|c| 3.0 * c);
            let toward = numbers.point();
            let direction = [0, 1, 2].map(|i| toward[i] - origin[i]);
            let length = direction.iter().map(|c| c * c).sum::<f32>().sqrt();
            let ray = ray(origin, direction.map(|c| c / length));
            let first = |i: &u32| *i as usize;
            let inside = curves.segments().iter().map(first).any(|i| {
                depth(basis, &curves.points()[i..i + per_segment], at(&ray, 0.0)).0 < 1e-3
            });
            if inside {
                continue;
            }
            let found = scene.intersect(&ray);
            match judged(basis, &curves, per_segment, &ray) {
                Verdict::Unclear => {}
                Verdict::Hit(expected) => {
                    let Some(hit) = found else {
                        panic!("{basis:?} {ray:?}: no hit, expected one at {expected}")
                    };
                    let error = (f64::from(hit.distance) - expected).abs();
                    assert!(
                        error < tolerance,
                        "{basis:?} {ray:?}: {hit:?}, expected {expected}"
                    );
                    assert!((0.0..=1.0).contains(&hit.u), "{hit:?}");
                    hits += 1;
                }
                Verdict::Miss => {
                    assert_eq!(found, None, "{basis:?} {ray:?}");
                    misses += 1;
                }
            }
        }
    }
    assert!(
        hits > 60 && misses > 60,
        "{basis:?}: {hits} hits, {misses} misses"
    );
    Ok(())
}

#[test]
fn linear_curves_are_cones_between_spheres() -> Result<(), Error> {
    compare(CurveBasis::Linear, true, 2e-4)
}

#[test]
fn b_splines_are_round_across_their_axis() -> Result<(), Error> {
    // Of even radius, the circles across the axis and the spheres along it have one surface.
    compare(CurveBasis::BSpline, false, 2e-4)
}

#[test]
fn packets_find_what_single_rays_find() -> Result<(), Error> {
    for basis in [CurveBasis::Linear, CurveBasis::BSpline] {
        let mut numbers = Numbers(23);
        let (curves, _) = random_curves(&mut numbers, basis, true);
        let scene = build(|builder| builder.add_curves(basis, &curves).map(|_| ()))?;
        let rays: Vec<Ray> = (0..4000)
            .map(|_| {
                let origin = numbers.point().map(|c| 2.0 * c);
                let toward = numbers.point();
                ray(origin, [0, 1, 2].map(|i| toward[i] - origin[i]))
            })
            .collect();
        let mut hits = Vec::new();
        scene.intersect_all(rays.iter().copied(), &mut hits);
        let alone: Vec<Option<Hit>> = rays.iter().map(|ray| scene.intersect(ray)).collect();
        let met = alone.iter().flatten().count();
        assert!(met > 200, "{met}");
        let differ = alone.iter().zip(&hits).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "{basis:?}: of {met} hits");
        let mut occluded = Vec::new();
        scene.occluded_all(rays.iter().copied(), &mut occluded);
        let alone: Vec<bool> = rays.iter().map(|ray| scene.occluded(ray)).collect();
        assert_eq!(occluded, alone, "{basis:?}");
    }
    Ok(())
}

#[test]
fn what_embree_cannot_take_is_refused() {
    let message = |points: Vec<[f32; 4]>, segments: Vec<u32>| {
        let curves = CurveBuffer::new(points, segments);
        let built = build(|builder| builder.add_curves(CurveBasis::BSpline, &curves).map(|_| ()));
        built
            .map(|_| ())
            .expect_err("it cannot be built")
            .to_string()
    };
    let points = vec![[0.0, 0.0, 0.0, 0.1]; 4];
    assert!(message(points.clone(), vec![0, 1]).contains("refers to vertex 1"));
    let mut broken = points.clone();
    broken[2][3] = -1.0;
    assert!(message(broken, vec![0]).contains("radius: -1 at control point 2"));
    let mut broken = points;
    broken[1][0] = f32::NAN;
    assert!(message(broken, vec![0]).contains("vertex 1"));
}

/// Rays that leave a straight curve right at its surface: outwards they are free, inwards they are not.
#[test]
fn surfaces_hold_at_every_size() -> Result<(), Error> {
    for scale in [1e-3_f32, 0.1, 1.0, 300.0, 1e5] {
        let points = [-1.5_f32, -0.5, 0.5, 1.5].map(|z| [0.1 * z, 0.2 * z, 0.6 * z, 0.6]);
        let points = points.map(|point| point.map(|number| number * scale));
        for (basis, segments) in [
            (CurveBasis::Linear, vec![0, 1, 2]),
            (CurveBasis::BSpline, vec![0]),
        ] {
            let curves = CurveBuffer::new(points.to_vec(), segments);
            let scene = build(|builder| builder.add_curves(basis, &curves).map(|_| ()))?;
            let mut numbers = Numbers(5);
            let mut met = 0;
            for _ in 0..1000 {
                let origin = numbers.point().map(|c| 4.0 * c * scale);
                let toward = numbers.point().map(|c| 0.5 * c * scale);
                let direction = [0, 1, 2].map(|i| toward[i] - origin[i]);
                let Some(hit) = scene.intersect(&ray(origin, direction)) else {
                    continue;
                };
                let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                let normal = hit.normal.map(|c| c / dot(hit.normal, hit.normal).sqrt());
                // Through the open end of a B-spline, or from inside.
                if dot(normal, direction) > 0.0 {
                    continue;
                }
                met += 1;
                let off = |way: f32| {
                    let gap = 1e-5 * scale * way;
                    [0, 1, 2].map(|i| origin[i] + direction[i] * hit.distance + normal[i] * gap)
                };
                let leave = numbers.point();
                let outwards = if dot(leave, normal) > 0.0 {
                    leave
                } else {
                    leave.map(|c| -c)
                };
                let what = format!("{basis:?} of size {scale}: {hit:?}");
                assert!(!scene.occluded(&ray(off(1.0), outwards)), "{what}");
                if basis == CurveBasis::Linear {
                    let inwards = outwards.map(|c| -c);
                    assert!(scene.occluded(&ray(off(-1.0), inwards)), "{what}");
                }
            }
            assert!(met > 200, "{met}");
        }
    }
    Ok(())
}
