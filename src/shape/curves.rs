//! Round curves: hairs, fibres, wires.
//!
//! The tracer says which segment a ray met, and how far along it. The point is worked out anew in
//! double precision, since a distance is not exact enough for thin hairs far from the origin.

use std::f32::consts::TAU;

use glam::DVec3;

use super::{Derivatives, ShapeError, ShapeHit, ShapeMemory, ShapeModel, SurfacePoint};
use crate::accel::{CurveBasis, CurveBuffer, Geometry};
use crate::math::{AreaDensity, Frame, Mat4, Vec2, Vec3};

/// The tracer's own error on B-splines, in multiples of that on triangles.
const B_SPLINE_ERROR: f32 = 4.0;

/// Curves of one kind, with a radius at each control point.
///
/// A linear segment is the surface of all spheres between its ends, so that ends are round. A cubic
/// B-spline is swept by circles across it and open at both ends. `u` goes around a curve, `v` along it,
/// from 0 to 1 over all segments of all curves, as in Mitsuba 3. Curves cannot emit.
#[derive(Clone, Debug)]
pub struct Curves {
    basis: CurveBasis,
    buffer: CurveBuffer,
    /// Which side normals point to: 1 outwards, −1 inwards.
    side: f32,
}

/// A point on the axis of a curve.
struct Axis {
    centre: DVec3,
    radius: f64,
    /// How both change along the segment.
    along: DVec3,
    widening: f64,
    /// How `along` changes.
    bend: DVec3,
}

/// The surface around a point of the axis.
struct Around {
    /// From the axis, unit.
    outwards: DVec3,
    normal: DVec3,
    /// How a point moves with its place along the segment, at one turn around it.
    along: DVec3,
}

impl Curves {
    /// Makes the curves.
    ///
    /// - `curves`: the control points of each curve, x, y, z and the radius there.
    /// - `to_world`: moves the points; radii stay what they are, as in Mitsuba 3.
    ///
    /// # Errors
    /// [`ShapeError::ShortCurve`], [`ShapeError::BadRadius`] for a negative radius,
    /// [`ShapeError::NotFinite`].
    pub fn new(
        basis: CurveBasis,
        curves: &[Vec<[f32; 4]>],
        to_world: Mat4,
    ) -> Result<Self, ShapeError> {
        let least = basis.points_per_segment();
        let (mut points, mut segments) = (Vec::new(), Vec::new());
        for curve in curves {
            let found = curve.len();
            if found < least {
                return Err(ShapeError::ShortCurve { found, least });
            }
            let first = points.len() as u32;
            segments.extend(first..first + (found - least + 1) as u32);
            for [x, y, z, radius] in curve {
                let placed = to_world.transform_point3(Vec3::new(*x, *y, *z));
                if !(placed.is_finite() && radius.is_finite()) {
                    return Err(ShapeError::NotFinite);
                }
                if *radius < 0.0 {
                    return Err(ShapeError::BadRadius);
                }
                points.push(placed.extend(*radius).to_array());
            }
        }
        Ok(Self {
            basis,
            buffer: CurveBuffer::new(points, segments),
            side: 1.0,
        })
    }

    /// Turns the normals to the other side.
    pub fn flip_normals(&mut self) {
        self.side = -self.side;
    }

    /// The control points of a segment, with their radii.
    pub fn segment(&self, index: u32) -> &[[f32; 4]] {
        let first = self.buffer.segments()[index as usize] as usize;
        &self.buffer.points()[first..first + self.basis.points_per_segment()]
    }

    /// Number of segments of all curves.
    pub fn segment_count(&self) -> usize {
        self.buffer.segments().len()
    }

    /// The middle and the radius of a segment at a place along it, in [0, 1].
    pub fn axis_point(&self, segment: u32, along: f64) -> (DVec3, f64) {
        let axis = self.axis(self.segment(segment), along);
        (axis.centre, axis.radius)
    }

    /// The axis of a segment at a place along it, in [0, 1].
    fn axis(&self, segment: &[[f32; 4]], at: f64) -> Axis {
        let [weights, slopes, bends] = match self.basis {
            CurveBasis::Linear => [[1.0 - at, at, 0.0, 0.0], [-1.0, 1.0, 0.0, 0.0], [0.0; 4]],
            CurveBasis::BSpline => b_spline(at),
        };
        let mut axis = Axis {
            centre: DVec3::ZERO,
            radius: 0.0,
            along: DVec3::ZERO,
            widening: 0.0,
            bend: DVec3::ZERO,
        };
        let factors = weights.into_iter().zip(slopes).zip(bends);
        for (point, ((weight, slope), bend)) in segment.iter().zip(factors) {
            let [x, y, z, radius] = point.map(f64::from);
            let centre = DVec3::new(x, y, z);
            axis.centre += centre * weight;
            axis.along += centre * slope;
            axis.bend += centre * bend;
            axis.radius += radius * weight;
            axis.widening += radius * slope;
        }
        axis
    }

    /// Where along a linear segment the sphere lies whose surface is nearest to a point.
    fn nearest_sphere(segment: &[[f32; 4]], point: DVec3) -> f64 {
        let [a, b] = [0, 1].map(|i| segment[i].map(f64::from));
        let start = DVec3::new(a[0], a[1], a[2]);
        let along = DVec3::new(b[0], b[1], b[2]) - start;
        let length = along.length();
        let narrowing = (a[3] - b[3]) / length;
        let is_cone = narrowing.abs() < 1.0;
        if !is_cone {
            // One of the spheres at the ends holds the other, or they are at one place.
            return f64::from(u8::from(b[3] > a[3]));
        }
        let height = (point - start).dot(along) / length;
        // Normals of the cone lean towards its narrow end: their spheres lie that far before the foot
        // of the point. From its distance to the axis alone this holds for points beside the surface.
        let across = (point - start - along * (height / length)).length();
        let lean = narrowing / (1.0 - narrowing * narrowing).sqrt();
        ((height - across * lean) / length).clamp(0.0, 1.0)
    }
}

/// Weights of the four control points of a uniform cubic B-spline, and their first and second
/// derivatives.
///
/// - `at`: place along the segment, in [0, 1].
fn b_spline(at: f64) -> [[f64; 4]; 3] {
    let rest = 1.0 - at;
    let weights = [
        rest * rest * rest,
        4.0 + at * at * (3.0 * at - 6.0),
        4.0 + rest * rest * (3.0 * rest - 6.0),
        at * at * at,
    ];
    let slopes = [
        -rest * rest,
        at * (3.0 * at - 4.0),
        -rest * (3.0 * rest - 4.0),
        at * at,
    ];
    let bends = [rest, 3.0 * at - 2.0, 3.0 * rest - 2.0, at];
    [weights.map(|w| w / 6.0), slopes.map(|s| s / 2.0), bends]
}

impl Axis {
    /// The unit direction along.
    fn direction(&self) -> DVec3 {
        self.along.try_normalize().unwrap_or(DVec3::Z)
    }

    /// A point of the sphere here, as linear curves have it.
    fn on_sphere(&self, near: DVec3) -> Around {
        let outwards = (near - self.centre).try_normalize().unwrap_or(DVec3::X);
        Around {
            outwards,
            normal: outwards,
            along: self.along + outwards * self.widening,
        }
    }

    /// A point of the circle across the axis here, as B-splines have it.
    fn on_circle(&self, near: DVec3) -> Around {
        let along = self.direction();
        let from_axis = near - self.centre;
        let across = from_axis - along * from_axis.dot(along);
        let outwards = across.try_normalize();
        let outwards =
            outwards.unwrap_or_else(|| Frame::around(along.as_vec3()).tangent.as_dvec3());
        let speed = self.along.length();
        // Inside of a bend, points move less than the axis.
        let stretch = speed - self.radius * outwards.dot(self.bend) / speed;
        let leaning = outwards * stretch - along * self.widening;
        // The direction that turns are counted from turns itself.
        let (level, up) = reference(along);
        let twist = DVec3::Z.cross(self.bend).dot(up) / DVec3::Z.cross(self.along).dot(level);
        let twist = if twist.is_finite() { twist } else { 0.0 };
        Around {
            outwards,
            normal: leaning.try_normalize().unwrap_or(outwards) * stretch.signum(),
            along: along * stretch
                + outwards * self.widening
                + along.cross(outwards) * (self.radius * twist),
        }
    }
}

impl ShapeModel for Curves {
    fn geometry(&self) -> Geometry {
        Geometry::Curves(self.basis, self.buffer.clone())
    }

    fn memory(&self) -> ShapeMemory {
        let (points, segments) = (self.buffer.points(), self.buffer.segments());
        ShapeMemory {
            shared: (size_of_val(points) + size_of_val(segments)) as u64,
            own: 0,
        }
    }

    fn prepare_sampling(&mut self) -> bool {
        false
    }

    // Out of line: paths have the code of triangles alone right where they need it.
    #[inline(never)]
    fn surface_at(&self, hit: &ShapeHit) -> SurfacePoint {
        let segment = self.segment(hit.primitive);
        let near = hit.position.as_dvec3();
        let at = match self.basis {
            CurveBasis::Linear => Self::nearest_sphere(segment, near),
            CurveBasis::BSpline => f64::from(hit.barycentrics.x),
        };
        let axis = self.axis(segment, at);
        let Around {
            outwards,
            normal,
            along,
        } = match self.basis {
            CurveBasis::Linear => axis.on_sphere(near),
            CurveBasis::BSpline => axis.on_circle(near),
        };
        let position = axis.centre + outwards * axis.radius;
        let normal = normal.as_vec3() * self.side;
        let count = self.segment_count() as f32;
        let (around, turn) = around(axis.direction(), outwards, axis.radius);
        let extent = segment
            .iter()
            .map(|[x, y, z, radius]| Vec3::new(*x, *y, *z).abs().max_element() + radius);
        let extent = extent.fold(0.0, f32::max);
        let error = match self.basis {
            CurveBasis::Linear => 1.0,
            CurveBasis::BSpline => B_SPLINE_ERROR,
        };
        SurfacePoint {
            position: position.as_vec3(),
            geometric_normal: normal,
            shading_normal: normal,
            derivatives: Derivatives::new(normal, turn, along.as_vec3() * count),
            uv: Vec2::new(around, (hit.primitive as f32 + at as f32) / count),
            error: error * SurfacePoint::error_bound(extent),
        }
    }

    fn area(&self) -> f64 {
        0.0
    }

    fn sample_area(&self, _: Vec2) -> (SurfacePoint, AreaDensity) {
        let somewhere = ShapeHit {
            primitive: 0,
            barycentrics: Vec2::ZERO,
            position: Vec3::ZERO,
        };
        // No point is ever sampled: curves cannot emit.
        (self.surface_at(&somewhere), AreaDensity(0.0))
    }

    fn invert_area(&self, _: &SurfacePoint) -> Option<Vec2> {
        None
    }
}

/// The two directions across a unit axis that turns are counted from: the level one to its left, and
/// the one above, as in Mitsuba 3.
fn reference(along: DVec3) -> (DVec3, DVec3) {
    let level = DVec3::Z.cross(along).try_normalize();
    let level = level.unwrap_or(DVec3::Y);
    (level, along.cross(level))
}

/// How far around its axis a direction lies, as a fraction of a turn, and how a point moves with that.
fn around(along: DVec3, outwards: DVec3, radius: f64) -> (f32, Vec3) {
    let (level, up) = reference(along);
    let angle = outwards.dot(up).atan2(outwards.dot(level)) as f32;
    let turn = angle / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    let circumference = f64::from(TAU) * radius;
    (turn, (along.cross(outwards) * circumference).as_vec3())
}

#[cfg(test)]
mod tests;
