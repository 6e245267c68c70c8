//! What light subpaths show on the film: no eye vertex.

use super::connect::{Made, geometric_cos, turn};
use super::{Bidirection, Bidirectional, LightImage, SubVertex};
use crate::bsdf::Transport;
use crate::emitter::EmitterModel;
use crate::math::Vec2;
use crate::path::{Event, PathSpace, PathVertex};

impl Bidirectional {
    /// Connections of the light subpath with the lens: no eye vertex.
    pub(super) fn see_light(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'_>,
        image: &LightImage,
    ) {
        if !self.techniques.light_image || self.max_depth == 0 {
            return;
        }
        for light in 1..=sample.light.vertices.len() + 1 {
            self.see(space, sample, light, image);
        }
    }

    /// The connection of one vertex of the light subpath with the lens.
    ///
    /// - `light`: its number as in [`Connection`](super::Connection).
    pub(super) fn see(
        &self,
        space: &PathSpace<'_>,
        sample: &mut Bidirection<'_>,
        light: usize,
        image: &LightImage,
    ) {
        let made = if light == 1 {
            self.see_emitter(space, sample, image)
        } else {
            let vertex = &sample.light.vertices[light - 2];
            let is_hidden = space.rules.hide_emitters && vertex.met.emitter.is_some();
            if is_hidden || !vertex.met.lobes.finite {
                return;
            }
            self.see_vertex(space, vertex, &sample.light_lens, image)
        };
        if let Some((raster, made)) = made {
            sample.propose((0, light), raster, made);
        }
    }

    /// The path from the lens to where the light subpath begins; none to lights without extent.
    fn see_emitter(
        &self,
        space: &PathSpace<'_>,
        sample: &Bidirection<'_>,
        image: &LightImage,
    ) -> Option<(Vec2, Made)> {
        let start = sample.light.start.as_ref()?;
        let class = space.scene.lights().get(start.emitter).class();
        if class.is_dirac() || space.rules.hide_emitters {
            return None;
        }
        let density = match start.ray.surface {
            Some(_) => start.ray.density.point.0,
            None => start.ray.density.direction.0,
        };
        let vertex = PathVertex::emitted_from(&start.ray, start.emitter, class);
        let lens = space.lens_before(&vertex, &sample.light_lens);
        let pixels = space.pixels_around(&lens, &vertex)?;
        let (to_vertex, _) = space.edge(&lens, &vertex)?;
        let radiance = space.emission(&vertex, -to_vertex);
        if radiance.is_black() {
            return None;
        }
        let sight = space.sight(&vertex, &lens);
        let (raster, ray) = sight.filter(|(raster, _)| image.contains(*raster))?;
        let ratio = pixels / (image.paths * f64::from(start.probability * density));
        let longer = self.weighing.raise(ratio);
        let made = Made {
            value: radiance * ratio as f32,
            weight: self.weighing.weight(0.0, longer),
            ray,
        };
        Some((raster, made))
    }

    /// The path from the lens to a vertex of the light subpath.
    fn see_vertex(
        &self,
        space: &PathSpace<'_>,
        vertex: &SubVertex<'_>,
        lens: &PathVertex,
        image: &LightImage,
    ) -> Option<(Vec2, Made)> {
        let point = PathVertex::surface(&vertex.met, Event::Finite);
        let lens = space.lens_before(&point, lens);
        let (direction, _) = space.edge(&lens, &point)?;
        let sight = space.sight(&point, &lens);
        let (raster, ray) = sight.filter(|(raster, _)| image.contains(*raster))?;
        let turn = turn(space, vertex, -direction, Transport::Importance)?;
        let pixels = space.pixels_around(&lens, &point)?;
        let weighing = self.weighing;
        let longer = weighing.raise(pixels / image.paths)
            * vertex.backlog.at_connection(weighing, turn.backward);
        let geometry = pixels / (image.paths * geometric_cos(vertex, vertex.met.back));
        let made = Made {
            value: vertex.throughput * turn.value * geometry as f32,
            weight: weighing.weight(0.0, longer),
            ray,
        };
        Some((raster, made))
    }
}
