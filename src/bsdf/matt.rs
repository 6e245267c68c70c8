//! Sampling of matt lobes that do not vanish where they graze the surface.

use std::f32::consts::TAU;

use super::{SampleNumbers, Spare};
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

/// The numbers of [`sample_matt`]; `None` below the horizon.
#[inline]
pub(super) fn invert_matt(wo: Local, spare: Spare) -> Option<SampleNumbers> {
    if wo.cos() <= 0.0 {
        return None;
    }
    let by_cosine = COSINE_SHARE * warp::cosine_hemisphere_density(wo.cos());
    let (lobe, spare) = spare.choose([by_cosine, (1.0 - COSINE_SHARE) / TAU])?;
    let numbers = spare.numbers;
    Some(if lobe == 0 {
        let u = warp::cosine_hemisphere_inverse(wo.0);
        numbers.with_direction(u).within(0.0, COSINE_SHARE)
    } else {
        let u = warp::uniform_cone_inverse(wo.0, 1.0);
        let numbers = numbers.with_direction(u);
        numbers.within(COSINE_SHARE, 1.0 - COSINE_SHARE)
    })
}
