//! Directions to emitters, for four surfaces at once.

use crate::emitter::MeshLight;
use crate::integrator::path::{Aim, aim};
use crate::math::lanes::{LANES, LaneMask, Lanes, Vec3Lanes, each, gather, mask};
use crate::math::{Vec2, Vec3};
use crate::scene::Scene;

/// A sampled direction to an emitter in each lane.
pub(super) struct Aims {
    /// Lanes that have one.
    pub(super) found: LaneMask,
    /// Unit directions.
    pub(super) direction: Vec3Lanes,
    /// Where shadow rays must reach to, in lanes that are not far.
    pub(super) target: Vec3Lanes,
    /// Lanes whose emitter is infinitely far away.
    pub(super) is_far: LaneMask,
    /// What arrives if nothing stands in between, in W·m⁻²·sr⁻¹, or W·m⁻² from Dirac emitters.
    pub(super) radiance: Vec3Lanes,
    /// Densities of the directions in 1/sr; probabilities of Dirac emitters.
    pub(super) density: Lanes,
    /// Lanes whose direction nothing else makes.
    pub(super) is_dirac: LaneMask,
}

impl Aims {
    /// As [`Lights::sample_toward`](crate::scene::Lights::sample_toward), for each lane.
    ///
    /// - `u`: uniform in the unit square.
    #[inline(always)]
    pub(super) fn sample(scene: &Scene, from: Vec3Lanes, u: [Vec2; LANES]) -> Self {
        match scene.lights().sole_mesh_light() {
            Some(light) => Self::at_light(light, from, u),
            None => Self::one_by_one(scene, from.vectors(), u),
        }
    }

    /// To a mesh that is the only emitter: as [`Area`](crate::emitter::Area) does it.
    #[inline(always)]
    fn at_light(light: MeshLight<'_>, from: Vec3Lanes, u: [Vec2; LANES]) -> Self {
        let (point, density) = light.mesh.sample_areas(u);
        let edge = point.position - from;
        let distance_squared = edge.length_squared();
        let distance = distance_squared.sqrt();
        let facing = point.geometric_normal.dot(edge);
        let density = density.0 * distance_squared / (facing / distance).abs();
        let direction = edge * (Lanes::ONE / distance);
        Self {
            found: density.is_finite_mask() & facing.cmplt(Lanes::ZERO),
            direction,
            target: point.ray_origin(-direction),
            is_far: LaneMask::splat(false),
            radiance: Vec3Lanes::splat(light.radiance.0),
            density,
            is_dirac: LaneMask::splat(false),
        }
    }

    #[inline(never)]
    fn one_by_one(scene: &Scene, from: [Vec3; LANES], u: [Vec2; LANES]) -> Self {
        let aims = each(|lane| aim(scene, from[lane], u[lane]));
        let vectors = |of: fn(&Aim) -> Vec3| {
            Vec3Lanes::gather(|lane| aims[lane].as_ref().map_or(Vec3::ZERO, of))
        };
        Self {
            found: mask(|lane| aims[lane].is_some()),
            direction: vectors(|aim| aim.direction),
            target: vectors(|aim| aim.target.unwrap_or_default()),
            is_far: mask(|lane| aims[lane].as_ref().is_some_and(|aim| aim.target.is_none())),
            radiance: vectors(|aim| aim.radiance.0),
            density: gather(|lane| aims[lane].as_ref().map_or(1.0, |aim| aim.density)),
            is_dirac: mask(|lane| aims[lane].as_ref().is_some_and(|aim| aim.is_dirac)),
        }
    }
}
