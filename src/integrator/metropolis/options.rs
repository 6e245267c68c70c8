//! Options about passes and their seeds.

use crate::mutation::SmallSteps;
use crate::scene::options::{OptionError, OptionReader};

/// How much work a pass is.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct MetropolisOptions {
    /// Mutations for each pixel.
    mutations_per_pixel: f64,
    /// Number of chains; `None` for as many as make chains of a good length.
    chains: Option<u32>,
    /// Samples of the bootstrap set; `None` for as many as are worth their time.
    bootstrap_samples: Option<u32>,
    /// Whether chains are drawn to where the noise is.
    pub(super) noise_aware: bool,
}

/// Mutations of a chain, where no number of chains is given.
const CHAIN_LENGTH: f64 = 1024.0;

/// Bootstrap samples for each pixel, where no number is given.
const SAMPLES_PER_PIXEL: f64 = 1.0;

/// Fewest bootstrap samples, where no number is given: what one seed stands for must not be too much.
const FEWEST_SAMPLES: f64 = 4096.0;

/// Work of a pass over an image of a given size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Work {
    /// Number of chains, at least one.
    pub(super) chains: u32,
    /// Mutations of each, at least one.
    pub(super) length: u32,
    /// Samples of the bootstrap set, at least one.
    pub(super) samples: u32,
}

impl MetropolisOptions {
    /// Reads the options; the names of Mitsuba 0.6's elements mean what they mean there.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(in crate::integrator) fn from_options(
        options: &mut OptionReader<'_>,
    ) -> Result<Self, OptionError> {
        let mutations_per_pixel = options.float("mutations_per_pixel", 1e-3..=1e6, 8.0)?;
        let some = |number: i64| (number > 0).then_some(number as u32);
        Ok(Self {
            mutations_per_pixel,
            chains: some(options.integer("chains", 0..=1 << 20, 0)?),
            bootstrap_samples: some(options.integer("luminance_samples", 0..=1 << 24, 0)?),
            noise_aware: options.boolean("noise_aware", false)?,
        })
    }

    /// The work of a pass.
    ///
    /// - `pixels`: number of pixels that paths are seen at.
    pub(super) fn work(&self, pixels: f64) -> Work {
        let mutations = (pixels * self.mutations_per_pixel).max(1.0);
        let default_chains = (mutations / CHAIN_LENGTH).ceil() as u32;
        let chains = self.chains.unwrap_or(default_chains).max(1);
        let default_samples = (pixels * SAMPLES_PER_PIXEL).max(FEWEST_SAMPLES) as u32;
        Work {
            chains,
            length: (mutations / f64::from(chains)).ceil().min(1e9) as u32,
            samples: self.bootstrap_samples.unwrap_or(default_samples),
        }
    }
}

/// How numbers move.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct PrimaryOptions {
    /// Probability of a large step.
    pub(in crate::integrator) p_large: f64,
    pub(in crate::integrator) steps: SmallSteps,
}

impl PrimaryOptions {
    /// Reads the options.
    ///
    /// - `p_large`: its default.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(in crate::integrator) fn from_options(
        options: &mut OptionReader<'_>,
        p_large: f64,
    ) -> Result<Self, OptionError> {
        let largest = options.float("step_largest", 1e-6..=0.49, 1.0 / 64.0)? as f32;
        let smallest = options.float("step_smallest", 1e-7..=0.49, 1.0 / 1024.0)? as f32;
        if smallest >= largest {
            return Err(options.refused("step_smallest", "less than step_largest"));
        }
        Ok(Self {
            p_large: options.float("p_large", 0.0..=1.0, p_large)?,
            steps: SmallSteps { smallest, largest },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::options::Options;

    #[test]
    fn chains_have_whole_lengths() {
        let options = Options::new();
        let read = MetropolisOptions::from_options(&mut OptionReader::new(&options));
        let mut read = read.expect("defaults are in range");
        let work = read.work(256.0 * 256.0);
        assert_eq!((work.chains, work.length, work.samples), (512, 1024, 65536));
        read.chains = Some(7);
        read.bootstrap_samples = Some(10);
        let work = read.work(10.0);
        assert_eq!((work.chains, work.length, work.samples), (7, 12, 10));
    }
}
