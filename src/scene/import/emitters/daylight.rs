//! The sun and the sky.

use glam::DVec3;

use super::super::loader::Loader;
use super::super::xml::{ColourUse, ElementReader};
use super::noted;
use crate::emitter::{
    Constant, DateAndPlace, Directional, Emitter, EmitterError, SUN_RADIUS, SunSky, SunSkySettings,
    sun_irradiance,
};
use crate::math::{Rgb, Transform, Vec3};

/// What says when and where, in place of `sun_direction`.
const DATE_AND_PLACE: [&str; 9] = [
    "year",
    "month",
    "day",
    "hour",
    "minute",
    "second",
    "timezone",
    "latitude",
    "longitude",
];

/// A summer afternoon in Tokyo: what both generations of Mitsuba take.
const DEFAULT: DateAndPlace = DateAndPlace {
    year: 2010,
    month: 7,
    day: 10,
    hour: 15.0,
    timezone: 9.0,
    latitude: 35.6894,
    longitude: 139.6917,
};

impl Loader<'_> {
    /// Reads `sky`, `sun` or `sunsky`; `None` after noting why there is none.
    pub(super) fn daylight(&mut self, reader: &mut ElementReader<'_>) -> Option<Emitter> {
        let to_world = reader.transform("to_world");
        let first_generation = self.tree.version().is_first_generation();
        let up = if first_generation { Vec3::Y } else { Vec3::Z };
        let albedo = reader.colour("albedo", ColourUse::Reflectance);
        let default_albedo = if first_generation { 0.15 } else { 0.3 };
        let (sky_scale, sun_scale) = scales(reader);
        let settings = SunSkySettings {
            up: to_world.vector(up),
            to_sun: to_sun(reader, &to_world, first_generation)?,
            turbidity: reader.float("turbidity", 3.0),
            albedo: albedo.unwrap_or(Rgb::grey(default_albedo)),
            sky_scale,
            sun_scale,
            sun_radius_scale: radius_scale(reader),
        };
        // How the sky and the sun's disk are sampled and shaded there.
        reader.ignore(&["resolution", "complex_sun"]);
        for name in ["stretch", "extend"] {
            if reader.has(name) {
                reader.ignore(&[name]);
                reader.warning(
                    name,
                    format!("\"{name}\" is ignored: the sky is as published"),
                );
            }
        }
        let built = if settings.sun_radius_scale == 0.0 {
            self.sun_without_extent(settings)
        } else {
            SunSky::new(settings)
        };
        if built.as_ref().err() == Some(&EmitterError::SunBelowHorizon) {
            reader.warning("sun_direction", "the sun is below the horizon; all is dark");
            return Some(Constant::new(Rgb::BLACK).into());
        }
        noted(reader, "turbidity", built)
    }

    /// Adds the sun as parallel light, and makes the sky without it.
    fn sun_without_extent(&mut self, settings: SunSkySettings) -> Result<SunSky, EmitterError> {
        let sky = SunSky::new(SunSkySettings {
            sun_scale: 0.0,
            sun_radius_scale: 1.0,
            ..settings
        })?;
        let (up, to_sun) = (settings.up.normalize(), settings.to_sun.normalize());
        let elevation = up.dot(to_sun).clamp(0.0, 1.0).asin();
        let irradiance = sun_irradiance(elevation, settings.turbidity) * settings.sun_scale;
        let sun = Directional::new(-to_sun, irradiance)?;
        self.builder.add_emitter(sun);
        Ok(sky)
    }
}

/// Factors on the sky and on the sun; one of them is 0 where the plugin has the other only.
fn scales(reader: &mut ElementReader<'_>) -> (f32, f32) {
    let plugin = reader.plugin();
    if plugin == "sunsky" {
        let sky = reader.float("sky_scale", 1.0);
        return (sky, reader.float("sun_scale", 1.0));
    }
    let scale = reader.float("scale", 1.0);
    if plugin == "sky" {
        (scale, 0.0)
    } else {
        (0.0, scale)
    }
}

/// Factor on the sun's radius, in the words of either generation.
fn radius_scale(reader: &mut ElementReader<'_>) -> f32 {
    let scale = reader.optional_float("sun_radius_scale");
    let aperture = reader.optional_float("sun_aperture");
    let from_aperture = aperture.map(|degrees| 0.5 * degrees / SUN_RADIUS);
    scale.or(from_aperture).unwrap_or(1.0)
}

/// World-space direction to the sun, given or by date, time and place.
fn to_sun(
    reader: &mut ElementReader<'_>,
    to_world: &Transform,
    first_generation: bool,
) -> Option<Vec3> {
    let direction = reader.vector3("sun_direction");
    let dated = date_and_place(reader);
    if let Some(direction) = direction {
        if dated.is_some() {
            let message = "found \"sun_direction\" and a date, a time or a place, expected one of \
                           the two";
            reader.error("sun_direction", message);
            return None;
        }
        return Some(direction);
    }
    let DVec3 { x, y, z } = dated.unwrap_or(DEFAULT).to_sun();
    // Where east and north lie in the emitter's own axes.
    let local = if first_generation {
        DVec3::new(x, z, y)
    } else {
        DVec3::new(-y, -x, z)
    };
    Some(to_world.vector(local.as_vec3()))
}

/// Date, time and place, where anything is said of them.
fn date_and_place(reader: &mut ElementReader<'_>) -> Option<DateAndPlace> {
    let said = DATE_AND_PLACE.iter().any(|name| reader.has(name));
    let mut number = |name, default: f64| f64::from(reader.float(name, default as f32));
    let hour = number("hour", DEFAULT.hour);
    let minute = number("minute", 0.0);
    let second = number("second", 0.0);
    let found = DateAndPlace {
        hour: hour + (minute + second / 60.0) / 60.0,
        timezone: number("timezone", DEFAULT.timezone),
        latitude: number("latitude", DEFAULT.latitude),
        longitude: number("longitude", DEFAULT.longitude),
        year: reader.integer("year", DEFAULT.year),
        month: reader.integer("month", DEFAULT.month),
        day: reader.integer("day", DEFAULT.day),
    };
    said.then_some(found)
}
