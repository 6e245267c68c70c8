//! Integrators raced against a reference: single trials, and what the seeds of one tell together.

mod errors;
mod plot;
mod record;
mod sheet;
mod spread;
mod stored;
mod table;

pub use errors::Errors;
pub use plot::error_plot;
pub use record::{Bench, BenchScene, Missed, option_value};
pub use sheet::{Sheet, Tile};
pub use spread::{Mean, Spread};
pub use stored::{RecordError, read_trial, stored_trial};
pub use table::three_digits;

/// One render, and how far it is from the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Name of the scene.
    pub scene: String,
    /// Name of the integrator, with what was set for it alone, or of a peer.
    pub integrator: String,
    /// How much was to be rendered, such as `5 s`.
    pub budget: String,
    /// The render's seed.
    pub seed: u64,
    /// Seconds that rendering took, without loading; those of the whole command for a peer.
    pub wall_seconds: f64,
    /// Processor time of the same, in seconds, all threads together.
    pub cpu_seconds: f64,
    /// By how many seconds the budget was overrun; zero where it was kept.
    pub overrun_seconds: f64,
    /// Work done; peers do not tell.
    pub work: Option<Work>,
    /// How far the image is from the reference.
    pub errors: Errors,
    /// What else is known of the render, by the names that tables and files show. Integrators may
    /// differ in what they tell.
    pub statistics: Vec<(String, f64)>,
}

/// Work done by a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    /// Passes in the image.
    pub passes: u32,
    /// Samples a pixel.
    pub samples: u32,
    /// Camera samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Estimates that were left out.
    pub rejected: u64,
}

/// What is measured of every trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Seconds by the clock.
    Wall,
    /// Seconds of processor time.
    Cpu,
    /// Seconds by which the budget was overrun.
    Overrun,
    /// Passes in the image; not a number where that is unknown.
    Passes,
    /// Samples a pixel; likewise.
    Samples,
    /// Mean squared error.
    Mse,
    /// Mean relative squared error.
    RelativeMse,
    /// Share of it that is the reference's own noise; not a number where that is unknown.
    ReferenceNoise,
    /// The rest; likewise.
    Corrected,
    /// Mean luminance of the image over that of the reference.
    Ratio,
    /// Mean FLIP error.
    Flip,
    /// Mean squared error of luminance.
    ///
    /// Source: Lai et al. 2007 (`Err`).
    Err,
    /// One over processor time and [`Measure::Err`]; higher is better.
    ///
    /// Source: Lai et al. 2007 (`Eff`).
    Eff,
    /// The efficiency constant: relative squared error without the reference's own noise, times
    /// processor time. For an unbiased estimator it does not depend on the time spent; lower is
    /// better. Where the noise is unknown it is taken for none.
    EfficiencyConstant,
}

impl Measure {
    /// All measures, with their names in files.
    pub const NAMES: [(&'static str, Self); 14] = [
        ("wall_s", Self::Wall),
        ("cpu_s", Self::Cpu),
        ("overrun_s", Self::Overrun),
        ("passes", Self::Passes),
        ("spp", Self::Samples),
        ("mse", Self::Mse),
        ("relmse", Self::RelativeMse),
        ("reference_noise", Self::ReferenceNoise),
        ("relmse_corrected", Self::Corrected),
        ("mean_ratio", Self::Ratio),
        ("flip", Self::Flip),
        ("err", Self::Err),
        ("eff", Self::Eff),
        ("efficiency_constant", Self::EfficiencyConstant),
    ];

    /// Its value in a trial.
    pub fn of(self, trial: &Trial) -> f64 {
        let found = &trial.errors;
        let corrected = found.corrected_relative_mse();
        let of_work = |count: fn(&Work) -> u32| {
            let work = trial.work.as_ref();
            work.map_or(f64::NAN, |work| f64::from(count(work)))
        };
        match self {
            Self::Wall => trial.wall_seconds,
            Self::Cpu => trial.cpu_seconds,
            Self::Overrun => trial.overrun_seconds,
            Self::Passes => of_work(|work| work.passes),
            Self::Samples => of_work(|work| work.samples),
            Self::Mse => found.mse,
            Self::RelativeMse => found.relative_mse,
            Self::ReferenceNoise => found.reference_noise.unwrap_or(f64::NAN),
            Self::Corrected => corrected.unwrap_or(f64::NAN),
            Self::Ratio => found.mean_ratio,
            Self::Flip => found.flip,
            Self::Err => found.luminance_mse,
            Self::Eff => (trial.cpu_seconds * found.luminance_mse).recip(),
            Self::EfficiencyConstant => corrected.unwrap_or(found.relative_mse) * trial.cpu_seconds,
        }
    }
}

/// All seeds of one integrator on one scene with one budget.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// Name of the scene.
    pub scene: String,
    /// Name of the integrator or the peer.
    pub integrator: String,
    /// How much was to be rendered.
    pub budget: String,
    /// Number of trials.
    pub seeds: usize,
    /// Mean over the seeds of [`Measure::Ratio`].
    pub ratio: Mean,
    /// False where the reference is too noisy for some trial: the relative error is less than twice
    /// the reference's own.
    pub beyond_noise: bool,
    /// What else is known, as far as all trials tell it.
    pub statistics: Vec<(String, Spread)>,
    spreads: [Spread; Measure::NAMES.len()],
}

impl Standing {
    /// How a measure is spread over the seeds.
    pub fn spread(&self, measure: Measure) -> Spread {
        self.spreads[measure as usize]
    }

    /// - `trials`: at least one, all of one scene, integrator and budget.
    fn new(trials: &[&Trial]) -> Option<Self> {
        let first = trials.first()?;
        let values = |measure: Measure| -> Vec<f64> {
            trials.iter().map(|trial| measure.of(trial)).collect()
        };
        let statistics = first.statistics.iter().filter_map(|(name, _)| {
            let values: Option<Vec<f64>> = trials.iter().map(|t| t.statistic(name)).collect();
            Some((name.clone(), Spread::of(&values?)))
        });
        Some(Self {
            scene: first.scene.clone(),
            integrator: first.integrator.clone(),
            budget: first.budget.clone(),
            seeds: trials.len(),
            ratio: Mean::of(&values(Measure::Ratio)),
            beyond_noise: trials.iter().all(|trial| trial.is_beyond_noise()),
            statistics: statistics.collect(),
            spreads: Measure::NAMES.map(|(_, measure)| Spread::of(&values(measure))),
        })
    }
}

impl Trial {
    /// One of the further statistics.
    pub fn statistic(&self, name: &str) -> Option<f64> {
        let mut found = self.statistics.iter().filter(|(known, _)| known == name);
        found.next().map(|(_, value)| *value)
    }

    /// Whether the error is at least twice the reference's own noise, as far as that is known.
    pub fn is_beyond_noise(&self) -> bool {
        let found = &self.errors;
        let noise = found.reference_noise.unwrap_or(0.0);
        found.relative_mse >= 2.0 * noise
    }

    fn is_of(&self, other: &Self) -> bool {
        self.scene == other.scene
            && self.integrator == other.integrator
            && self.budget == other.budget
    }
}

/// Puts the seeds together, in the order in which scenes, budgets and integrators first appear.
pub fn standings(trials: &[Trial]) -> Vec<Standing> {
    let mut groups: Vec<Vec<&Trial>> = Vec::new();
    for trial in trials {
        match groups.iter_mut().find(|group| group[0].is_of(trial)) {
            Some(group) => group.push(trial),
            None => groups.push(vec![trial]),
        }
    }
    groups
        .iter()
        .filter_map(|group| Standing::new(group))
        .collect()
}

#[cfg(test)]
mod tests;
