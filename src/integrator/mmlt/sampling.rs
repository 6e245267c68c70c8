//! Chains of numbers that make one path each.

use std::ops::Range;

use super::Mmlt;
use super::evaluation::{Evaluator, Shown, Technique};
use crate::film::{Canvas, Filter};
use crate::integrator::chains::Landing;
use crate::integrator::metropolis::{
    ChainPlan, PrimaryNumbers, PrimaryOptions, Sampling, Seed, counted,
};
use crate::integrator::render::Counters;
use crate::mutation::PrimarySpace;

/// Chains of numbers and techniques as what Metropolis sampling samples.
///
/// A bootstrap sample is one of bidirectional path tracing, and each of its paths is a seed by itself. Given the
/// length of a path, the technique and the numbers that it is made of are then spread as the target of
/// chains is: the technique's number is uniform among those that choose it, and what Russian roulette has
/// left out is made up for by what it has strengthened. So chains share out over lengths as the light does,
/// lengths have no limit, and chains need no roulette, which would make holes in their target.
///
/// Differs: the paper draws seeds for each length from samples of one technique each; how many techniques there are
/// then is a factor of the target. Here it would be the same on either side of every ratio.
pub(in crate::integrator) struct MultiplexedSampling<'a>(pub(super) &'a Mmlt);

/// A chain under way.
struct Walk<'a> {
    /// Edges of its paths.
    edges: usize,
    /// The number that chooses the technique.
    number: f32,
    here: Shown,
    /// Energy that waits where the chain is.
    waiting: f64,
    /// Energy of a deposit.
    deposit: f64,
    landing: Landing<'a>,
}

impl Walk<'_> {
    fn flush(&mut self) {
        let energy = std::mem::take(&mut self.waiting);
        let here = &self.here;
        self.landing.land(here.raster, here.colour, (energy, 0.0));
    }

    /// Makes a step.
    ///
    /// Source: Hachisuka et al. 2014; van Antwerpen 2011, Alg. 5 and 8.
    fn step(
        &mut self,
        evaluator: &mut Evaluator<'_>,
        numbers: &mut PrimaryNumbers,
        options: &PrimaryOptions,
    ) {
        let is_large = numbers.uniform() < options.p_large;
        let random = numbers.eye.random();
        let number = if is_large {
            random.next_f32()
        } else {
            options.steps.step(self.number, random)
        };
        numbers.propose(is_large);
        let technique = Technique::of(number, self.edges);
        let (there, tried) = evaluator.evaluate(technique, numbers.sides());
        let importance = there.map_or(0.0, |there| there.importance);
        let acceptance = (importance / self.here.importance).min(1.0);
        if let Some(raster) = tried.filter(|_| self.landing.counts_proposals()) {
            self.landing.count_proposal(raster, acceptance);
        }
        self.waiting += (1.0 - acceptance) * self.deposit;
        let is_accepted = acceptance > 0.0 && numbers.uniform() < acceptance;
        numbers.settle(acceptance, is_accepted);
        let Some(there) = there else { return };
        if is_accepted {
            self.flush();
            self.here = there;
            self.number = number;
            self.waiting = acceptance * self.deposit;
        } else {
            let energy = acceptance * self.deposit;
            self.landing.land(there.raster, there.colour, (energy, 0.0));
        }
    }
}

/// Finds the path of a bootstrap sample that a seed has chosen, in proportion to its light; `None` for one
/// without light.
fn chosen(
    evaluator: &mut Evaluator<'_>,
    numbers: &mut PrimaryNumbers,
    seed: &Seed,
) -> Option<(Technique, Shown)> {
    // What rounding makes of sums must not lead beyond the last path.
    let mut within = seed.within * (1.0 - 1e-9);
    let mut chosen = None;
    evaluator.trace(numbers.sides(), &mut |technique, shown| {
        if within >= 0.0 {
            chosen = Some((technique, shown));
            within -= shown.importance;
        }
    });
    chosen
}

impl Sampling for MultiplexedSampling<'_> {
    fn bootstrap(&self, plan: &ChainPlan<'_>, samples: Range<u32>) -> (Vec<f64>, Counters) {
        let mut evaluator = Evaluator::new(plan, &self.0.tracing);
        let mut numbers = PrimaryNumbers::new(self.0.primary.steps, plan);
        let luminance = |sample| {
            numbers.begin(plan, sample);
            let mut sum = 0.0;
            evaluator.trace(numbers.sides(), &mut |_, shown| sum += shown.importance);
            sum
        };
        let luminances: Vec<f64> = samples.map(luminance).collect();
        counted(luminances, evaluator.space.rays())
    }

    fn run_chain(&self, plan: &ChainPlan<'_>, index: u32, seed: Seed) -> Counters {
        let mmlt = self.0;
        let mut evaluator = Evaluator::new(plan, &mmlt.tracing);
        let mut numbers = PrimaryNumbers::new(mmlt.primary.steps, plan);
        numbers.begin(plan, seed.sample);
        let Some((technique, shown)) = chosen(&mut evaluator, &mut numbers, &seed) else {
            return Counters::default();
        };
        if let Some(place) = plan.film.places.chains {
            plan.layers[place].add(&Filter::pixel_box(), shown.raster, [1.0]);
        }
        // The numbers that the sample has asked for, but those of the roulette.
        numbers.propose(true);
        let (here, _) = evaluator.evaluate(technique, numbers.sides());
        numbers.start_chain(plan, index);
        evaluator.reserve(technique.edges());
        let landing = plan.landing();
        let fits = technique.edges() <= PrimarySpace::VERTICES;
        if let Some(here) = here.filter(|_| fits) {
            let mut walk = Walk {
                edges: technique.edges(),
                number: technique.number(numbers.uniform() as f32),
                here,
                waiting: 0.0,
                deposit: plan.deposit,
                landing,
            };
            for _ in 0..plan.length {
                walk.step(&mut evaluator, &mut numbers, &mmlt.primary);
            }
            walk.flush();
        } else {
            let energy = plan.deposit * f64::from(plan.length);
            landing.land(shown.raster, shown.colour, (energy, energy));
        }
        Counters {
            rays: evaluator.space.rays(),
            chains: 1,
            mutations: numbers.eye.statistics,
            ..Counters::default()
        }
    }
}
