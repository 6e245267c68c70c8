//! Densities of vertices that are made one from another, on either side.

use super::{Event, Path, PathSpace, VertexKind};
use crate::bsdf::{BsdfModel, Transport};
use crate::emitter::EmitterClass;
use crate::sensor::SensorModel;

impl PathSpace<'_> {
    /// Density with which the direction from a vertex to the next one is sampled, coming from the eye: in
    /// 1/sr; the probability of its Dirac component.
    #[inline]
    pub fn forward_density(&self, path: &Path, index: usize) -> Option<f64> {
        self.scattering_density(path, index)
    }

    /// Density with which the direction from a vertex to the one before is sampled, coming from the light:
    /// in 1/sr; the probability of its Dirac component.
    pub fn backward_density(&self, path: &Path, index: usize) -> Option<f64> {
        let vertices = path.vertices();
        let vertex = &vertices[index];
        let (to_eye, _) = self.edge(vertex, &vertices[index - 1])?;
        let (to_light, _) = self.edge(vertex, vertices.get(index + 1)?)?;
        let frame = vertex.point.shading_frame();
        let wi = frame.to_local(to_light);
        if vertex.event.is_dirac() {
            let found = self.dirac(vertex, vertex.event, wi, Transport::Importance)?;
            return Some(f64::from(found.probability));
        }
        let density = self.bsdf(vertex)?.density(
            wi,
            frame.to_local(to_eye),
            &vertex.point,
            Transport::Importance,
        );
        Some(f64::from(density.0))
    }

    /// Factor of a vertex's value where light is followed from the light on:
    /// `|n_g · ω_e| / |n_g · ω_l|`, for Dirac events times what solid angles shrink by.
    pub fn backward_factor(&self, path: &Path, index: usize) -> Option<f64> {
        let vertices = path.vertices();
        let vertex = &vertices[index];
        if vertex.event.is_dirac() {
            return Some(f64::from(vertex.adjoint));
        }
        let (to_eye, _) = self.edge(vertex, &vertices[index - 1])?;
        Some(f64::from(vertex.geometric_cos(to_eye)) / self.light_cosine(path, index)?)
    }

    /// Size of the cosine between the direction from a vertex to the next one and the geometric normal.
    pub fn light_cosine(&self, path: &Path, index: usize) -> Option<f64> {
        let vertices = path.vertices();
        let (to_light, _) = self.edge(&vertices[index], vertices.get(index + 1)?)?;
        Some(f64::from(vertices[index].geometric_cos(to_light)))
    }

    /// Density with which the last vertex of a path is sampled as a point of a light that the vertex before
    /// asks for: in 1/m², or 1/sr for an environment.
    pub fn explicit_density(&self, path: &Path) -> Option<f64> {
        let (vertices, last) = (path.vertices(), path.edges());
        self.light_density(vertices.get(last.checked_sub(1)?)?, &vertices[last])
    }

    /// Density with which a ray of light is sampled that makes the last edge of a path, over the cosine at
    /// the light.
    pub fn emission_density(&self, path: &Path) -> Option<f64> {
        let (vertices, last) = (path.vertices(), path.edges());
        let light = &vertices[last];
        let (id, lights) = (light.emitter()?, self.scene.lights());
        let (direction, at) = match light.kind {
            VertexKind::Infinity => (-light.position(), None),
            kind => {
                let (direction, _) = self.edge(light, &vertices[last - 1])?;
                (
                    direction,
                    (kind == VertexKind::Surface).then_some(&light.point),
                )
            }
        };
        let density = lights.emission_density(id, at, direction);
        let both = f64::from(density.point.0) * f64::from(density.direction.0);
        let cos = f64::from(light.geometric_cos(direction));
        Some(f64::from(lights.emission_probability(id)) * both / cos)
    }

    /// Whether a vertex ends a path that rays can find by chance.
    #[inline]
    pub fn can_be_met(&self, path: &Path) -> bool {
        let last = path.vertices().last().map(|light| light.event);
        matches!(
            last,
            Some(Event::Emission(
                EmitterClass::Area | EmitterClass::Environment
            ))
        )
    }

    /// Where the lens is, for a path from there to a vertex: one point, except where rays are parallel.
    #[inline]
    pub fn lens_for(&self, path: &mut Path, vertex: &super::PathVertex) {
        let lens = &mut path.vertices_mut()[0];
        lens.point.position = self.sensor.lens_before(vertex.position(), lens.position());
    }
}
