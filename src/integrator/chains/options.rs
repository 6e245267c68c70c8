//! Options about seeds and the energy of deposits.

use super::energy::MeanEnergy;
use super::noise_filter::NoiseFilter;
use crate::integrator::path::depth_limit;
use crate::path::{Bidirectional, PathRules, PathTracing, Techniques, Weighing};
use crate::scene::options::{OptionError, OptionReader};

/// Mutations a camera sample that somebody may want.
const USUAL_MUTATIONS: std::ops::RangeInclusive<f64> = 1e-2..=1e4;

/// How seeds are found, and how much energy a deposit has.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct SeedOptions {
    /// How seeds are traced.
    pub(in crate::integrator) tracing: PathTracing,
    /// How they are traced from both sides; `None` to trace them from the sensor alone.
    pub(in crate::integrator) both_sides: Option<Bidirectional>,
    /// What paths are.
    pub(in crate::integrator) rules: PathRules,
    /// Mutations for each camera sample, in the mean.
    pub(in crate::integrator) mutations_per_sample: f64,
    /// Energy of a deposit; `None` to have it estimated.
    deposition_energy: Option<f64>,
    /// Camera samples of that estimate; `None` for some for each pixel.
    pub(super) luminance_samples: Option<u32>,
    /// Further camera samples for each pixel and pass of the layer of direct light; `None` where chains
    /// carry it, too.
    pub(super) direct_samples: Option<u32>,
    pub(super) noise_filter: NoiseFilter,
}

impl SeedOptions {
    /// Reads the options; the names of Mitsuba 0.6's element mean what they mean there.
    ///
    /// - `mutations_per_sample`: its default.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(in crate::integrator) fn from_options(
        options: &mut OptionReader<'_>,
        mutations_per_sample: f64,
    ) -> Result<Self, OptionError> {
        let tracing = tracing(options, 5)?;
        let rules = rules(options)?;
        let mutations_per_sample =
            options.float("mutations_per_sample", 1e-6..=1e9, mutations_per_sample)?;
        let deposition_energy = options.float("deposition_energy", 0.0..=f64::INFINITY, 0.0)?;
        let luminance_samples = options.integer("luminance_samples", 0..=1 << 28, 0)?;
        Ok(Self {
            both_sides: both_sides(options, &tracing)?,
            tracing,
            rules,
            mutations_per_sample,
            deposition_energy: (deposition_energy > 0.0).then_some(deposition_energy),
            luminance_samples: (luminance_samples > 0).then_some(luminance_samples as u32),
            direct_samples: direct_samples(options)?,
            noise_filter: NoiseFilter::from_options(options)?,
        })
    }

    /// Reads what Metropolis sampling needs of the options: there, the energy of a deposit is no choice, and
    /// nothing comes from the pixels' own camera samples.
    ///
    /// - `with_filter`: whether the chains know the noise filters.
    /// - `rr_depth`: its default.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(in crate::integrator) fn of_metropolis(
        options: &mut OptionReader<'_>,
        with_filter: bool,
        rr_depth: i64,
    ) -> Result<Self, OptionError> {
        let is_separate = options.boolean("separate_direct", true)?;
        let direct = options.integer("direct_samples", -1..=1 << 16, 1)?;
        Ok(Self {
            tracing: tracing(options, rr_depth)?,
            both_sides: None,
            rules: rules(options)?,
            mutations_per_sample: 1.0,
            deposition_energy: None,
            luminance_samples: None,
            direct_samples: (is_separate && direct >= 0).then_some(direct.max(1) as u32),
            noise_filter: if with_filter {
                NoiseFilter::from_options(options)?
            } else {
                NoiseFilter::OFF
            },
        })
    }

    /// The same with seeds as the options say: from the sensor alone, or from both sides.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(in crate::integrator) fn with_sides(
        self,
        options: &mut OptionReader<'_>,
    ) -> Result<Self, OptionError> {
        Ok(Self {
            both_sides: both_sides(options, &self.tracing)?,
            ..self
        })
    }

    /// Energy of a deposit.
    pub(super) fn deposit(&self, mean: &MeanEnergy) -> f64 {
        self.deposition_energy
            .unwrap_or_else(|| mean.deposit(self.mutations_per_sample))
    }

    /// Says so where the energy of a deposit that was given makes far more or far fewer mutations than
    /// anybody wants.
    pub(in crate::integrator) fn remark(&self, mean: &MeanEnergy) -> Option<String> {
        let deposit = self.deposition_energy.filter(|_| mean.chains > 0.0)?;
        let mutations = mean.chains / deposit;
        if USUAL_MUTATIONS.contains(&mutations) {
            return None;
        }
        let consequence = if mutations > 1.0 {
            "a pass may hardly end"
        } else {
            "hardly any chain begins, and the picture is very noisy"
        };
        let usual = mean.deposit(self.mutations_per_sample);
        Some(format!(
            "deposition_energy {deposit} makes {mutations:.1e} mutations a camera sample, so that \
             {consequence}; {usual:.3e} makes {} here",
            self.mutations_per_sample
        ))
    }

    /// Whether the energy of paths of so many edges goes to chains.
    ///
    /// Both classes are closed under all mutations, so that nothing leaks.
    pub(in crate::integrator) fn goes_to_chains(&self, edges: u32) -> bool {
        self.direct_samples.is_none() || edges > 2
    }
}

/// Reads how paths are traced.
///
/// - `rr_depth`: its default.
fn tracing(options: &mut OptionReader<'_>, rr_depth: i64) -> Result<PathTracing, OptionError> {
    Ok(PathTracing {
        max_depth: depth_limit(options.integer("max_depth", -1..=i64::MAX, -1)?),
        rr_depth: depth_limit(options.integer("rr_depth", 1..=i64::MAX, rr_depth)?),
        heuristic: crate::integrator::heuristic(options)?,
    })
}

/// Reads whether seeds are traced from both sides.
fn both_sides(
    options: &mut OptionReader<'_>,
    tracing: &PathTracing,
) -> Result<Option<Bidirectional>, OptionError> {
    let seeds = options.choice("seeds", &["path", "bdpt"], "path")?;
    Ok((seeds == "bdpt").then(|| from_both_sides(tracing)))
}

/// How subpaths are traced from both sides, by the options of path tracing.
pub(in crate::integrator) fn from_both_sides(tracing: &PathTracing) -> Bidirectional {
    Bidirectional {
        max_depth: tracing.max_depth,
        rr_depth: tracing.rr_depth,
        weighing: Weighing::new(tracing.heuristic, 2.0),
        techniques: Techniques {
            light_image: true,
            sample_direct: true,
        },
        connection_threshold: 0.0,
    }
}

/// Reads what paths are.
fn rules(options: &mut OptionReader<'_>) -> Result<PathRules, OptionError> {
    Ok(PathRules {
        hide_emitters: options.boolean("hide_emitters", false)?,
        strict_normals: options.boolean("strict_normals", false)?,
    })
}

/// Reads whether direct light is estimated apart, and with how many samples.
fn direct_samples(options: &mut OptionReader<'_>) -> Result<Option<u32>, OptionError> {
    let is_separate = options.boolean("separate_direct", true)?;
    let samples = options.integer("direct_samples", -1..=1 << 16, 0)?;
    Ok((is_separate && samples >= 0).then_some(samples.max(0) as u32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::options::{OptionValue, Options};

    fn remark(deposit: f64, chains: f64) -> Option<String> {
        let options = [("deposition_energy".to_owned(), OptionValue::Float(deposit))];
        let options = Options::from(options);
        let seeds = SeedOptions::from_options(&mut OptionReader::new(&options), 3.0).unwrap();
        seeds.remark(&MeanEnergy { image: 1.0, chains })
    }

    #[test]
    fn deposits_of_no_use_are_told_of() {
        for (deposit, expected) in [
            (0.0, None),
            (0.1, None),
            (20.0, None),
            (1e-6, Some("a pass may hardly end; 1.667e-1 makes 3 here")),
            (1e9, Some("hardly any chain begins")),
        ] {
            let found = remark(deposit, 0.5);
            let is_right = match expected {
                Some(text) => found.as_ref().is_some_and(|found| found.contains(text)),
                None => found.is_none(),
            };
            assert!(is_right, "{deposit}: {found:?}");
        }
        // Nothing to compare with.
        assert_eq!(remark(1e9, 0.0), None);
    }
}
