//! Making new vertices.

use crate::accel::Ray;
use crate::bsdf::{BsdfModel, Transport};
use crate::emitter::{EmitterClass, EmitterModel, EmitterSample};
use crate::math::{Vec2, Vec3, warp};
use crate::mutation::{RasterDomain, Rejection};
use crate::path::{Event, Path, PathSpace, PathVertex};
use crate::random::Stream;
use crate::scene::Interaction;
use crate::sensor::SensorModel;

/// Samples the direction in which a vertex that a ray has met sends the path on, and writes it into the
/// vertex.
///
/// - `came`: unit direction back to where the subpath comes from.
fn scatter(
    space: &PathSpace<'_>,
    vertex: &mut PathVertex,
    came: Vec3,
    transport: Transport,
    random: &mut Stream,
) -> Option<Ray> {
    let frame = vertex.point.shading_frame();
    let bsdf = space.bsdf(vertex)?;
    let (u_lobe, u) = (random.next_f32(), random.next_vec2());
    let sample = bsdf.sample(frame.to_local(came), &vertex.point, transport, u_lobe, u)?;
    let direction = frame.to_world(sample.direction);
    vertex.event = Event::of(&sample);
    let (to_eye, to_light) = match transport {
        Transport::Radiance => (came, direction),
        Transport::Importance => (direction, came),
    };
    if vertex.event.is_dirac() {
        let followed = match transport {
            Transport::Radiance => space.follow(vertex, vertex.event, to_eye)?,
            Transport::Importance => space.follow_back(vertex, vertex.event, to_light)?,
        };
        vertex.value = followed.value;
        vertex.adjoint = followed.adjoint;
    } else {
        vertex.value = space.finite_value(vertex, to_eye, to_light);
        vertex.adjoint = 1.0;
    }
    (!vertex.value.is_black()).then(|| space.leave(vertex, direction))
}

/// Where the sensor's side begins: a new place on the image and on the lens.
fn look(space: &PathSpace<'_>, domain: &RasterDomain, path: &mut Path, random: &mut Stream) -> Ray {
    let raster = warp::stretch(random.next_vec2(), domain.low, domain.high);
    let ray = space.sensor.sample_ray(raster, random.next_vec2());
    path.start(ray.origin, raster);
    ray.to_ray()
}

/// Makes vertices from the last one of a path on, coming from the eye.
///
/// - `ends`: whether the last of them is to be the light.
pub(super) fn extend_from_sensor(
    space: &PathSpace<'_>,
    domain: &RasterDomain,
    path: &mut Path,
    (count, ends): (usize, bool),
    random: &mut Stream,
) -> Result<(), Rejection> {
    for made in 1..=count {
        let last = path.edges();
        let ray = if last == 0 {
            look(space, domain, path, random)
        } else {
            let before = path.vertices()[last - 1];
            let vertex = &mut path.vertices_mut()[last];
            let (to_eye, _) = space.edge(vertex, &before).ok_or(Rejection::Dark)?;
            let ray = scatter(space, vertex, to_eye, Transport::Radiance, random);
            ray.ok_or(Rejection::Dark)?
        };
        let met = space.meet(ray, last == 0);
        let vertex = if ends && made == count {
            light_met(space, &ray, last == 0, met)?
        } else {
            PathVertex::surface(&met.ok_or(Rejection::Missed)?, Event::Finite)
        };
        path.push(vertex);
    }
    Ok(())
}

/// The light that a ray meets.
fn light_met(
    space: &PathSpace<'_>,
    ray: &Ray,
    from_sensor: bool,
    met: Option<Interaction<'_>>,
) -> Result<PathVertex, Rejection> {
    let lights = space.scene.lights();
    let vertex = match met {
        Some(met) if met.emitter.is_some() => {
            let mut light = PathVertex::surface(&met, Event::Emission(EmitterClass::Area));
            light.value = space.emission(&light, met.back);
            light
        }
        None if !(from_sensor && space.rules.hide_emitters) => {
            let id = lights.environment().ok_or(Rejection::Missed)?;
            let toward = ray.direction();
            PathVertex::environment(toward, lights.environment_radiance(toward), id)
        }
        _ => return Err(Rejection::Missed),
    };
    if vertex.value.is_black() {
        return Err(Rejection::Dark);
    }
    Ok(vertex)
}

/// Makes vertices from the last one of a reversed path on, coming from the light.
///
/// - `light`: the vertices at the light's end, the light first; its other vertices are met already.
pub(super) fn extend_from_light(
    space: &PathSpace<'_>,
    light: &mut Path,
    count: usize,
    random: &mut Stream,
) -> Result<(), Rejection> {
    for _ in 0..count {
        let last = light.edges();
        let before = light.vertices()[last - 1];
        let vertex = &mut light.vertices_mut()[last];
        let (to_light, _) = space.edge(vertex, &before).ok_or(Rejection::Dark)?;
        let ray = scatter(space, vertex, to_light, Transport::Importance, random);
        let met = space.meet(ray.ok_or(Rejection::Dark)?, false);
        light.push(PathVertex::surface(
            &met.ok_or(Rejection::Missed)?,
            Event::Finite,
        ));
    }
    Ok(())
}

/// Begins a light's side with a sampled ray, and the surface that it meets.
pub(super) fn emit(
    space: &PathSpace<'_>,
    light: &mut Path,
    random: &mut Stream,
) -> Result<(), Rejection> {
    let lights = space.scene.lights();
    let (u_choice, u_point) = (random.next_f32(), random.next_vec2());
    let chosen = lights.sample_emission(u_choice, u_point, random.next_vec2());
    let chosen = chosen.ok_or(Rejection::Dark)?;
    let ray = chosen.ray;
    if ray.value.is_black() {
        return Err(Rejection::Dark);
    }
    let class = lights.get(chosen.emitter).class();
    let is_near = !matches!(class, EmitterClass::Directional | EmitterClass::Environment);
    let sample = EmitterSample {
        direction: -ray.direction,
        target: is_near.then_some(ray.origin),
        radiance: ray.value,
        density: ray.density.direction,
        is_dirac: class.is_dirac(),
        surface: ray.surface,
    };
    let vertex = PathVertex::sampled_light(&sample, chosen.emitter, class);
    light.vertices_mut()[0] = vertex;
    let met = space.meet(Ray::new(ray.origin, ray.direction), false);
    light.push(PathVertex::surface(
        &met.ok_or(Rejection::Missed)?,
        Event::Finite,
    ));
    Ok(())
}

/// Samples a point of a light that a vertex asks for.
pub(super) fn sample_light(
    space: &PathSpace<'_>,
    from: &PathVertex,
    u: Vec2,
) -> Result<PathVertex, Rejection> {
    let lights = space.scene.lights();
    let chosen = lights.sample_toward(from.position(), u);
    let chosen = chosen.ok_or(Rejection::Dark)?;
    let class = lights.get(chosen.emitter).class();
    Ok(PathVertex::sampled_light(
        &chosen.sample,
        chosen.emitter,
        class,
    ))
}

/// Connects a vertex to the next: finds what both contribute, and whether they see each other.
pub(super) fn connect(space: &PathSpace<'_>, path: &mut Path, end: usize) -> Result<(), Rejection> {
    if end == 0 {
        let next = path.vertices()[1];
        space.lens_for(path, &next);
    }
    let vertices = path.vertices();
    let (mut from, mut to) = (vertices[end], vertices[end + 1]);
    if matches!(to.event, Event::Emission(class) if !class.is_connectable()) {
        return Err(Rejection::Dark);
    }
    let (direction, _) = space.edge(&from, &to).ok_or(Rejection::Dark)?;
    let finite = |vertex: &PathVertex, to_eye, to_light| {
        let mut vertex = *vertex;
        vertex.event = Event::Finite;
        vertex.adjoint = 1.0;
        vertex.value = space.finite_value(&vertex, to_eye, to_light);
        vertex
    };
    if end > 0 {
        let (to_eye, _) = space
            .edge(&from, &vertices[end - 1])
            .ok_or(Rejection::Dark)?;
        from = finite(&from, to_eye, direction);
    }
    match vertices.get(end + 2) {
        Some(after) => {
            let (to_light, _) = space.edge(&to, after).ok_or(Rejection::Dark)?;
            to = finite(&to, -direction, to_light);
        }
        None => to.value = space.emission(&to, -direction),
    }
    if from.value.is_black() || to.value.is_black() {
        return Err(Rejection::Dark);
    }
    if end == 0 {
        let raster = space.seen_at(&to, &from).ok_or(Rejection::OffImage)?;
        path.set_raster(raster);
    } else if !space.is_visible(&from, &to) {
        return Err(Rejection::Occluded);
    }
    let vertices = path.vertices_mut();
    vertices[end] = from;
    vertices[end + 1] = to;
    Ok(())
}
