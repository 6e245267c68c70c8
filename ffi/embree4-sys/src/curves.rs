//! What curves must be for Embree to take them.

use std::sync::Arc;

use crate::bindings;
use crate::buffers::{CurveBuffer, VertexBuffer};
use crate::builder::{GeometryId, Kept, SceneBuilder};
use crate::error::Error;

/// What lies between the control points of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveBasis {
    /// Straight pieces: the surface of all spheres between two control points.
    Linear,
    /// Cubic uniform B-splines: the surface of all circles across the curve.
    BSpline,
}

impl CurveBasis {
    /// Control points of a segment.
    pub fn points_per_segment(self) -> usize {
        match self {
            Self::Linear => 2,
            Self::BSpline => 4,
        }
    }

    /// Finds what Embree would read out of bounds or leave out silently.
    ///
    /// # Errors
    /// As [`SceneBuilder::add_curves`].
    pub fn check(self, curves: &CurveBuffer) -> Result<(), Error> {
        let (points, segments) = (curves.points(), curves.segments());
        for (what, count) in [
            ("control points", points.len()),
            ("segments", segments.len()),
        ] {
            if u32::try_from(count).is_err() {
                return Err(Error::TooMany { what, count });
            }
        }
        // Written so that not-a-number fails.
        let usable = |point: &[f32; 4]| point.iter().all(|c| c.abs() <= VertexBuffer::LARGEST);
        if let Some(vertex) = points.iter().position(|point| !usable(point)) {
            let [x, y, z, _] = points[vertex];
            return Err(Error::BadVertex {
                vertex,
                position: [x, y, z],
            });
        }
        if let Some(point) = points.iter().position(|[_, _, _, radius]| *radius < 0.0) {
            let value = format!("{} at control point {point}", points[point][3]);
            return Err(Error::BadShape {
                what: "a curve",
                parameter: "radius",
                value,
            });
        }
        let last = self.points_per_segment() as u64 - 1;
        for (segment, &index) in segments.iter().enumerate() {
            if u64::from(index) + last >= points.len() as u64 {
                return Err(Error::IndexOutOfRange {
                    triangle: segment,
                    index,
                    vertices: points.len(),
                });
            }
        }
        Ok(())
    }
}

/// What the callbacks of linear curves need to know; holds what it points to.
#[derive(Debug)]
pub(crate) struct LinearCurves {
    shim: bindings::ShimCurves,
    #[expect(dead_code, reason = "held for its memory, not read")]
    curves: CurveBuffer,
}

// SAFETY: the pointers lead into the buffer that is held, which nothing changes.
unsafe impl Send for LinearCurves {}
// SAFETY: as above; shared access only reads.
unsafe impl Sync for LinearCurves {}

impl SceneBuilder {
    /// Adds round curves. The scene reads the buffer where it is and keeps it alive.
    ///
    /// A hit has `u` = how far along its segment it lies, in [0, 1], `v` = 0, and a normal that points
    /// outwards; the primitive is the segment.
    ///
    /// Linear segments are hulls of two spheres and exact, as spheres are; where segments follow each
    /// other in a buffer, what lies inside of a neighbour is no surface. They are user geometries: of
    /// Embree's own, some hits are lost where segments are shorter than 0.01 (3.13.5: 0.7 % at a length
    /// of 6e-4). B-splines are swept by circles across them, open at both ends, and Embree's own, in
    /// single precision.
    ///
    /// # Errors
    /// [`Error::BadVertex`] for a number that is not finite or beyond [`VertexBuffer::LARGEST`],
    /// [`Error::BadShape`] for a negative radius, [`Error::IndexOutOfRange`] with the segment for a
    /// triangle, [`Error::TooMany`], [`Error::Embree`] for want of memory.
    pub fn add_curves(
        &mut self,
        basis: CurveBasis,
        curves: &CurveBuffer,
    ) -> Result<GeometryId, Error> {
        basis.check(curves)?;
        match basis {
            CurveBasis::Linear => self.add_linear_curves(curves),
            CurveBasis::BSpline => self.add_b_splines(curves),
        }
    }

    fn add_linear_curves(&mut self, curves: &CurveBuffer) -> Result<GeometryId, Error> {
        let kept = Arc::new(LinearCurves {
            shim: bindings::ShimCurves {
                points: curves.points().as_ptr(),
                segments: curves.segments().as_ptr(),
                segment_count: curves.segments().len() as u32,
            },
            curves: curves.clone(),
        });
        // SAFETY: the device is live; what the callbacks read stays at its address, unchanged, because
        // `attach` keeps it for as long as the scene that owns the geometry.
        let geometry =
            unsafe { bindings::shim_new_linear_curves(self.device.handle(), &raw const kept.shim) };
        self.device.check("make curves")?;
        self.attach(geometry, Kept::Linear(kept))
    }

    fn add_b_splines(&mut self, curves: &CurveBuffer) -> Result<GeometryId, Error> {
        // SAFETY: the device is live.
        let geometry = unsafe {
            bindings::rtcNewGeometry(
                self.device.handle(),
                bindings::RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE,
            )
        };
        self.device.check("make curves")?;
        // SAFETY: Embree only reads through these pointers. The buffers have the stated number of
        // elements of the stated format, whose size is that of the elements; `attach` keeps them
        // alive and in place for as long as the scene that owns the geometry.
        unsafe {
            bindings::rtcSetSharedGeometryBuffer(
                geometry,
                bindings::RTC_BUFFER_TYPE_VERTEX,
                0,
                bindings::RTC_FORMAT_FLOAT4,
                curves.points().as_ptr().cast(),
                0,
                size_of::<[f32; 4]>(),
                curves.points().len(),
            );
            bindings::rtcSetSharedGeometryBuffer(
                geometry,
                bindings::RTC_BUFFER_TYPE_INDEX,
                0,
                bindings::RTC_FORMAT_UINT,
                curves.segments().as_ptr().cast(),
                0,
                size_of::<u32>(),
                curves.segments().len(),
            );
        }
        self.attach(geometry, Kept::BSplines(curves.clone()))
    }
}
