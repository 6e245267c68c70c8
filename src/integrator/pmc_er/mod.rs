//! Population Monte Carlo energy redistribution.

mod kernel;
mod map;
mod pool;
mod render;

use super::Algorithm;
use super::chains::{SeedOptions, angle_kernel, angle_of_pixel, lens_aperture};
use super::pixel::PixelSettings;
use super::render::Integrator;
use crate::energy::{PopulationRule, Scheme, Transfer};
use crate::mutation::{
    AngleKernel, CausticKernel, Choice, Fault, Mutation, Perturbation, RasterDomain, RasterKernel,
};
use crate::scene::Scene;
use crate::scene::options::{OptionError, OptionReader};
use crate::sensor::Sensor;
use render::PmcErRender;

/// Layers that are made on demand.
pub(super) const OWN_LAYERS: &[&str] = &[
    "proposals",
    "acceptance",
    "chains",
    "strategy",
    "mutations",
    "population_age",
];

/// Mutations for each camera sample, where no number is given; `docs/pmc-er.md` has a study.
const MUTATIONS_PER_SAMPLE: f64 = 3.0;

/// A population of paths spreads the energy that path tracing finds, and learns how far to move.
///
/// Differs: all members live equally long, elimination is a roulette on their weights, and kernels adapt by a map
/// of the image that does not change while members live. The published scheme makes a biased picture; it is
/// there as `scheme=lai`. See `docs/pmc-er.md`.
///
/// Source: Lai et al. 2007.
#[derive(Clone, Debug)]
pub struct PmcEr {
    seeds: SeedOptions,
    /// Most members alive at once.
    population: usize,
    scheme: Scheme,
    transfer: Transfer,
    /// Mutations of a round.
    mutations: u32,
    /// Largest number of members of a seed.
    member_cap: u32,
    /// Part of the population that is replaced after a round.
    resampling_rate: f64,
    /// Radii of the moves on the image, in pixels, smallest first.
    radii: Vec<f32>,
    angle: AngleKernel,
    lens: f32,
    choice: Choice,
    adaptation: Adaptation,
    density: Density,
    learning: Learning,
}

/// How the radii's probabilities adapt.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Adaptation {
    /// They stay the same.
    Off,
    /// By the place on the image, from what was learnt in passes before.
    Map {
        /// Side of its cells in pixels.
        cell: u32,
    },
    /// By what a member has seen itself: biased.
    Member,
}

/// Which density of proposing is in the acceptance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Density {
    /// That of the kernel that made the proposal.
    ///
    /// Source: Lai et al. 2007, Eq. 5.
    Kernel,
    /// That of all kernels together.
    ///
    /// Source: Lai et al. 2007, Eq. 4.
    Mixture,
}

/// How kernels are learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Learning {
    /// Chance that goes to each kernel whatever its merit.
    epsilon: f64,
    /// Power of the radius in a kernel's merit, beside the mean acceptance.
    reach: f64,
}

impl PmcEr {
    /// Reads the options.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range, and options that contradict each other.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let scheme = options.choice("scheme", &["fixed", "lai"], "fixed")?;
        let rounds = options.integer("rounds", 1..=1 << 16, 20)? as u32;
        let (scheme, adaptation) = match scheme.as_str() {
            "lai" => (Scheme::Energy, "member"),
            _ => (Scheme::Fixed { rounds }, "map"),
        };
        let mut radii = options.floats("radii", 1e-3..=1e5, "2,8")?;
        radii.sort_by(f64::total_cmp);
        Ok(Self {
            seeds: SeedOptions::from_options(options, MUTATIONS_PER_SAMPLE)?,
            population: options.integer("population", 1..=1 << 20, 5000)? as usize,
            scheme,
            transfer: transfer(options, scheme)?,
            mutations: options.integer("mutations", 1..=1 << 20, 16)? as u32,
            member_cap: options.integer("max_members", 1..=1 << 24, 1000)? as u32,
            resampling_rate: options.float("resampling_rate", 0.0..=0.99, 0.4)?,
            radii: radii.into_iter().map(|radius| radius as f32).collect(),
            angle: angle_kernel(options)?,
            lens: lens_aperture(options)?,
            choice: choice(options)?,
            adaptation: adaptation_of(options, adaptation)?,
            density: density(options)?,
            learning: Learning {
                epsilon: options.float("epsilon", 0.0..=1.0, 0.01)?,
                reach: options.float("reach_power", 0.0..=8.0, 0.0)?,
            },
        })
    }

    /// How members come to life and live, for deposits of a given energy.
    fn rule(&self, deposit: f64) -> PopulationRule {
        PopulationRule {
            scheme: self.scheme,
            transfer: self.transfer,
            mutations: self.mutations,
            deposit,
            cap: self.member_cap,
        }
    }

    /// Camera samples that begin one member, roughly.
    fn samples_per_member(&self) -> f64 {
        match self.scheme {
            Scheme::Fixed { rounds } => {
                let life = f64::from(rounds) * f64::from(self.mutations);
                life / self.seeds.mutations_per_sample
            }
            // Every path that carries light begins one.
            Scheme::Energy => 0.25,
        }
    }

    /// The kernels' moves, one for each radius.
    ///
    /// - `domain`: where paths are seen.
    fn perturbations(
        &self,
        sensor: &Sensor,
        film_size: (u32, u32),
        domain: RasterDomain,
    ) -> Vec<Perturbation> {
        let angle_of_pixel = angle_of_pixel(sensor, film_size);
        let largest = self.radii.iter().copied().fold(0.0, f32::max);
        let perturbation = |radius: &f32| Perturbation {
            raster: RasterKernel::Disk { radius: *radius },
            angle: AngleKernel {
                inner: self.angle.inner * radius / largest,
                outer: self.angle.outer * radius / largest,
            },
            caustic: CausticKernel::Pixels {
                pixels: *radius,
                angle_of_pixel,
            },
            lens: self.lens,
            domain,
            fault: Fault::None,
        };
        self.radii.iter().map(perturbation).collect()
    }
}

/// Reads how members spread their energy.
fn transfer(options: &mut OptionReader<'_>, scheme: Scheme) -> Result<Transfer, OptionError> {
    let is_balance = options.choice("transfer", &["deposits", "balance"], "deposits")? == "balance";
    let expected = options.boolean("expected_values", scheme != Scheme::Energy)?;
    if !is_balance {
        return Ok(Transfer::Deposits { expected });
    }
    if scheme == Scheme::Energy {
        return Err(options.refused("transfer", "deposits, with scheme=lai"));
    }
    Ok(Transfer::Balance)
}

/// Reads how one of the mutations that apply is chosen.
fn choice(options: &mut OptionReader<'_>) -> Result<Choice, OptionError> {
    let caustic = options.float("caustic_share", 0.0..=1.0, 0.9)? as f32;
    let mut weights = [0.0; Mutation::COUNT];
    weights[Mutation::Caustic as usize] = caustic;
    weights[Mutation::Lens as usize] = 1.0 - caustic;
    weights[Mutation::MultiChain as usize] = 1.0 - caustic;
    Ok(Choice {
        weights,
        by_rule: false,
    })
}

/// Reads how radii adapt.
///
/// - `default`: its name.
fn adaptation_of(options: &mut OptionReader<'_>, default: &str) -> Result<Adaptation, OptionError> {
    let name = options.choice("adaptation", &["map", "member", "off"], default)?;
    let cell = options.integer("map_cell", 1..=1 << 16, 8)? as u32;
    Ok(match name.as_str() {
        "map" => Adaptation::Map { cell },
        "member" => Adaptation::Member,
        _ => Adaptation::Off,
    })
}

/// Reads which density is in the acceptance.
fn density(options: &mut OptionReader<'_>) -> Result<Density, OptionError> {
    let name = options.choice("proposal_density", &["kernel", "mixture"], "kernel")?;
    Ok(match name.as_str() {
        "mixture" => Density::Mixture,
        _ => Density::Kernel,
    })
}

impl Algorithm for PmcEr {
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's> {
        Box::new(PmcErRender::new(scene, sensor, self, settings))
    }

    fn has_second_moment(&self) -> bool {
        // What lands on a pixel at once is no sample of it.
        false
    }

    fn shows_traced_light(&self) -> bool {
        self.seeds.both_sides.is_some()
    }

    fn own_layers(&self) -> &'static [&'static str] {
        OWN_LAYERS
    }
}
