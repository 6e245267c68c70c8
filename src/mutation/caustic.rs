//! The caustic perturbation.

use super::fault;
use super::kernel::{AngleKernel, turned};
use super::{Fault, Mutate, Perturbation, Rejection, Site};
use crate::accel::Ray;
use crate::emitter::EmitterClass;
use crate::math::{Rgb, Vec3};
use crate::path::{Event, Path, PathSpace, PathVertex, VertexKind};
use crate::random::Stream;
use crate::sensor::SensorModel;

/// How far a caustic perturbation turns the direction at its head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CausticKernel {
    /// By an angle whose logarithm is uniform.
    ///
    /// Source: Veach & Guibas 1997, Sec. 5.3; Cline et al. 2005, Sec. 4.3.
    Logarithmic(AngleKernel),
    /// By an angle that is uniform up to a largest one, which moves the path by about `pixels` on the
    /// image: `θ(pixels) · |x_0 x_1| / Σ` lengths of the edges from the head to `x_1`.
    ///
    /// Differs: their sum is misprinted; see `docs/errata.md`.
    ///
    /// Source: Lai et al. 2007, Eq. 2.
    Pixels {
        /// The distance on the image.
        pixels: f32,
        /// Angle that a pixel in the middle of the image subtends, in radians.
        angle_of_pixel: f32,
    },
}

/// Turns the direction in which light leaves the second finite vertex from the eye, or the light,
/// follows the Dirac events to the first finite vertex and connects that to the lens.
///
/// Applies to paths `E D S* (D|L) …` whose head is a surface or a point light.
///
/// Source: Cline et al. 2005, Sec. 4.3.
#[derive(Clone, Copy, Debug)]
pub struct CausticPerturbation;

/// No move turns by more than a right angle, in radians: neither there nor back.
pub(super) const LARGEST_TURN: f32 = std::f32::consts::FRAC_PI_2;

/// Index of the vertex whose outgoing direction is turned.
pub(super) fn head(path: &Path) -> Option<usize> {
    let vertices = path.vertices();
    if vertices.get(1)?.event != Event::Finite {
        return None;
    }
    let head = 2 + vertices[2..].iter().position(|v| !v.event.is_dirac())?;
    let can_turn = matches!(
        vertices[head].event,
        Event::Finite | Event::Emission(EmitterClass::Area | EmitterClass::Point)
    );
    can_turn.then_some(head)
}

/// Largest angle of [`CausticKernel::Pixels`] at a path.
pub(super) fn largest_angle(space: &PathSpace<'_>, path: &Path, head: usize, angle: f32) -> f32 {
    let vertices = path.vertices();
    let length = |a: &PathVertex, b: &PathVertex| a.position().distance(b.position());
    let chain: f32 = vertices[1..=head]
        .windows(2)
        .map(|pair| length(&pair[0], &pair[1]))
        .sum();
    let seen = vertices[0]
        .position()
        .distance_squared(vertices[1].position());
    angle * space.sensor.spread(seen).sqrt() / chain
}

impl CausticPerturbation {
    /// True when the path's second vertex from the eye is a Dirac event: a caustic proper.
    #[inline]
    pub fn is_caustic(path: &Path) -> bool {
        path.vertices().get(2).is_some_and(|v| v.event.is_dirac())
    }
}

impl Mutate for CausticPerturbation {
    #[inline]
    fn site(&self, path: &Path) -> Option<Site> {
        head(path).map(|head| Site {
            last_moved: head - 1,
            last_changed: head,
        })
    }

    /// In the coordinates of the direction at the head and the point of the lens: with `h` the head and
    /// `θ_h`, `φ_1` angles to geometric normals,
    /// `L_e or f_s · |cos θ_h| · Π coefficients · f_s(y_1) · |cos φ_1| / d² · pixels per steradian`.
    fn factor(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        path: &Path,
        site: Site,
    ) -> f64 {
        let (head, vertices) = (site.last_changed, path.vertices());
        let edge = |from: usize, to: usize| space.edge(&vertices[from], &vertices[to]);
        let (Some((out, _)), Some((in_1, _)), Some((seen, distance_squared))) =
            (edge(head, head - 1), edge(1, 2), edge(0, 1))
        else {
            return 0.0;
        };
        let keep = |fault, factor| settings.fault.keep(fault, f64::from(factor));
        let cos = |index: usize, direction| vertices[index].geometric_cos(direction);
        let mut factor = keep(
            Fault::PixelsPerSteradian,
            space.sensor.pixels_per_steradian(seen),
        );
        factor /= keep(Fault::ImageDistance, space.sensor.spread(distance_squared));
        factor *= keep(Fault::ImageCosine, cos(1, seen));
        factor *= keep(Fault::HeadCosine, cos(head, out));
        // The value at x_1 holds the cosine to the shading normal: f_s is that over the true one.
        factor /= keep(Fault::FirstCosine, cos(1, in_1));
        for index in 2..head {
            factor *= fault::adjoint(space, settings, path, index);
        }
        // Without the number of pixels, which all paths share: so the target is one for any number.
        if let CausticKernel::Pixels { angle_of_pixel, .. } = settings.caustic {
            let largest = largest_angle(space, path, head, angle_of_pixel);
            factor /= keep(Fault::LargestAngle, largest);
        }
        factor
    }

    fn propose(
        &self,
        space: &PathSpace<'_>,
        settings: &Perturbation,
        site: Site,
        (current, proposal): (&Path, &mut Path),
        random: &mut Stream,
    ) -> Result<f64, Rejection> {
        let (head, old) = (site.last_changed, current.vertices());
        // Before the lens moves: how far directions turn belongs to the path as it is.
        let angle = match settings.caustic {
            CausticKernel::Logarithmic(kernel) => kernel.angle(random.next_f32()),
            CausticKernel::Pixels {
                pixels,
                angle_of_pixel,
            } => random.next_f32() * largest_angle(space, current, head, pixels * angle_of_pixel),
        };
        if angle > LARGEST_TURN {
            return Err(Rejection::NoWayBack);
        }
        let lens = super::lens_point::perturb(space, settings, old[0].position(), random)?;
        let (value, mut ray) = leave_head(space, old, head, (angle, random.next_f32()))?;
        proposal.vertices_mut()[head].value = value;
        for index in (2..head).rev() {
            let vertex = &mut proposal.vertices_mut()[index];
            ray = pass(space, (vertex, old[index].event), ray)?;
        }
        connect(space, (proposal, lens), ray)?;
        if !settings.domain.contains(proposal.raster()) {
            return Err(Rejection::OffImage);
        }
        if let CausticKernel::Pixels {
            pixels,
            angle_of_pixel,
        } = settings.caustic
        {
            let largest = largest_angle(space, proposal, head, pixels * angle_of_pixel);
            if angle > largest && !settings.fault.is(Fault::WayBack) {
                return Err(Rejection::NoWayBack);
            }
        }
        Ok(self.factor(space, settings, proposal, site))
    }
}

/// Turns the direction at the head; returns its value and the ray that leaves it.
fn leave_head(
    space: &PathSpace<'_>,
    vertices: &[PathVertex],
    head: usize,
    (angle, azimuth): (f32, f32),
) -> Result<(Rgb, Ray), Rejection> {
    let (old, _) = space
        .edge(&vertices[head], &vertices[head - 1])
        .ok_or(Rejection::Dark)?;
    let direction = turned(old, angle, azimuth);
    let vertex = &vertices[head];
    let value = match vertices.get(head + 1) {
        Some(after) => {
            let (to_light, _) = space.edge(vertex, after).ok_or(Rejection::Dark)?;
            space.finite_value(vertex, direction, to_light)
        }
        None => space.emission(vertex, direction),
    };
    if value.is_black() {
        return Err(Rejection::Dark);
    }
    let ray = match vertex.kind {
        VertexKind::Surface => space.leave(vertex, direction),
        _ => Ray::new(vertex.position(), direction),
    };
    Ok((value, ray))
}

/// Follows a Dirac event towards the eye; returns the ray that leaves it.
///
/// - `vertex`: becomes that of the event.
fn pass(
    space: &PathSpace<'_>,
    (vertex, event): (&mut PathVertex, Event),
    ray: Ray,
) -> Result<Ray, Rejection> {
    let met = space.meet_at(ray, false, event, vertex);
    met.ok_or(Rejection::Missed)?;
    let followed = space
        .follow_back(vertex, event, -ray.direction())
        .ok_or(Rejection::SignatureChanged)?;
    vertex.value = followed.value;
    vertex.adjoint = followed.adjoint;
    Ok(space.leave(vertex, followed.direction))
}

/// Makes the first finite vertex and connects it to a point of the lens.
fn connect(
    space: &PathSpace<'_>,
    (proposal, lens): (&mut Path, Vec3),
    ray: Ray,
) -> Result<(), Rejection> {
    let vertices = proposal.vertices_mut();
    let met = space.meet_at(ray, false, Event::Finite, &mut vertices[1]);
    if !met.ok_or(Rejection::Missed)?.lobes.finite {
        return Err(Rejection::SignatureChanged);
    }
    let lens = space.sensor.lens_before(vertices[1].position(), lens);
    vertices[0] = PathVertex::sensor(lens);
    let (seen, _) = space
        .edge(&vertices[0], &vertices[1])
        .ok_or(Rejection::Dark)?;
    let value = space.finite_value(&vertices[1], -seen, -ray.direction());
    if value.is_black() {
        return Err(Rejection::Dark);
    }
    vertices[1].value = value;
    let raster = space.seen_at(&vertices[1], &vertices[0]);
    proposal.set_raster(raster.ok_or(Rejection::OffImage)?);
    Ok(())
}
