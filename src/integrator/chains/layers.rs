//! The layers of a render by chains.

use super::SeedOptions;
use crate::film::Layer;
use crate::integrator::pixel::PixelSettings;

/// Layers that all algorithms of chains make on demand.
pub(in crate::integrator) const OWN_LAYERS: &[&str] = &["proposals", "acceptance", "chains"];

/// Place of each layer among the buffers; `None` for those that are not made.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrator) struct Places {
    pub(super) direct: Option<usize>,
    pub(super) redistributed: usize,
    pub(super) filtered: Option<usize>,
    pub(super) proposals: Option<usize>,
    pub(super) expected: Option<usize>,
    pub(super) acceptance: Option<usize>,
    /// Chains that began at a pixel.
    pub(in crate::integrator) chains: Option<usize>,
    /// Mutations made from a pixel.
    pub(in crate::integrator) mutations: Option<usize>,
    /// Share of the small, middle and large moves among them.
    pub(in crate::integrator) strategy: Option<usize>,
    /// Rounds lived by those who made them.
    pub(in crate::integrator) age: Option<usize>,
    pub(super) first_aov: usize,
}

impl Places {
    /// The layers of a render, with their places.
    pub(super) fn new(seeds: &SeedOptions, settings: &PixelSettings) -> (Vec<Layer>, Self) {
        let beauty = if settings.alpha { "RGBA" } else { "RGB" };
        let mut layers = vec![Layer::new("", beauty)];
        let mut push = |name: &str, channels: &str| {
            layers.push(Layer::new(name, channels));
            layers.len() - 1
        };
        let is_wanted = |name: &str| settings.own_layers.iter().any(|wanted| wanted == name);
        let filter = &seeds.noise_filter;
        let acceptance = is_wanted("acceptance");
        let needs_proposals = acceptance || is_wanted("proposals") || filter.needs_proposals();
        let (strategy, age) = (is_wanted("strategy"), is_wanted("population_age"));
        let needs_mutations = strategy || age || is_wanted("mutations");
        let places = Self {
            direct: seeds.direct_samples.map(|_| push("direct", "RGB")),
            redistributed: push("redistributed", "RGB"),
            filtered: filter.is_on().then(|| push("filtered", "RGB")),
            proposals: needs_proposals.then(|| push("proposals", "Y")),
            expected: filter
                .needs_proposals()
                .then(|| push("expected_proposals", "Y")),
            acceptance: acceptance.then(|| push("acceptance", "Y")),
            chains: is_wanted("chains").then(|| push("chains", "Y")),
            mutations: needs_mutations.then(|| push("mutations", "Y")),
            strategy: strategy.then(|| push("strategy", "RGB")),
            age: age.then(|| push("population_age", "Y")),
            first_aov: 0,
        };
        let first_aov = layers.len();
        layers.extend(settings.aovs.iter().map(|aov| aov.layer()));
        (
            layers,
            Self {
                first_aov,
                ..places
            },
        )
    }

    /// Places of the layers that count something.
    pub(super) fn counts(&self) -> impl Iterator<Item = usize> {
        [
            self.proposals,
            self.expected,
            self.acceptance,
            self.chains,
            self.mutations,
            self.strategy,
            self.age,
        ]
        .into_iter()
        .flatten()
    }

    /// Layers of sums with the layers of counts that make means of them.
    pub(super) fn ratios(&self) -> impl Iterator<Item = (usize, usize)> {
        [
            self.acceptance.zip(self.proposals),
            self.strategy.zip(self.mutations),
            self.age.zip(self.mutations),
        ]
        .into_iter()
        .flatten()
    }
}
