//! Subpaths from the sensor and from a light.

use super::weighing::{Backlog, Departure};
use super::{Bidirectional, LightImage};
use crate::accel::Ray;
use crate::bsdf::{BsdfModel, BsdfSample, Lobe, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::path::tracer::survival_of;
use crate::path::{Event, PathSpace, PathVertex};
use crate::random::Numbers;
use crate::scene::{ChosenRay, Interaction};
use crate::sensor::CameraRay;

/// A vertex of a subpath on a surface.
#[derive(Clone, Debug)]
pub struct SubVertex<'s> {
    /// The surface, met by a ray from the vertex before.
    pub met: Interaction<'s>,
    /// Estimate of what the subpath carries to the vertex: importance in units of a pixel's, or the flux of
    /// light in W.
    pub throughput: Rgb,
    /// What the other techniques' densities are.
    pub backlog: Backlog,
    /// By which event the subpath goes on to its next vertex; finite at its last.
    pub event: Event,
    /// Numbers to sample a light with, of vertices of eye subpaths.
    pub(super) u_light: Vec2,
}

/// The vertex of an eye subpath that has left the scene.
#[derive(Clone, Copy, Debug)]
pub struct Escape {
    /// Unit direction towards infinity.
    pub toward: Vec3,
    /// As [`SubVertex::throughput`].
    pub throughput: Rgb,
    /// As [`SubVertex::backlog`].
    pub backlog: Backlog,
}

/// A subpath from the sensor.
#[derive(Debug, Default)]
pub struct EyeSubpath<'s> {
    /// The vertices beyond the lens.
    pub vertices: Vec<SubVertex<'s>>,
    /// Where it leaves the scene.
    pub escape: Option<Escape>,
    /// One where the sample met something that is not invisible, else zero.
    pub alpha: f32,
}

impl EyeSubpath<'_> {
    /// Forgets what was traced before.
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
        self.escape = None;
        self.alpha = 0.0;
    }
}

/// A subpath from a light.
#[derive(Debug, Default)]
pub struct LightSubpath<'s> {
    /// Its first vertex, with the ray that leaves it.
    pub start: Option<ChosenRay>,
    /// The vertices on the surfaces that it meets.
    pub vertices: Vec<SubVertex<'s>>,
}

/// How far an eye subpath goes.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    /// Most vertices beyond the lens.
    pub(super) vertices: u32,
    /// Which of them sample lights.
    pub(super) lit: Lit,
}

/// Which vertices of an eye subpath sample lights.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Lit {
    /// All that may have one more edge.
    All,
    /// The last that is asked for.
    Last,
    /// None.
    Nowhere,
}

impl Reach {
    /// Numbers for a vertex to sample a light with. Those that it does not need are passed over: numbers keep
    /// their places whatever is wanted.
    ///
    /// - `depth`: number of the vertex, from one.
    fn light_numbers(self, depth: u32, sampler: &mut impl Numbers) -> Vec2 {
        let is_last = depth == self.vertices;
        match self.lit {
            Lit::All if !is_last => sampler.next_2d(),
            Lit::Last if is_last => sampler.next_2d(),
            _ if is_last => Vec2::ZERO,
            _ => {
                sampler.skip_2d();
                Vec2::ZERO
            }
        }
    }
}

/// A ray under way to the next vertex.
pub(super) struct Flight {
    ray: Ray,
    throughput: Rgb,
    pub(super) departure: Departure,
    pub(super) backlog: Backlog,
    /// Share of light that the event at its start has kept.
    kept: f32,
    is_null: bool,
}

impl Bidirectional {
    /// Traces a subpath from the sensor.
    ///
    /// - `raster`, `camera_ray`: the camera sample.
    /// - `image`: how light subpaths make images of their own.
    pub(super) fn trace_eye<'s>(
        &self,
        space: &PathSpace<'s>,
        (raster, camera_ray): (Vec2, &CameraRay),
        (image, reach): (&LightImage, Reach),
        sampler: &mut impl Numbers,
        subpath: &mut EyeSubpath<'s>,
    ) {
        subpath.clear();
        let lens = PathVertex::sensor(camera_ray.origin);
        let first = |vertex: &PathVertex| self.first_backlog(space, raster, (&lens, vertex), image);
        let mut flight: Option<Flight> = None;
        for depth in 1..=reach.vertices {
            let ray = flight
                .as_ref()
                .map_or_else(|| camera_ray.to_ray(), |f| f.ray);
            let throughput = flight.as_ref().map_or(Rgb::WHITE, |f| f.throughput);
            let Some(met) = space.meet(ray, depth == 1) else {
                if !(depth == 1 && space.rules.hide_emitters) {
                    subpath.escape = self.escape(space, &flight, ray.direction(), &first);
                }
                return;
            };
            let backlog = match &flight {
                Some(flight) => self.arrive(flight, &met),
                None => first(&PathVertex::surface(&met, Event::Finite)),
            };
            sampler.begin_vertex(depth);
            let u_light = if met.lobes.finite {
                reach.light_numbers(depth, sampler)
            } else {
                Vec2::ZERO
            };
            subpath.vertices.push(SubVertex {
                met,
                throughput,
                backlog,
                event: Event::Finite,
                u_light,
            });
            if depth == reach.vertices {
                subpath.alpha = 1.0;
                return;
            }
            let Some(vertex) = subpath.vertices.last_mut() else {
                return;
            };
            let next = self.scatter(space, vertex, Transport::Radiance, sampler);
            if !next.as_ref().is_some_and(|next| next.is_null) {
                subpath.alpha = 1.0;
            }
            flight = next.and_then(|next| self.survive(depth, next, sampler));
            if flight.is_none() {
                return;
            }
        }
    }

    /// The vertex where a ray leaves the scene.
    fn escape(
        &self,
        space: &PathSpace<'_>,
        flight: &Option<Flight>,
        toward: Vec3,
        first: &impl Fn(&PathVertex) -> Backlog,
    ) -> Option<Escape> {
        let id = space.scene.lights().environment()?;
        let (throughput, backlog) = match flight {
            Some(Flight {
                throughput,
                departure,
                backlog,
                ..
            }) => (
                *throughput,
                backlog.after(self.weighing, departure, 1.0, 1.0),
            ),
            None => {
                let vertex = PathVertex::environment(toward, Rgb::BLACK, id);
                (Rgb::WHITE, first(&vertex))
            }
        };
        Some(Escape {
            toward,
            throughput,
            backlog,
        })
    }

    /// Traces a subpath from a light.
    ///
    /// - `limit`: largest number of its vertices, the light's own included.
    pub(super) fn trace_light<'s>(
        &self,
        space: &PathSpace<'s>,
        limit: u32,
        sampler: &mut impl Numbers,
        subpath: &mut LightSubpath<'s>,
    ) {
        subpath.vertices.clear();
        let u_choice = sampler.next_1d();
        let (u_point, u_direction) = (sampler.next_2d(), sampler.next_2d());
        let lights = space.scene.lights();
        subpath.start = lights.sample_emission(u_choice, u_point, u_direction);
        let Some(start) = &subpath.start else { return };
        let flux = start.ray.power() * (1.0 / start.probability);
        let mut throughput = flux;
        let mut ray = Ray::new(start.ray.origin, start.ray.direction);
        let mut flight: Option<Flight> = None;
        for count in 2..=limit {
            if throughput.is_black() {
                return;
            }
            let Some(met) = space.meet(ray, false) else {
                return;
            };
            let backlog = match &flight {
                Some(flight) => self.arrive(flight, &met),
                None => self.first_light_backlog(space, start, &met),
            };
            subpath.vertices.push(SubVertex {
                met,
                throughput,
                backlog,
                event: Event::Finite,
                u_light: Vec2::ZERO,
            });
            if count == limit {
                return;
            }
            let Some(vertex) = subpath.vertices.last_mut() else {
                return;
            };
            sampler.begin_vertex(count - 1);
            let next = self.scatter(space, vertex, Transport::Importance, sampler);
            let Some(next) = next.and_then(|next| self.survive(count - 1, next, sampler)) else {
                return;
            };
            (ray, throughput) = (next.ray, next.throughput);
            flight = Some(next);
        }
    }

    /// Samples how a subpath leaves its last vertex; `None` ends it.
    fn scatter(
        &self,
        space: &PathSpace<'_>,
        vertex: &mut SubVertex<'_>,
        transport: Transport,
        sampler: &mut impl Numbers,
    ) -> Option<Flight> {
        let met = &vertex.met;
        let u_lobe = if met.lobes.single {
            0.0
        } else {
            sampler.next_1d()
        };
        let u = sampler.next_2d();
        let sample = met.bsdf.sample(met.wi, &met.point, transport, u_lobe, u)?;
        let ray = met.spawn(sample.direction);
        let agree = space.strict_agrees(met, sample.direction, ray.direction());
        if !agree || sample.weight.is_black() {
            return None;
        }
        let event = Event::of(&sample);
        let backward = match event.component() {
            None => {
                met.bsdf
                    .density(sample.direction, met.wi, &met.point, transport.adjoint())
                    .0
            }
            // Of the same directions as `density`: solid angles change by the event.
            Some(component) => met
                .bsdf
                .follow(sample.direction, &met.point, transport.adjoint(), component)
                .map_or(0.0, |back| back.probability * back.inverse_stretch()),
        };
        let weight = match transport {
            Transport::Radiance => sample.weight,
            Transport::Importance => sample.weight * shading_factor(met, ray.direction()),
        };
        vertex.event = event;
        Some(Flight {
            throughput: vertex.throughput * weight,
            departure: Departure {
                density: f64::from(sample.density),
                backward: f64::from(backward),
                cos: f64::from(met.point.geometric_normal.dot(ray.direction()).abs()),
                is_dirac: event.is_dirac(),
            },
            ray,
            backlog: vertex.backlog,
            kept: kept(&sample, transport),
            is_null: sample.lobe == Lobe::Null,
        })
    }

    /// Russian roulette: ends subpaths where surfaces are dark, and strengthens those that go on.
    ///
    /// It knows nothing but the event at the vertex, and is left out of the densities of the weights: where
    /// it begins depends on the number of edges, which the other side's subpath does not know.
    ///
    /// - `edges`: of the subpath up to the vertex.
    fn survive(
        &self,
        edges: u32,
        mut flight: Flight,
        sampler: &mut impl Numbers,
    ) -> Option<Flight> {
        if edges < self.rr_depth {
            return Some(flight);
        }
        let survival = survival_of(flight.kept);
        flight.throughput *= 1.0 / survival;
        (sampler.next_1d() < survival).then_some(flight)
    }
}

/// Share of light that an event keeps, without the growth by refraction, which is undone on the way out.
#[inline]
pub(in crate::path) fn kept(sample: &BsdfSample, transport: Transport) -> f32 {
    let eta = match transport {
        Transport::Radiance => sample.eta,
        Transport::Importance => 1.0,
    };
    sample.weight.max_channel() / (eta * eta)
}

/// What interpolated and bumpy normals do to the importance that a surface scatters:
/// `|n_s·ω_l| |n_g·ω_e| / (|n_g·ω_l| |n_s·ω_e|)`.
///
/// Source: Veach 1997, Sec. 5.3.
#[inline]
pub(super) fn shading_factor(met: &Interaction<'_>, to_eye: Vec3) -> f32 {
    let (shading, geometric) = (met.point.shading_normal, met.point.geometric_normal);
    if shading == geometric {
        return 1.0;
    }
    let light = (shading.dot(met.back) / geometric.dot(met.back)).abs();
    let eye = (geometric.dot(to_eye) / shading.dot(to_eye)).abs();
    light * eye
}
