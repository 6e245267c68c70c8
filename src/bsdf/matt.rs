//! Sampling of matt lobes that do not vanish where they graze the surface.

use std::f32::consts::TAU;

use crate::math::{Local, Vec2, warp};

/// Share of samples that lie on the hemisphere by the cosine; the others are uniform.
///
/// Some lobes hold a cosine in their divisor: with the cosine alone, samples near the horizon would
/// weigh without bound.
const COSINE_SHARE: f32 = 0.75;

/// Samples a direction above the surface.
///
/// - `u_lobe`, `u`: uniform in `[0, 1)`.
#[inline]
pub(super) fn sample_matt(u_lobe: f32, u: Vec2) -> Local {
    Local(if u_lobe < COSINE_SHARE {
        warp::cosine_hemisphere(u)
    } else {
        warp::uniform_cone(u, 1.0)
    })
}

/// Density of [`sample_matt`], in 1/sr; zero below the horizon.
#[inline]
pub(super) fn matt_density(cos: f32) -> f32 {
    if cos <= 0.0 {
        return 0.0;
    }
    COSINE_SHARE * warp::cosine_hemisphere_density(cos) + (1.0 - COSINE_SHARE) / TAU
}
