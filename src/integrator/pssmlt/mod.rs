//! Metropolis light transport in primary sample space.

mod evaluation;
mod sampling;

use super::chains::{ChainFilm, SeedOptions, from_both_sides};
use super::metropolis::{Metropolis, MetropolisOptions, PrimaryOptions};
use crate::scene::options::{OptionError, OptionReader};
use sampling::PrimarySampling;

/// What the importance of a state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    /// The luminance of all paths of a camera sample together.
    Sample,
    /// The luminance of one of its paths; the chain keeps to paths of one length and one technique.
    Path,
}

/// Small and large steps of the numbers that camera samples are made of.
///
/// Source: Kelemen et al. 2002; van Antwerpen 2011, Sec. 6.6.
#[derive(Clone, Copy, Debug)]
pub struct Pssmlt {
    seeds: SeedOptions,
    metropolis: MetropolisOptions,
    primary: PrimaryOptions,
    target: Target,
    /// Whether large steps count as samples of their own, too.
    weigh_large_steps: bool,
}

impl Pssmlt {
    /// Reads the options; the names of Mitsuba 0.6's element mean what they mean there.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let target = match options
            .choice("target", &["sample", "path"], "sample")?
            .as_str()
        {
            "path" => Target::Path,
            _ => Target::Sample,
        };
        let usual = match target {
            Target::Sample => "weighed",
            Target::Path => "expected",
        };
        let deposits = options.choice("deposits", &["expected", "weighed"], usual)?;
        let weigh_large_steps = deposits == "weighed";
        if weigh_large_steps && target == Target::Path {
            return Err(options.refused("deposits", "\"expected\" where target is \"path\""));
        }
        let bidirectional = options.boolean("bidirectional", false)?;
        if bidirectional && target == Target::Path {
            return Err(options.refused("bidirectional", "false where target is \"path\""));
        }
        let mut seeds = SeedOptions::of_metropolis(options, false, 5)?;
        seeds.both_sides = bidirectional.then(|| from_both_sides(&seeds.tracing));
        Ok(Self {
            seeds,
            metropolis: MetropolisOptions::from_options(options)?,
            primary: PrimaryOptions::from_options(options, 0.3)?,
            target,
            weigh_large_steps,
        })
    }
}

impl Metropolis for Pssmlt {
    type Sampling<'s> = PrimarySampling<'s>;

    fn options(&self) -> (&SeedOptions, &MetropolisOptions) {
        (&self.seeds, &self.metropolis)
    }

    fn sampling<'s>(&'s self, _: &ChainFilm<'s>) -> PrimarySampling<'s> {
        PrimarySampling(self)
    }
}
