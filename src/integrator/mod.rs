//! Integrators: algorithms that estimate the image.
//!
//! An [`Integrator`] is a set of layers and a number of work units in each pass; a unit's result
//! depends on scene, options, seed, pass and unit alone. [`render`] runs passes; it knows no clock.

mod aov;
mod bdpt;
mod camera;
mod chains;
mod depth;
mod direct;
mod erpt;
mod metropolis;
mod mlt;
mod mmlt;
mod path;
mod pixel;
mod pmc_er;
mod pssmlt;
mod render;
mod smooth;
mod walk;
mod wave;

pub use aov::Aov;
pub use bdpt::Bdpt;
pub use depth::Depth;
pub use direct::Direct;
pub use erpt::Erpt;
pub use mlt::Mlt;
pub use mmlt::Mmlt;
pub use path::PathTracer;
pub use pixel::{Estimate, PixelIntegrator, PixelRender, PixelSettings};
pub use pmc_er::PmcEr;
pub use pssmlt::Pssmlt;
pub use render::{Counters, Driver, Integrator, Progress, Rendered, Step, film_memory, render};

use crate::path::Heuristic;
use crate::scene::Scene;
use crate::scene::options::{OptionError, OptionReader};
use crate::sensor::Sensor;

/// A chosen algorithm with its options: what can render any scene.
pub trait Algorithm: Send + Sync {
    /// Prepares the render of a scene.
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's>;

    /// Whether the algorithm can make the layer of squared samples.
    fn has_second_moment(&self) -> bool {
        true
    }

    /// Whether the algorithm connects light that it traces from the emitters on to the lens: no other shows what a
    /// beam without width lights.
    fn shows_traced_light(&self) -> bool {
        false
    }

    /// Names of the layers that the algorithm can make besides its image, on demand.
    fn own_layers(&self) -> &'static [&'static str] {
        &[]
    }
}

/// Names of the integrators that [`from_options`] knows, with what they are.
pub const NAMES: [(&str, &str); 10] = [
    ("path", "path tracing with multiple importance sampling"),
    ("direct", "direct light only"),
    ("bdpt", "bidirectional path tracing"),
    ("ptracer", "light tracing: paths from the lights only"),
    ("depth", "distance to the first surface"),
    ("erpt", "energy redistribution path tracing"),
    ("pmc-er", "population Monte Carlo energy redistribution"),
    ("mlt", "Metropolis light transport"),
    (
        "pssmlt",
        "Metropolis light transport in primary sample space",
    ),
    ("mmlt", "multiplexed Metropolis light transport"),
];

/// Other names of integrators.
const ALIASES: [(&str, &str); 2] = [("pmcer", "pmc-er"), ("pmc_er", "pmc-er")];

/// The name in [`NAMES`] of an integrator that may be called otherwise; any other name is returned as it is.
pub fn canonical_name(name: &str) -> &str {
    let found = ALIASES.into_iter().find(|(alias, _)| *alias == name);
    found.map_or(name, |(_, name)| name)
}

/// True for algorithms whose pixels depend on each other: chains spread what one sample has found, so
/// that a mean over a tile varies more than its pixels tell.
pub fn correlates_pixels(name: &str) -> bool {
    matches!(
        canonical_name(name),
        "erpt" | "pmc-er" | "mlt" | "pssmlt" | "mmlt"
    )
}

/// Names of layers that some algorithm makes on demand.
pub const OWN_LAYERS: [&[&str]; 2] = [pmc_er::OWN_LAYERS, bdpt::OWN_LAYERS];

/// Makes an algorithm by name.
///
/// # Errors
/// An option whose value is of the wrong kind or out of range; [`OptionError::UnknownIntegrator`]
/// for a name that is not in [`NAMES`].
pub fn from_options(
    name: &str,
    options: &mut OptionReader<'_>,
) -> Result<Box<dyn Algorithm>, OptionError> {
    match name {
        "bdpt" => Ok(Box::new(Bdpt::from_options(options)?)),
        "ptracer" => Ok(Box::new(Bdpt::light_tracing(options)?)),
        "erpt" => Ok(Box::new(Erpt::from_options(options)?)),
        "pmc-er" => Ok(Box::new(PmcEr::from_options(options)?)),
        "mlt" => Ok(Box::new(Mlt::from_options(options)?)),
        "pssmlt" => Ok(Box::new(Pssmlt::from_options(options)?)),
        "mmlt" => Ok(Box::new(Mmlt::from_options(options)?)),
        _ => Ok(Box::new(pixel_integrator(name, options)?)),
    }
}

/// Makes an integrator by name that estimates one camera ray at a time.
///
/// # Errors
/// As [`from_options`].
pub fn pixel_integrator(
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
