//! Where the sun stands, by date, time and place.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// A moment and a place on the Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DateAndPlace {
    /// Year of the Gregorian calendar.
    pub year: i64,
    /// Month, from 1.
    pub month: i64,
    /// Day of the month, from 1.
    pub day: i64,
    /// Local time in hours since midnight.
    pub hour: f64,
    /// Hours by which local time is ahead of Universal Time.
    pub timezone: f64,
    /// Degrees north of the equator.
    pub latitude: f64,
    /// Degrees east of Greenwich.
    pub longitude: f64,
}

impl DateAndPlace {
    /// Unit direction to the sun: x to the east, y to the north, z up. Below the horizon, z is
    /// negative.
    ///
    /// Exact to half a minute of arc from 1999 to 2015, less so long before and after.
    ///
    /// Source: Blanco-Muriel et al. 2001, Sec. 4.
    pub fn to_sun(&self) -> DVec3 {
        let hours = self.hour - self.timezone;
        let days = self.days_since_2000(hours);
        let (right_ascension, declination) = celestial_position(days);
        let sidereal_hours = 6.697_424_324_2 + 0.065_709_828_3 * days + hours;
        let sidereal = (sidereal_hours * 15.0 + self.longitude).to_radians();
        let (sin_hour, cos_hour) = (sidereal - right_ascension).sin_cos();
        let (sin_latitude, cos_latitude) = self.latitude.to_radians().sin_cos();
        let (sin_declination, cos_declination) = declination.sin_cos();
        let east = -cos_declination * sin_hour;
        let north = sin_declination * cos_latitude - cos_declination * sin_latitude * cos_hour;
        let up = cos_latitude * cos_hour * cos_declination + sin_declination * sin_latitude;
        // Seen from the surface, not from the middle of the Earth, the sun stands a little lower.
        const EARTH_RADIUS_IN_ASTRONOMICAL_UNITS: f64 = 6371.01 / 149_597_890.0;
        let across = east.hypot(north);
        let zenith_angle = across.atan2(up) + EARTH_RADIUS_IN_ASTRONOMICAL_UNITS * across;
        let azimuth = east.atan2(north);
        DVec3::new(
            zenith_angle.sin() * azimuth.sin(),
            zenith_angle.sin() * azimuth.cos(),
            zenith_angle.cos(),
        )
    }

    /// Days since noon of the first of January 2000, Universal Time.
    fn days_since_2000(&self, hours: f64) -> f64 {
        // Years that begin in March, so that the leap day is the last of its year.
        let year = self.year + (self.month - 14) / 12;
        let months = self.month - 2 - 12 * ((self.month - 14) / 12);
        let julian_day =
            1461 * (year + 4800) / 4 + 367 * months / 12 - 3 * ((year + 4900) / 100) / 4 + self.day
                - 32_075;
        julian_day as f64 - 0.5 + hours / 24.0 - 2_451_545.0
    }
}

/// Right ascension and declination of the sun in radians.
fn celestial_position(days: f64) -> (f64, f64) {
    let omega = 2.1429 - 0.001_039_459_4 * days;
    let mean_longitude = 4.895_063 + 0.017_202_791_698 * days;
    let anomaly = 6.240_06 + 0.017_201_969_9 * days;
    let longitude =
        mean_longitude + 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin()
            - 0.000_113_4
            - 0.000_020_3 * omega.sin();
    let obliquity = 0.409_092_8 - 6.214e-9 * days + 0.000_039_6 * omega.cos();
    let (sin, cos) = longitude.sin_cos();
    let right_ascension = (obliquity.cos() * sin).atan2(cos).rem_euclid(TAU);
    (
        right_ascension,
        (obliquity.sin() * sin).asin().min(0.5 * PI),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(moment: DateAndPlace) -> (f64, f64) {
        let to_sun = moment.to_sun();
        let elevation = to_sun.z.asin().to_degrees();
        let azimuth = to_sun.x.atan2(to_sun.y).to_degrees().rem_euclid(360.0);
        (elevation, azimuth)
    }

    /// The example of a well-known algorithm: Golden, Colorado, 17 October 2003 at 12:30:30, where
    /// the zenith angle without refraction is 50.12 degrees and the azimuth 194.34.
    ///
    /// Source: Reda & Andreas 2004, Table A5.1.
    #[test]
    fn the_sun_stands_where_others_see_it() {
        let golden = DateAndPlace {
            year: 2003,
            month: 10,
            day: 17,
            hour: 12.0 + 30.5 / 60.0,
            timezone: -7.0,
            latitude: 39.742_476,
            longitude: -105.178_6,
        };
        let (elevation, azimuth) = degrees(golden);
        assert!((elevation - (90.0 - 50.128)).abs() < 0.03, "{elevation}");
        assert!((azimuth - 194.340).abs() < 0.03, "{azimuth}");
    }

    #[test]
    fn on_the_equator_the_equinox_has_its_noon_overhead() {
        let equator = DateAndPlace {
            year: 2010,
            month: 3,
            day: 20,
            // The equation of time makes noon seven minutes late.
            hour: 12.0 + 7.5 / 60.0,
            timezone: 0.0,
            latitude: 0.0,
            longitude: 0.0,
        };
        let (elevation, _) = degrees(equator);
        assert!(elevation > 89.5, "{elevation}");
        let (evening, azimuth) = degrees(DateAndPlace {
            hour: 17.0,
            ..equator
        });
        assert!((10.0..20.0).contains(&evening), "{evening}");
        assert!((azimuth - 270.0).abs() < 2.0, "{azimuth}");
        let (midnight, _) = degrees(DateAndPlace {
            hour: 0.0,
            ..equator
        });
        assert!(midnight < -80.0, "{midnight}");
    }
}
