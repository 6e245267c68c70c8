//! The mixture of mutations and radii.

use super::map::KernelMap;
use super::{Adaptation, Density, PmcEr};
use crate::energy::{AcceptanceTally, choose_kernel, kernel_weights};
use crate::film::{Canvas, Filter, PassBuffer};
use crate::integrator::chains::{Kernel, Places};
use crate::math::Vec2;
use crate::mutation::{
    Chain, Choice, ChoiceAt, Choose, Component, Mutation, Perturbation, Proposed, mixture_density,
};
use crate::path::{Path, PathSpace};
use crate::random::Stream;

/// What all members of a batch share.
#[derive(Clone, Copy)]
pub(super) struct Batch<'a> {
    pub(super) pmc_er: &'a PmcEr,
    /// The moves of each radius.
    pub(super) perturbations: &'a [Perturbation],
    /// Frozen while members live.
    pub(super) map: &'a KernelMap,
    pub(super) places: Places,
    pub(super) layers: &'a [PassBuffer],
}

/// What a member has seen of each radius itself; empty where that does not matter.
pub(super) type Memory = Vec<AcceptanceTally>;

/// A mixture of kernels: chooses a radius by the state's place on the image, then a mutation by the state's kind.
///
/// Source: Lai et al. 2007, Sec. 4.2.
pub(super) struct RadiusKernel<'a> {
    batch: Batch<'a>,
    choice: ChoiceAt,
    memory: Memory,
    /// Probabilities by the member's own memory.
    own_weights: Vec<f32>,
    /// Rounds that the member has lived.
    age: u32,
}

impl<'a> RadiusKernel<'a> {
    pub(super) fn new(batch: Batch<'a>) -> Self {
        let kernels = batch.perturbations.len();
        Self {
            batch,
            choice: ChoiceAt::default(),
            memory: Memory::new(),
            own_weights: vec![1.0 / kernels as f32; kernels],
            age: 0,
        }
    }

    /// Begins a member's round.
    ///
    /// - `memory`: what the member has seen.
    /// - `age`: rounds that it has lived.
    pub(super) fn begin_round(&mut self, path: &Path, memory: &mut Memory, age: u32) {
        self.choice = self.batch.pmc_er.choice.at(path);
        self.age = age;
        if self.batch.pmc_er.adaptation == Adaptation::Member {
            std::mem::swap(&mut self.memory, memory);
            self.memory
                .resize(self.own_weights.len(), AcceptanceTally::default());
            let learning = self.batch.pmc_er.learning;
            // As published: sums, not means.
            let merits = self.memory.iter().zip(&self.batch.pmc_er.radii);
            let merits: Vec<f64> = merits
                .map(|(tally, radius)| tally.steps as f64 * learning.reach_of(*radius))
                .collect();
            self.own_weights = kernel_weights(&merits, learning.epsilon);
        }
    }

    /// Ends a member's round: gives its memory back.
    pub(super) fn end_round(&mut self, memory: &mut Memory) {
        if self.batch.pmc_er.adaptation == Adaptation::Member {
            std::mem::swap(&mut self.memory, memory);
        }
    }

    /// Probabilities of the radii for a path that is seen at a raster position.
    #[inline]
    fn weights(&self, raster: Vec2) -> &[f32] {
        match self.batch.pmc_er.adaptation {
            Adaptation::Map { .. } => self.batch.map.weights(raster),
            Adaptation::Member | Adaptation::Off => &self.own_weights,
        }
    }

    /// Remembers how a mutation went.
    #[inline]
    fn learn(&mut self, raster: Vec2, kernel: usize, acceptance: f64) {
        match self.batch.pmc_er.adaptation {
            Adaptation::Map { .. } => self.batch.map.learn(raster, kernel, acceptance),
            Adaptation::Member => self.memory[kernel].add(acceptance),
            Adaptation::Off => {}
        }
    }

    /// Counts a mutation on the layers that were asked for.
    fn count(&self, raster: Vec2, kernel: usize) {
        let Batch { places, layers, .. } = self.batch;
        let Some(mutations) = places.mutations else {
            return;
        };
        let pixel = Filter::pixel_box();
        layers[mutations].add(&pixel, raster, [1.0]);
        if let Some(age) = places.age {
            layers[age].add(&pixel, raster, [self.age as f32]);
        }
        if let Some(strategy) = places.strategy {
            let mut share = [0.0; 3];
            share[kernel * 3 / self.own_weights.len()] = 1.0;
            layers[strategy].add(&pixel, raster, share);
        }
    }
}

impl Kernel for RadiusKernel<'_> {
    fn prepare(&mut self, seed: &Path) -> bool {
        can_move(&self.batch.pmc_er.choice, seed)
    }

    #[inline]
    fn propose(
        &mut self,
        chain: &mut Chain,
        space: &PathSpace<'_>,
        random: &mut Stream,
    ) -> Option<Proposed> {
        let here = chain.current().raster();
        let kernel = choose_kernel(self.weights(here), random.next_f32());
        let settings = &self.batch.perturbations[kernel];
        let choice = OfRadius {
            mixture: self,
            kernel,
        };
        let proposed = chain.propose(space, settings, &choice, random);
        let acceptance = proposed.map_or(0.0, |proposed| proposed.acceptance);
        self.learn(here, kernel, acceptance);
        self.count(here, kernel);
        proposed
    }
}

/// Whether any mutation applies to a path.
pub(super) fn can_move(choice: &Choice, path: &Path) -> bool {
    !choice.at(path).is_empty() && path.colour().is_some()
}

/// The choice of a mutation, given the radius.
struct OfRadius<'k> {
    mixture: &'k RadiusKernel<'k>,
    kernel: usize,
}

impl OfRadius<'_> {
    /// Probability of choosing a radius and a mutation at a path.
    #[inline]
    fn probability(&self, path: &Path, kernel: usize, mutation: Mutation) -> f64 {
        let weight = f64::from(self.mixture.weights(path.raster())[kernel]);
        weight * self.mixture.choice.probability(mutation)
    }

    fn component(&self, path: &Path, kernel: usize, mutation: Mutation) -> Component<'_> {
        Component {
            mutation,
            settings: &self.mixture.batch.perturbations[kernel],
            probability: self.probability(path, kernel, mutation),
        }
    }
}

impl Choose for OfRadius<'_> {
    #[inline]
    fn choose(&self, path: &Path, u: f32) -> Option<Mutation> {
        self.mixture.choice.choose(path, u)
    }

    #[inline]
    fn density(&self, space: &PathSpace<'_>, from: &Path, to: &Path, mutation: Mutation) -> f64 {
        if self.mixture.batch.pmc_er.density == Density::Kernel {
            return self.probability(from, self.kernel, mutation);
        }
        let kernels = 0..self.mixture.own_weights.len();
        let components = kernels.flat_map(|kernel| {
            let of_mutation = move |mutation: &Mutation| self.component(from, kernel, *mutation);
            Mutation::ALL.iter().map(of_mutation)
        });
        let maker = self.component(from, self.kernel, mutation);
        mixture_density(space, maker, components, (from, to))
    }
}
