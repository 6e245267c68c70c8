//! Metropolis light transport.

mod kernel;
mod sampling;

use super::chains::{ChainFilm, MutationOptions, SeedOptions};
use super::metropolis::{Metropolis, MetropolisOptions};
use crate::mutation::BidirectionalMutation;
use crate::path::CAPACITY;
use crate::scene::options::{OptionError, OptionReader};
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

impl Metropolis for Mlt {
    type Sampling<'s> = PathSampling<'s>;

    fn options(&self) -> (&SeedOptions, &MetropolisOptions) {
        (&self.seeds, &self.metropolis)
    }

    fn sampling<'s>(&'s self, film: &ChainFilm<'s>) -> PathSampling<'s> {
        PathSampling::new(self, film)
    }
}
