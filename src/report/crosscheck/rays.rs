//! The rays of a check.

use glam::DVec3;

use super::address::{Kind, RayAddress};
use super::exact::Exact;
use super::subject::{Id, Subject};
use crate::accel::Ray;
use crate::math::{Vec2, Vec3, warp};
use crate::random::{Purpose, Stream};
use crate::sensor::{Sensor, SensorModel};
use crate::shape::SurfacePoint;

/// Where primary rays come from.
#[derive(Clone, Copy)]
pub struct Camera<'a> {
    /// The camera.
    pub sensor: &'a Sensor,
    /// Width and height of its film, in pixels.
    pub film_size: (u32, u32),
}

/// What rays are aimed at.
pub(super) struct Aim<'a> {
    subject: &'a Subject,
    camera: Option<Camera<'a>>,
    /// Geometries of the world and of all instances, each with the number of primitives before it and
    /// its own.
    targets: Vec<(u64, Option<u32>, u32)>,
    primitives: u64,
    middle: DVec3,
    radius: f64,
}

/// A point of a surface, in the world.
struct Spot {
    point: DVec3,
    normal: DVec3,
    /// The corners of its triangle.
    corners: Option<[DVec3; 3]>,
}

impl<'a> Aim<'a> {
    pub(super) fn new(
        subject: &'a Subject,
        camera: Option<Camera<'a>>,
        bounds: [DVec3; 2],
    ) -> Self {
        let (mut targets, mut primitives) = (Vec::new(), 0);
        let mut add = |instance: Option<u32>, geometries: &[crate::accel::Geometry]| {
            for (index, geometry) in (0..).zip(geometries) {
                let count = u64::from(Exact::count(geometry));
                if count > 0 {
                    targets.push((primitives, instance, index));
                    primitives += count;
                }
            }
        };
        add(None, &subject.geometries);
        for (index, instance) in (0..).zip(&subject.instances) {
            add(Some(index), &subject.groups[instance.group as usize]);
        }
        let [low, high] = bounds;
        Self {
            subject,
            camera,
            targets,
            primitives,
            middle: 0.5 * (low + high),
            radius: 0.5 * (high - low).length(),
        }
    }

    /// The ray of an address; `None` where there is nothing to aim at.
    pub(super) fn ray(&self, address: RayAddress, seed: u64) -> Option<Ray> {
        if self.primitives == 0 {
            return None;
        }
        let kind = address.kind as u32;
        let stream = &mut Stream::new(seed, Purpose::Crosscheck, address.index, kind);
        Some(match address.kind {
            Kind::Primary => self.primary(stream),
            Kind::Bounce => {
                let spot = self.spot(stream);
                let direction = unit(stream).as_vec3();
                Ray::new(spot.off(direction), direction)
            }
            Kind::Shadow => {
                let [from, to] = [(); 2].map(|()| self.spot(stream));
                let way = (to.point - from.point).as_vec3();
                Ray::segment(from.off(way), to.off(-way))
            }
            Kind::Grazing => {
                let spot = self.spot(stream);
                let lean = 10.0_f64.powf(-1.0 - 6.0 * number(stream));
                let along = spot.normal.cross(unit(stream)).normalize_or(DVec3::X);
                let direction = along + lean * spot.normal * sign(stream);
                self.through(stream, spot.point, direction)
            }
            Kind::Edge => {
                let spot = self.spot(stream);
                let target = match spot.corners {
                    Some(corners) => {
                        let edge = (stream.next_u32() % 3) as usize;
                        let part = number(stream);
                        corners[edge] * (1.0 - part) + corners[(edge + 1) % 3] * part
                    }
                    None => spot.point,
                };
                self.at(stream, target)
            }
            Kind::Vertex => {
                let spot = self.spot(stream);
                let corner = (stream.next_u32() % 3) as usize;
                self.at(
                    stream,
                    spot.corners.map_or(spot.point, |corners| corners[corner]),
                )
            }
            Kind::Far => {
                let spot = self.spot(stream);
                let away = self.radius * 10.0_f64.powf(2.0 + 3.0 * number(stream));
                let origin = self.middle + away * unit(stream);
                toward(origin, spot.point)
            }
            Kind::Axis => {
                let axis = DVec3::AXES[(stream.next_u32() % 3) as usize] * sign(stream);
                let spot = self.spot(stream);
                self.through(stream, spot.point, axis)
            }
            Kind::Degenerate => self.degenerate(stream),
        })
    }

    fn primary(&self, stream: &mut Stream) -> Ray {
        match &self.camera {
            Some(camera) => {
                let (width, height) = camera.film_size;
                let raster = stream.next_vec2() * Vec2::new(width as f32, height as f32);
                let ray = camera.sensor.sample_ray(raster, stream.next_vec2());
                ray.to_ray()
            }
            None => {
                let origin = self.middle + 2.0 * self.radius * unit(stream);
                let target = self.middle + self.radius * number(stream) * unit(stream);
                toward(origin, target)
            }
        }
    }

    fn degenerate(&self, stream: &mut Stream) -> Ray {
        let spot = self.spot(stream);
        let corner = spot.corners.map_or(spot.point, |corners| corners[0]);
        let way = unit(stream);
        let plain = self.through(stream, spot.point, way);
        let length = (spot.point - plain.origin().as_dvec3()).length() as f32;
        match stream.next_u32() % 10 {
            0 => plain.between(length, length),
            1 => plain.between(length, 0.5 * length),
            2 => plain.between(0.0, 0.0),
            3 => Ray::new(plain.origin(), Vec3::ZERO),
            4 => {
                let tiny = 10.0_f64.powf(-6.0 - 30.0 * number(stream));
                let axis = DVec3::AXES[(stream.next_u32() % 3) as usize];
                self.through(stream, spot.point, axis + tiny * way)
            }
            5 => {
                let scale = 10.0_f32.powf(-6.0 + 12.0 * stream.next_f32());
                Ray::new(plain.origin(), plain.direction() * scale)
            }
            6 => Ray::new(spot.point.as_vec3(), way.as_vec3()),
            7 => Ray::new(corner.as_vec3(), way.as_vec3()),
            8 => {
                let within = spot.normal.cross(way).normalize_or(DVec3::X);
                self.through(stream, spot.point, within)
            }
            _ => {
                let next = spot.corners.map_or(spot.point + way, |corners| corners[1]);
                Ray::new(corner.as_vec3(), (next - corner).as_vec3())
            }
        }
    }

    /// A ray through a point, from anywhere before it within the size of the geometry.
    fn through(&self, stream: &mut Stream, point: DVec3, direction: DVec3) -> Ray {
        let away = self.radius * number(stream) / direction.length();
        Ray::new((point - away * direction).as_vec3(), direction.as_vec3())
    }

    /// A ray at a point from anywhere around the geometry, of unit length or up to the point.
    fn at(&self, stream: &mut Stream, target: DVec3) -> Ray {
        let origin = self.middle + 1.5 * self.radius * number(stream) * unit(stream);
        if stream.next_u32() % 2 == 0 {
            return toward(origin, target);
        }
        let origin = origin.as_vec3();
        Ray::new(origin, target.as_vec3() - origin)
    }

    /// A point of a primitive, each primitive as likely as any other.
    fn spot(&self, stream: &mut Stream) -> Spot {
        let high = u64::from(stream.next_u32()) << 32;
        let chosen = (high | u64::from(stream.next_u32())) % self.primitives;
        let after = self
            .targets
            .partition_point(|(before, _, _)| *before <= chosen);
        let (before, instance, geometry) = self.targets[after - 1];
        let id = Id {
            instance,
            geometry,
            primitive: (chosen - before) as u32,
        };
        let exact = self.subject.exact(id);
        let point = point_of(&exact, stream);
        let (normal, corners) = (exact.normal(point), corners_of(&exact));
        let Some(place) = instance.map(|instance| self.subject.place(instance)) else {
            return Spot {
                point,
                normal,
                corners,
            };
        };
        let placed = |p: DVec3| place.linear * p + place.origin;
        Spot {
            point: placed(point),
            normal: (place.inverse.transpose() * normal).normalize_or_zero(),
            corners: corners.map(|corners| corners.map(placed)),
        }
    }
}

impl Spot {
    /// Off the surface, to the side that a ray leaves to.
    fn off(&self, direction: Vec3) -> Vec3 {
        let extent = self.point.abs().max_element() as f32;
        let side = SurfacePoint::error_bound(extent);
        let normal = self.normal.as_vec3();
        self.point.as_vec3() + normal * side.copysign(normal.dot(direction))
    }
}

fn corners_of(exact: &Exact) -> Option<[DVec3; 3]> {
    match exact {
        Exact::Triangle(corners) => Some(*corners),
        _ => None,
    }
}

/// A point of a primitive, anywhere on it.
fn point_of(exact: &Exact, stream: &mut Stream) -> DVec3 {
    let uv = stream.next_vec2();
    match exact {
        Exact::Triangle(_) => {
            let place = warp::uniform_triangle(uv);
            exact.named([place.x, place.y].map(f64::from))
        }
        _ => exact.named([uv.x, uv.y].map(f64::from)),
    }
    .unwrap_or_else(|| {
        // Around the axis of a curve, or a sphere around its centre.
        let axis = exact.axis().map(|axis| axis.at(f64::from(uv.x)));
        let (centre, radius) = axis.unwrap_or_default();
        centre + radius * unit(stream)
    })
}

fn toward(origin: DVec3, target: DVec3) -> Ray {
    let direction = (target - origin).normalize_or(DVec3::X);
    Ray::new(origin.as_vec3(), direction.as_vec3())
}

fn number(stream: &mut Stream) -> f64 {
    f64::from(stream.next_f32())
}

fn sign(stream: &mut Stream) -> f64 {
    if stream.next_u32() % 2 == 0 {
        1.0
    } else {
        -1.0
    }
}

fn unit(stream: &mut Stream) -> DVec3 {
    warp::uniform_sphere(stream.next_vec2())
        .as_dvec3()
        .normalize()
}
