//! What all sensors have in common.

use super::*;
use crate::math::statistics::two_samples_p;
use crate::math::{Mat4, warp};
use crate::random::{Purpose, Stream};

const FILM: (u32, u32) = (200, 100);

fn sensors() -> [Sensor; 4] {
    let turn = Mat4::from_rotation_y(0.7) * Mat4::from_rotation_x(-0.3);
    let to_world = Mat4::from_translation(Vec3::new(3.0, -1.0, 2.0)) * turn;
    let settings = PerspectiveSettings {
        to_world,
        field_of_view: 60.0,
        axis: FieldOfViewAxis::X,
        near: 0.1,
        far: 100.0,
        principal_point_offset: Vec2::new(0.1, 0.0),
        film_size: FILM,
    };
    [
        Perspective::new(settings).unwrap().into(),
        ThinLens::new(settings, 0.25, 3.0).unwrap().into(),
        Orthographic::new(to_world, (0.0, 9.0), FILM)
            .unwrap()
            .into(),
        Spherical::new(to_world, FILM).unwrap().into(),
    ]
}

fn pair(stream: &mut Stream) -> Vec2 {
    let x = stream.next_f32();
    Vec2::new(x, stream.next_f32())
}

/// Largest distances of rays made anew from the numbers found, of their raster positions, and of numbers of
/// lenses that are found as they were given; and the chance that numbers of lenses are spread as those given.
fn round_trips(sensor: &Sensor, spare: impl Fn(&mut Stream) -> Vec2) -> ([f32; 3], f64) {
    const SIDE: usize = 8;
    let film = Vec2::new(FILM.0 as f32, FILM.1 as f32);
    let mut stream = Stream::new(31, Purpose::Check, 0, 0);
    let mut worst = [0.0_f32; 3];
    let mut cells = [[0.0; SIDE * SIDE]; 2];
    for index in 0..20_000 {
        // Near the poles of an all-round camera many rasters see almost the same.
        let place = 0.05 + 0.9 * pair(&mut stream);
        let (raster, lens) = (place * film, pair(&mut stream));
        let ray = sensor.sample_ray(raster, lens);
        let found = sensor.invert_ray(ray.origin, ray.direction, spare(&mut stream));
        let (place, numbers) = found.expect("the ray leaves the sensor");
        let again = sensor.sample_ray(place, numbers);
        let ray_off = again.origin.distance(ray.origin) + again.direction.distance(ray.direction);
        let lens_off = if sensor.has_lens() {
            (numbers - lens).abs().max_element()
        } else {
            0.0
        };
        for (worst, off) in worst
            .iter_mut()
            .zip([ray_off, place.distance(raster), lens_off])
        {
            *worst = worst.max(off);
        }
        let cell = ([lens, numbers][index % 2] * SIDE as f32).as_uvec2();
        cells[index % 2][cell.x as usize + SIDE * cell.y as usize] += 1.0;
    }
    let p = two_samples_p(&cells[0], &cells[1]);
    (worst, p.expect("every cell has numbers"))
}

#[test]
fn rays_lead_back_to_their_numbers() {
    for sensor in sensors() {
        let ([ray, raster, lens], p) = round_trips(&sensor, pair);
        assert!(ray < 1e-5, "{ray}: {sensor:?}");
        assert!(raster < 2e-3, "{raster}: {sensor:?}");
        assert!(lens < 1e-3, "{lens}: {sensor:?}");
        assert!(p > 1e-3, "{p}: {sensor:?}");
        // What a pinhole leaves open must come from elsewhere.
        let (_, p) = round_trips(&sensor, |_| Vec2::splat(0.3));
        assert_eq!(p < 1e-9, !sensor.has_lens(), "{p}: {sensor:?}");
    }
}

#[test]
fn points_beside_the_lens_give_numbers_all_the_same() {
    let [_, lens, ..] = sensors();
    for coordinates in [Vec2::new(1.0, 0.0), Vec2::new(-0.6, 0.8001)] {
        let u = lens.invert_lens(lens.lens_point(coordinates), Vec2::ZERO);
        assert!(
            u.cmpge(Vec2::ZERO).all() && u.max_element() <= warp::ONE_MINUS_EPSILON,
            "{u}"
        );
    }
}
