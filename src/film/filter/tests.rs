use super::*;

const KINDS: [FilterKind; 8] = [
    FilterKind::Box { radius: 0.5 },
    FilterKind::Box { radius: 1.3 },
    FilterKind::Tent { radius: 1.0 },
    FilterKind::Gaussian { stddev: 0.5 },
    FilterKind::Mitchell {
        b: 1.0 / 3.0,
        c: 1.0 / 3.0,
    },
    FilterKind::Mitchell { b: 0.2, c: 0.6 },
    FilterKind::CatmullRom,
    FilterKind::Lanczos { lobes: 3.0 },
];

#[test]
fn each_filter_integrates_to_one_over_the_samples_positions() {
    for kind in KINDS {
        let filter = Filter::new(kind).unwrap();
        let n = 64;
        let reach = filter.border() as i32 + 1;
        // The pixel (0, 0) seen from samples all over its surroundings.
        let mut integral = 0.0;
        for i in -reach * n..(reach + 1) * n {
            for j in -reach * n..(reach + 1) * n {
                let raster = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / n as f32;
                filter.for_each_pixel(raster, |x, y, w| {
                    if (x, y) == (0, 0) {
                        integral += f64::from(w);
                    }
                });
            }
        }
        integral /= f64::from(n * n);
        assert!((integral - 1.0).abs() < 0.02, "{}: {integral}", kind.name());
    }
}

#[test]
fn the_weights_of_a_sample_add_up_to_one() {
    for kind in KINDS {
        let filter = Filter::new(kind).unwrap();
        for i in 0..1000 {
            let raster = Vec2::new(i as f32 * 0.377, 50.0 - i as f32 * 0.0101);
            let mut sum = 0.0;
            filter.for_each_pixel(raster, |_, _, w| sum += f64::from(w));
            assert!((sum - 1.0).abs() < 1e-5, "{kind:?} at {raster}: {sum}");
        }
    }
}

#[test]
fn each_pixel_within_reach_gets_the_weight_of_its_distance_once() {
    let kinds = KINDS.into_iter().chain([
        FilterKind::Gaussian { stddev: 1.5 },
        FilterKind::Tent { radius: 64.0 },
    ]);
    for filter in kinds.map(|kind| Filter::new(kind).unwrap()) {
        // Far from the diagonal, and at centres of pixels too.
        for raster in [
            Vec2::new(3.3, 50.8),
            Vec2::new(-2.25, 7.5),
            Vec2::new(4.5, 0.125),
        ] {
            let at = |x: i32, y: i32| {
                let off = Vec2::new(x as f32, y as f32) + 0.5 - raster;
                filter.weight(off.x) * filter.weight(off.y)
            };
            let mut found = Vec::new();
            filter.for_each_pixel(raster, |x, y, weight| found.push(((x, y), weight)));
            let sum: f32 = found.iter().map(|((x, y), _)| at(*x, *y)).sum();
            for ((x, y), weight) in &found {
                let expected = at(*x, *y) / if filter.even { sum } else { 1.0 };
                let kind = filter.kind();
                assert!(
                    (weight - expected).abs() < 1e-5,
                    "{kind:?}: {x} {y} at {raster}"
                );
            }
            let (x, y) = pixel_of(raster);
            let around = |centre: i32| centre - 66..centre + 67;
            for pixel in around(y).flat_map(|y| around(x).map(move |x| (x, y))) {
                let times = found.iter().filter(|(place, _)| *place == pixel).count();
                assert!(times == 1 || times == 0 && at(pixel.0, pixel.1).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn filters_with_gaps_keep_their_weights() {
    let filter = Filter::new(FilterKind::Gaussian { stddev: 0.05 }).unwrap();
    let mut weight = 0.0;
    filter.for_each_pixel(Vec2::splat(0.5), |_, _, w| weight = w);
    assert!(weight > 50.0, "{weight}");
    filter.for_each_pixel(Vec2::ZERO, |x, y, w| panic!("{x} {y}: {w}"));
}

#[test]
fn shapes_have_their_known_values() {
    let ratio = |kind: FilterKind, x: f32| kind.shape(x) / kind.shape(0.0);
    let mitchell = FilterKind::Mitchell {
        b: 1.0 / 3.0,
        c: 1.0 / 3.0,
    };
    assert!((mitchell.shape(0.0) - 8.0 / 9.0).abs() < 1e-6);
    assert!((mitchell.shape(1.0) - 1.0 / 18.0).abs() < 1e-6);
    assert_eq!(FilterKind::CatmullRom.shape(1.0), 0.0);
    assert_eq!(ratio(FilterKind::Tent { radius: 2.0 }, 0.5), 0.75);
    assert!((ratio(FilterKind::Gaussian { stddev: 0.5 }, 0.5) - (-0.5_f32).exp()).abs() < 1e-3);
    assert!(ratio(FilterKind::Lanczos { lobes: 3.0 }, 1.0).abs() < 1e-6);
}

#[test]
fn parameters_without_a_filter_are_refused() {
    for kind in [
        FilterKind::Box { radius: 0.0 },
        FilterKind::Gaussian { stddev: f32::NAN },
        FilterKind::Tent { radius: 1e6 },
    ] {
        assert_eq!(Filter::new(kind), None);
    }
}
