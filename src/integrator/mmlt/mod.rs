//! Multiplexed Metropolis light transport.

mod evaluation;
mod sampling;

use super::chains::{ChainFilm, SeedOptions, from_both_sides};
use super::metropolis::{Metropolis, MetropolisOptions, PrimaryOptions};
use crate::path::{Bidirectional, Weighing};
use crate::scene::options::{OptionError, OptionReader};
use sampling::MultiplexedSampling;

/// Small and large steps of the numbers that one path is made of, and of the number that chooses the
/// technique by which it is made; a chain keeps to paths of one length.
///
/// Source: Hachisuka et al. 2014.
#[derive(Clone, Copy, Debug)]
pub struct Mmlt {
    seeds: SeedOptions,
    metropolis: MetropolisOptions,
    primary: PrimaryOptions,
    tracing: Bidirectional,
}

/// Edges of a subpath of the bootstrap set from which on Russian roulette may end it, where no number is given:
/// short ones serve best, as with bidirectional path tracing.
const RR_DEPTH: i64 = 2;

/// Chance of a large step, where no number is given: less than where a step makes many paths at once, most of
/// which bring light.
const P_LARGE: f64 = 0.1;

impl Mmlt {
    /// Reads the options.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let mut seeds = SeedOptions::of_metropolis(options, false, RR_DEPTH)?;
        let power = options.float("mis_power", 0.1..=100.0, 2.0)?;
        let tracing = Bidirectional {
            weighing: Weighing::new(seeds.tracing.heuristic, power),
            ..from_both_sides(&seeds.tracing)
        };
        seeds.both_sides = Some(tracing);
        Ok(Self {
            tracing,
            seeds,
            metropolis: MetropolisOptions::from_options(options)?,
            primary: PrimaryOptions::from_options(options, P_LARGE)?,
        })
    }
}

impl Metropolis for Mmlt {
    type Sampling<'s> = MultiplexedSampling<'s>;

    fn options(&self) -> (&SeedOptions, &MetropolisOptions) {
        (&self.seeds, &self.metropolis)
    }

    fn sampling<'s>(&'s self, _: &ChainFilm<'s>) -> MultiplexedSampling<'s> {
        MultiplexedSampling(self)
    }
}
