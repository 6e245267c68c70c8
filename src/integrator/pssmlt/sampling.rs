//! Chains of numbers.

use std::ops::Range;

use super::evaluation::{Evaluation, Evaluator, Wanted};
use super::{Pssmlt, Target};
use crate::film::Filter;
use crate::integrator::chains::Landing;
use crate::integrator::metropolis::{ChainPlan, Sampling, Seed};
use crate::integrator::render::Counters;
use crate::mutation::PrimarySpace;

/// Chains of numbers as what Metropolis sampling samples.
pub(super) struct PrimarySampling<'a>(pub(super) &'a Pssmlt);

/// How energy is shared between the places of a chain and the large steps as samples of their own.
#[derive(Clone, Copy)]
struct Weights {
    /// Energy of a deposit.
    deposit: f64,
    /// Energy of a large step as a sample of its own, for each unit of its importance.
    per_importance: f64,
    /// Density of large steps over that of a chain's places, times the importance.
    ratio: f64,
}

impl Weights {
    /// The weights of a pass. Their sum is one for any mean, if only it does not depend on the pass.
    fn new(pssmlt: &Pssmlt, plan: &ChainPlan<'_>) -> Self {
        if !pssmlt.weigh_large_steps || pssmlt.p_large == 0.0 {
            return Self {
                deposit: plan.deposit,
                per_importance: 0.0,
                ratio: 0.0,
            };
        }
        let mean = plan.film.mean.chains;
        let mutations = f64::from(plan.chains) * f64::from(plan.length);
        Self {
            deposit: plan.deposit,
            per_importance: plan.pixels() / (pssmlt.p_large * mutations),
            ratio: pssmlt.p_large * mean,
        }
    }

    /// Energy of a deposit at a state.
    #[inline]
    fn of_state(&self, importance: f64) -> f64 {
        self.deposit * (importance / (importance + self.ratio))
    }

    /// Energy of a large step as a sample of its own.
    #[inline]
    fn of_large_step(&self, importance: f64) -> f64 {
        self.per_importance * importance * (self.ratio / (importance + self.ratio))
    }
}

/// A chain under way.
struct Walk<'a> {
    here: Evaluation,
    /// Energy that waits there.
    waiting: f64,
    weights: Weights,
    landing: Landing<'a>,
}

impl Walk<'_> {
    fn flush(&mut self) {
        let energy = std::mem::take(&mut self.waiting);
        self.land(self.here, energy);
    }

    fn land(&self, state: Evaluation, energy: f64) {
        self.landing.land(state.raster, state.colour, (energy, 0.0));
    }

    /// Makes a step.
    ///
    /// Source: Kelemen et al. 2002, for the weights; van Antwerpen 2011, Alg. 5.
    fn step(
        &mut self,
        (evaluator, wanted): (&mut Evaluator<'_>, Wanted),
        primary: &mut PrimarySpace,
        p_large: f64,
    ) {
        let is_large = f64::from(primary.random().next_f32()) < p_large;
        primary.propose(is_large);
        let there = evaluator.evaluate(wanted, primary);
        let acceptance = (there.importance / self.here.importance).min(1.0);
        if self.landing.counts_proposals() {
            self.landing.count_proposal(there.raster, acceptance);
        }
        self.waiting += (1.0 - acceptance) * self.weights.of_state(self.here.importance);
        if there.importance > 0.0 {
            let mut energy = acceptance * self.weights.of_state(there.importance);
            if is_large {
                energy += self.weights.of_large_step(there.importance);
            }
            self.land(there, energy);
        }
        let is_accepted = acceptance > 0.0 && f64::from(primary.random().next_f32()) < acceptance;
        primary.settle(acceptance, is_accepted);
        if is_accepted {
            self.flush();
            self.here = there;
        }
    }
}

impl Sampling for PrimarySampling<'_> {
    fn bootstrap(&self, plan: &ChainPlan<'_>, samples: Range<u32>) -> (Vec<f64>, Counters) {
        let mut evaluator = Evaluator::new(plan);
        let mut primary = PrimarySpace::new(self.0.steps, plan.bootstrap_numbers(0));
        let luminance = |sample| {
            primary.begin(plan.bootstrap_numbers(sample), plan.cells.cell(sample));
            evaluator.evaluate(Wanted::All, &mut primary).importance
        };
        let luminances: Vec<f64> = samples.map(luminance).collect();
        let counters = Counters {
            paths: luminances.len() as u64,
            rays: evaluator.space.rays(),
            ..Counters::default()
        };
        (luminances, counters)
    }

    fn run_chain(&self, plan: &ChainPlan<'_>, index: u32, seed: Seed) -> Counters {
        let pssmlt = self.0;
        let mut evaluator = Evaluator::new(plan);
        let (numbers, cell) = (
            plan.bootstrap_numbers(seed.sample),
            plan.cells.cell(seed.sample),
        );
        let mut primary = PrimarySpace::new(pssmlt.steps, numbers.clone());
        let mut wanted = Wanted::All;
        if pssmlt.target == Target::Path {
            primary.begin(numbers.clone(), cell);
            let all = evaluator.evaluate(Wanted::All, &mut primary);
            let within = seed.within / plan.importance.at(all.raster);
            primary.begin(numbers.clone(), cell);
            wanted = evaluator.path_at(within, &mut primary);
        }
        primary.begin(numbers, cell);
        let here = evaluator.evaluate(wanted, &mut primary);
        primary.start_chain(plan.chain_numbers(index));
        let mut walk = Walk {
            here,
            waiting: 0.0,
            weights: Weights::new(pssmlt, plan),
            landing: plan.landing(),
        };
        if let Some(place) = plan.film.places.chains {
            plan.layers[place].add(&Filter::pixel_box(), here.raster, [1.0]);
        }
        for _ in 0..plan.length {
            walk.step((&mut evaluator, wanted), &mut primary, pssmlt.p_large);
        }
        walk.flush();
        Counters {
            rays: evaluator.space.rays(),
            chains: 1,
            mutations: primary.statistics,
            ..Counters::default()
        }
    }
}
