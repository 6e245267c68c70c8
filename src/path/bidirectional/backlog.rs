//! The backlogs of the vertices of subpaths.

use super::subpath::Flight;
use super::weighing::Backlog;
use super::{Bidirectional, LightImage};
use crate::emitter::{EmitterClass, EmitterModel};
use crate::math::Vec2;
use crate::path::{PathSpace, PathVertex};
use crate::scene::{ChosenRay, Interaction};

impl Bidirectional {
    /// The backlog of the first vertex beyond the lens: of the techniques before it there is the one that
    /// connects a light subpath to the lens.
    pub(super) fn first_backlog(
        &self,
        space: &PathSpace<'_>,
        raster: Vec2,
        (lens, vertex): (&PathVertex, &PathVertex),
        image: &LightImage,
    ) -> Backlog {
        if !(self.techniques.light_image && image.shows(space.sensor, raster)) {
            return Backlog::default();
        }
        let made = space.pixels_around(lens, vertex);
        let ratio = made
            .filter(|made| *made > 0.0)
            .map_or(0.0, |made| image.paths / made);
        Backlog {
            base: self.weighing.raise(ratio),
            slope: 0.0,
        }
    }

    /// The backlog of a vertex that a ray has met.
    pub(super) fn arrive(&self, flight: &Flight, met: &Interaction<'_>) -> Backlog {
        let distance_squared = f64::from(met.distance).powi(2);
        let cos = f64::from(met.point.geometric_normal.dot(met.back).abs());
        let (departure, backlog) = (&flight.departure, flight.backlog);
        backlog.after(
            self.weighing,
            departure,
            cos / distance_squared,
            distance_squared,
        )
    }

    /// The backlog of the first vertex that light meets: of the techniques before it there are the one that
    /// samples the light from here, and the one that meets it by chance.
    pub(super) fn first_light_backlog(
        &self,
        space: &PathSpace<'_>,
        start: &ChosenRay,
        met: &Interaction<'_>,
    ) -> Backlog {
        let (ray, id) = (&start.ray, start.emitter);
        let lights = space.scene.lights();
        let class = lights.get(id).class();
        if !class.is_connectable() {
            return Backlog::default();
        }
        let from = met.point.position;
        let cos = f64::from(met.point.geometric_normal.dot(met.back).abs());
        let distance_squared = f64::from(met.distance).powi(2);
        // Densities of the light's vertex, and of this one as the light makes it.
        let probability = f64::from(start.probability);
        let point = f64::from(ray.density.point.0);
        let direction = f64::from(ray.density.direction.0);
        let (own, made, per_area) = match class {
            EmitterClass::Area | EmitterClass::Point | EmitterClass::Collimated => {
                let light_cos = ray.surface.map_or(1.0, |at| {
                    f64::from(at.geometric_normal.dot(ray.direction).abs())
                });
                let made = direction * cos / distance_squared;
                (probability * point, made, light_cos / distance_squared)
            }
            EmitterClass::Directional | EmitterClass::Environment => {
                (probability * direction, point * cos, 1.0)
            }
        };
        let direct = if self.techniques.sample_direct {
            let density = match (class, &ray.surface) {
                (EmitterClass::Area, Some(at)) => {
                    f64::from(lights.density_toward(id, from, at).0) * per_area
                }
                (EmitterClass::Environment, _) => {
                    f64::from(lights.environment_density(from, -ray.direction).0)
                }
                _ => f64::from(lights.probability(id, from)),
            };
            density / own
        } else {
            1.0
        };
        let met_by_chance = if class.is_dirac() { 0.0 } else { 1.0 / own };
        Backlog {
            base: self.weighing.raise(direct / made),
            slope: self.weighing.raise(per_area * met_by_chance / made),
        }
    }
}
