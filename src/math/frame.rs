//! Orthonormal frames, and directions that are written in one.

use super::{Mat3, Mat4, Vec3};

/// A direction in a shading frame: unit, pointing away from the surface, `z` along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local(pub Vec3);

impl Local {
    /// The shading normal itself.
    pub const NORMAL: Self = Self(Vec3::Z);

    /// Makes a direction from its parts along tangent, bitangent and normal.
    #[inline]
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self(Vec3::new(x, y, z))
    }

    /// Signed cosine of the angle to the normal.
    #[inline]
    pub fn cos(self) -> f32 {
        self.0.z
    }

    /// Size of the cosine of the angle to the normal.
    #[inline]
    pub fn abs_cos(self) -> f32 {
        self.0.z.abs()
    }

    /// Squared sine of the angle to the normal.
    #[inline]
    pub fn sin_squared(self) -> f32 {
        (1.0 - self.0.z * self.0.z).max(0.0)
    }

    /// The direction of a perfect mirror.
    #[inline]
    pub fn mirrored(self) -> Self {
        Self::new(-self.0.x, -self.0.y, self.0.z)
    }

    /// The direction that goes straight on through the surface.
    #[inline]
    pub fn straight_on(self) -> Self {
        Self(-self.0)
    }

    /// The same direction seen from the back of the surface.
    #[inline]
    pub fn flipped(self) -> Self {
        Self::new(self.0.x, self.0.y, -self.0.z)
    }

    /// True when both directions lie on one side of the surface, and neither in its plane.
    #[inline]
    pub fn same_side(self, other: Self) -> bool {
        self.0.z * other.0.z > 0.0
    }
}

/// A right-handed orthonormal basis (tangent, bitangent, normal) in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First axis.
    pub tangent: Vec3,
    /// Second axis.
    pub bitangent: Vec3,
    /// Third axis.
    pub normal: Vec3,
}

impl Frame {
    /// Some frame around a unit normal.
    ///
    /// Continuous except where the normal's `z` changes sign.
    ///
    /// Source: Duff 2017, Listing 3.
    #[inline]
    pub fn around(normal: Vec3) -> Self {
        let sign = 1.0_f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: Vec3::new(
                1.0 + sign * normal.x * normal.x * a,
                sign * b,
                -sign * normal.x,
            ),
            bitangent: Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The frame around a unit normal whose tangent lies as near to `tangent` as it can.
    ///
    /// Falls back to [`Frame::around`] where `tangent` is zero or parallel to the normal.
    #[inline]
    pub fn with_tangent(normal: Vec3, tangent: Vec3) -> Self {
        let in_plane = tangent - normal * normal.dot(tangent);
        // Below this the subtraction has left mostly rounding.
        if in_plane.length_squared() > 1e-6 * tangent.length_squared() {
            let tangent = in_plane.normalize();
            Self {
                tangent,
                bitangent: normal.cross(tangent),
                normal,
            }
        } else {
            Self::around(normal)
        }
    }

    /// Writes a world-space direction in this frame.
    #[inline]
    pub fn to_local(&self, world: Vec3) -> Local {
        Local::new(
            world.dot(self.tangent),
            world.dot(self.bitangent),
            world.dot(self.normal),
        )
    }

    /// Writes a direction of this frame in world space.
    #[inline]
    pub fn to_world(&self, local: Local) -> Vec3 {
        self.tangent * local.0.x + self.bitangent * local.0.y + self.normal * local.0.z
    }
}

/// The axes of a transform without its scale and shear: unit and perpendicular, mirrored where the
/// transform mirrors.
///
/// The z axis keeps its direction, the x axis its plane with z. `None` where the transform flattens
/// them or holds numbers that are not finite.
pub fn rotation_part(transform: Mat4) -> Option<Mat3> {
    let column = |axis: glam::Vec4| axis.truncate().as_dvec3();
    let z = column(transform.z_axis).try_normalize()?;
    let x = column(transform.x_axis);
    let x = (x - z * z.dot(x)).try_normalize()?;
    let y = z.cross(x);
    let side = y.dot(column(transform.y_axis));
    let y = if side < 0.0 { -y } else { y };
    let axes = Mat3::from_cols(x.as_vec3(), y.as_vec3(), z.as_vec3());
    (side != 0.0 && axes.is_finite()).then_some(axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_part_drops_scale_and_shear_and_keeps_mirrors() {
        let rotation = Mat4::from_rotation_y(0.4) * Mat4::from_rotation_x(-1.1);
        let scaled = rotation * Mat4::from_scale(Vec3::new(-2.0, 3.0, 0.5));
        let expected = Mat3::from_mat4(rotation * Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
        assert!(rotation_part(scaled).unwrap().abs_diff_eq(expected, 1e-6));
        let mut sheared = Mat4::IDENTITY;
        sheared.x_axis.z = 0.7;
        sheared.y_axis.x = -0.2;
        assert!(
            rotation_part(sheared)
                .unwrap()
                .abs_diff_eq(Mat3::IDENTITY, 1e-6)
        );
        assert_eq!(
            rotation_part(Mat4::from_scale(Vec3::new(1.0, 0.0, 1.0))),
            None
        );
        assert_eq!(rotation_part(Mat4::NAN), None);
    }

    fn check(frame: Frame) {
        let Frame {
            tangent,
            bitangent,
            normal,
        } = frame;
        assert!(
            (tangent.cross(bitangent) - normal).length() < 1e-5,
            "{frame:?}"
        );
        assert!((tangent.length() - 1.0).abs() < 1e-5 && (bitangent.length() - 1.0).abs() < 1e-5);
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for z in [-1.0, -0.999_999, -0.3, 0.0, 0.4, 1.0_f32] {
            for angle in [0.0, 1.0, 2.5, 4.0_f32] {
                let r = (1.0 - z * z).sqrt();
                let normal = Vec3::new(r * angle.cos(), r * angle.sin(), z).normalize();
                check(Frame::around(normal));
                check(Frame::with_tangent(normal, Vec3::new(0.3, -0.2, 0.9)));
                check(Frame::with_tangent(normal, normal));
            }
        }
    }

    #[test]
    fn to_world_undoes_to_local() {
        let frame = Frame::around(Vec3::new(0.6, -0.64, 0.48));
        let direction = Vec3::new(0.36, 0.48, -0.8);
        assert!((frame.to_world(frame.to_local(direction)) - direction).length() < 1e-6);
    }
}
