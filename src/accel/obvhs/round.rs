//! Lines against spheres, disks and cylinders.
//!
//! Written apart from the callbacks that Embree is given, by other formulas where there are some.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};

use super::line::{Crossing, Line};

/// Where a line crosses a sphere: from the distance between line and centre, a cross product, which
/// nothing cancels in.
pub(super) fn cross_sphere(centre: DVec3, radius: f64, line: &Line) -> Option<Crossing> {
    let length = line.direction.length();
    let along = line.direction / length;
    let to_centre = centre - line.origin;
    let apart = to_centre.cross(along).length();
    // As a product, which is exact where the line grazes.
    let half_chord = ((radius - apart) * (radius + apart)).sqrt();
    let middle = to_centre.dot(along);
    let ends = [middle - half_chord, middle + half_chord].map(|end| end / length);
    let distance = line.first(ends, |_| true)?;
    Some(Crossing {
        distance,
        u: 0.0,
        v: 0.0,
        normal: (line.at(distance) - centre) / radius,
    })
}

/// Where a line crosses the image of the unit disk: with the plane that two axes span, then by the two
/// products of the point with them.
pub(super) fn cross_disk(linear: &DMat3, origin: DVec3, line: &Line) -> Option<Crossing> {
    let (x, y) = (linear.x_axis, linear.y_axis);
    let normal = x.cross(y);
    let distance = normal.dot(origin - line.origin) / normal.dot(line.direction);
    if !line.accepts(distance) {
        return None;
    }
    let point = line.at(distance) - origin;
    let area = normal.length_squared();
    let place = DVec2::new(point.cross(y).dot(normal), x.cross(point).dot(normal)) / area;
    (place.length_squared() <= 1.0).then(|| Crossing {
        distance,
        u: place.length(),
        v: turn(place),
        normal: normal.normalize() * normal.dot(linear.z_axis).signum(),
    })
}

/// Where a line crosses the image of the open cylinder: the roots of a quadratic, without the
/// difference of nearly equal numbers.
pub(super) fn cross_cylinder(inverse: &DMat3, origin: DVec3, line: &Line) -> Option<Crossing> {
    let start = *inverse * (line.origin - origin);
    let direction = *inverse * line.direction;
    // From the point nearest to the axis on, all numbers are small.
    let (o, d) = (start.truncate(), direction.truncate());
    let squared = d.length_squared();
    let shift = -o.dot(d) / squared;
    let nearest = o + shift * d;
    let b = nearest.dot(d);
    let c = (nearest.length() - 1.0) * (nearest.length() + 1.0);
    let discriminant = b * b - squared * c;
    if discriminant.is_nan() || discriminant < 0.0 {
        return None;
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    let mut ends = [q / squared, c / q].map(|end| end + shift);
    ends.sort_by(f64::total_cmp);
    let on_wall = |distance: f64| (0.0..=1.0).contains(&(start.z + distance * direction.z));
    let distance = line.first(ends, on_wall)?;
    let point = start + distance * direction;
    let outwards = DVec3::new(point.x, point.y, 0.0);
    Some(Crossing {
        distance,
        u: turn(point.truncate()),
        v: point.z,
        normal: (inverse.transpose() * outwards).normalize(),
    })
}

/// The angle from the first axis as a fraction of a turn, in [0, 1) as a float.
fn turn(place: DVec2) -> f64 {
    let angle = place.to_angle() / TAU;
    let fraction = if angle < 0.0 { angle + 1.0 } else { angle };
    if (fraction as f32) < 1.0 {
        fraction
    } else {
        0.0
    }
}
