//! Energy redistribution path tracing.

mod render;

use super::Algorithm;
use super::chains::{MutationOptions, OWN_LAYERS, SeedOptions};
use super::pixel::PixelSettings;
use super::render::Integrator;
use crate::energy::FlowRule;
use crate::scene::Scene;
use crate::scene::options::{OptionError, OptionReader};
use crate::sensor::Sensor;
use render::ErptRender;

/// Mutations for each camera sample, where no number is given.
///
/// Few: where paths of high energy are rare, finding them is what counts. It is less than what the paper
/// uses, 5.6 (200 mutations a pixel at 36 samples); `docs/erpt.md` has a study.
const MUTATIONS_PER_SAMPLE: f64 = 3.0;

/// Path tracing finds paths; chains of mutations spread their energy over the image.
///
/// Source: Cline et al. 2005; van Antwerpen 2011, Sec. 6.8.
#[derive(Clone, Copy, Debug)]
pub struct Erpt {
    seeds: SeedOptions,
    mutations: MutationOptions,
    flow: Flow,
    /// Steps of a chain.
    chain_length: u32,
    /// Largest number of chains of a seed.
    chain_cap: u32,
}

/// Which flow rule, with what belongs to it alone.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flow {
    Equal { expected: bool },
    DetailedBalance,
    Iterated { proposals: u32, depth: u32 },
}

impl Erpt {
    /// Reads the options; the names of Mitsuba 0.6's element mean what they mean there.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let chain_length = options.integer("chain_length", 1..=1_000_000, 100)?;
        let chains = options.float("num_chains", 0.0..=1e6, 0.0)?;
        let mutations_per_sample = if chains > 0.0 {
            chains * chain_length as f64
        } else {
            MUTATIONS_PER_SAMPLE
        };
        let cap = options.integer("max_chains", 0..=1 << 24, 1000)?;
        Ok(Self {
            seeds: SeedOptions::from_options(options, mutations_per_sample)?,
            mutations: MutationOptions::from_options(options)?,
            flow: flow(options)?,
            chain_length: chain_length as u32,
            // Mitsuba's zero is no limit; ours changes the size of deposits, never the mean.
            chain_cap: if cap == 0 { 1000 } else { cap as u32 },
        })
    }

    /// The flow rule for deposits of a given energy.
    fn flow_rule(&self, deposit: f64) -> FlowRule {
        match self.flow {
            Flow::Equal { expected } => FlowRule::EqualDeposition {
                length: self.chain_length,
                deposit,
                cap: self.chain_cap,
                expected,
            },
            Flow::DetailedBalance => FlowRule::DetailedBalance {
                proposals: self.chain_length,
            },
            Flow::Iterated { proposals, depth } => FlowRule::IteratedDetailedBalance {
                proposals,
                depth,
                threshold: deposit,
            },
        }
    }
}

/// Reads the flow rule.
fn flow(options: &mut OptionReader<'_>) -> Result<Flow, OptionError> {
    let names = ["equal", "detailed", "iterated"];
    let name = options.choice("flow", &names, "equal")?;
    let expected = options.boolean("expected_values", true)?;
    let proposals = options.integer("flow_proposals", 1..=64, 2)? as u32;
    let depth = options.integer("flow_depth", 1..=24, 5)? as u32;
    Ok(match name.as_str() {
        "detailed" => Flow::DetailedBalance,
        "iterated" => Flow::Iterated { proposals, depth },
        _ => Flow::Equal { expected },
    })
}

impl Algorithm for Erpt {
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's> {
        Box::new(ErptRender::new(scene, sensor, self, settings))
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
