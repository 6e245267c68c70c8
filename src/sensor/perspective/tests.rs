//! Rays against Mitsuba 3.9.1, projection and densities against the rays.

use super::*;

fn options() -> PerspectiveOptions {
    PerspectiveOptions {
        to_world: Mat4::IDENTITY,
        field_of_view: FieldOfView::Angle {
            angle: 50.0_f32.to_radians(),
            axis: FovAxis::X,
        },
        film_size: [40, 30],
        clip: [0.01, 10_000.0],
        principal_point_offset: Vec2::ZERO,
    }
}

fn direction(options: PerspectiveOptions, raster: [f32; 2]) -> Vec3 {
    let camera = Perspective::new(options).unwrap();
    let ray = camera.sample_ray(raster.into(), Vec2::ZERO);
    assert!((ray.direction.length() - 1.0).abs() < 1e-6);
    ray.direction
}

fn check(options: PerspectiveOptions, raster: [f32; 2], expected: [f32; 3]) {
    let found = direction(options, raster);
    let miss = (found - Vec3::from_array(expected)).length();
    assert!(miss < 2e-6, "{found} instead of {expected:?}");
}

/// Directions that Mitsuba 3.9.1 samples.
#[test]
fn angles_of_view_are_those_of_mitsuba() {
    let with = |axis| PerspectiveOptions {
        field_of_view: FieldOfView::Angle {
            angle: 50.0_f32.to_radians(),
            axis,
        },
        ..options()
    };
    let by_width = [0.402_865_4, 0.302_149, 0.863_947_6];
    let by_height = [0.490_916_9, 0.368_187_7, 0.789_581_1];
    check(with(FovAxis::X), [0.0, 0.0], by_width);
    check(
        with(FovAxis::X),
        [10.0, 21.0],
        [0.224_985_5, -0.134_991_2, 0.964_965_7],
    );
    check(with(FovAxis::Y), [0.0, 0.0], by_height);
    check(with(FovAxis::Smaller), [0.0, 0.0], by_height);
    check(with(FovAxis::Larger), [0.0, 0.0], by_width);
    check(
        with(FovAxis::Diagonal),
        [0.0, 0.0],
        [0.338_094_6, 0.253_570_9, 0.906_307_8],
    );
    let portrait = PerspectiveOptions {
        film_size: [30, 40],
        ..with(FovAxis::Smaller)
    };
    check(portrait, [0.0, 0.0], [0.368_187_7, 0.490_917, 0.789_581_1]);
    let focal = PerspectiveOptions {
        field_of_view: FieldOfView::FocalLength(50.0),
        ..options()
    };
    check(focal, [0.0, 0.0], [0.317_673_4, 0.238_255_1, 0.917_778_8]);
}

/// A crop at (10, 5) of 8 × 6 pixels, and a principal point, in Mitsuba 3.9.1.
#[test]
fn crops_and_principal_points_are_those_of_mitsuba() {
    check(
        options(),
        [10.0, 5.0],
        [0.221_427_4, 0.221_427_4, 0.949_705_1],
    );
    check(
        options(),
        [12.0, 9.2],
        [0.181_761_7, 0.131_777_2, 0.974_472_9],
    );
    let shifted = PerspectiveOptions {
        principal_point_offset: Vec2::new(0.1, 0.05),
        ..options()
    };
    check(
        shifted,
        [20.0, 15.0],
        [-0.092_802_3, -0.034_800_8, 0.995_076_3],
    );
    check(
        shifted,
        [40.0, 30.0],
        [-0.462_926, -0.318_261_6, 0.827_290_2],
    );
    check(
        shifted,
        [18.0, 11.0],
        [-0.046_501_4, 0.058_126_8, 0.997_225_5],
    );
}

#[test]
fn clipping_planes_cut_rays_by_depth() {
    let clipped = PerspectiveOptions {
        clip: [0.5, 20.0],
        ..options()
    };
    let camera = Perspective::new(clipped).unwrap();
    let ray = camera.sample_ray(Vec2::ZERO, Vec2::ZERO);
    assert!((ray.near - 0.5 / 0.863_947_6).abs() < 1e-5);
    // Mitsuba starts at the near plane and goes on for 22.570814.
    assert!((ray.far - ray.near - 22.570_814).abs() < 1e-4);
    assert_eq!(camera.project(Vec3::new(0.0, 0.0, 0.499)), None);
    assert_eq!(camera.project(Vec3::new(0.0, 0.0, 20.01)), None);
    assert_eq!(camera.project(Vec3::new(0.0, 0.0, -1.0)), None);
    assert_eq!(camera.project(Vec3::NAN), None);
    let centre = camera.project(Vec3::new(0.0, 0.0, 1.0));
    assert_eq!(centre, Some(Vec2::new(20.0, 15.0)));
}

#[test]
fn scale_is_ignored_and_a_mirror_mirrors() {
    let moved = Mat4::from_translation(Vec3::new(1.0, 2.0, 3.0)) * Mat4::from_rotation_y(0.4);
    let with = |scale: Vec3| PerspectiveOptions {
        to_world: moved * Mat4::from_scale(scale),
        ..options()
    };
    let plain = direction(with(Vec3::ONE), [3.0, 7.0]);
    check(with(Vec3::new(2.0, 3.0, 0.5)), [3.0, 7.0], plain.to_array());
    check(
        with(Vec3::new(-1.0, 1.0, 1.0)),
        [37.0, 7.0],
        plain.to_array(),
    );
    let camera = Perspective::new(with(Vec3::ONE)).unwrap();
    assert_eq!(camera.origin(), Vec3::new(1.0, 2.0, 3.0));
}

fn oblique() -> Perspective {
    let to_world = Mat4::from_translation(Vec3::new(-31.0, 12.5, 7.0))
        * Mat4::from_rotation_y(2.1)
        * Mat4::from_rotation_x(-0.6);
    Perspective::new(PerspectiveOptions {
        to_world,
        film_size: [1920, 1080],
        principal_point_offset: Vec2::new(-0.2, 0.1),
        ..options()
    })
    .unwrap()
}

const RASTER: [Vec2; 4] = [
    Vec2::new(960.5, 540.25),
    Vec2::new(0.1, 1079.0),
    Vec2::new(1919.0, 3.0),
    Vec2::new(-2.0, 1081.5),
];

#[test]
fn projecting_undoes_sampling() {
    let camera = oblique();
    for raster in RASTER {
        let ray = camera.sample_ray(raster, Vec2::ZERO);
        for distance in [0.5, 30.0, 4000.0] {
            let found = camera
                .project(ray.origin + ray.direction * distance)
                .unwrap();
            // Near the camera the point's own rounding shows.
            assert!(
                (found - raster).length() < 0.02,
                "{raster} came back as {found}"
            );
        }
    }
}

#[test]
fn raster_density_is_the_jacobian_of_sampling() {
    let camera = oblique();
    for raster in RASTER {
        let at = |offset: Vec2| {
            let ray = camera.sample_ray(raster + offset, Vec2::ZERO);
            ray.direction.as_dvec3()
        };
        let half = 4.0;
        let along_x = (at(Vec2::X * half) - at(-Vec2::X * half)) / f64::from(2.0 * half);
        let along_y = (at(Vec2::Y * half) - at(-Vec2::Y * half)) / f64::from(2.0 * half);
        let solid_angle = along_x.cross(along_y).length();
        let direction = camera.sample_ray(raster, Vec2::ZERO).direction;
        let density = camera.raster_density(direction);
        assert!((density * solid_angle - 1.0).abs() < 1e-3, "{raster}");
        let cos = camera.axes.z_axis.dot(direction.as_dvec3());
        assert!((camera.importance(direction) * cos / density - 1.0).abs() < 1e-9);
        assert_eq!(camera.importance(-direction), 0.0);
        assert_eq!(camera.raster_density(-direction), 0.0);
    }
}

#[test]
fn senseless_options_are_refused() {
    let spoilt = |spoil: fn(&mut PerspectiveOptions)| {
        let mut options = options();
        spoil(&mut options);
        Perspective::new(options).err()
    };
    let angle = |angle| FieldOfView::Angle {
        angle,
        axis: FovAxis::X,
    };
    assert!(Perspective::new(options()).is_ok());
    assert_eq!(
        spoilt(|o| o.to_world = Mat4::ZERO),
        Some(SensorError::Singular)
    );
    assert_eq!(
        spoilt(|o| o.to_world.w_axis.x = f32::NAN),
        Some(SensorError::Singular)
    );
    assert_eq!(
        spoilt(|o| o.film_size = [0, 4]),
        Some(SensorError::NoPixels)
    );
    assert_eq!(spoilt(|o| o.clip = [0.0, 1.0]), Some(SensorError::BadClip));
    assert_eq!(
        spoilt(|o| o.clip = [1.0, f32::NAN]),
        Some(SensorError::BadClip)
    );
    assert_eq!(
        spoilt(|o| o.principal_point_offset.x = f32::INFINITY),
        Some(SensorError::BadPrincipalPoint)
    );
    for field_of_view in [
        angle(0.0),
        angle(3.2),
        angle(f32::NAN),
        FieldOfView::FocalLength(0.0),
    ] {
        let options = PerspectiveOptions {
            field_of_view,
            ..options()
        };
        assert_eq!(
            Perspective::new(options).err(),
            Some(SensorError::BadFieldOfView)
        );
    }
}
