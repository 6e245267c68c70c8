//! Days: what the sky and the sun look like.

use super::*;

fn noon() -> SunSkySettings {
    SunSkySettings {
        up: Vec3::Z,
        to_sun: Vec3::new(0.0, -0.5, 1.0),
        turbidity: 3.0,
        albedo: Rgb::grey(0.3),
        sky_scale: 1.0,
        sun_scale: 1.0,
        sun_radius_scale: 1.0,
    }
}

#[test]
fn the_sky_is_blue_brighter_near_the_sun_and_ends_at_the_horizon() {
    let day = SunSky::new(noon()).unwrap();
    let at = |x, y, z| day.environment_radiance(Vec3::new(x, y, z).normalize());
    let zenith = at(0.0, 0.0, 1.0);
    assert!(zenith.0.z > 1.5 * zenith.0.x, "{zenith:?}");
    let (near, far) = (at(0.0, -0.6, 1.0), at(0.0, 0.6, 1.0));
    assert!(near.luminance() > 2.0 * far.luminance());
    assert_eq!(at(0.3, 0.2, -0.1), Rgb::BLACK);
    // 5 to 20 klx, as skylight is, of 683 lm/W times ∫ȳ.
    let sky = day.sky.influence(Vec3::ZERO) * 683.0 * OBSERVER_INTEGRAL;
    assert!((3e3..2e4).contains(&sky), "{sky}");
}

#[test]
fn a_larger_sun_gives_the_same_light() {
    let [small, large] = [1.0, 10.0].map(|sun_radius_scale| {
        let day = SunSky::new(SunSkySettings {
            sun_radius_scale,
            ..noon()
        });
        day.unwrap().sun
    });
    assert!((small.irradiance() / large.irradiance() - 1.0).abs() < 1e-4);
    assert!(small.radiance.luminance() > 90.0 * large.radiance.luminance());
    let toward = small.frame.normal + small.frame.tangent * 0.02;
    assert!(!small.is_seen(toward.normalize()) && large.is_seen(toward.normalize()));
}

#[test]
fn days_that_cannot_be_are_refused() {
    let refused = |change: fn(&mut SunSkySettings)| {
        let mut settings = noon();
        change(&mut settings);
        SunSky::new(settings).err()
    };
    assert_eq!(
        refused(|s| s.to_sun.z = -0.1),
        Some(EmitterError::SunBelowHorizon)
    );
    assert_eq!(refused(|s| s.turbidity = 11.0), Some(EmitterError::BadAir));
    assert_eq!(
        refused(|s| s.albedo = Rgb::grey(1.1)),
        Some(EmitterError::BadAir)
    );
    assert_eq!(
        refused(|s| s.up = Vec3::ZERO),
        Some(EmitterError::NoDirection)
    );
    assert_eq!(
        refused(|s| s.sky_scale = -1.0),
        Some(EmitterError::BadScale)
    );
}
