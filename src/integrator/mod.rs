//! Integrators: algorithms that estimate the image.
//!
//! An [`Integrator`] is a set of layers and a number of work units in each pass; a unit's result
//! depends on scene, options, seed, pass and unit alone. [`render`] runs passes; it knows no clock.

mod aov;
mod depth;
mod direct;

mod path;
mod pixel;
mod render;

pub use aov::Aov;
pub use depth::Depth;
pub use direct::Direct;

pub use path::PathTracer;
pub use pixel::{Estimate, PixelIntegrator, PixelRender, PixelSettings};
pub use render::{Counters, Integrator, Progress, Rendered, Step, render};

use crate::path::Heuristic;
use crate::scene::options::{OptionError, OptionReader};

/// Names of the integrators that [`from_options`] knows, with what they are.
pub const NAMES: [(&str, &str); 3] = [
    ("path", "path tracing with multiple importance sampling"),
    ("direct", "direct light only"),
    ("depth", "distance to the first surface"),
];

/// Makes an integrator by name.
///
/// # Errors
/// An option whose value is of the wrong kind or out of range; [`OptionError::UnknownIntegrator`]
/// for a name that is not in [`NAMES`].
pub fn from_options(
    name: &str,
    options: &mut OptionReader<'_>,
) -> Result<Box<dyn PixelIntegrator>, OptionError> {
    match name {
        "path" => Ok(Box::new(PathTracer::from_options(options)?)),
        "direct" => Ok(Box::new(Direct::from_options(options)?)),
        "depth" => Ok(Box::new(Depth)),
        _ => Err(OptionError::UnknownIntegrator {
            name: name.to_owned(),
        }),
    }
}

/// Reads the option `mis`.
fn heuristic(options: &mut OptionReader<'_>) -> Result<Heuristic, OptionError> {
    let names = Heuristic::NAMES.map(|(name, _)| name);
    let name = options.choice("mis", &names, "power")?;
    let found = Heuristic::NAMES
        .into_iter()
        .find(|(candidate, _)| *candidate == name);
    Ok(found.map_or_else(Heuristic::default, |(_, heuristic)| heuristic))
}
