//! The geometries of the second tracer.

use embree4_sys::{
    CurveBasis, CurveBuffer, Error, IndexBuffer, VertexBuffer, check_map, check_sphere,
    check_triangles,
};
use glam::{DMat3, DVec3};

use super::line::{Box3, Crossing, Line};
use super::{cone, round, spline, triangle};
use crate::accel::Geometry;

/// A geometry in double precision; triangles and curves are read where they are.
#[derive(Debug)]
pub(super) enum Solid {
    Triangles(VertexBuffer, IndexBuffer),
    Curves(CurveBasis, CurveBuffer),
    Sphere {
        centre: DVec3,
        radius: f64,
    },
    Disk {
        linear: DMat3,
        origin: DVec3,
    },
    Cylinder {
        linear: DMat3,
        inverse: DMat3,
        origin: DVec3,
    },
}

impl Solid {
    /// Takes what a tracer is given.
    ///
    /// # Errors
    /// As the adding methods of [`embree4_sys::SceneBuilder`].
    pub(super) fn new(geometry: Geometry) -> Result<Self, Error> {
        Ok(match geometry {
            Geometry::Triangles(vertices, triangles) => {
                check_triangles(vertices.as_slice(), triangles.as_slice())?;
                Self::Triangles(vertices, triangles)
            }
            Geometry::Curves(basis, curves) => {
                basis.check(&curves)?;
                Self::Curves(basis, curves)
            }
            Geometry::Sphere { centre, radius } => {
                check_sphere(centre.to_array(), radius)?;
                Self::Sphere {
                    centre: centre.as_dvec3(),
                    radius: f64::from(radius),
                }
            }
            Geometry::Disk(to_world) => {
                check_map("a disk", &to_world)?;
                let (linear, origin) = affine(&to_world);
                Self::Disk { linear, origin }
            }
            Geometry::Cylinder(to_world) => {
                check_map("a cylinder", &to_world)?;
                let (linear, origin) = affine(&to_world);
                Self::Cylinder {
                    inverse: linear.inverse(),
                    linear,
                    origin,
                }
            }
        })
    }

    pub(super) fn primitive_count(&self) -> u32 {
        match self {
            Self::Triangles(_, triangles) => triangles.as_slice().len() as u32,
            Self::Curves(_, curves) => curves.segments().len() as u32,
            Self::Sphere { .. } | Self::Disk { .. } | Self::Cylinder { .. } => 1,
        }
    }

    /// The box around a primitive.
    pub(super) fn bounds(&self, primitive: u32) -> Box3 {
        match self {
            Self::Triangles(vertices, triangles) => {
                Box3::around(corners(vertices, triangles, primitive))
            }
            Self::Curves(CurveBasis::Linear, curves) => cone::bounds(curves, primitive as usize),
            Self::Curves(CurveBasis::BSpline, curves) => spline::bounds(curves, primitive as usize),
            Self::Sphere { centre, radius } => let_out(*centre, DVec3::splat(*radius)),
            Self::Disk { linear, origin } => let_out(*origin, reach(linear)),
            Self::Cylinder { linear, origin, .. } => {
                let ends = [*origin, *origin + linear.z_axis];
                let ends = ends.map(|end| let_out(end, reach(linear)));
                Box3 {
                    low: ends[0].low.min(ends[1].low),
                    high: ends[0].high.max(ends[1].high),
                }
            }
        }
    }

    /// Where a line crosses a primitive first.
    pub(super) fn cross(&self, primitive: u32, line: &Line) -> Option<Crossing> {
        match self {
            Self::Triangles(vertices, triangles) => {
                triangle::cross(corners(vertices, triangles, primitive), line)
            }
            Self::Curves(CurveBasis::Linear, curves) => {
                cone::cross(curves, primitive as usize, line)
            }
            Self::Curves(CurveBasis::BSpline, curves) => {
                spline::cross(curves, primitive as usize, line)
            }
            Self::Sphere { centre, radius } => round::cross_sphere(*centre, *radius, line),
            Self::Disk { linear, origin } => round::cross_disk(linear, *origin, line),
            Self::Cylinder {
                inverse, origin, ..
            } => round::cross_cylinder(inverse, *origin, line),
        }
    }
}

fn corners(vertices: &VertexBuffer, triangles: &IndexBuffer, primitive: u32) -> [DVec3; 3] {
    let indices = triangles.as_slice()[primitive as usize];
    indices.map(|index| DVec3::from_array(vertices.as_slice()[index as usize].map(f64::from)))
}

/// How far the images of unit circles around z reach along each axis.
fn reach(linear: &DMat3) -> DVec3 {
    let (x, y) = (linear.x_axis, linear.y_axis);
    (x * x + y * y).map(f64::sqrt)
}

/// A box of half a width around a middle, and rounding.
fn let_out(middle: DVec3, reach: DVec3) -> Box3 {
    let reach = reach + (middle.abs() + reach) * 1e-12;
    Box3 {
        low: middle - reach,
        high: middle + reach,
    }
}

/// Linear part and translation of an affine map by rows.
pub(super) fn affine(rows: &[[f32; 4]; 3]) -> (DMat3, DVec3) {
    let column = |i: usize| DVec3::from_array(rows.map(|row| f64::from(row[i])));
    (DMat3::from_cols(column(0), column(1), column(2)), column(3))
}
