//! Densities that carry their measure in their type.

/// A probability density of directions, in 1/sr.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct SolidAngleDensity(pub f32);

/// A probability density of points on surfaces, in 1/m².
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct AreaDensity(pub f32);

impl SolidAngleDensity {
    /// No direction can be sampled here.
    pub const ZERO: Self = Self(0.0);

    /// Re-expresses a density of directions at `x` as a density of points at `y`.
    ///
    /// Multiplies by `|cos θ_y| / ‖x − y‖²`, the Jacobian dω/dA of the change of measure.
    ///
    /// - `cos_at_y`: cosine between the edge and the *geometric* normal at `y`; sign ignored.
    ///   Pass 1 for a vertex inside a medium.
    /// - `distance_squared`: ‖x − y‖² in m², must be positive.
    ///
    /// The result is in 1/m². It grows without bound as `y` approaches `x`; callers store it as
    /// `f32` and multiply densities in `f64`.
    ///
    /// Source: Veach 1997, Ch. 8.
    #[inline]
    pub fn to_area(self, cos_at_y: f32, distance_squared: f32) -> AreaDensity {
        debug_assert!(distance_squared > 0.0, "coincident vertices have no edge");
        AreaDensity(self.0 * cos_at_y.abs() / distance_squared)
    }
}

impl AreaDensity {
    /// Re-expresses a density of points at `y` as a density of directions at `x`.
    ///
    /// The inverse of [`SolidAngleDensity::to_area`]; `cos_at_y` must not be zero. A point seen
    /// exactly edge-on has no finite density of directions: `None`.
    #[inline]
    pub fn to_solid_angle(self, cos_at_y: f32, distance_squared: f32) -> Option<SolidAngleDensity> {
        let density = self.0 * distance_squared / cos_at_y.abs();
        density.is_finite().then_some(SolidAngleDensity(density))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_convert_back_and_forth() {
        let area = SolidAngleDensity(0.25).to_area(-0.5, 4.0);
        assert_eq!(area, AreaDensity(0.03125));
        assert_eq!(area.to_solid_angle(0.5, 4.0), Some(SolidAngleDensity(0.25)));
        assert_eq!(area.to_solid_angle(0.0, 4.0), None);
    }
}
