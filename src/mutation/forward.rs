//! Rebuilding a path from the sensor: what lens, multi-chain and Lai lens perturbation share.

use super::kernel::{AngleKernel, turned};
use super::{Fault, Perturbation, Rejection, Site};
use crate::accel::Ray;
use crate::emitter::EmitterClass;
use crate::math::Vec3;
use crate::path::{Event, Path, PathSpace, PathVertex};
use crate::random::Stream;
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

/// The site of a mutation whose last moved vertex is connected to the next one, where there is one.
pub(super) fn site_up_to(path: &Path, last: usize) -> Site {
    Site {
        last_moved: last,
        last_changed: (last + 1).min(path.edges()),
    }
}

/// The site where a finite vertex with a specular one behind it is passed; `None` for paths that the lens
/// perturbation alone rebuilds.
pub(super) fn site_behind_finite(path: &Path) -> Option<Site> {
    if last_moved(path, 0).is_some() {
        return None;
    }
    Some(site_up_to(path, last_moved(path, usize::MAX)?))
}

/// Rebuilds vertices 1 to `last` of a proposal from a moved raster position and lens point on, and connects
/// the last one to what follows; returns [`connection_factor`] there.
///
/// - `paths`: the current path, and the proposal, which needs to be a copy of it behind `last` alone, in its
///   number of vertices, and in that it begins at a sensor.
///
/// # Errors
/// Why there is no such path.
pub(super) fn rebuild(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    redirect: Option<Redirect>,
    ((current, proposal), last): ((&Path, &mut Path), usize),
    random: &mut Stream,
) -> Result<f64, Rejection> {
    let raster = current.raster() + settings.raster.offset(random.next_vec2());
    if !settings.domain.contains(raster) {
        return Err(Rejection::OffImage);
    }
    proposal.set_raster(raster);
    let old = current.vertices();
    let origin = super::lens_point::perturb(space, settings, old[0].position(), random)?;
    let camera_ray = space.sensor.camera_ray(raster, origin);
    proposal.vertices_mut()[0].point.position = camera_ray.origin;
    let mut ray = camera_ray.to_ray();
    let mut index = 1;
    loop {
        if index + 1 == old.len() {
            let light = arrive_at_light(space, ray, (old[index].event, index == 1))?;
            proposal.vertices_mut()[index] = light;
            return Ok(1.0);
        }
        let (event, vertex) = (old[index].event, &mut proposal.vertices_mut()[index]);
        let object = space.meet_at(ray, index == 1, event, vertex);
        let (object, to_eye) = (object.ok_or(Rejection::Missed)?, -ray.direction());
        if event.is_dirac() {
            ray = pass(space, vertex, to_eye)?;
        } else {
            if !object.lobes.finite {
                return Err(Rejection::SignatureChanged);
            }
            if index == last {
                return connect(space, settings, (old, proposal), (last, to_eye));
            }
            let Some(redirect) = redirect else {
                return Err(Rejection::SignatureChanged);
            };
            let turn = (redirect, settings.fault);
            let edge = [&old[index], &old[index + 1]];
            ray = scatter(space, turn, edge, (vertex, to_eye), random)?;
        }
        index += 1;
        if event == Event::Finite && redirect == Some(Redirect::Aim) {
            // The next vertex stays; only what it does with the new direction changes.
            let mut next = old[index];
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
///
/// - `old`, `next`: the vertex and the specular one on the current path.
fn scatter(
    space: &PathSpace<'_>,
    (redirect, fault): (Redirect, Fault),
    [old, next]: [&PathVertex; 2],
    (vertex, to_eye): (&mut PathVertex, Vec3),
    random: &mut Stream,
) -> Result<Ray, Rejection> {
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

/// The end of a path that reaches its light by a ray.
///
/// - `from_sensor`: whether it is the first ray.
fn arrive_at_light(
    space: &PathSpace<'_>,
    ray: Ray,
    (event, from_sensor): (Event, bool),
) -> Result<PathVertex, Rejection> {
    let met = space.meet(ray, from_sensor);
    let lights = space.scene.lights();
    let light = match (event, met) {
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
    Ok(light)
}

/// Connects a moved finite vertex to the next vertex of the path, which stays; returns
/// [`connection_factor`] there.
///
/// - `old`: the vertices of the current path.
/// - `last`: index of the moved vertex.
/// - `to_eye`: world-space unit direction away from it.
#[inline(always)]
fn connect(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    (old, proposal): (&[PathVertex], &mut Path),
    (last, to_eye): (usize, Vec3),
) -> Result<f64, Rejection> {
    let vertices = proposal.vertices_mut();
    let (from, to) = (&mut vertices[last], &old[last + 1]);
    let edge = space.edge(from, to).ok_or(Rejection::Dark)?;
    let (direction, _) = edge;
    from.value = space.finite_value(from, to_eye, direction);
    let value = match old.get(last + 2) {
        Some(after) => {
            let (to_light, _) = space.edge(to, after).ok_or(Rejection::Dark)?;
            space.finite_value(to, -direction, to_light)
        }
        None => space.emission(to, -direction),
    };
    if from.value.is_black() || value.is_black() {
        return Err(Rejection::Dark);
    }
    if !space.is_visible(from, to) {
        return Err(Rejection::Occluded);
    }
    vertices[last + 1].value = value;
    Ok(factor_of_edge(settings, edge, to))
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
