//! Distance to the first surface.

use super::pixel::{Estimate, PixelIntegrator};
use super::render::Counters;
use crate::math::Rgb;
use crate::random::Sampler;
use crate::scene::Scene;
use crate::sensor::CameraRay;

/// Shows the distance to the first surface as a grey value in m; zero where there is none.
#[derive(Clone, Copy, Debug)]
pub struct Depth;

impl PixelIntegrator for Depth {
    fn estimate(
        &self,
        scene: &Scene,
        ray: &CameraRay,
        _sampler: &mut Sampler,
        counters: &mut Counters,
    ) -> Estimate {
        counters.rays += 1;
        match scene.intersect(&ray.to_ray()) {
            Some(hit) => Estimate {
                radiance: Rgb::grey(hit.distance),
                alpha: 1.0,
            },
            None => Estimate {
                radiance: Rgb::BLACK,
                alpha: 0.0,
            },
        }
    }
}
