//! Affine maps with their inverse, as scene files write them.
//!
//! Kept in `f64`: a scene file chains many factors, and the camera's inverse must agree with the
//! camera. Use [`Transform::matrix`] where single precision is enough.

use glam::{DMat3, DMat4, DVec3, Mat4, Vec3};
use thiserror::Error;

/// An invertible affine map of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    matrix: DMat4,
    inverse: DMat4,
}

/// Why numbers do not describe a [`Transform`].
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TransformError {
    /// The matrix flattens space and cannot be inverted.
    #[error("the matrix is singular: it flattens space and has no inverse")]
    Singular,
    /// The last row is not 0 0 0 1.
    #[error("the last row of the matrix is not 0 0 0 1")]
    NotAffine,
    /// A number is infinite or not a number.
    #[error("the matrix holds a number that is not finite")]
    NotFinite,
    /// A rotation about the zero vector.
    #[error("the axis of rotation is zero")]
    NoAxis,
    /// A camera that looks at the point where it stands.
    #[error("origin and target are the same point")]
    NoDirection,
    /// A camera whose up vector lies along its view.
    #[error("the up vector is zero or parallel to the viewing direction")]
    NoUp,
}

/// A matrix counts as singular when its determinant is below this fraction of the product of its
/// columns' lengths: far above the rounding of `f64`, far below the skew of any real object.
const SINGULAR: f64 = 1e-12;

impl Transform {
    /// The map that leaves everything where it is.
    pub const IDENTITY: Self = Self {
        matrix: DMat4::IDENTITY,
        inverse: DMat4::IDENTITY,
    };

    /// Makes a transform from a matrix that acts on column vectors.
    ///
    /// # Errors
    /// The matrix is singular, not affine, or holds numbers that are not finite.
    pub fn from_matrix(matrix: DMat4) -> Result<Self, TransformError> {
        if !matrix.is_finite() {
            return Err(TransformError::NotFinite);
        }
        let last_row = matrix.row(3);
        if last_row.truncate().abs().max_element() > 1e-6 || (last_row.w - 1.0).abs() > 1e-6 {
            return Err(TransformError::NotAffine);
        }
        let linear = DMat3::from_mat4(matrix);
        let lengths = linear.x_axis.length() * linear.y_axis.length() * linear.z_axis.length();
        let volume = linear.determinant().abs();
        if volume.is_nan() || volume <= SINGULAR * lengths {
            return Err(TransformError::Singular);
        }
        let inverse = matrix.inverse();
        if inverse.is_finite() {
            Ok(Self { matrix, inverse })
        } else {
            Err(TransformError::Singular)
        }
    }

    /// Shifts by `offset`.
    ///
    /// # Errors
    /// The offset is not finite.
    pub fn translate(offset: DVec3) -> Result<Self, TransformError> {
        Self::from_matrix(DMat4::from_translation(offset))
    }

    /// Stretches each axis by its factor; negative factors mirror.
    ///
    /// # Errors
    /// A factor is zero or not finite.
    pub fn scale(factors: DVec3) -> Result<Self, TransformError> {
        Self::from_matrix(DMat4::from_scale(factors))
    }

    /// Turns by `degrees` about `axis` (any length), counter-clockwise as seen from its tip.
    ///
    /// # Errors
    /// The axis is zero, or a number is not finite.
    pub fn rotate(axis: DVec3, degrees: f64) -> Result<Self, TransformError> {
        if !(axis.is_finite() && degrees.is_finite()) {
            return Err(TransformError::NotFinite);
        }
        let axis = axis.try_normalize().ok_or(TransformError::NoAxis)?;
        Self::from_matrix(DMat4::from_axis_angle(axis, degrees.to_radians()))
    }

    /// Places a camera at `origin` that looks along its +Z towards `target`, with +X to its left
    /// and +Y on the side of `up`.
    ///
    /// Without `up` any roll may come out.
    ///
    /// # Errors
    /// `origin` equals `target`, `up` is zero or parallel to the view, a number is not finite.
    pub fn look_at(
        origin: DVec3,
        target: DVec3,
        up: Option<DVec3>,
    ) -> Result<Self, TransformError> {
        let view = target - origin;
        if !(origin.is_finite() && view.is_finite() && up.unwrap_or(view).is_finite()) {
            return Err(TransformError::NotFinite);
        }
        let forward = view.try_normalize().ok_or(TransformError::NoDirection)?;
        let up = match up {
            Some(up) => up.try_normalize().ok_or(TransformError::NoUp)?,
            None => forward.any_orthonormal_vector(),
        };
        let left = up.cross(forward);
        if left.length() < 1e-6 {
            return Err(TransformError::NoUp);
        }
        let left = left.normalize();
        let true_up = forward.cross(left);
        Self::from_matrix(DMat4::from_cols(
            left.extend(0.0),
            true_up.extend(0.0),
            forward.extend(0.0),
            origin.extend(1.0),
        ))
    }

    /// This transform followed by `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            matrix: next.matrix * self.matrix,
            inverse: self.inverse * next.inverse,
        }
    }

    /// The map that undoes this one.
    #[must_use]
    pub fn invert(&self) -> Self {
        Self {
            matrix: self.inverse,
            inverse: self.matrix,
        }
    }

    /// The matrix, acting on column vectors.
    pub fn matrix(&self) -> Mat4 {
        self.matrix.as_mat4()
    }

    /// The matrix in full precision.
    pub fn matrix_f64(&self) -> DMat4 {
        self.matrix
    }

    /// The inverse matrix, acting on column vectors.
    pub fn inverse(&self) -> Mat4 {
        self.inverse.as_mat4()
    }

    /// Maps a position.
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.matrix.transform_point3(point.as_dvec3()).as_vec3()
    }

    /// Maps a difference of positions; its length changes with the scale.
    pub fn vector(&self, vector: Vec3) -> Vec3 {
        self.matrix.transform_vector3(vector.as_dvec3()).as_vec3()
    }

    /// Maps a surface normal so that it stays perpendicular to the surface, and makes it unit.
    ///
    /// Returns zero for the zero vector.
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        let transposed = DMat3::from_mat4(self.inverse).transpose();
        (transposed * normal.as_dvec3())
            .normalize_or_zero()
            .as_vec3()
    }

    /// True when the map turns left hands into right hands, as a mirror does.
    pub fn mirrors(&self) -> bool {
        DMat3::from_mat4(self.matrix).determinant() < 0.0
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(found: Vec3, expected: [f32; 3]) {
        assert!(
            found.distance(Vec3::from_array(expected)) < 1e-5,
            "{found} is not {expected:?}"
        );
    }

    #[test]
    fn a_camera_looks_along_z_with_x_to_its_left() {
        let camera =
            Transform::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, Some(DVec3::Y)).unwrap();
        assert_near(camera.point(Vec3::ZERO), [0.0, 0.0, 4.0]);
        assert_near(camera.vector(Vec3::Z), [0.0, 0.0, -1.0]);
        assert_near(camera.vector(Vec3::X), [-1.0, 0.0, 0.0]);
        assert_near(camera.vector(Vec3::Y), [0.0, 1.0, 0.0]);
        assert!(!camera.mirrors());
    }

    #[test]
    fn factors_apply_in_the_order_of_then() {
        let turn = Transform::rotate(DVec3::Z * 3.0, 90.0).unwrap();
        let shift = Transform::translate(DVec3::X).unwrap();
        assert_near(turn.then(&shift).point(Vec3::X), [1.0, 1.0, 0.0]);
        assert_near(shift.then(&turn).point(Vec3::X), [0.0, 2.0, 0.0]);
        let both = turn.then(&shift);
        assert_near(both.invert().point(both.point(Vec3::ONE)), [1.0; 3]);
    }

    #[test]
    fn normals_stay_perpendicular_under_uneven_scale() {
        let stretch = Transform::scale(DVec3::new(2.0, 1.0, 1.0)).unwrap();
        let (tangent, normal) = (Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, 1.0, 0.0));
        let dot = stretch.vector(tangent).dot(stretch.normal(normal));
        assert!(dot.abs() < 1e-6);
        assert!(
            Transform::scale(DVec3::new(-1.0, 1.0, 1.0))
                .unwrap()
                .mirrors()
        );
    }

    #[test]
    fn broken_numbers_are_refused_with_their_reason() {
        let flat = DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(Transform::from_matrix(flat), Err(TransformError::Singular));
        let rank_two = DMat3::from_cols_array(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let rank_two = Transform::from_matrix(DMat4::from_mat3(rank_two));
        assert_eq!(rank_two, Err(TransformError::Singular));
        assert_eq!(
            Transform::from_matrix(2.0 * DMat4::IDENTITY),
            Err(TransformError::NotAffine)
        );
        let at = |target, up| Transform::look_at(DVec3::ZERO, target, Some(up));
        assert_eq!(at(DVec3::ZERO, DVec3::Y), Err(TransformError::NoDirection));
        assert_eq!(at(DVec3::Y, DVec3::Y), Err(TransformError::NoUp));
        assert_eq!(at(DVec3::Y, DVec3::ZERO), Err(TransformError::NoUp));
        assert_eq!(
            Transform::rotate(DVec3::ZERO, 1.0),
            Err(TransformError::NoAxis)
        );
        let infinite = Transform::scale(DVec3::splat(f64::INFINITY));
        assert_eq!(infinite, Err(TransformError::NotFinite));
    }

    #[test]
    fn tiny_objects_are_not_singular() {
        let tiny = Transform::scale(DVec3::new(1e-9, 1e-9, 1.0)).unwrap();
        assert_near(tiny.invert().point(tiny.point(Vec3::ONE)), [1.0; 3]);
        assert!(Transform::look_at(DVec3::ZERO, DVec3::Y, None).is_ok());
    }
}
