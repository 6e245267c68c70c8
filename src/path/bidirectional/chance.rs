//! Eye subpaths that meet lights by chance: no light vertex.

use super::connect::geometric_cos;
use super::{Backlog, Bidirection, Bidirectional, Connection, Escape, EyeSubpath, SubVertex};
use crate::emitter::EmitterModel;
use crate::math::{Rgb, Vec2, Vec3};
use crate::path::PathSpace;

impl Bidirectional {
    /// All paths of an eye subpath that meets lights.
    pub(super) fn meet_lights<'s>(
        &self,
        space: &PathSpace<'_>,
        sample: &Bidirection<'s>,
        raster: Vec2,
        found: &mut impl FnMut(&Bidirection<'s>, &Connection),
    ) {
        for eye in 1..=sample.eye.vertices.len() + 1 {
            if let Some(connection) = self.meet_light(space, &sample.eye, eye, raster) {
                found(sample, &connection);
            }
        }
    }

    /// The path of an eye subpath that meets a light by chance with one of its vertices; the last is the one
    /// where it leaves the scene.
    ///
    /// - `eye`: number of its vertices up to there.
    pub(super) fn meet_light(
        &self,
        space: &PathSpace<'_>,
        subpath: &EyeSubpath<'_>,
        eye: usize,
        raster: Vec2,
    ) -> Option<Connection> {
        let vertices = &subpath.vertices;
        let before = eye.checked_sub(2).and_then(|index| vertices.get(index));
        let before = before.map(|vertex| vertex.met.point.position);
        let (value, shorter) = match vertices.get(eye - 1) {
            Some(vertex) => self.meet_surface(space, vertex, before)?,
            None if eye == vertices.len() + 1 => {
                self.meet_environment(space, subpath.escape.as_ref()?, before)?
            }
            None => return None,
        };
        let weight = self.weighing.weight(shorter, 0.0) as f32;
        (weight > 0.0).then_some(Connection {
            eye,
            light: 0,
            raster,
            value,
            weight,
        })
    }

    /// Value of a path that ends at a surface that glows, and the raised densities of the techniques with
    /// shorter eye subpaths over its own.
    ///
    /// - `before`: the vertex before; `None` where that is the lens.
    fn meet_surface(
        &self,
        space: &PathSpace<'_>,
        vertex: &SubVertex<'_>,
        before: Option<Vec3>,
    ) -> Option<(Rgb, f64)> {
        let (id, lights) = (vertex.met.emitter?, space.scene.lights());
        let (point, back) = (&vertex.met.point, vertex.met.back);
        let radiance = lights.get(id).radiance(point, back);
        if radiance.is_black() {
            return None;
        }
        let per_area = geometric_cos(vertex, back) / f64::from(vertex.met.distance).powi(2);
        let direct = |from| f64::from(lights.density_toward(id, from, point).0) * per_area;
        let emission = lights.emission_density(id, Some(point), back);
        let own = f64::from(lights.emission_probability(id) * emission.point.0);
        let onward = f64::from(emission.direction.0);
        let shorter = self.before_light(vertex.backlog, before.map(direct), own, onward);
        Some((vertex.throughput * radiance, shorter))
    }

    /// As [`Bidirectional::meet_surface`] for a path that leaves the scene.
    fn meet_environment(
        &self,
        space: &PathSpace<'_>,
        escape: &Escape,
        before: Option<Vec3>,
    ) -> Option<(Rgb, f64)> {
        let (lights, toward) = (space.scene.lights(), escape.toward);
        let id = lights.environment()?;
        let radiance = lights.environment_radiance(toward);
        if radiance.is_black() {
            return None;
        }
        let direct = |from| f64::from(lights.environment_density(from, toward).0);
        let emission = lights.emission_density(id, None, -toward);
        let own = f64::from(lights.emission_probability(id) * emission.direction.0);
        let onward = f64::from(emission.point.0);
        let shorter = self.before_light(escape.backlog, before.map(direct), own, onward);
        Some((escape.throughput * radiance, shorter))
    }

    /// Raised densities of all techniques but the one that meets a light by chance, over its own.
    ///
    /// - `direct`: density with which the light's vertex is sampled from the vertex before; `None` where that
    ///   is the lens.
    /// - `own`: density with which light subpaths begin at the light's vertex.
    /// - `onward`: density with which they go on from there.
    fn before_light(&self, backlog: Backlog, direct: Option<f64>, own: f64, onward: f64) -> f64 {
        let weighing = self.weighing;
        let Some(direct) = direct else {
            return weighing.raise(own) * backlog.base;
        };
        let direct = if self.techniques.sample_direct {
            direct
        } else {
            own
        };
        weighing.join(
            weighing.raise(direct) * backlog.base,
            weighing.raise(own * onward) * backlog.slope,
        )
    }
}
