//! Lookups against Mitsuba 3.9.1, and how well samples follow the picture.

use super::*;
use crate::random::{Purpose, Stream};

fn map(width: u32, height: u32, texels: Vec<f32>) -> Arc<Bitmap> {
    Arc::new(Bitmap::new(width, height, 3, Texels::Float(texels)).unwrap())
}

/// Red holds the column and green the row, from one.
fn numbered() -> Arc<Bitmap> {
    let texels = (0..32_u16).flat_map(|i| [f32::from(i % 8 + 1), f32::from(i / 8 + 1), 1.0]);
    map(8, 4, texels.collect())
}

fn check(light: &Envmap, toward: [f32; 3], expected: [f32; 3]) {
    let found = light.environment_radiance(Vec3::from_array(toward).normalize());
    let miss = (found - Rgb::from(expected)).0.abs().max_element();
    assert!(
        miss < 2e-5,
        "{found:?} instead of {expected:?} toward {toward:?}"
    );
}

/// What Mitsuba 3.9.1 returns for the same picture.
#[test]
fn lookups_are_those_of_mitsuba() {
    let light = Envmap::new(numbered(), Mat4::IDENTITY, 1.0).unwrap();
    check(&light, [1.0, 0.0, 0.0], [2.5, 2.5, 1.0]);
    check(&light, [0.0, 0.0, 1.0], [4.5, 2.5, 1.0]);
    check(&light, [0.0, 0.0, -1.0], [4.5, 2.5, 1.0]);
    check(&light, [-1.0, 0.0, 0.0], [6.5, 2.5, 1.0]);
    check(&light, [0.3, 0.4, 0.5], [3.811_916, 1.925_835, 1.0]);
    check(&light, [0.3, -0.9, -0.5], [1.188_084, 3.451_025, 1.0]);
    check(&light, [-0.6, 0.1, -0.5], [7.384_568, 2.378_395, 1.0]);
    check(&light, [0.3, 0.95, 0.1], [2.909_665, 1.306_852, 1.0]);
    let turned = Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let light = Envmap::new(numbered(), turned, 2.0).unwrap();
    check(&light, [1.0, 0.0, 0.0], [5.0, 5.0, 2.0]);
    check(&light, [0.0, 1.0, 0.0], [9.0, 5.0, 2.0]);
    check(&light, [0.3, 0.4, 0.5], [2.638_66, 3.5, 2.0]);
}

#[test]
fn samples_follow_the_light_so_closely_that_their_weights_hardly_vary() {
    for light in Envmap::examples() {
        let integral = light.map.integral * f64::from(light.scale);
        let mut stream = Stream::new(3, Purpose::Check, 0, 0);
        for _ in 0..2000 {
            let u = Vec2::new(stream.next_f32(), stream.next_f32());
            let Some(sample) = light.sample_toward(Vec3::ZERO, u) else {
                continue;
            };
            let weight = f64::from(sample.radiance.luminance() / sample.density.0);
            // Twice the mean is reached beside the poles.
            assert!(weight < 2.02 * integral, "{weight} of {integral}");
        }
    }
}

#[test]
fn poles_have_a_finite_density_and_a_sun_beside_them_is_found() {
    let mut texels = vec![0.001; 3 * 64 * 33];
    texels[3 * 64..3 * 64 + 3].fill(1e6);
    let light = Envmap::new(map(64, 33, texels), Mat4::IDENTITY, 1.0).unwrap();
    for toward in [Vec3::Y, -Vec3::Y] {
        let density = light.environment_density(toward).0;
        assert!(density > 0.0 && density < 1e4, "{density}");
    }
    let mut stream = Stream::new(4, Purpose::Check, 0, 0);
    for _ in 0..1000 {
        let u = Vec2::new(stream.next_f32(), stream.next_f32());
        let sample = light.sample_toward(Vec3::ZERO, u).unwrap();
        let again = light.environment_density(sample.direction);
        assert_eq!(again, sample.density);
    }
}

#[test]
fn black_maps_send_nothing_and_broken_ones_are_refused() {
    let new = |texels, scale, to_world| Envmap::new(map(2, 2, texels), to_world, scale);
    let black = new(vec![0.0; 12], 1.0, Mat4::IDENTITY).unwrap();
    assert!(black.sample_toward(Vec3::ZERO, Vec2::splat(0.5)).is_none());
    assert_eq!(black.environment_density(Vec3::X), SolidAngleDensity::ZERO);
    assert_eq!(black.power(), 0.0);
    let negative = new(vec![-1.0; 12], 1.0, Mat4::IDENTITY).unwrap();
    assert_eq!(negative.environment_radiance(Vec3::X), Rgb::BLACK);
    let mut texels = vec![1.0; 12];
    assert!(new(texels.clone(), 1.0, Mat4::IDENTITY).is_ok());
    let error = |e: Result<Envmap, EmitterError>| e.err().unwrap();
    assert_eq!(
        error(new(texels.clone(), f32::NAN, Mat4::IDENTITY)),
        EmitterError::BadScale
    );
    assert_eq!(
        error(new(texels.clone(), 1.0, Mat4::ZERO)),
        EmitterError::Singular
    );
    texels[10] = f32::INFINITY;
    let bad = EmitterError::BadTexel { x: 1, y: 1 };
    assert_eq!(error(new(texels, 1.0, Mat4::IDENTITY)), bad);
}
