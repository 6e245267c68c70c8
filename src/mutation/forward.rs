//! Rebuilding a path from the sensor: what lens, multi-chain and Lai lens perturbation share.

use super::kernel::{AngleKernel, turned};
use super::{Fault, Perturbation, Rejection};
use crate::accel::Ray;
use crate::emitter::EmitterClass;
use crate::math::Vec3;
use crate::path::{Event, Path, PathSpace, PathVertex};
use crate::random::Stream;
use crate::scene::Interaction;
use crate::sensor::SensorModel;

/// What happens at a finite vertex whose next vertex is specular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Redirect {
    /// The direction to the next vertex is turned by a small angle.
    Turn(AngleKernel),
    /// The next vertex stays where it is.
    Aim,
}

/// Index of the last vertex that moves, when a path is rebuilt from the sensor: the first finite
/// vertex that can be connected to the next, or the light.
///
/// - `passes`: how many finite vertices with a specular one behind them may be passed.
///
/// `None` where there are more of them, and where all vertices are where a beam without width has put them.
pub(super) fn last_moved(path: &Path, mut passes: usize) -> Option<usize> {
    let vertices = path.vertices();
    for (index, pair) in vertices.windows(2).enumerate().skip(1) {
        if pair[0].event != Event::Finite {
            continue;
        }
        if pair[1].event.is_connectable() {
            return Some(index);
        }
        passes = passes.checked_sub(1)?;
    }
    let is_beam = |light: &PathVertex| light.event == Event::Emission(EmitterClass::Collimated);
    (!vertices.last().is_some_and(is_beam)).then_some(path.edges())
}

/// Index of the last vertex that changes, where a finite vertex with a specular one behind it is passed;
/// `None` for paths that the lens perturbation alone rebuilds.
pub(super) fn last_changed_behind_finite(path: &Path) -> Option<usize> {
    if last_moved(path, 0).is_some() {
        return None;
    }
    Some((last_moved(path, usize::MAX)? + 1).min(path.edges()))
}

/// Rebuilds vertices 1 to `last` of a proposal, which is a copy of the current path, from a moved
/// raster position and lens point on, and connects the last one to what follows; returns
/// [`connection_factor`] there.
///
/// # Errors
/// Why there is no such path; the proposal is then in disorder up to `last + 1`.
pub(super) fn rebuild(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    redirect: Option<Redirect>,
    proposal: &mut Path,
    last: usize,
    random: &mut Stream,
) -> Result<f64, Rejection> {
    let raster = proposal.raster() + settings.raster.offset(random.next_vec2());
    if !settings.domain.contains(raster) {
        return Err(Rejection::OffImage);
    }
    proposal.set_raster(raster);
    super::lens_point::perturb(space, settings, proposal, random)?;
    let origin = proposal.vertices()[0].position();
    let camera_ray = space.sensor.camera_ray(raster, origin);
    proposal.vertices_mut()[0].point.position = camera_ray.origin;
    let mut ray = camera_ray.to_ray();
    let mut index = 1;
    loop {
        if index == proposal.edges() {
            return arrive_at_light(space, proposal, ray, index).map(|()| 1.0);
        }
        let met = space.meet(ray, index == 1).ok_or(Rejection::Missed)?;
        let event = proposal.vertices()[index].event;
        if event.is_dirac() {
            let vertex = &mut proposal.vertices_mut()[index];
            *vertex = PathVertex::surface(&met, event);
            ray = pass(space, vertex, met.back)?;
        } else {
            if !met.lobes.finite {
                return Err(Rejection::SignatureChanged);
            }
            if index == last {
                return connect(space, settings, proposal, (last, &met));
            }
            let Some(redirect) = redirect else {
                return Err(Rejection::SignatureChanged);
            };
            let mut vertex = PathVertex::surface(&met, event);
            ray = scatter(
                space,
                (redirect, settings.fault),
                proposal,
                (index, &mut vertex, met.back),
                random,
            )?;
            proposal.vertices_mut()[index] = vertex;
        }
        index += 1;
        if event == Event::Finite && redirect == Some(Redirect::Aim) {
            // The next vertex stays; only what it does with the new direction changes.
            let mut next = proposal.vertices()[index];
            ray = pass(space, &mut next, -ray.direction())?;
            proposal.vertices_mut()[index] = next;
            index += 1;
        }
    }
}

/// Lets light pass a Dirac vertex: finds its value, and the ray that goes on.
fn pass(space: &PathSpace<'_>, vertex: &mut PathVertex, to_eye: Vec3) -> Result<Ray, Rejection> {
    let followed = space
        .follow(vertex, vertex.event, to_eye)
        .ok_or(Rejection::SignatureChanged)?;
    vertex.value = followed.value;
    vertex.adjoint = followed.adjoint;
    Ok(space.leave(vertex, followed.direction))
}

/// Sends a finite vertex's path on to a specular vertex.
fn scatter(
    space: &PathSpace<'_>,
    (redirect, fault): (Redirect, Fault),
    current: &Path,
    (index, vertex, to_eye): (usize, &mut PathVertex, Vec3),
    random: &mut Stream,
) -> Result<Ray, Rejection> {
    // Both ends are still those of the current path.
    let (old, next) = (&current.vertices()[index], &current.vertices()[index + 1]);
    let direction = match redirect {
        Redirect::Turn(kernel) => {
            let from = if fault.is(Fault::Aim) { &*vertex } else { old };
            let (old_direction, _) = space.edge(from, next).ok_or(Rejection::Dark)?;
            let angle = kernel.angle(random.next_f32());
            turned(old_direction, angle, random.next_f32())
        }
        Redirect::Aim => {
            if !space.is_visible(vertex, next) {
                return Err(Rejection::Occluded);
            }
            space.edge(vertex, next).ok_or(Rejection::Dark)?.0
        }
    };
    vertex.value = space.finite_value(vertex, to_eye, direction);
    if vertex.value.is_black() {
        return Err(Rejection::Dark);
    }
    Ok(space.leave(vertex, direction))
}

/// Ends a path that reaches its light by a ray.
fn arrive_at_light(
    space: &PathSpace<'_>,
    proposal: &mut Path,
    ray: Ray,
    index: usize,
) -> Result<(), Rejection> {
    let met = space.meet(ray, index == 1);
    let lights = space.scene.lights();
    let light = match (proposal.vertices()[index].event, met) {
        (Event::Emission(EmitterClass::Environment), None) => {
            let toward = ray.direction();
            let id = lights.environment().ok_or(Rejection::Missed)?;
            PathVertex::environment(toward, lights.environment_radiance(toward), id)
        }
        (event @ Event::Emission(EmitterClass::Area), Some(met)) if met.emitter.is_some() => {
            let mut light = PathVertex::surface(&met, event);
            light.value = space.emission(&light, met.back);
            light
        }
        _ => return Err(Rejection::Missed),
    };
    if light.value.is_black() {
        return Err(Rejection::Dark);
    }
    proposal.vertices_mut()[index] = light;
    Ok(())
}

/// Connects a moved finite vertex to the next vertex of the path, which stays; returns
/// [`connection_factor`] there.
///
/// - `last`, `met`: index of the moved vertex, and what is there; it has its place in the path when all is
///   well.
#[inline(always)]
fn connect(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    proposal: &mut Path,
    (last, met): (usize, &Interaction<'_>),
) -> Result<f64, Rejection> {
    let mut from = PathVertex::surface(met, proposal.vertices()[last].event);
    let to = &proposal.vertices()[last + 1];
    let edge = space.edge(&from, to).ok_or(Rejection::Dark)?;
    let (direction, _) = edge;
    from.value = space.finite_value(&from, met.back, direction);
    let value = match proposal.vertices().get(last + 2) {
        Some(after) => {
            let (to_light, _) = space.edge(to, after).ok_or(Rejection::Dark)?;
            space.finite_value(to, -direction, to_light)
        }
        None => space.emission(to, -direction),
    };
    if from.value.is_black() || value.is_black() {
        return Err(Rejection::Dark);
    }
    if !space.is_visible(&from, to) {
        return Err(Rejection::Occluded);
    }
    let factor = factor_of_edge(settings, edge, to);
    let vertices = proposal.vertices_mut();
    vertices[last] = from;
    vertices[last + 1].value = value;
    Ok(factor)
}

/// Factor that turns a density of directions at the last moved vertex into one of what it is
/// connected to; one where the path reaches its light by a ray.
pub(super) fn connection_factor(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    path: &Path,
    last: usize,
) -> f64 {
    let from = &path.vertices()[last];
    let Some(next) = path.vertices().get(last + 1) else {
        return 1.0;
    };
    let edge = space.edge(from, next);
    edge.map_or(0.0, |edge| factor_of_edge(settings, edge, next))
}

/// [`connection_factor`] of an edge to a vertex that stays, see [`PathSpace::edge`].
#[inline]
fn factor_of_edge(
    settings: &Perturbation,
    (direction, squared): (Vec3, f32),
    to: &PathVertex,
) -> f64 {
    let cos = f64::from(to.geometric_cos(direction));
    let cos = settings.fault.keep(Fault::ConnectionCosine, cos);
    cos / settings
        .fault
        .keep(Fault::ConnectionDistance, f64::from(squared))
}
