//! How two subpaths make paths: one function for each kind of technique.

use super::{Bidirection, Bidirectional, Connection, SubVertex};
use crate::accel::Ray;
use crate::bsdf::{BsdfModel, Transport};
use crate::emitter::EmitterModel;
use crate::math::{Local, Rgb, Vec2, Vec3};
use crate::path::{PathSpace, PathVertex};
use crate::scene::ChosenSample;

/// A path that exists if a ray is free.
pub(super) struct Made {
    pub(super) value: Rgb,
    pub(super) weight: f64,
    pub(super) ray: Ray,
}

/// What a surface does with light between a known direction and that of a connection.
pub(super) struct Turn {
    /// `f_s · |n_s · ω_l|`, radiance from the light's side scattered to the eye's.
    pub(super) value: Rgb,
    /// Density with which it sends the subpath that has met it into the connection, in 1/sr.
    forward: f64,
    /// Density with which it sends what comes along the connection back, in 1/sr.
    pub(super) backward: f64,
}

/// A world-space direction in the frame of a vertex; `None` where the material only reflects and it lies on
/// the other side.
#[inline]
fn before(vertex: &SubVertex<'_>, direction: Vec3) -> Option<Local> {
    let met = &vertex.met;
    let local = met.frame.to_local(direction);
    (met.lobes.transmission || met.wi.same_side(local)).then_some(local)
}

/// The finite lobes of a vertex of a subpath, towards a world-space direction; `None` where they are black.
#[inline]
pub(super) fn turn(
    space: &PathSpace<'_>,
    vertex: &SubVertex<'_>,
    direction: Vec3,
    transport: Transport,
) -> Option<Turn> {
    turn_to(
        space,
        vertex,
        before(vertex, direction)?,
        direction,
        transport,
    )
}

/// [`turn`], with the direction in both frames.
#[inline]
fn turn_to(
    space: &PathSpace<'_>,
    vertex: &SubVertex<'_>,
    other: Local,
    direction: Vec3,
    transport: Transport,
) -> Option<Turn> {
    let met = &vertex.met;
    if !space.strict_agrees(met, other, direction) {
        return None;
    }
    let ask = |wi: Local, wo: Local| {
        met.bsdf
            .eval_with_density(wi, wo, &met.point, Transport::Radiance)
    };
    // The value is that of radiance on either subpath: as path tracing would have it.
    let (value, forward, backward) = match transport {
        Transport::Radiance => {
            let (value, forward) = ask(met.wi, other);
            let black = value.is_black();
            let backward = || {
                met.bsdf
                    .density(other, met.wi, &met.point, Transport::Importance)
            };
            (value, forward, if black { forward } else { backward() })
        }
        Transport::Importance => {
            let (value, backward) = ask(other, met.wi);
            let black = value.is_black();
            let forward = || {
                met.bsdf
                    .density(met.wi, other, &met.point, Transport::Importance)
            };
            (value, if black { backward } else { forward() }, backward)
        }
    };
    (!value.is_black()).then(|| Turn {
        value,
        forward: f64::from(forward.0),
        backward: f64::from(backward.0),
    })
}

/// Size of the cosine between a direction and the geometric normal.
#[inline]
pub(super) fn geometric_cos(vertex: &SubVertex<'_>, direction: Vec3) -> f64 {
    f64::from(vertex.met.point.geometric_normal.dot(direction).abs())
}

impl Bidirectional {
    /// Eye subpaths that end at points sampled on lights: one light vertex.
    pub(super) fn sample_lights(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'_>,
        raster: Vec2,
    ) {
        let most = (self.max_depth as usize).saturating_sub(1);
        for eye in 1..=sample.eye.vertices.len().min(most) {
            self.sample_light(space, sample, eye, raster);
        }
    }

    /// The path from a vertex of the eye subpath to a point sampled on a light.
    ///
    /// - `eye`: number of the vertex, from one.
    pub(super) fn sample_light(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'_>,
        eye: usize,
        raster: Vec2,
    ) {
        let (lights, vertex) = (space.scene.lights(), &sample.eye.vertices[eye - 1]);
        if !vertex.met.lobes.finite {
            return;
        }
        let from = vertex.met.point.position;
        let chosen = if self.techniques.sample_direct {
            lights.sample_toward(from, vertex.u_light)
        } else {
            let start = sample.light.start.as_ref();
            start.and_then(|start| lights.as_sample(start, from))
        };
        let made = chosen.and_then(|chosen| {
            let made = self.sampled_light(space, vertex, &chosen)?;
            Some((chosen, made))
        });
        if let Some((chosen, made)) = made {
            let class = lights.get(chosen.emitter).class();
            let end = PathVertex::sampled_light(&chosen.sample, chosen.emitter, class);
            sample.ends[eye - 1] = Some(end);
            sample.propose((eye, 1), raster, made);
        }
    }

    /// The path from an eye subpath's vertex to a sampled point of a light.
    fn sampled_light(
        &self,
        space: &PathSpace<'_>,
        vertex: &SubVertex<'_>,
        chosen: &ChosenSample,
    ) -> Option<Made> {
        let (sample, lights) = (&chosen.sample, space.scene.lights());
        let turn = turn(space, vertex, sample.direction, Transport::Radiance)?;
        let density = f64::from(sample.density.0);
        let at = sample.surface.as_ref();
        let emission = lights.emission_density(chosen.emitter, at, -sample.direction);
        // With the densities of the light's vertex as they are for solid angles.
        let per_area = match (at, sample.target) {
            (Some(at), _) => 1.0 / f64::from(at.geometric_normal.dot(sample.direction).abs()),
            (None, Some(target)) => {
                1.0 / f64::from(target.distance_squared(vertex.met.point.position))
            }
            (None, None) => 1.0,
        };
        let emitted = f64::from(lights.emission_probability(chosen.emitter))
            * f64::from(emission.point.0)
            * f64::from(emission.direction.0)
            * geometric_cos(vertex, sample.direction)
            * per_area;
        let weighing = self.weighing;
        let longer = if sample.is_dirac {
            0.0
        } else {
            weighing.raise(turn.forward / density)
        };
        let shorter = weighing.raise(emitted / density)
            * vertex.backlog.at_connection(weighing, turn.backward);
        Some(Made {
            value: vertex.throughput * turn.value * sample.radiance * (1.0 / sample.density.0),
            weight: weighing.weight(shorter, longer),
            ray: match sample.target {
                Some(target) => vertex.met.point.ray_to(target),
                None => vertex.met.point.ray_toward(sample.direction),
            },
        })
    }

    /// Connections of two vertices that both lie on surfaces: two light vertices or more.
    pub(super) fn join_subpaths(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'_>,
        raster: Vec2,
    ) {
        for eye in 1..=sample.eye.vertices.len() {
            if !sample.eye.vertices[eye - 1].met.lobes.finite {
                continue;
            }
            // The light's own vertex comes before those of its subpath.
            let most = (self.max_depth as usize).saturating_sub(eye);
            for light in 2..=(sample.light.vertices.len() + 1).min(most) {
                self.join_pair(space, sample, (eye, light), raster);
            }
        }
    }

    /// The connection of two vertices, by their numbers as in [`Connection`].
    #[inline]
    pub(super) fn join_pair(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'_>,
        (eye, light): (usize, usize),
        raster: Vec2,
    ) {
        let (eye_vertices, light_vertices) = (&sample.eye.vertices, &sample.light.vertices);
        let pair = (&eye_vertices[eye - 1], &light_vertices[light - 2]);
        if !pair.0.met.lobes.finite || !pair.1.met.lobes.finite {
            return;
        }
        if let Some(made) = self.join(space, pair) {
            sample.propose((eye, light), raster, made);
        }
    }

    /// The connection of a vertex of the eye subpath with one of the light subpath.
    #[inline]
    fn join(
        &self,
        space: &PathSpace<'_>,
        (eye, light): (&SubVertex<'_>, &SubVertex<'_>),
    ) -> Option<Made> {
        let edge = light.met.point.position - eye.met.point.position;
        let distance_squared = edge.length_squared();
        let direction = edge * (1.0 / distance_squared.sqrt());
        if !direction.is_finite() {
            return None;
        }
        // Before anything that costs more: about half of all pairs see each other's backs.
        let (to_light, to_eye) = (before(eye, direction)?, before(light, -direction)?);
        let at_eye = turn_to(space, eye, to_light, direction, Transport::Radiance)?;
        let at_light = turn_to(space, light, to_eye, -direction, Transport::Importance)?;
        let distance_squared = f64::from(distance_squared);
        let eye_per_area = geometric_cos(eye, direction) / distance_squared;
        let light_per_area = geometric_cos(light, direction) / distance_squared;
        let weighing = self.weighing;
        let shorter = weighing.raise(at_light.forward * eye_per_area)
            * eye.backlog.at_connection(weighing, at_eye.backward);
        let longer = weighing.raise(at_eye.forward * light_per_area)
            * light.backlog.at_connection(weighing, at_light.backward);
        let geometry = light_per_area / geometric_cos(light, light.met.back);
        let value = eye.throughput * at_eye.value * (light.throughput * at_light.value);
        let target = light.met.point.ray_origin(-direction);
        Some(Made {
            value: value * geometry as f32,
            weight: weighing.weight(shorter, longer),
            ray: eye.met.point.ray_to(target),
        })
    }
}

impl Bidirection<'_> {
    /// Adds a path that exists if a ray is free.
    ///
    /// - `eye`, `light`: numbers of its vertices, as in [`Connection`].
    #[inline]
    pub(super) fn propose(&mut self, (eye, light): (usize, usize), raster: Vec2, made: Made) {
        // Written so that a weight that is no number is handed on, and counted.
        if made.weight <= 0.0 {
            return;
        }
        self.candidates.push(Connection {
            eye,
            light,
            raster,
            value: made.value,
            weight: made.weight as f32,
        });
        self.rays.push(made.ray);
    }
}
