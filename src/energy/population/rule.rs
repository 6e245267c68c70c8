//! What a member has, and what it does with it.

use crate::energy::Walker;
use crate::energy::flow::run_chain;

/// How long members live.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// All of them the same number of rounds. Unbiased.
    Fixed {
        /// That number; positive.
        rounds: u32,
    },
    /// As long as their energy lasts.
    ///
    /// Biased: a chain that has less energy ends sooner, and how its states are spread depends on how long it
    /// was. Kept because the published tables were made so; `docs/pmc-er.md` measures the bias.
    ///
    /// Source: Lai et al. 2007, Fig. 2.
    Energy,
}

/// How a member spreads its energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transfer {
    /// A deposit of the same energy at each mutation.
    Deposits {
        /// Whether a mutation deposits at both states, in proportion to the chance of being there.
        expected: bool,
    },
    /// Detailed balance: a member stays where it is, and its proposals become members of their own, with as much
    /// of its energy as they would be accepted with.
    ///
    /// Source: Lai et al. 2007, Sec. 5; Cline et al. 2005, Sec. 3.2.
    Balance,
}

/// The energy and the time of a member.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Account {
    /// Factor on its deposits; under [`Scheme::Energy`] what is left of its energy, as luminance.
    pub weight: f64,
    /// Rounds to come; under [`Scheme::Energy`] one until the last is over.
    rounds_left: u32,
    /// Rounds lived.
    pub age: u32,
}

impl Account {
    /// Whether there are rounds to come.
    pub fn is_alive(&self) -> bool {
        self.rounds_left > 0
    }
}

/// Members that start from one seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Births {
    /// How many.
    pub count: u32,
    /// What each of them has.
    pub account: Account,
}

/// How members come to life and live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PopulationRule {
    /// How long they live.
    pub scheme: Scheme,
    /// How they spread their energy.
    pub transfer: Transfer,
    /// Mutations of a round; positive.
    pub mutations: u32,
    /// Energy of a deposit at weight one, as luminance; positive.
    pub deposit: f64,
    /// Most members of one seed; a seed of more energy makes heavier ones. Positive.
    pub cap: u32,
}

impl PopulationRule {
    /// Energy of a round at weight one.
    fn round_energy(&self) -> f64 {
        f64::from(self.mutations) * self.deposit
    }

    /// Energy of a member at weight one; only where all live equally long.
    fn member_energy(&self, rounds: u32) -> f64 {
        f64::from(rounds) * self.round_energy()
    }

    /// The members of a seed.
    ///
    /// - `energy`: of the seed, as luminance; not negative.
    /// - `u`: uniform in `[0, 1)`.
    pub fn births(&self, energy: f64, u: f64) -> Births {
        let born = |count, weight, rounds_left| Births {
            count,
            account: Account {
                weight,
                rounds_left,
                age: 0,
            },
        };
        let Scheme::Fixed { rounds } = self.scheme else {
            return born(u32::from(energy > 0.0), energy, 1);
        };
        let share = energy / self.member_energy(rounds);
        let cap = f64::from(self.cap);
        // Decided by the energy before it is rounded: see the cap of chains.
        if share > cap {
            born(self.cap, share / cap, rounds)
        } else {
            born(((share + u).floor() as u32).min(self.cap), 1.0, rounds)
        }
    }

    /// Begins a member's next round; `None` where it has died instead.
    ///
    /// Returns the energy of a deposit. Under [`Scheme::Energy`] a round that the energy left does not suffice for takes
    /// place with that chance.
    ///
    /// - `u`: uniform in `[0, 1)`.
    pub(super) fn begin_round(&self, account: &mut Account, u: f64) -> Option<f64> {
        account.age += 1;
        match self.scheme {
            Scheme::Fixed { .. } => {
                account.rounds_left -= 1;
                Some(account.weight * self.deposit)
            }
            Scheme::Energy => {
                let round = self.round_energy();
                if account.weight >= round {
                    account.weight -= round;
                    return Some(self.deposit);
                }
                account.rounds_left = 0;
                (u * round < account.weight).then_some(self.deposit)
            }
        }
    }

    /// Plays a member's next round.
    ///
    /// - `walker`: at the member's state.
    /// - `give_birth`: told of each child, which starts at the walker's proposal.
    ///
    /// Source: Lai et al. 2007, Fig. 2, lines 7 to 13.
    pub fn play_round<W: Walker>(
        &self,
        account: &mut Account,
        walker: &mut W,
        give_birth: impl FnMut(&mut W, Account),
    ) {
        let u = walker.uniform();
        let Some(deposit) = self.begin_round(account, u) else {
            return;
        };
        match self.transfer {
            Transfer::Deposits { expected } => {
                run_chain(walker, self.mutations, deposit, expected);
            }
            Transfer::Balance => self.share(account, walker, give_birth),
        }
    }

    /// A round of detailed balance: to what goes and to what stays, the same is done in the rounds to come.
    fn share<W: Walker>(
        &self,
        account: &mut Account,
        walker: &mut W,
        mut give_birth: impl FnMut(&mut W, Account),
    ) {
        let Scheme::Fixed { rounds } = self.scheme else {
            unreachable!("options refuse this");
        };
        let energy = self.member_energy(rounds);
        let mut left = account.weight;
        for _ in 0..self.mutations {
            let part = walker.propose() * account.weight / f64::from(self.mutations);
            left -= part;
            if part > 0.0 {
                if account.is_alive() {
                    if let Some(weight) = roulette(part, walker.uniform()) {
                        give_birth(walker, Account { weight, ..*account });
                    }
                } else {
                    walker.deposit_there(part * energy);
                }
            }
            walker.settle(false);
        }
        let left = left.max(0.0);
        if !account.is_alive() {
            walker.deposit_here(left * energy);
        } else if let Some(weight) = roulette(left, walker.uniform()) {
            account.weight = weight;
        } else {
            account.rounds_left = 0;
        }
    }

    /// What a member's chance of surviving is proportional to: the energy that it is still to spread.
    pub(super) fn strength(&self, account: &Account) -> f64 {
        match self.scheme {
            Scheme::Fixed { .. } => account.weight * f64::from(account.rounds_left),
            Scheme::Energy => account.weight,
        }
    }

    /// Gives a survivor what others have lost.
    pub(super) fn strengthen(&self, account: &mut Account, factor: f64) {
        account.weight *= factor;
    }
}

/// Russian roulette for weights below one, so that the number of members does not grow from round to
/// round.
fn roulette(weight: f64, u: f64) -> Option<f64> {
    if weight >= 1.0 {
        return Some(weight);
    }
    (u < weight).then_some(1.0)
}
