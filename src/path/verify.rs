//! Checks a path from scratch.

use std::fmt;

use super::{Event, Path, PathSpace, PathVertex, VertexKind};
use crate::emitter::EmitterClass;
use crate::math::{Frame, Rgb, Vec2, Vec3};
use crate::sensor::{Sensor, SensorModel};

/// How far a direction is turned by its own rounding, in radians.
const DIRECTION_ROUNDING: f32 = 4.0 * f32::EPSILON;

/// A claim that a path makes about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// It begins at the sensor, ends at a light, and scatters at surfaces in between.
    Shape,
    /// Its first vertex is on the lens.
    OnLens,
    /// It is seen where it says.
    Raster,
    /// Nothing stands between two vertices.
    Visibility,
    /// A Dirac vertex sends light to the next vertex.
    Direction,
    /// What a vertex contributes.
    Value,
    /// The factor between the two ways of following a Dirac vertex.
    Adjoint,
    /// What the light sends.
    Emission,
}

/// A claim that does not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Broken {
    /// What was claimed.
    pub claim: Claim,
    /// Index of the vertex that it is about.
    pub vertex: usize,
    /// By how much it fails, in units of what is tolerated.
    pub excess: f32,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            claim,
            vertex,
            excess,
        } = self;
        write!(
            f,
            "{claim:?} at vertex {vertex}: {excess} times the tolerance"
        )
    }
}

/// How far a path may be from what is computed anew: positions were rounded, and directions between
/// them are not quite those in which they were found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Distance on the image in pixels.
    pub raster: f32,
    /// Angle between a Dirac vertex's ray and the edge to the next, times the cosine of that edge: near
    /// total reflection a little changes much. What positions may be off by comes on top.
    pub direction: f32,
    /// Relative difference of values, against their largest channel. What an error of the
    /// directions makes of them comes on top.
    pub value: f32,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self {
            raster: 0.01,
            direction: 2e-5,
            value: 1e-2,
        }
    }
}

/// A claim with the vertex that it is about, and how far it is off in units of the tolerance.
type Finding = (Claim, usize, f32);

impl Path {
    /// Recomputes everything that the path says about itself.
    ///
    /// # Errors
    /// The claim that is farthest off, where one is off by more than is tolerated.
    pub fn verify(&self, space: &PathSpace<'_>, tolerance: &Tolerance) -> Result<(), Broken> {
        let findings = self.findings(space, tolerance);
        let worst = findings.into_iter().max_by(|a, b| a.2.total_cmp(&b.2));
        match worst {
            Some((claim, vertex, excess)) if excess.is_nan() || excess > 1.0 => Err(Broken {
                claim,
                vertex,
                excess,
            }),
            _ => Ok(()),
        }
    }

    fn findings(&self, space: &PathSpace<'_>, tolerance: &Tolerance) -> Vec<Finding> {
        let mut findings = Vec::new();
        if let Some(vertex) = self.misshapen() {
            return vec![(Claim::Shape, vertex, f32::INFINITY)];
        }
        self.check_lens(space, tolerance, &mut findings);
        let vertices = self.vertices();
        for index in 1..self.edges() {
            if !space.is_visible(&vertices[index], &vertices[index + 1]) {
                findings.push((Claim::Visibility, index, f32::INFINITY));
            }
            self.check_scattering(space, tolerance, index, &mut findings);
        }
        self.check_light(space, tolerance, &mut findings);
        findings
    }

    /// Index of a vertex that cannot be where it is.
    fn misshapen(&self) -> Option<usize> {
        let vertices = self.vertices();
        let is_right = |(index, vertex): (usize, &PathVertex)| match vertex.event {
            Event::Measurement => index == 0 && vertex.kind == VertexKind::Sensor,
            Event::Emission(class) => {
                let kind = match class {
                    EmitterClass::Area => VertexKind::Surface,
                    EmitterClass::Point | EmitterClass::Collimated => VertexKind::Point,
                    EmitterClass::Directional | EmitterClass::Environment => VertexKind::Infinity,
                };
                index > 0 && index + 1 == vertices.len() && vertex.kind == kind
            }
            _ => index > 0 && index + 1 < vertices.len() && vertex.kind == VertexKind::Surface,
        };
        if vertices.len() < 2 {
            return Some(0);
        }
        vertices.iter().enumerate().position(|each| !is_right(each))
    }

    fn check_lens(&self, space: &PathSpace<'_>, tolerance: &Tolerance, to: &mut Vec<Finding>) {
        let (lens, first) = (&self.vertices()[0], &self.vertices()[1]);
        let sensor = space.sensor;
        let is_on_lens = sensor.is_on_lens(lens.position());
        let seen = match first.kind {
            VertexKind::Infinity => sensor.raster_at(lens.position(), first.position()),
            _ => space.seen_at(first, lens),
        };
        to.push((
            Claim::OnLens,
            0,
            if is_on_lens { 0.0 } else { f32::INFINITY },
        ));
        to.push(match seen {
            Some(raster) => {
                let off = raster_distance(sensor, raster, self.raster());
                let allowed = tolerance.raster + self.raster_error(space, raster);
                (Claim::Raster, 0, off / allowed)
            }
            None => (Claim::Visibility, 0, f32::INFINITY),
        });
    }

    /// How far the first vertex's raster position may be off, since directions are, in pixels: near the
    /// poles of a spherical sensor a little turns it far.
    ///
    /// - `seen`: that position.
    fn raster_error(&self, space: &PathSpace<'_>, seen: Vec2) -> f32 {
        let vertices = self.vertices();
        let Some((direction, _)) = space.edge(&vertices[0], &vertices[1]) else {
            return 0.0;
        };
        let turned = DIRECTION_ROUNDING + direction_error(&vertices[..2]);
        let frame = Frame::around(direction);
        let off = [frame.tangent, frame.bitangent].map(|way| {
            let direction = (direction + way * turned).normalize();
            let raster = space.sensor.raster_at(vertices[0].position(), direction);
            raster.map_or(0.0, |raster| raster_distance(space.sensor, raster, seen))
        });
        off[0].max(off[1])
    }

    fn check_scattering(
        &self,
        space: &PathSpace<'_>,
        tolerance: &Tolerance,
        index: usize,
        to: &mut Vec<Finding>,
    ) {
        let vertices = self.vertices();
        let vertex = &vertices[index];
        let edge = |other: usize| space.edge(vertex, &vertices[other]);
        let (Some((to_eye, _)), Some((to_light, _))) = (edge(index - 1), edge(index + 1)) else {
            return to.push((Claim::Shape, index, f32::INFINITY));
        };
        let angle = tolerance.direction + direction_error(&vertices[index - 1..=index + 1]);
        let cosines = [to_light, to_eye].map(|way| vertex.geometric_cos(way));
        if !vertex.event.is_dirac() {
            let value = space.finite_value(vertex, to_eye, to_light);
            let allowed = tolerance.value + angle / cosines[0].min(cosines[1]);
            let off = difference(value, vertex.value) / allowed;
            return to.push((Claim::Value, index, off));
        }
        match space.follow(vertex, vertex.event, to_eye) {
            Some(followed) => {
                let off = followed.direction.distance(to_light) * cosines[0] / angle;
                to.push((Claim::Direction, index, off));
                let allowed = tolerance.value + angle / cosines[0].min(cosines[1]).powi(2);
                let off = difference(followed.value, vertex.value) / allowed;
                to.push((Claim::Value, index, off));
                let off = (followed.adjoint / vertex.adjoint - 1.0).abs() / allowed;
                to.push((Claim::Adjoint, index, off));
            }
            None => to.push((Claim::Direction, index, f32::INFINITY)),
        }
    }

    fn check_light(&self, space: &PathSpace<'_>, tolerance: &Tolerance, to: &mut Vec<Finding>) {
        let (vertices, last) = (self.vertices(), self.edges());
        let light = &vertices[last];
        let to_eye = match light.kind {
            VertexKind::Infinity => Vec3::ZERO,
            _ => match space.edge(light, &vertices[last - 1]) {
                Some((direction, _)) => direction,
                None => return to.push((Claim::Shape, last, f32::INFINITY)),
            },
        };
        let emission = space.emission(light, to_eye);
        let off = difference(emission, light.value) / tolerance.value;
        to.push((Claim::Emission, last, off));
    }
}

/// How far the directions between neighbours may be off, since their positions are, in radians.
fn direction_error(neighbours: &[PathVertex]) -> f32 {
    // Rays start off the surface by the error, and end within it.
    let error = 4.0 * neighbours.iter().map(|v| v.point.error).fold(0.0, f32::max);
    let length = |pair: &[PathVertex]| match pair[1].kind {
        VertexKind::Infinity => f32::INFINITY,
        _ => pair[0].position().distance(pair[1].position()),
    };
    error
        / neighbours
            .windows(2)
            .map(length)
            .fold(f32::INFINITY, f32::min)
}

/// Distance of two raster positions in pixels; across the sides of the film where they meet.
fn raster_distance(sensor: &Sensor, a: Vec2, b: Vec2) -> f32 {
    let mut apart = (a - b).abs();
    if let Some(film) = sensor.raster_range() {
        apart.x = apart.x.min((film.x - apart.x).abs());
    }
    apart.length()
}

/// Difference of two colours, against the largest channel.
fn difference(a: Rgb, b: Rgb) -> f32 {
    let largest = a.max_channel().max(b.max_channel());
    (a.0 - b.0).abs().max_element() / largest
}
