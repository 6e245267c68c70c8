//! The path tracer that hands out every complete path.

use super::{Event, Heuristic, Path, PathSpace, PathVertex, luminance};
use crate::accel::Ray;
use crate::bsdf::{BsdfModel, Transport};
use crate::emitter::{EmitterClass, EmitterModel, EmitterSample};
use crate::math::{Rgb, Vec2, Vec3};
use crate::random::Numbers;
use crate::scene::{EmitterId, Interaction};
use crate::sensor::{CameraRay, SensorModel};

/// How paths are traced from the sensor.
#[derive(Clone, Copy, Debug)]
pub struct PathTracing {
    /// Largest number of edges; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// Number of edges from which on Russian roulette may end a path.
    pub rr_depth: u32,
    /// How emitter sampling and scattering are weighed.
    pub heuristic: Heuristic,
}

/// A complete path that the tracer has found.
#[derive(Clone, Copy, Debug)]
pub struct Found<'p> {
    /// The path; `None` for one that is longer than [`CAPACITY`](super::CAPACITY) allows.
    pub path: Option<&'p Path>,
    /// Its number of edges.
    pub edges: u32,
    /// Whether its light was sampled, and not met by chance.
    pub is_explicit: bool,
    /// `w · f / p`: weight of its technique, measurement contribution and density.
    pub energy: Rgb,
}

impl Found<'_> {
    /// Luminance of the energy.
    pub fn luminance(&self) -> f64 {
        luminance(self.energy.0.as_dvec3())
    }
}

/// What the tracer carries along.
struct Walk {
    throughput: Rgb,
    /// Product of the refractions' relative indices, see [`crate::bsdf::BsdfSample::eta`].
    eta: f32,
    /// Where the last ray left, and the density of its direction in 1/sr; no density after the camera
    /// and Dirac events, whose directions no other technique makes.
    departure: (Vec3, Option<f32>),
    /// False once the path has outgrown its capacity.
    fits: bool,
    /// Number of edges up to the vertex under way.
    depth: u32,
}

impl PathTracing {
    /// Traces one camera sample and hands every complete path that it finds to `found`: each explicit
    /// connection and each hit of an emitter.
    ///
    /// The energies of one call add up to the path tracer's estimate. Returns one where the sample met
    /// something that is not invisible, else zero.
    ///
    /// - `path`: working memory.
    /// - `raster`, `camera_ray`: the camera sample.
    ///
    /// Source: van Antwerpen 2011, Alg. 1; Cline et al. 2005, Sec. 4.1.
    pub fn trace(
        &self,
        space: &PathSpace<'_>,
        path: &mut Path,
        (raster, camera_ray): (Vec2, &CameraRay),
        sampler: &mut impl Numbers,
        found: &mut impl FnMut(Found<'_>),
    ) -> f32 {
        let mut ray = camera_ray.to_ray();
        let mut walk = Walk {
            throughput: Rgb::WHITE,
            eta: 1.0,
            departure: (ray.origin(), None),
            fits: true,
            depth: 0,
        };
        path.start(camera_ray.origin, raster);
        let mut alpha = 0.0;
        for depth in 1..=self.max_depth {
            walk.depth = depth;
            let Some(met) = space.meet(ray, depth == 1) else {
                if !(depth == 1 && space.rules.hide_emitters) {
                    self.leave_scene(space, path, &walk, ray.direction(), found);
                }
                break;
            };
            walk.fits = walk.fits && path.push(PathVertex::surface(&met, Event::Finite));
            self.meet_emitter(space, path, &walk, &met, found);
            if depth == self.max_depth {
                alpha = 1.0;
                break;
            }
            sampler.begin_vertex(depth);
            if met.lobes.finite {
                self.connect(space, path, &walk, &met, sampler, found);
            }
            let (next, is_null) = self.scatter(space, path, &mut walk, &met, sampler);
            if !is_null {
                alpha = 1.0;
            }
            let Some(next) = next else { break };
            ray = next;
            if !self.survives(&mut walk, sampler) {
                break;
            }
        }
        alpha
    }

    /// Hands out a path; `last` completes it where it fits.
    fn complete(
        &self,
        path: &mut Path,
        walk: &Walk,
        (last, energy, is_explicit): (PathVertex, Rgb, bool),
        found: &mut impl FnMut(Found<'_>),
    ) {
        let fits = walk.fits && path.push(last);
        found(Found {
            path: fits.then_some(&*path),
            edges: walk.depth,
            is_explicit,
            energy,
        });
        if fits {
            path.pop();
        }
    }

    /// Completes a path that leaves the scene.
    fn leave_scene(
        &self,
        space: &PathSpace<'_>,
        path: &mut Path,
        walk: &Walk,
        toward: Vec3,
        found: &mut impl FnMut(Found<'_>),
    ) {
        let lights = space.scene.lights();
        let Some(id) = lights.environment() else {
            return;
        };
        let radiance = lights.environment_radiance(toward);
        if radiance.is_black() {
            return;
        }
        let (from, density) = walk.departure;
        let weight = density.map_or(1.0, |own| {
            let other = lights.environment_density(from, toward).0;
            self.heuristic.second_weight(other, own)
        });
        let last = PathVertex::environment(toward, radiance, id);
        let energy = walk.throughput * radiance * weight;
        self.complete(path, walk, (last, energy, false), found);
    }

    /// Completes a path that has met an emitting surface.
    fn meet_emitter(
        &self,
        space: &PathSpace<'_>,
        path: &mut Path,
        walk: &Walk,
        met: &Interaction<'_>,
        found: &mut impl FnMut(Found<'_>),
    ) {
        let Some(id) = met.emitter else { return };
        let lights = space.scene.lights();
        let radiance = lights.get(id).radiance(&met.point, met.back);
        if radiance.is_black() {
            return;
        }
        let (from, density) = walk.departure;
        let weight = density.map_or(1.0, |own| {
            let other = lights.density_toward(id, from, &met.point).0;
            self.heuristic.second_weight(other, own)
        });
        let mut last = PathVertex::surface(met, Event::Emission(EmitterClass::Area));
        last.value = radiance;
        let energy = walk.throughput * radiance * weight;
        // The emitter's vertex takes the place of the surface's for a moment.
        if walk.fits {
            path.pop();
        }
        self.complete(path, walk, (last, energy, false), found);
        if walk.fits {
            path.push(PathVertex::surface(met, Event::Finite));
        }
    }

    /// Completes a path by a sampled direction to an emitter.
    fn connect(
        &self,
        space: &PathSpace<'_>,
        path: &mut Path,
        walk: &Walk,
        met: &Interaction<'_>,
        sampler: &mut impl Numbers,
        found: &mut impl FnMut(Found<'_>),
    ) {
        let lights = space.scene.lights();
        let Some(chosen) = lights.sample_toward(met.point.position, sampler.next_2d()) else {
            return;
        };
        let sample = chosen.sample;
        let wo = met.frame.to_local(sample.direction);
        if !space.strict_agrees(met, wo, sample.direction) {
            return;
        }
        let (value, own) = met
            .bsdf
            .eval_with_density(met.wi, wo, &met.point, Transport::Radiance);
        if value.is_black() {
            return;
        }
        let last = light_vertex(space, &sample, chosen.emitter);
        if !space.is_visible(&PathVertex::surface(met, Event::Finite), &last) {
            return;
        }
        let weight = if sample.is_dirac {
            1.0
        } else {
            self.heuristic.first_weight(sample.density.0, own.0)
        };
        if walk.fits {
            set_event(path, Event::Finite, value, 1.0);
        }
        let energy = walk.throughput * (value * sample.radiance * (weight / sample.density.0));
        let walk = Walk {
            depth: walk.depth + 1,
            ..*walk
        };
        self.complete(path, &walk, (last, energy, true), found);
    }

    /// Samples the next direction, and whether it goes straight through; `None` ends the path.
    fn scatter(
        &self,
        space: &PathSpace<'_>,
        path: &mut Path,
        walk: &mut Walk,
        met: &Interaction<'_>,
        sampler: &mut impl Numbers,
    ) -> (Option<Ray>, bool) {
        let u_lobe = if met.lobes.single {
            0.0
        } else {
            sampler.next_1d()
        };
        let u = sampler.next_2d();
        let sampled = met
            .bsdf
            .sample(met.wi, &met.point, Transport::Radiance, u_lobe, u);
        let Some(sample) = sampled else {
            return (None, false);
        };
        let event = Event::of(&sample);
        let ray = met.spawn(sample.direction);
        let is_null = matches!(event, Event::Null(_));
        let agree = space.strict_agrees(met, sample.direction, ray.direction());
        if !agree || sample.weight.is_black() {
            return (None, false);
        }
        if walk.fits {
            set_scattering(space, path, event, sample.value, met.back);
        }
        walk.throughput *= sample.weight;
        walk.eta *= sample.eta;
        let density = (!event.is_dirac()).then_some(sample.density);
        walk.departure = (met.point.position, density);
        (Some(ray), is_null)
    }

    /// Russian roulette: ends weak paths, and strengthens those that go on; false ends the path.
    fn survives(&self, walk: &mut Walk, sampler: &mut impl Numbers) -> bool {
        if walk.depth < self.rr_depth {
            return true;
        }
        // Without the growth by refraction, which is undone on the way out.
        let survival = survival_of(walk.throughput.max_channel() / (walk.eta * walk.eta));
        if sampler.next_1d() >= survival {
            return false;
        }
        walk.throughput *= 1.0 / survival;
        true
    }
}

/// Probability with which Russian roulette lets a path go on that has kept a share of its light.
#[inline]
pub(super) fn survival_of(kept: f32) -> f32 {
    kept.min(0.95)
}

/// The last vertex of a path to a sampled point of an emitter, with what it sends.
fn light_vertex(space: &PathSpace<'_>, sample: &EmitterSample, emitter: EmitterId) -> PathVertex {
    let class = space.scene.lights().get(emitter).class();
    let mut last = PathVertex::sampled_light(sample, emitter, class);
    if class == EmitterClass::Point {
        last.value = space.emission(&last, -sample.direction);
    }
    last
}

/// Gives the last vertex a sampled event.
fn set_scattering(space: &PathSpace<'_>, path: &mut Path, event: Event, value: Rgb, to_eye: Vec3) {
    let Some(vertex) = path.vertices().last() else {
        return;
    };
    let adjoint = if event.is_dirac() {
        space
            .follow(vertex, event, to_eye)
            .map_or(1.0, |followed| followed.adjoint)
    } else {
        1.0
    };
    set_event(path, event, value, adjoint);
}

/// Sets what happens at the last vertex.
fn set_event(path: &mut Path, event: Event, value: Rgb, adjoint: f32) {
    if let Some(vertex) = path.vertices_mut().last_mut() {
        vertex.event = event;
        vertex.value = value;
        vertex.adjoint = adjoint;
    }
}

/// One camera sample: a raster position and a ray through the lens.
///
/// - `sampler`: the numbers of the sample; the raster position's are taken already.
pub fn camera_sample(space: &PathSpace<'_>, raster: Vec2, sampler: &mut impl Numbers) -> CameraRay {
    space.sensor.sample_ray(raster, sampler.next_2d())
}
