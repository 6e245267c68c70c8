//! Populations on the ring: what is unbiased, and what is found not to be.

use super::{Account, Births, Member, Population, PopulationRule, Scheme, Transfer};
use crate::energy::Walker;
use crate::energy::adaptation::{AcceptanceTally, choose_kernel, kernel_weights};
use crate::energy::ring::{METROPOLIS, Ring, STATES, check_groups};

/// Kernels: steps to a neighbour, and to the other side.
const STEPS: [usize; 2] = [1, 3];

/// What is done, and what is done wrong.
#[derive(Clone, Copy)]
struct Trial {
    rule: PopulationRule,
    rate: f64,
    adaptation: Adaptation,
    fault: Fault,
    /// Members alive at once.
    size: usize,
    /// Seeds at each state in a batch.
    batch: u32,
}

/// How kernels are chosen.
#[derive(Clone, Copy, PartialEq)]
enum Adaptation {
    /// Always the first one.
    None,
    /// By the state, from what was seen in batches before.
    Map,
    /// By what the member has seen itself.
    Member,
}

#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// The chance of choosing the kernel is left out of the ratio.
    NoWeights,
    /// The map learns while members live.
    MapChanges,
    /// Survivors take over nothing.
    NoCompensation,
    /// What finds no room is dropped.
    NoQueue,
}

const FIXED: PopulationRule = PopulationRule {
    scheme: Scheme::Fixed { rounds: 4 },
    transfer: Transfer::Deposits { expected: true },
    mutations: 2,
    // Seeds want 0.75 to 6 members.
    deposit: 0.5,
    cap: 1000,
};

const TRIAL: Trial = Trial {
    rule: FIXED,
    rate: 0.4,
    adaptation: Adaptation::None,
    fault: Fault::None,
    size: 12,
    batch: 30,
};

/// A member: where it is, and what it has seen of each kernel.
#[derive(Clone, Copy, Default)]
struct State {
    place: usize,
    seen: [AcceptanceTally; 2],
}

impl State {
    fn at(place: usize) -> Self {
        Self {
            place,
            ..Self::default()
        }
    }
}

/// What the ring's states are known for.
type Map = [[AcceptanceTally; 2]; STATES];

/// A walker on the ring with two kernels.
struct Walk<'a> {
    trial: Trial,
    ring: &'a mut Ring,
    frozen: &'a Map,
    learnt: &'a mut Map,
    seen: [AcceptanceTally; 2],
}

impl Walk<'_> {
    /// Probability of choosing each kernel at a state.
    fn weights(&self, place: usize) -> Vec<f32> {
        let means = |tallies: &[AcceptanceTally; 2]| tallies.map(|tally| tally.mean((0.0, 0.0)));
        let merits = match (self.trial.adaptation, self.trial.fault) {
            (Adaptation::None, _) => return vec![1.0, 0.0],
            (Adaptation::Map, Fault::MapChanges) => means(&self.learnt[place]),
            (Adaptation::Map, _) => means(&self.frozen[place]),
            // As printed: sums.
            (Adaptation::Member, _) => self.seen.map(|tally| tally.steps as f64),
        };
        kernel_weights(&merits, 0.01)
    }
}

impl Walker for Walk<'_> {
    fn restart(&mut self) {
        self.ring.restart();
    }

    fn propose(&mut self) -> f64 {
        let here = self.ring.place();
        let u = self.ring.uniform() as f32;
        let kernel = choose_kernel(&self.weights(here), u);
        let has_factor =
            self.trial.adaptation == Adaptation::Map && self.trial.fault != Fault::NoWeights;
        let chances: [f32; STATES] = std::array::from_fn(|place| self.weights(place)[kernel]);
        let acceptance = self.ring.propose_step(STEPS[kernel], |there| {
            if has_factor {
                f64::from(chances[there]) / f64::from(chances[here])
            } else {
                1.0
            }
        });
        self.learnt[here][kernel].add(acceptance);
        self.seen[kernel].add(acceptance);
        acceptance
    }

    fn settle(&mut self, is_accepted: bool) {
        self.ring.settle(is_accepted);
    }

    fn deposit_here(&mut self, energy: f64) {
        self.ring.deposit_here(energy);
    }

    fn deposit_there(&mut self, energy: f64) {
        self.ring.deposit_there(energy);
    }

    fn uniform(&mut self) -> f64 {
        self.ring.uniform()
    }

    fn save(&mut self, level: usize) {
        self.ring.save(level);
    }

    fn load(&mut self, level: usize) {
        self.ring.load(level);
    }

    fn save_proposal(&mut self, level: usize) {
        self.ring.save_proposal(level);
    }
}

/// One batch: seeds at all states, some of them alive at a time.
fn batch(trial: Trial, ring: &mut Ring, map: &mut Map) {
    let frozen = *map;
    let mut learnt = if trial.fault == Fault::MapChanges {
        Map::default()
    } else {
        *map
    };
    let mut population: Population<State> = Population::new(trial.rule, trial.size);
    let mut pool = (0..trial.batch).flat_map(|_| 0..STATES);
    loop {
        if trial.fault == Fault::NoQueue {
            population.forget_queue();
        }
        while population.vacancies() > 0 {
            let Some(place) = pool.next() else { break };
            let births = trial.rule.births(ring.seed_energy(place), ring.uniform());
            population.enqueue((births, State::at(place)));
        }
        population.admit(|_| {});
        if population.is_empty() {
            break;
        }
        let children = play_round(trial, ring, &mut population, (&frozen, &mut learnt));
        population.turn_over(children);
        let alive = population.members.len();
        population.eliminate(trial.rate, ring.uniform());
        if trial.fault == Fault::NoCompensation && population.members.len() < alive {
            for member in population.members_mut() {
                member.account.weight = 1.0;
            }
        }
    }
    *map = learnt;
}

/// A round of all members; returns their children.
fn play_round(
    trial: Trial,
    ring: &mut Ring,
    population: &mut Population<State>,
    (frozen, learnt): (&Map, &mut Map),
) -> Vec<Member<State>> {
    let mut children = Vec::new();
    for member in population.members_mut() {
        ring.go_to(member.state.place);
        let mut walk = Walk {
            trial,
            ring: &mut *ring,
            frozen,
            learnt: &mut *learnt,
            seen: member.state.seen,
        };
        let mut give_birth = |walk: &mut Walk<'_>, account| {
            let state = State::at(walk.ring.proposed());
            children.push(Member { account, state });
        };
        trial
            .rule
            .play_round(&mut member.account, &mut walk, &mut give_birth);
        member.state.seen = walk.seen;
        member.state.place = ring.place();
    }
    children
}

/// Mean deposits of a group of seeds, in batches that learn from those before.
fn check(trial: Trial) -> Result<(), String> {
    check_groups(METROPOLIS, |ring, rounds| {
        let mut map = Map::default();
        let batches = rounds.div_ceil(trial.batch);
        for _ in 0..batches {
            batch(trial, ring, &mut map);
        }
        batches * trial.batch
    })
}

fn with_rule(rule: PopulationRule) -> Trial {
    Trial { rule, ..TRIAL }
}

#[test]
fn populations_are_unbiased() -> Result<(), String> {
    for expected in [true, false] {
        for (rounds, mutations) in [(1, 1), (1, 8), (4, 2), (16, 1)] {
            for (cap, rate) in [(1000, 0.4), (2, 0.4), (1000, 0.0), (1000, 0.9)] {
                let rule = PopulationRule {
                    scheme: Scheme::Fixed { rounds },
                    transfer: Transfer::Deposits { expected },
                    mutations,
                    deposit: 4.0 / f64::from(rounds * mutations),
                    cap,
                };
                check(Trial {
                    rate,
                    ..with_rule(rule)
                })
                .map_err(|error| format!("{rule:?}: {error}"))?;
            }
        }
    }
    Ok(())
}

#[test]
fn balance_transfer_is_unbiased() -> Result<(), String> {
    for (rounds, mutations) in [(1, 1), (1, 4), (3, 2), (6, 1)] {
        for rate in [0.0, 0.4] {
            let rule = PopulationRule {
                scheme: Scheme::Fixed { rounds },
                transfer: Transfer::Balance,
                mutations,
                deposit: 4.0 / f64::from(rounds * mutations),
                cap: 3,
            };
            check(Trial {
                rate,
                ..with_rule(rule)
            })
            .map_err(|error| format!("{rule:?}: {error}"))?;
        }
    }
    Ok(())
}

#[test]
fn maps_adapt_without_bias() -> Result<(), String> {
    check(Trial {
        adaptation: Adaptation::Map,
        ..TRIAL
    })
}

#[test]
fn planted_errors_are_found() {
    for (name, trial) in [
        (
            "kernel weights left out",
            Trial {
                adaptation: Adaptation::Map,
                fault: Fault::NoWeights,
                ..TRIAL
            },
        ),
        (
            "map changed inside of a batch",
            Trial {
                adaptation: Adaptation::Map,
                fault: Fault::MapChanges,
                size: 1,
                batch: 1,
                ..TRIAL
            },
        ),
        (
            "survivors not compensated",
            Trial {
                fault: Fault::NoCompensation,
                ..TRIAL
            },
        ),
        (
            "queue dropped",
            Trial {
                fault: Fault::NoQueue,
                ..TRIAL
            },
        ),
    ] {
        let found = check(trial);
        assert!(found.is_err(), "{name}");
        println!("{name}: {}", found.unwrap_err());
    }
}

/// The published scheme: life by energy, and kernels by a member's own past.
#[test]
fn lives_by_energy_and_own_pasts_are_biased() {
    let lai = with_rule(PopulationRule {
        scheme: Scheme::Energy,
        mutations: 4,
        deposit: 1.5,
        ..FIXED
    });
    let own_past = Trial {
        adaptation: Adaptation::Member,
        rate: 0.0,
        ..with_rule(PopulationRule {
            scheme: Scheme::Fixed { rounds: 30 },
            mutations: 1,
            deposit: 2.0 / 30.0,
            ..FIXED
        })
    };
    for (name, trial) in [("life by energy", lai), ("own past", own_past)] {
        let found = check(trial);
        println!("{name}: {found:?}");
        assert!(found.is_err(), "{name}");
    }
}

#[test]
fn heavier_members_take_what_the_cap_leaves() {
    let births = |energy| FIXED.births(energy, 0.5);
    let capped = PopulationRule { cap: 2, ..FIXED };
    assert_eq!(births(8.0).count, 2);
    assert_eq!(births(8.0).account.weight, 1.0);
    assert_eq!(births(0.0).count, 0);
    let Births { count, account } = capped.births(40.0, 0.5);
    assert_eq!((count, account.weight), (2, 5.0));
    assert!(Account::is_alive(&account));
}
