//! A ring of six states that energy flows over: whatever the rule, a seed's mean deposit is the target.

use statrs::function::beta::beta_reg;

use super::{FlowRule, Walker};
use crate::math::statistics::sidak;
use crate::random::{Purpose, Stream};

pub(super) const STATES: usize = 6;
/// The target at each state. Seeds are uniform, so that they have six times this energy.
const TARGET: [f64; STATES] = [1.0, 2.0, 4.0, 1.5, 3.0, 0.5];
/// Independent groups of seeds, from which the variance comes.
const GROUPS: usize = 64;
/// Mutations of one rule, roughly.
const MUTATIONS: f64 = 1e6;
/// Chance that the right rules fail with another seed.
const LEVEL: f64 = 1e-3;
/// Values that are compared: those of all states and their sum, for about so many rules.
const FAMILY: usize = (STATES + 1) * 64;

/// How a walker on the ring moves.
#[derive(Clone, Copy)]
pub(super) struct Moves {
    /// Acceptance of a proposal with so many times the current target.
    pub(super) acceptance: fn(f64) -> f64,
    /// Part of the proposals that go up.
    pub(super) up: f64,
    /// Part of the mutations that make no proposal.
    pub(super) failures: f64,
}

pub(super) const METROPOLIS: Moves = Moves {
    acceptance: |ratio| ratio.min(1.0),
    up: 0.5,
    failures: 0.125,
};

/// A walker that holds everyone to the order of calls.
pub(super) struct Ring {
    moves: Moves,
    random: Stream,
    seed: usize,
    current: usize,
    /// Outer `None` but between propose and settle, inner where there is no proposal.
    proposal: Option<Option<usize>>,
    kept: Vec<Option<usize>>,
    deposits: [f64; STATES],
}

impl Ring {
    fn new(moves: Moves, levels: usize, group: usize) -> Self {
        Self {
            moves,
            random: Stream::new(61, Purpose::Check, group as u32, 0),
            seed: 0,
            current: 0,
            proposal: None,
            kept: vec![None; levels],
            deposits: [0.0; STATES],
        }
    }

    /// Energy of a seed at a state.
    pub(super) fn seed_energy(&self, state: usize) -> f64 {
        TARGET[state] * STATES as f64
    }

    /// The current state.
    pub(super) fn place(&self) -> usize {
        self.current
    }

    /// Makes a state the current one.
    pub(super) fn go_to(&mut self, state: usize) {
        assert_eq!(self.proposal, None);
        self.current = state;
    }

    /// The proposal under way.
    pub(super) fn proposed(&self) -> usize {
        self.proposal.flatten().expect("a proposal")
    }

    /// Proposes a step of a size, up or down; returns its acceptance, given a further factor on the ratio.
    pub(super) fn propose_step(&mut self, size: usize, factor: impl FnOnce(usize) -> f64) -> f64 {
        assert_eq!(self.proposal, None);
        if self.uniform() < self.moves.failures {
            self.proposal = Some(None);
            return 0.0;
        }
        let step = if self.uniform() < self.moves.up {
            size
        } else {
            STATES - size
        };
        let next = (self.current + step) % STATES;
        self.proposal = Some(Some(next));
        (self.moves.acceptance)(TARGET[next] / TARGET[self.current] * factor(next))
    }
}

impl Walker for Ring {
    fn restart(&mut self) {
        assert_eq!(self.proposal, None);
        self.current = self.seed;
    }

    fn propose(&mut self) -> f64 {
        self.propose_step(1, |_| 1.0)
    }

    fn settle(&mut self, is_accepted: bool) {
        let proposal = self.proposal.take().expect("a mutation to settle");
        if is_accepted {
            self.current = proposal.expect("a proposal to accept");
        }
    }

    fn deposit_here(&mut self, energy: f64) {
        self.deposits[self.current] += energy;
    }

    fn deposit_there(&mut self, energy: f64) {
        self.deposits[self.proposed()] += energy;
    }

    fn uniform(&mut self) -> f64 {
        (f64::from(self.random.next_u32()) + 0.5) / 4_294_967_296.0
    }

    fn save(&mut self, level: usize) {
        self.kept[level] = Some(self.current);
    }

    fn load(&mut self, level: usize) {
        assert_eq!(self.proposal, None);
        self.current = self.kept[level].expect("a state that was kept");
    }

    fn save_proposal(&mut self, level: usize) {
        self.kept[level] = Some(self.proposal.flatten().expect("a proposal"));
    }
}

/// Checks the mean deposit at every state and their sum.
///
/// - `levels`: states that the rule keeps at a time.
/// - `mutations`: of a seed, in the mean.
pub(super) fn check(
    moves: Moves,
    (levels, mutations): (usize, f64),
    spread: impl Fn(&mut Ring, f64),
) -> Result<(), String> {
    let rounds = (MUTATIONS / (mutations * (GROUPS * STATES) as f64)).max(4.0) as u32;
    let group = |ring: &mut Ring| {
        for _ in 0..rounds {
            for state in 0..STATES {
                ring.seed = state;
                spread(ring, ring.seed_energy(state));
            }
        }
        rounds
    };
    compare(moves, levels, group)
}

/// As [`check`], of something that makes a group of seeds itself.
///
/// - `run`: told about how many seeds to make at each state; returns how many it made.
pub(super) fn check_groups(
    moves: Moves,
    run: impl Fn(&mut Ring, u32) -> u32,
) -> Result<(), String> {
    const ROUNDS: u32 = 600;
    compare(moves, 0, |ring| run(ring, ROUNDS))
}

/// Compares the mean deposits of independent groups of seeds with the target.
///
/// - `run`: makes as many seeds at each state, and returns how many.
fn compare(moves: Moves, levels: usize, run: impl Fn(&mut Ring) -> u32) -> Result<(), String> {
    let groups: Vec<_> = (0..GROUPS)
        .map(|number| {
            let mut ring = Ring::new(moves, levels, number);
            let seeds = f64::from(run(&mut ring)) * STATES as f64;
            ring.deposits.map(|sum| sum / seeds)
        })
        .collect();
    let sum = |values: &[f64; STATES]| values.iter().sum::<f64>();
    for state in 0..STATES {
        verdict(
            &format!("state {state}"),
            TARGET[state],
            groups.iter().map(|group| group[state]),
        )?;
    }
    verdict("their sum", sum(&TARGET), groups.iter().map(sum))
}

/// Checks the mean of independent values against its expectation, by Student's t.
fn verdict(
    what: &str,
    expected: f64,
    values: impl ExactSizeIterator<Item = f64> + Clone,
) -> Result<(), String> {
    let count = values.len() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares = values.map(|value| (value - mean).powi(2)).sum::<f64>();
    let difference = mean - expected;
    // Rules that conserve each seed's energy leave rounding alone.
    if difference.abs() < 1e-9 * expected {
        return Ok(());
    }
    let t = difference / (squares / (count * (count - 1.0))).sqrt();
    let freedom = count - 1.0;
    let p = beta_reg(freedom / 2.0, 0.5, freedom / (freedom + t * t));
    if p > sidak(LEVEL, FAMILY) {
        return Ok(());
    }
    Err(format!("{what}: {mean:.5}, not {expected} (t = {t:.1})"))
}

/// As [`check`] for one of the renderer's rules.
pub(super) fn check_rule(moves: Moves, rule: FlowRule) -> Result<(), String> {
    let mutations = match rule {
        FlowRule::EqualDeposition {
            length,
            deposit,
            cap,
            ..
        } => {
            let wanted = TARGET.map(|target| STATES as f64 * target / deposit);
            let most = f64::from(cap) * f64::from(length);
            wanted.iter().map(|steps| steps.min(most)).sum::<f64>() / STATES as f64
        }
        FlowRule::DetailedBalance { proposals } => f64::from(proposals),
        FlowRule::IteratedDetailedBalance {
            proposals, depth, ..
        } => f64::from(proposals + 1).powi(depth as i32) - 1.0,
    };
    check(moves, (rule.levels(), mutations), |ring, energy| {
        rule.spread(ring, energy);
    })
    .map_err(|error| format!("{rule:?}: {error}"))
}
