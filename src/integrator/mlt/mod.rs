//! Metropolis light transport.

mod kernel;
mod sampling;

use super::Algorithm;
use super::chains::{MutationOptions, SeedOptions};
use super::metropolis::{MetropolisOptions, MetropolisRender, OWN_LAYERS};
use super::pixel::PixelSettings;
use super::render::Integrator;
use crate::mutation::BidirectionalMutation;
use crate::path::CAPACITY;
use crate::scene::Scene;
use crate::scene::options::{OptionError, OptionReader};
use crate::sensor::Sensor;
use sampling::PathSampling;

/// Mutations of paths: some change a little, one takes a piece out and puts another in.
///
/// Source: Veach & Guibas 1997; van Antwerpen 2011, Sec. 6.2.
#[derive(Clone, Copy, Debug)]
pub struct Mlt {
    seeds: SeedOptions,
    metropolis: MetropolisOptions,
    mutations: MutationOptions,
    /// Weight of the bidirectional mutation; zero switches it off.
    bidirectional: f64,
    /// Whether a step deposits at both states, in proportion to the chance of being there.
    expected_values: bool,
}

impl Mlt {
    /// Reads the options; the names of Mitsuba 0.6's element mean what they mean there.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let is_on = options.boolean("bidirectional_mutation", true)?;
        let weight = options.float("bidirectional_weight", 1e-6..=1e6, 0.5)?;
        Ok(Self {
            seeds: SeedOptions::of_metropolis(options, true, 5)?.with_sides(options)?,
            metropolis: MetropolisOptions::from_options(options)?,
            mutations: MutationOptions::from_options(options)?,
            bidirectional: if is_on { weight } else { 0.0 },
            expected_values: options.boolean("expected_values", true)?,
        })
    }

    /// The mutation of paths of all lengths that chains carry.
    fn bidirectional_mutation(&self) -> BidirectionalMutation {
        let fewest = (1..=3).find(|edges| self.seeds.goes_to_chains(*edges));
        let most = (CAPACITY - 1).min(self.seeds.tracing.max_depth as usize);
        let mutation = BidirectionalMutation::new(fewest.map_or(1, |edges| edges as usize), most);
        if self.seeds.both_sides.is_some() {
            mutation.among_seeds_of_both_sides()
        } else {
            mutation
        }
    }
}

impl Algorithm for Mlt {
    fn start<'s>(
        &'s self,
        scene: &'s Scene,
        sensor: &'s Sensor,
        settings: PixelSettings,
    ) -> Box<dyn Integrator + 's> {
        let film_size = settings.film_size;
        let sampling = |film: &_| PathSampling::new(self, film, film_size);
        let space = (scene, sensor);
        let render =
            MetropolisRender::new(space, &self.seeds, &self.metropolis, settings, sampling);
        Box::new(render)
    }

    fn has_second_moment(&self) -> bool {
        // What lands on a pixel at once is no sample of it.
        false
    }

    fn own_layers(&self) -> &'static [&'static str] {
        OWN_LAYERS
    }
}
