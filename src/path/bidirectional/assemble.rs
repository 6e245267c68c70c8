//! Paths of two subpaths, written out as one.

use super::{Bidirection, Connection};
use crate::emitter::{EmitterClass, EmitterModel};
use crate::path::{Event, Path, PathSpace, PathVertex};

impl Bidirection<'_> {
    /// Writes a path that this sample has made vertex by vertex; false for one that is too long.
    pub fn assemble(
        &self,
        space: &PathSpace<'_>,
        connection: &Connection,
        path: &mut Path,
    ) -> bool {
        let mut fits = true;
        let mut push = |path: &mut Path, vertex| fits = path.push(vertex) && fits;
        let (eye, light) = (connection.eye, connection.light);
        path.start(self.lens.position(), connection.raster);
        let met = self.eye.vertices.iter().take(eye).enumerate();
        for (index, vertex) in met {
            // The last one is connected, unless it is a light itself.
            let event = match (index + 1 == eye, light) {
                (true, 0) => Event::Emission(EmitterClass::Area),
                (true, _) => Event::Finite,
                _ => vertex.event,
            };
            push(path, PathVertex::surface(&vertex.met, event));
        }
        let escape = self.eye.escape.filter(|_| eye > self.eye.vertices.len());
        if let (Some(escape), Some(id)) = (escape, space.scene.lights().environment()) {
            let radiance = space.scene.lights().environment_radiance(escape.toward);
            push(path, PathVertex::environment(escape.toward, radiance, id));
        }
        for index in (0..light.saturating_sub(1)).rev() {
            let vertex = &self.light.vertices[index];
            let event = if index + 2 == light {
                Event::Finite
            } else {
                vertex.event
            };
            push(path, PathVertex::surface(&vertex.met, event));
        }
        let end = match (eye, light) {
            (_, 0) => None,
            (1.., 1) => self.ends[eye - 1],
            _ => self.light.first(space),
        };
        if let Some(end) = end {
            push(path, end);
        }
        if eye == 0 && path.edges() > 0 {
            let lens = space.lens_before(&path.vertices()[1], &self.light_lens);
            path.vertices_mut()[0] = lens;
        }
        fits && set_values(space, path)
    }
}

impl super::LightSubpath<'_> {
    /// The vertex on the light.
    pub(super) fn first(&self, space: &PathSpace<'_>) -> Option<PathVertex> {
        let start = self.start.as_ref()?;
        Some(PathVertex::emitted_from(
            &start.ray,
            start.emitter,
            space.scene.lights().get(start.emitter).class(),
        ))
    }
}

/// Finds what each vertex contributes; false where one contributes nothing.
fn set_values(space: &PathSpace<'_>, path: &mut Path) -> bool {
    let last = path.edges();
    for index in 1..last {
        let vertices = path.vertices();
        let vertex = vertices[index];
        let to_eye = space.edge(&vertex, &vertices[index - 1]);
        let to_light = space.edge(&vertex, &vertices[index + 1]);
        let (Some((to_eye, _)), Some((to_light, _))) = (to_eye, to_light) else {
            return false;
        };
        let (value, adjoint) = if vertex.event.is_dirac() {
            let Some(followed) = space.follow(&vertex, vertex.event, to_eye) else {
                return false;
            };
            (followed.value, followed.adjoint)
        } else {
            (space.finite_value(&vertex, to_eye, to_light), 1.0)
        };
        let vertex = &mut path.vertices_mut()[index];
        (vertex.value, vertex.adjoint) = (value, adjoint);
    }
    let (light, before) = (path.vertices()[last], path.vertices()[last - 1]);
    // The edge of a vertex at infinity has no other end.
    let to_eye = space.edge(&before, &light).map(|(direction, _)| -direction);
    let Some(to_eye) = to_eye else { return false };
    path.vertices_mut()[last].value = space.emission(&light, to_eye);
    path.vertices()[1..].iter().all(|v| !v.value.is_black())
}
