//! A camera for models that have none.

use crate::film::{Filter, FilterKind, Window};
use crate::math::{Mat4, Vec2, Vec3};
use crate::random::SamplerKind;
use crate::scene::Scene;
use crate::scene::import::View;
use crate::sensor::{FieldOfViewAxis, Perspective, PerspectiveSettings, Sensor, SensorError};

/// Field of view over the smaller side of the film, in degrees.
const FIELD_OF_VIEW: f32 = 35.0;

/// From the middle of the model towards the camera: from the front, a little from the right and above.
const TOWARDS_CAMERA: Vec3 = Vec3::new(0.45, 0.35, 1.0);

/// Width and height of a film that nothing is said of, in pixels.
const FILM: (u32, u32) = (768, 576);

/// Samples a pixel.
const SAMPLES: u32 = 64;

/// How far the camera stands back, in distances at which the model just fits.
const MARGIN: f32 = 1.08;

/// A camera that sees the box around a scene, with +y up.
///
/// # Errors
/// [`SensorError`] for a scene of a size that no camera spans.
pub(super) fn of_all(scene: &Scene, film_size: Option<(u32, u32)>) -> Result<View, SensorError> {
    let (low, high) = scene
        .accel()
        .bounding_box()
        .unwrap_or((-Vec3::ONE, Vec3::ONE));
    let (centre, half_box) = (0.5 * (low + high), 0.5 * (high - low));
    let film_size = film_size.unwrap_or(FILM);
    let film = Vec2::new(film_size.0 as f32, film_size.1 as f32);
    let axis = FieldOfViewAxis::Smaller;
    let half_film = PerspectiveSettings::half_extent(FIELD_OF_VIEW, axis, film);
    let forward = -TOWARDS_CAMERA.normalize();
    let turned = camera(Vec3::ZERO, forward).transpose();
    let needed = (0..8).map(|corner| {
        let sign = |bit: u32| if corner & bit == 0 { -1.0 } else { 1.0 };
        let corner = half_box * Vec3::new(sign(1), sign(2), sign(4));
        let seen = turned.transform_vector3(corner);
        (seen.truncate().abs() / half_film).max_element() - seen.z
    });
    let fits = needed.fold(half_box.length(), f32::max);
    let distance = MARGIN * fits.max(f32::MIN_POSITIVE);
    let sensor = Perspective::new(PerspectiveSettings {
        to_world: camera(centre - forward * distance, forward),
        field_of_view: FIELD_OF_VIEW,
        axis,
        near: distance * 1e-3,
        far: distance * 1e3,
        principal_point_offset: Vec2::ZERO,
        film_size,
    })?;
    Ok(view(sensor.into(), film_size))
}

/// The map of a camera at a point that looks along a unit direction, with +y up.
fn camera(origin: Vec3, forward: Vec3) -> Mat4 {
    let left = Vec3::Y.cross(forward).normalize_or(Vec3::X);
    let up = forward.cross(left);
    Mat4::from_cols(
        left.extend(0.0),
        up.extend(0.0),
        forward.extend(0.0),
        origin.extend(1.0),
    )
}

/// A view with a whole film, as models have it.
pub(super) fn view(sensor: Sensor, film_size: (u32, u32)) -> View {
    let filter = Filter::new(FilterKind::Gaussian { stddev: 0.5 });
    View {
        sensor,
        film_size,
        window: Window::full(film_size.0, film_size.1),
        filter: filter.expect("a Gaussian weighs something"),
        sampler: SamplerKind::Sobol,
        sample_count: SAMPLES,
        alpha: false,
        half: true,
    }
}
