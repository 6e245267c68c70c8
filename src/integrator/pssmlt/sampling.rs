//! Chains of numbers.

use std::ops::Range;

use super::evaluation::{Evaluation, Evaluator, Wanted};
use super::{Pssmlt, Target};
use crate::film::{Canvas, Filter};
use crate::integrator::chains::Landing;
use crate::integrator::metropolis::{ChainPlan, PrimaryNumbers, Sampling, Seed, counted};
use crate::integrator::render::Counters;

/// Chains of numbers as what Metropolis sampling samples.
pub(in crate::integrator) struct PrimarySampling<'a>(pub(super) &'a Pssmlt);

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
        if !pssmlt.weigh_large_steps || pssmlt.primary.p_large == 0.0 {
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
            per_importance: plan.pixels() / (pssmlt.primary.p_large * mutations),
            ratio: pssmlt.primary.p_large * mean,
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
    there: Evaluation,
    /// Energy that waits where the chain is.
    waiting: f64,
    weights: Weights,
    landing: Landing<'a>,
}

impl Walk<'_> {
    fn flush(&mut self) {
        let energy = std::mem::take(&mut self.waiting);
        self.land(&self.here, energy);
    }

    /// Lets energy land at all places of a state, in proportion to their importances.
    fn land(&self, state: &Evaluation, energy: f64) {
        for splat in &state.splats {
            let part = energy * (splat.importance / state.importance);
            self.landing.land(splat.raster, splat.colour, (part, 0.0));
        }
    }

    /// Makes a step.
    ///
    /// Source: Kelemen et al. 2002, for the weights; van Antwerpen 2011, Alg. 5.
    fn step(
        &mut self,
        (evaluator, wanted): (&mut Evaluator<'_>, Wanted),
        numbers: &mut PrimaryNumbers,
        p_large: f64,
    ) {
        let is_large = numbers.uniform() < p_large;
        numbers.propose(is_large);
        evaluator.evaluate(wanted, numbers.sides(), &mut self.there);
        let (here, there) = (self.here.importance, self.there.importance);
        let acceptance = (there / here).min(1.0);
        if self.landing.counts_proposals() {
            self.landing.count_proposal(self.there.raster, acceptance);
        }
        self.waiting += (1.0 - acceptance) * self.weights.of_state(here);
        if there > 0.0 {
            let mut energy = acceptance * self.weights.of_state(there);
            if is_large {
                energy += self.weights.of_large_step(there);
            }
            self.land(&self.there, energy);
        }
        let is_accepted = acceptance > 0.0 && numbers.uniform() < acceptance;
        numbers.settle(acceptance, is_accepted);
        if is_accepted {
            self.flush();
            std::mem::swap(&mut self.here, &mut self.there);
        }
    }
}

impl Sampling for PrimarySampling<'_> {
    fn bootstrap(&self, plan: &ChainPlan<'_>, samples: Range<u32>) -> (Vec<f64>, Counters) {
        let mut evaluator = Evaluator::new(plan, self.0.seeds.both_sides.as_ref());
        let mut numbers = PrimaryNumbers::new(self.0.primary.steps, plan);
        let mut found = Evaluation::new();
        let luminance = |sample| {
            numbers.begin(plan, sample);
            evaluator.evaluate(Wanted::All, numbers.sides(), &mut found);
            found.importance
        };
        let luminances: Vec<f64> = samples.map(luminance).collect();
        counted(luminances, evaluator.space.rays())
    }

    fn run_chain(&self, plan: &ChainPlan<'_>, index: u32, seed: Seed) -> Counters {
        let pssmlt = self.0;
        let mut evaluator = Evaluator::new(plan, pssmlt.seeds.both_sides.as_ref());
        let mut numbers = PrimaryNumbers::new(pssmlt.primary.steps, plan);
        let mut here = Evaluation::new();
        let mut wanted = Wanted::All;
        if pssmlt.target == Target::Path {
            numbers.begin(plan, seed.sample);
            evaluator.evaluate(wanted, numbers.sides(), &mut here);
            let within = seed.within / plan.importance.at(here.raster);
            numbers.begin(plan, seed.sample);
            wanted = evaluator.path_at(within, &mut numbers.eye);
        }
        numbers.begin(plan, seed.sample);
        evaluator.evaluate(wanted, numbers.sides(), &mut here);
        numbers.start_chain(plan, index);
        if let Some(place) = plan.film.places.chains {
            plan.layers[place].add(&Filter::pixel_box(), here.raster, [1.0]);
        }
        let mut walk = Walk {
            here,
            there: Evaluation::new(),
            waiting: 0.0,
            weights: Weights::new(pssmlt, plan),
            landing: plan.landing(),
        };
        for _ in 0..plan.length {
            walk.step(
                (&mut evaluator, wanted),
                &mut numbers,
                pssmlt.primary.p_large,
            );
        }
        walk.flush();
        Counters {
            rays: evaluator.space.rays(),
            chains: 1,
            mutations: numbers.eye.statistics,
            ..Counters::default()
        }
    }
}
