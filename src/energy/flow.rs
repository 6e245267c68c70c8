//! Flow rules.

/// What energy flows over: a current state, proposals, and a place where energy lands.
pub trait Walker {
    /// Goes back to the seed.
    fn restart(&mut self);

    /// Makes a proposal; returns the probability of accepting it, zero where there is none.
    fn propose(&mut self) -> f64;

    /// Makes the last proposal the current state, or forgets it. Follows every [`Walker::propose`].
    fn settle(&mut self, is_accepted: bool);

    /// Deposits energy at the current state.
    fn deposit_here(&mut self, energy: f64);

    /// Deposits energy at the proposal; only between propose and settle.
    fn deposit_there(&mut self, energy: f64);

    /// A uniform number in `[0, 1)`.
    fn uniform(&mut self) -> f64;

    /// Keeps the current state as number `level`.
    fn save(&mut self, level: usize);

    /// Goes to the state that was kept as number `level`.
    fn load(&mut self, level: usize);

    /// Keeps the proposal as number `level`; only between propose and settle.
    fn save_proposal(&mut self, level: usize);
}

/// How the energy of a seed is spread.
///
/// Source: Cline et al. 2005, Sec. 3.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlowRule {
    /// Chains that deposit the same energy at each step; how many depends on the seed's energy.
    EqualDeposition {
        /// Steps of a chain.
        length: u32,
        /// Energy of a deposit, as luminance.
        deposit: f64,
        /// Largest number of chains of one seed; a seed of more energy makes larger deposits.
        cap: u32,
        /// Whether a step deposits at both states, in proportion to the chance of being there, instead
        /// of at the one where it ends.
        expected: bool,
    },
    /// A number of proposals from the seed, each of which gets its share of the energy as far as it is
    /// accepted; the rest stays.
    DetailedBalance {
        /// Number of proposals.
        proposals: u32,
    },
    /// Detailed balance, applied again to what stays and to what went, to a fixed depth.
    ///
    /// Differs: the paper leaves open what the rule is applied to; applied to what went alone it is
    /// biased.
    IteratedDetailedBalance {
        /// Number of proposals at each application.
        proposals: u32,
        /// How often the rule is applied to one another's results.
        depth: u32,
        /// Energies below this one are put to Russian roulette; zero for none.
        threshold: f64,
    },
}

impl FlowRule {
    /// Number of states that [`Walker::save`] must have room for.
    pub fn levels(self) -> usize {
        match self {
            Self::EqualDeposition { .. } | Self::DetailedBalance { .. } => 0,
            Self::IteratedDetailedBalance { depth, .. } => 2 * depth as usize + 2,
        }
    }

    /// Spreads the energy of a seed, at which the walker starts; returns the number of chains.
    ///
    /// - `energy`: of the seed, as luminance; not negative.
    pub fn spread(self, walker: &mut impl Walker, energy: f64) -> u32 {
        match self {
            Self::EqualDeposition {
                length,
                deposit,
                cap,
                expected,
            } => {
                // Decided by the energy before it is rounded to chains: the chance of being rounded down
                // to the cap must not cost energy.
                let most = f64::from(cap) * f64::from(length) * deposit;
                let (chains, deposit) = if energy > most {
                    (cap, deposit * (energy / most))
                } else {
                    let wanted = chain_count(energy, deposit, length, walker.uniform());
                    (wanted.min(cap), deposit)
                };
                for _ in 0..chains {
                    walker.restart();
                    run_chain(walker, length, deposit, expected);
                }
                chains
            }
            Self::DetailedBalance { proposals } => {
                walker.restart();
                let left = share(walker, energy, proposals, |walker, part| {
                    walker.deposit_there(part);
                });
                walker.deposit_here(left);
                1
            }
            Self::IteratedDetailedBalance {
                proposals,
                depth,
                threshold,
            } => {
                walker.restart();
                iterate(walker, energy, (proposals, depth, threshold));
                1
            }
        }
    }
}

/// Number of Markov chains that a seed starts under equal deposition.
///
/// Rounds `energy / (length · deposit)` up or down at random, so that the *expected* energy handed out
/// is the seed's.
///
/// - `energy`: luminance of the seed's Monte Carlo estimate. Zero gives no chain.
/// - `deposit`: energy of one deposit, same unit, positive.
/// - `length`: steps of a chain, positive.
/// - `u`: uniform in `[0, 1)`.
///
/// Source: Cline et al. 2005, Fig. 6.
///
/// ```
/// use lumiflow::energy::chain_count;
/// assert_eq!(chain_count(3.0, 0.01, 100, 0.99), 3); // three chains, almost surely
/// assert_eq!(chain_count(0.5, 0.01, 100, 0.6), 1); // half a chain, rounded by u
/// assert_eq!(chain_count(0.5, 0.01, 100, 0.4), 0);
/// ```
pub fn chain_count(energy: f64, deposit: f64, length: u32, u: f64) -> u32 {
    (energy / (deposit * f64::from(length)) + u).floor() as u32
}

/// One chain of equal deposition, from where the walker is.
///
/// - `length`: number of steps.
/// - `deposit`: energy of each, as luminance.
/// - `expected`: whether a step deposits at both states, in proportion to the chance of being there.
///
/// Source: Cline et al. 2005, Fig. 6; van Antwerpen 2011, Alg. 8 for the expected values.
pub fn run_chain(walker: &mut impl Walker, length: u32, deposit: f64, expected: bool) {
    for _ in 0..length {
        let acceptance = walker.propose();
        if expected {
            if acceptance > 0.0 {
                walker.deposit_there(acceptance * deposit);
            }
            if acceptance < 1.0 {
                walker.deposit_here((1.0 - acceptance) * deposit);
            }
        }
        let is_accepted = acceptance > 0.0 && walker.uniform() < acceptance;
        walker.settle(is_accepted);
        if !expected {
            walker.deposit_here(deposit);
        }
    }
}

/// Offers energy to proposals from the current state; returns what stays.
fn share<W: Walker>(
    walker: &mut W,
    energy: f64,
    proposals: u32,
    mut give: impl FnMut(&mut W, f64),
) -> f64 {
    let mut left = energy;
    for _ in 0..proposals {
        let part = walker.propose() * energy / f64::from(proposals);
        if part > 0.0 {
            left -= part;
            give(walker, part);
        }
        walker.settle(false);
    }
    left.max(0.0)
}

/// Detailed balance from the current state, and again from the states that result.
fn iterate(walker: &mut impl Walker, energy: f64, rule: (u32, u32, f64)) {
    let (proposals, depth, threshold) = rule;
    let mut energy = energy;
    if energy < threshold {
        if walker.uniform() * threshold >= energy {
            return;
        }
        energy = threshold;
    }
    if depth == 0 {
        walker.deposit_here(energy);
        return;
    }
    let deeper = (proposals, depth - 1, threshold);
    // What was kept by this application: the state itself, and one proposal at a time.
    let (own, child) = (2 * depth as usize, 2 * depth as usize + 1);
    walker.save(own);
    let mut left = energy;
    for _ in 0..proposals {
        let part = walker.propose() * energy / f64::from(proposals);
        if part > 0.0 {
            left -= part;
            walker.save_proposal(child);
            walker.settle(false);
            walker.load(child);
            iterate(walker, part, deeper);
            walker.load(own);
        } else {
            walker.settle(false);
        }
    }
    iterate(walker, left.max(0.0), deeper);
}
