//! The ratio of an acceptance, written out in full in two ways.
//!
//! `f(ȳ) T(ȳ → x̄) / (f(x̄) T(x̄ → ȳ))` with `f` the luminance of the measurement contribution and `T` the
//! density of proposing. Chains use the ratio of [`Mutate::target`](super::Mutate::target), where most of
//! this has cancelled; the three must agree.

use super::caustic::{LARGEST_TURN, head, largest_angle};
use super::forward::last_moved;
use super::{AngleKernel, CausticKernel, Mutation, Perturbation};
use crate::math::Vec3;
use crate::path::{Coordinates, Event, Generation, Path, PathSpace, PathVertex, luminance};
use crate::sensor::SensorModel;

/// Logarithm of the ratio by the rules of Cline et al.: the tracer's estimates, times the change of
/// the path's density, times that of the transition, in the coordinates of the density.
///
/// `None` where the tracer does not make such paths in this way, or the mutation does not apply.
///
/// - `made`: how the path tracer makes both paths; the ratio does not depend on it.
///
/// Source: Cline et al. 2005, Eq. 6, Sec. 4.2 and App. A.
pub fn log_ratio_by_rules(
    mutation: Mutation,
    space: &PathSpace<'_>,
    settings: &Perturbation,
    made: Generation,
    (current, proposal): (&Path, &Path),
) -> Option<f64> {
    let coordinates = coordinates(mutation, current, made)?;
    let log = |path: &Path| {
        let estimate = luminance(space.estimate(path, made)?);
        let density = space.density(path, made, coordinates)?;
        let conversion = conversion(mutation, space, settings, path, coordinates)?;
        Some(estimate.ln() + density.ln() + conversion.ln())
    };
    Some(log(proposal)? - log(current)?)
}

/// Coordinates in which the rules state the density of a path that a mutation changes.
fn coordinates(mutation: Mutation, path: &Path, made: Generation) -> Option<Coordinates> {
    use crate::path::Technique::Implicit;
    if mutation == Mutation::Caustic {
        let head = head(path)?;
        // A chain of Dirac events decides where the head is; without one, it is a point that was
        // connected or sampled, or that a ray has met.
        let is_met = head == path.edges() && made.technique == Implicit;
        return Some(Coordinates {
            raster: false,
            directions: if head > 2 || is_met { 1 << 1 } else { 0 },
        });
    }
    let last = last_moved(path, usize::MAX)?;
    let turned = |index: &usize| path.vertices()[*index].event == Event::Finite;
    let directions = match mutation {
        Mutation::MultiChain => (1..last).filter(turned).fold(0, |bits, i| bits | (1 << i)),
        _ => 0,
    };
    // A path that reaches its light by a ray does so in a direction, or at a point: both are one.
    Some(Coordinates {
        raster: true,
        directions,
    })
}

/// What turns the density of proposing a path in the mutation's own coordinates, where a move and its
/// way back are equally likely, into one in the coordinates of the rules: its inverse, as a factor of
/// the path.
///
/// For the caustic perturbation, whose own coordinate is the direction at the head, that is the
/// conservation of étendue `n² dA |cos θ| dω` along the chain of Dirac events, or `dA = d² dω / |cos θ|`
/// where there is none.
fn conversion(
    mutation: Mutation,
    space: &PathSpace<'_>,
    settings: &Perturbation,
    path: &Path,
    coordinates: Coordinates,
) -> Option<f64> {
    if mutation != Mutation::Caustic {
        return Some(1.0);
    }
    let head = head(path)?;
    let vertices = path.vertices();
    let (out, _) = space.edge(&vertices[head], &vertices[head - 1])?;
    let (in_1, distance_squared) = space.edge(&vertices[1], &vertices[2])?;
    let cos_head = f64::from(vertices[head].geometric_cos(out));
    let cos_1 = f64::from(vertices[1].geometric_cos(in_1));
    let mut conversion = if coordinates.has_direction(1) {
        cos_head / cos_1
    } else {
        f64::from(distance_squared) / cos_1
    };
    for index in 2..head {
        // Index of refraction towards the eye over that towards the light.
        let eta = f64::from(space.selection(path, index)?.eta);
        conversion *= space.shading_factor(path, index)? / (eta * eta);
    }
    if let CausticKernel::Pixels {
        pixels,
        angle_of_pixel,
    } = settings.caustic
    {
        conversion /= f64::from(largest_angle(space, path, head, pixels * angle_of_pixel));
    }
    Some(conversion)
}

/// Logarithm of the ratio in area-product measure: contributions with all geometry terms, and densities
/// of proposing as densities of the positions of all vertices.
///
/// `None` where the mutation does not apply, or never makes one path of the other.
///
/// Source: van Antwerpen 2011, Eqs. 2.13 and 6.5 to 6.11.
pub fn log_ratio_by_measure(
    mutation: Mutation,
    space: &PathSpace<'_>,
    settings: &Perturbation,
    (current, proposal): (&Path, &Path),
) -> Option<f64> {
    let backward = match mutation {
        Mutation::Caustic => 2..head(current)?,
        _ => 0..0,
    };
    let log = |from: &Path, to: &Path| {
        let contribution = space.contribution(to, backward.clone())?;
        Some(contribution.ln() + log_transition(mutation, space, settings, (to, from))?)
    };
    Some(log(current, proposal)? - log(proposal, current)?)
}

/// Logarithm of the density with which a mutation proposes a path from another, in area-product measure.
///
/// Of the Dirac events' deltas, per solid angle, and of vertices that stay, per area, nothing is kept.
/// `None` where it never does.
///
/// Source: van Antwerpen 2011, Sec. 6.3.
pub fn log_transition(
    mutation: Mutation,
    space: &PathSpace<'_>,
    settings: &Perturbation,
    (from, to): (&Path, &Path),
) -> Option<f64> {
    let density = match mutation {
        Mutation::Caustic => caustic_transition(space, settings, from, to)?,
        _ => forward_transition(mutation, space, settings, (from, to))?,
    };
    let density = density * lens_density(space, settings, from, to);
    (density > 0.0).then(|| density.ln())
}

/// Density of a move on the lens, in units of its radius; one without a lens.
fn lens_density(space: &PathSpace<'_>, settings: &Perturbation, from: &Path, to: &Path) -> f64 {
    if !space.sensor.has_lens() {
        return 1.0;
    }
    let [a, b] = [from, to].map(|path| {
        let point = path.vertices()[0].position();
        space.sensor.lens_coordinates(point)
    });
    // Recovering coordinates from positions errs a little.
    let is_inside = a.distance(b) <= settings.lens * 1.001 + 1e-3;
    f64::from(u8::from(is_inside)) / (std::f64::consts::PI * f64::from(settings.lens).powi(2))
}

/// Density of a turn of the edge between two vertices, in 1/sr, each edge given by its ends.
///
/// Directions that are recovered from positions are off by as much as positions are, which must not take
/// a move out of the kernel's range.
fn turn_density(
    kernel: AngleKernel,
    space: &PathSpace<'_>,
    before: [&PathVertex; 2],
    after: [&PathVertex; 2],
) -> Option<f64> {
    let angle = angle_between(
        space.edge(before[0], before[1])?.0,
        space.edge(after[0], after[1])?.0,
    );
    let slack: f64 = 1e-5 + direction_error(before) + direction_error(after);
    let (inner, outer) = (f64::from(kernel.inner), f64::from(kernel.outer));
    let is_inside = (inner - slack..outer + slack).contains(&angle);
    is_inside.then(|| kernel.density(angle.clamp(inner, outer)))
}

/// How far the direction of an edge may be off, in radians: rays start off the surface by the error of
/// its points, and end within it.
fn direction_error([from, to]: [&PathVertex; 2]) -> f64 {
    let error = 4.0 * (from.point.error + to.point.error);
    f64::from(error / from.position().distance(to.position()))
}

/// The angle between two unit directions, accurate for small ones.
fn angle_between(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    a.cross(b).length().atan2(a.dot(b))
}

/// Lens, multi-chain and Lai lens perturbation.
fn forward_transition(
    mutation: Mutation,
    space: &PathSpace<'_>,
    settings: &Perturbation,
    (from, to): (&Path, &Path),
) -> Option<f64> {
    let last = last_moved(from, usize::MAX)?;
    let (old, new) = (from.vertices(), to.vertices());
    // The offset was rounded when it was added: it may have left the kernel's range.
    let offset = to.raster() - from.raster();
    let density_at = |scale: f32| settings.raster.density(offset * scale);
    let mut density = density_at(1.0 - 1e-5).max(density_at(1.0 + 1e-5));
    density *= space.pixels_per_area(to)?;
    for index in 1..last {
        let per_area = space.solid_angle_per_area(&new[index], &new[index + 1]);
        if new[index].event.is_dirac() {
            density *= per_area;
        } else if mutation == Mutation::MultiChain {
            let before = [&old[index], &old[index + 1]];
            let after = [&new[index], &new[index + 1]];
            density *= turn_density(settings.angle, space, before, after)? * per_area;
        }
    }
    Some(density)
}

/// Caustic perturbation.
fn caustic_transition(
    space: &PathSpace<'_>,
    settings: &Perturbation,
    from: &Path,
    to: &Path,
) -> Option<f64> {
    let head_index = head(from)?;
    let (old, new) = (from.vertices(), to.vertices());
    let before = [&old[head_index], &old[head_index - 1]];
    let after = [&new[head_index], &new[head_index - 1]];
    let mut density = match settings.caustic {
        CausticKernel::Logarithmic(kernel) => turn_density(kernel, space, before, after)?,
        CausticKernel::Pixels {
            pixels,
            angle_of_pixel,
        } => {
            let outer = largest_angle(space, from, head_index, pixels * angle_of_pixel);
            let angle = angle_between(
                space.edge(before[0], before[1])?.0,
                space.edge(after[0], after[1])?.0,
            );
            let slack = 1e-5 + direction_error(before) + direction_error(after);
            let is_inside = angle <= f64::from(outer.min(LARGEST_TURN)) + slack;
            let density = 1.0 / (std::f64::consts::TAU * angle.sin() * f64::from(outer));
            is_inside.then_some(density)?
        }
    };
    for index in (2..=head_index).rev() {
        density *= space.solid_angle_per_area(&new[index], &new[index - 1]);
    }
    Some(density)
}
