//! Options about mutations.

use crate::math::Vec2;
use crate::mutation::{
    AngleKernel, CausticKernel, Choice, Fault, Mutation, Perturbation, RasterDomain, RasterKernel,
};
use crate::scene::options::{OptionError, OptionReader};
use crate::sensor::{Sensor, SensorModel};

/// How paths are mutated, as options say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrator) struct MutationOptions {
    raster: RasterKernel,
    angle: AngleKernel,
    /// Reach of caustic moves on the image in pixels; zero for angles whose logarithm is uniform.
    caustic_pixels: f32,
    lens: f32,
    /// Which mutation comes next.
    pub(in crate::integrator) choice: Choice,
}

impl MutationOptions {
    /// Reads the options.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(in crate::integrator) fn from_options(
        options: &mut OptionReader<'_>,
    ) -> Result<Self, OptionError> {
        let shape = options.choice("lens_shape", &["square", "disk", "log"], "square")?;
        let size = options.float("lens_size", 1e-3..=1e5, 9.0)? as f32;
        let smallest = options.float("lens_smallest", 1e-4..=1e5, 0.1)? as f32;
        if shape == "log" && smallest >= size {
            return Err(options.refused("lens_smallest", "less than lens_size"));
        }
        let raster = match shape.as_str() {
            "disk" => RasterKernel::Disk { radius: size },
            "log" => RasterKernel::Logarithmic {
                inner: smallest,
                outer: size,
            },
            _ => RasterKernel::Square { side: size },
        };
        Ok(Self {
            raster,
            angle: angle_kernel(options)?,
            caustic_pixels: options.float("caustic_pixels", 0.0..=1e5, 0.0)? as f32,
            lens: lens_aperture(options)?,
            choice: choice(options)?,
        })
    }

    /// The moves for one film and sensor.
    ///
    /// - `domain`: where paths are seen.
    pub(in crate::integrator) fn perturbation(
        &self,
        sensor: &Sensor,
        film_size: (u32, u32),
        domain: RasterDomain,
    ) -> Perturbation {
        let caustic = if self.caustic_pixels > 0.0 {
            CausticKernel::Pixels {
                pixels: self.caustic_pixels,
                angle_of_pixel: angle_of_pixel(sensor, film_size),
            }
        } else {
            CausticKernel::Logarithmic(self.angle)
        };
        Perturbation {
            raster: self.raster,
            angle: self.angle,
            caustic,
            lens: self.lens,
            domain,
            fault: Fault::None,
        }
    }
}

/// Angle that a pixel in the middle of the image subtends, in radians.
pub(in crate::integrator) fn angle_of_pixel(sensor: &Sensor, film_size: (u32, u32)) -> f32 {
    let middle = Vec2::new(film_size.0 as f32, film_size.1 as f32) * 0.5;
    let seen = sensor.sample_ray(middle, Vec2::splat(0.5)).direction;
    1.0 / sensor.pixels_per_steradian(seen).sqrt()
}

/// Reads how far directions inside of the scene are turned.
pub(in crate::integrator) fn angle_kernel(
    options: &mut OptionReader<'_>,
) -> Result<AngleKernel, OptionError> {
    let outer = options.float("angle_largest", 1e-6..=std::f64::consts::PI, 0.1)? as f32;
    let inner = options.float("angle_smallest", 1e-7..=std::f64::consts::PI, 1e-4)? as f32;
    if inner >= outer {
        return Err(options.refused("angle_smallest", "less than angle_largest"));
    }
    Ok(AngleKernel { inner, outer })
}

/// Reads how far points on the lens move, in radii of the lens.
pub(in crate::integrator) fn lens_aperture(
    options: &mut OptionReader<'_>,
) -> Result<f32, OptionError> {
    Ok(options.float("lens_aperture", 0.0..=2.0, 0.25)? as f32)
}

/// Reads which mutations are used, and how one is chosen.
fn choice(options: &mut OptionReader<'_>) -> Result<Choice, OptionError> {
    let by_rule = options.choice("mutation_choice", &["rule", "mixture"], "rule")? == "rule";
    let mut weights = [0.0; Mutation::COUNT];
    for (mutation, name, default) in [
        (Mutation::Lens, "lens_perturbation", true),
        (Mutation::MultiChain, "multi_chain_perturbation", true),
        (Mutation::Caustic, "caustic_perturbation", true),
        (Mutation::LaiLens, "lai_lens_perturbation", false),
    ] {
        weights[mutation as usize] = f32::from(u8::from(options.boolean(name, default)?));
    }
    let range = || 1e-6..=1e6;
    for (mutation, name) in [
        (Mutation::Lens, "lens_weight"),
        (Mutation::MultiChain, "multi_chain_weight"),
        (Mutation::Caustic, "caustic_weight"),
        (Mutation::LaiLens, "lai_lens_weight"),
    ] {
        weights[mutation as usize] *= options.float(name, range(), 1.0)? as f32;
    }
    Ok(Choice { weights, by_rule })
}
