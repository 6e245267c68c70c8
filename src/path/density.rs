//! The density of a path among those of the path tracer, and its change under a mutation.
//!
//! Two forms of the same thing, each the other's test. The *rules form* follows the sampler: the
//! estimate `X_f = f / p` as the tracer makes it, times the density `p` in the coordinates in which a
//! mutation moves the path. The *measure form* knows no sampler: the measurement contribution in
//! area-product measure. Chains use neither, but the target of
//! [`Mutate`](../mutation/trait.Mutate.html), in which most factors have cancelled.

use std::ops::Range;

use glam::DVec3;

use super::{Event, Path, PathSpace, PathVertex, VertexKind, luminance};
use crate::bsdf::{BsdfModel, DiracEvent, Transport};
use crate::emitter::EmitterClass;
use crate::math::Vec3;
use crate::sensor::SensorModel;

/// How the path tracer comes to the last vertex of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// A scattered ray meets the light.
    Implicit,
    /// A point of the light is sampled and connected.
    Explicit,
}

/// How the path tracer makes a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Generation {
    /// How it comes to the last vertex.
    pub technique: Technique,
    /// As [`PathTracing::rr_depth`](super::PathTracing::rr_depth).
    pub rr_depth: u32,
}

/// The coordinates in which the density of a path is stated.
///
/// The vertices behind what a mutation changes may be written in any of them: their factors cancel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coordinates {
    /// Whether the raster position is one; if not, it is the position of the first vertex.
    pub raster: bool,
    /// Bit `i`: whether it is the direction from the finite vertex `i` to the next; if not, it is the
    /// next one's position.
    pub directions: u32,
}

impl Coordinates {
    /// True when the direction from a finite vertex is a coordinate.
    #[inline]
    pub fn has_direction(self, index: usize) -> bool {
        (self.directions >> index) & 1 == 1
    }
}

/// One vertex with its two neighbours' directions.
struct Corner<'p> {
    vertex: &'p PathVertex,
    to_eye: Vec3,
    to_light: Vec3,
}

impl Corner<'_> {
    /// `|n·ω_e| / |n·ω_l|`.
    fn cosine_ratio(&self, normal: Vec3) -> f64 {
        let cos = |direction: Vec3| f64::from(normal.dot(direction)).abs();
        cos(self.to_eye) / cos(self.to_light)
    }
}

/// A vertex between sensor and light.
fn corner<'p>(space: &PathSpace<'_>, path: &'p Path, index: usize) -> Option<Corner<'p>> {
    let vertices = path.vertices();
    let vertex = vertices.get(index)?;
    Some(Corner {
        vertex,
        to_eye: space.edge(vertex, vertices.get(index.checked_sub(1)?)?)?.0,
        to_light: space.edge(vertex, vertices.get(index + 1)?)?.0,
    })
}

impl PathSpace<'_> {
    /// The Dirac event at a vertex as the path tracer meets it; `None` at finite vertices.
    pub fn selection(&self, path: &Path, index: usize) -> Option<DiracEvent> {
        let corner = corner(self, path, index)?;
        let wi = corner.vertex.point.shading_frame().to_local(corner.to_eye);
        self.dirac(corner.vertex, corner.vertex.event, wi, Transport::Radiance)
    }

    /// `|n_g·ω_e| |n·ω_l| / (|n_g·ω_l| |n·ω_e|)` at a Dirac vertex, with `n` the normal that the Dirac lobe is
    /// written around: what interpolated and bumpy normals do to the importance that passes. One where
    /// that is the true normal.
    ///
    /// Source: Veach 1997, Sec. 5.3.
    pub fn shading_factor(&self, path: &Path, index: usize) -> Option<f64> {
        let corner = corner(self, path, index)?;
        let lobe = f64::from(self.selection(path, index)?.cosine_ratio);
        Some(corner.cosine_ratio(corner.vertex.point.geometric_normal) * lobe)
    }

    /// Density with which the path tracer samples the direction of a finite vertex to the next, in
    /// 1/sr, or the probability of its Dirac component: `p_d` and `p_s`.
    pub(super) fn scattering_density(&self, path: &Path, index: usize) -> Option<f64> {
        if path.vertices()[index].event.is_dirac() {
            return Some(f64::from(self.selection(path, index)?.probability));
        }
        let corner = corner(self, path, index)?;
        let frame = corner.vertex.point.shading_frame();
        let (wi, wo) = (
            frame.to_local(corner.to_eye),
            frame.to_local(corner.to_light),
        );
        let bsdf = self.bsdf(corner.vertex)?;
        Some(f64::from(
            bsdf.density(wi, wo, &corner.vertex.point, Transport::Radiance)
                .0,
        ))
    }

    /// Density with which the path tracer samples a light's vertex: in 1/m² on a surface, in 1/sr in an
    /// environment, the probability of a Dirac light: `p_light · p_area`.
    pub(super) fn light_density(&self, from: &PathVertex, light: &PathVertex) -> Option<f64> {
        let (id, lights) = (light.emitter()?, self.scene.lights());
        let from_point = from.position();
        Some(match light.event {
            Event::Emission(EmitterClass::Area) => {
                let density = lights.density_toward(id, from_point, &light.point).0;
                f64::from(density) * self.solid_angle_per_area(from, light)
            }
            Event::Emission(EmitterClass::Environment) => {
                f64::from(lights.environment_density(from_point, light.position()).0)
            }
            Event::Emission(class) if class.is_connectable() => {
                f64::from(lights.probability(id, from_point))
            }
            _ => return None,
        })
    }

    /// `X_f = f / p`: what the path tracer counts for a path, without the weight of its technique.
    ///
    /// `None` where the technique does not make such paths.
    ///
    /// Source: Cline et al. 2005, Eqs. 9, 10.
    pub fn estimate(&self, path: &Path, made: Generation) -> Option<DVec3> {
        let (estimate, survival) = self.walk(path, made)?;
        Some(estimate / survival)
    }

    /// The estimate without Russian roulette, and the probability of surviving that.
    fn walk(&self, path: &Path, made: Generation) -> Option<(DVec3, f64)> {
        let (vertices, last) = (path.vertices(), path.edges());
        let (mut throughput, mut survival, mut eta) = (DVec3::ONE, 1.0, 1.0);
        for index in 1..last {
            let vertex = &vertices[index];
            throughput *= vertex.value.0.as_dvec3();
            if index + 1 == last && made.technique == Technique::Explicit {
                if vertex.event.is_dirac() {
                    return None;
                }
                let light = &vertices[last];
                throughput *= self.solid_angle_per_area(vertex, light);
                throughput /= self.light_density(vertex, light)?;
                break;
            }
            throughput /= self.scattering_density(path, index)?;
            eta *= self
                .selection(path, index)
                .map_or(1.0, |s| f64::from(s.eta));
            if index >= made.rr_depth as usize {
                let energy = throughput.max_element() / survival / (eta * eta);
                survival *= energy.min(0.95);
            }
        }
        let is_met = match vertices[last].event {
            Event::Emission(class) => !class.is_dirac(),
            _ => false,
        };
        let is_made = is_met || made.technique == Technique::Explicit;
        (is_made && last > 0)
            .then(|| (throughput * vertices[last].value.0.as_dvec3(), survival))
            .filter(|_| last > 1 || made.technique == Technique::Implicit)
    }

    /// Density `p` of a path among those that the path tracer makes, in given coordinates: up to factors
    /// of the sensor that all paths share.
    ///
    /// The numbers of the comments are those of the rules of Cline et al.; the rules are applied from
    /// the eye on, whatever end a mutation starts at. A ratio of two densities is their product.
    ///
    /// Source: Cline et al. 2005, Sec. 4.2.
    pub fn density(&self, path: &Path, made: Generation, coordinates: Coordinates) -> Option<f64> {
        let vertices = path.vertices();
        // Rule 1, else rule 5.
        let mut density = if coordinates.raster {
            1.0
        } else {
            self.pixels_per_area(path)?
        };
        for index in 1..path.edges() {
            let (vertex, next) = (&vertices[index], &vertices[index + 1]);
            let is_light = index + 1 == path.edges();
            let per_area = self.solid_angle_per_area(vertex, next);
            let is_direction = coordinates.has_direction(index);
            if is_light && made.technique == Technique::Explicit {
                // Rule 4.
                density *= self.light_density(vertex, next)?;
                density /= if is_direction { per_area } else { 1.0 };
                continue;
            }
            // Rule 2, and with the area rule 3; implicit paths of rule 4 are as those of rule 3.
            density *= self.scattering_density(path, index)?;
            if !is_direction && !vertex.event.is_dirac() {
                density *= per_area;
            }
        }
        let (_, survival) = self.walk(path, made)?;
        Some(density * survival)
    }

    /// Number of pixels for each square metre around the first vertex: `W_e · G`, where the cosines at
    /// the lens cancel.
    pub fn pixels_per_area(&self, path: &Path) -> Option<f64> {
        let (lens, first) = (path.vertices().first()?, path.vertices().get(1)?);
        self.pixels_around(lens, first)
    }

    /// Number of pixels, on the image seen from a point of the lens, for each square metre around a
    /// vertex on a surface; for each steradian around one at infinity.
    #[inline]
    pub fn pixels_around(&self, lens: &PathVertex, vertex: &PathVertex) -> Option<f64> {
        let (direction, distance_squared) = self.edge(lens, vertex)?;
        let pixels = f64::from(self.sensor.pixels_per_steradian(direction));
        let spread = match vertex.kind {
            // Parallel rays see one direction only, which no sample has.
            VertexKind::Infinity if self.sensor.has_parallel_rays() => return None,
            VertexKind::Infinity => 1.0,
            _ => f64::from(self.sensor.spread(distance_squared)),
        };
        Some(pixels * (f64::from(vertex.geometric_cos(direction)) / spread))
    }

    /// Geometry term `G` of the edge from a vertex on a surface to the next, without visibility.
    fn geometry_term(&self, from: &PathVertex, to: &PathVertex) -> Option<f64> {
        let (direction, _) = self.edge(from, to)?;
        Some(f64::from(from.geometric_cos(direction)) * self.solid_angle_per_area(from, to))
    }

    /// Luminance of the measurement contribution `f` in area-product measure.
    ///
    /// Of a Dirac only the coefficient is kept, per solid angle of the direction that it decides: the one
    /// to the light, or at the vertices `backward` the one to the eye.
    ///
    /// Source: van Antwerpen 2011, Eq. 2.13; Veach 1997, Sec. 5.3.
    pub fn contribution(&self, path: &Path, backward: Range<usize>) -> Option<f64> {
        let (vertices, last) = (path.vertices(), path.edges());
        let mut scalar = self.pixels_per_area(path)?;
        let mut value = vertices[last].value.0.as_dvec3();
        for index in 1..last {
            let corner = corner(self, path, index)?;
            let vertex = corner.vertex;
            scalar *= self.geometry_term(vertex, &vertices[index + 1])?;
            if backward.contains(&index) {
                let wi = vertex.point.shading_frame().to_local(corner.to_light);
                let found = self.dirac(vertex, vertex.event, wi, Transport::Importance)?;
                value *= found.coefficient.0.as_dvec3();
                let point = &vertex.point;
                scalar *= corner.cosine_ratio(point.geometric_normal);
                scalar /= corner.cosine_ratio(point.shading_normal);
                scalar /= f64::from(vertex.geometric_cos(corner.to_eye));
            } else {
                // The value has the cosine to the shading normal; f_s is it over the true one.
                value *= vertex.value.0.as_dvec3();
                scalar /= f64::from(vertex.geometric_cos(corner.to_light));
            }
        }
        Some(luminance(value) * scalar)
    }
}
