//! The flow rules on a ring, and faulty ones.

use super::ring::{METROPOLIS, Moves, Ring, check, check_rule};
use super::{FlowRule, Walker, chain_count};

/// Deposits such that a seed wants 0.75 to 6 chains, in the mean three.
fn three_chains(length: u32) -> f64 {
    4.0 / f64::from(length)
}

fn equal(length: u32, cap: u32, expected: bool) -> FlowRule {
    FlowRule::EqualDeposition {
        length,
        deposit: three_chains(length),
        cap,
        expected,
    }
}

fn iterated(proposals: u32, depth: u32, threshold: f64) -> FlowRule {
    FlowRule::IteratedDetailedBalance {
        proposals,
        depth,
        threshold,
    }
}

#[test]
fn equal_deposition_is_unbiased() -> Result<(), String> {
    for expected in [true, false] {
        for length in [1, 10, 100] {
            // Caps that all energies reach, some (one of them by half a chain), and none.
            for cap in [1, 2, 4, 1000] {
                check_rule(METROPOLIS, equal(length, cap, expected))?;
            }
        }
    }
    Ok(())
}

#[test]
fn detailed_balance_is_unbiased() -> Result<(), String> {
    for proposals in [1, 3] {
        check_rule(METROPOLIS, FlowRule::DetailedBalance { proposals })?;
    }
    Ok(())
}

#[test]
fn iterated_detailed_balance_is_unbiased() -> Result<(), String> {
    for proposals in [1, 2] {
        for depth in [1, 3, 6] {
            for threshold in [0.0, 2.0] {
                check_rule(METROPOLIS, iterated(proposals, depth, threshold))?;
            }
        }
    }
    Ok(())
}

const RULES: [FlowRule; 3] = [
    FlowRule::EqualDeposition {
        length: 10,
        deposit: 0.4,
        cap: 4,
        expected: true,
    },
    FlowRule::DetailedBalance { proposals: 2 },
    FlowRule::IteratedDetailedBalance {
        proposals: 1,
        depth: 5,
        threshold: 1.0,
    },
];

#[test]
fn any_acceptance_in_balance_will_do() -> Result<(), String> {
    // That of Barker instead of Metropolis and Hastings, and one that is always small.
    for acceptance in [
        |ratio| ratio / (1.0 + ratio),
        |ratio: f64| 0.1 * ratio.min(1.0),
    ] {
        for rule in RULES {
            check_rule(
                Moves {
                    acceptance,
                    ..METROPOLIS
                },
                rule,
            )?;
        }
    }
    Ok(())
}

#[test]
fn walkers_out_of_balance_are_found() {
    let ratio_too_large = Moves {
        acceptance: |ratio| (1.05 * ratio).min(1.0),
        ..METROPOLIS
    };
    let accepts_all = Moves {
        acceptance: |_| 1.0,
        ..METROPOLIS
    };
    let prefers_up = Moves {
        up: 0.55,
        ..METROPOLIS
    };
    for moves in [ratio_too_large, accepts_all, prefers_up] {
        for rule in RULES {
            assert!(check_rule(moves, rule).is_err(), "{rule:?}");
        }
    }
}

/// One chain of equal deposition.
fn chain(ring: &mut Ring, length: u32, deposit: f64) {
    let rule = FlowRule::EqualDeposition {
        length,
        deposit,
        cap: 1,
        expected: true,
    };
    rule.spread(ring, deposit * f64::from(length));
}

#[test]
fn chains_cut_at_the_cap_are_found() {
    const LENGTH: u32 = 2;
    let deposit = three_chains(LENGTH);
    let cut = |ring: &mut Ring, energy: f64| {
        let wanted = chain_count(energy, deposit, LENGTH, ring.uniform());
        (0..wanted.min(4)).for_each(|_| chain(ring, LENGTH, deposit));
    };
    assert!(check(METROPOLIS, (0, 6.0), cut).is_err());
    // Larger deposits for rounded numbers beyond the cap: what was rounded down to it loses energy.
    let raised_by_chance = |ring: &mut Ring, energy: f64| {
        let wanted = chain_count(energy, deposit, LENGTH, ring.uniform());
        let deposit = if wanted > 4 {
            energy / f64::from(4 * LENGTH)
        } else {
            deposit
        };
        (0..wanted.min(4)).for_each(|_| chain(ring, LENGTH, deposit));
    };
    assert!(check(METROPOLIS, (0, 6.0), raised_by_chance).is_err());
}

#[test]
fn chains_that_live_as_long_as_their_energy_are_found() {
    for deposit in [3.0, 1.0] {
        let by_energy = |ring: &mut Ring, energy: f64| {
            let steps = chain_count(energy, deposit, 1, ring.uniform());
            if steps > 0 {
                chain(ring, steps, deposit);
            }
        };
        assert!(check(METROPOLIS, (0, 12.0 / deposit), by_energy).is_err());
    }
}

#[test]
fn deposits_at_proposals_that_are_not_weighed_are_found() {
    let unweighed = |ring: &mut Ring, energy: f64| {
        ring.restart();
        for _ in 0..10 {
            let acceptance = ring.propose();
            if acceptance > 0.0 {
                ring.deposit_there(energy / 10.0);
            } else {
                ring.deposit_here(energy / 10.0);
            }
            let is_accepted = ring.uniform() < acceptance;
            ring.settle(is_accepted);
        }
    };
    assert!(check(METROPOLIS, (0, 10.0), unweighed).is_err());
}

/// What is wrong with a copy of iterated detailed balance.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Nothing,
    /// Only what goes to proposals is spread again; what is left stays.
    ChildrenOnly,
    /// Weak energies end without a stronger one in their place.
    Uncompensated,
    /// Weak energies are not spread any further.
    StopsWhenWeak,
}

fn faulty_iteration(ring: &mut Ring, energy: f64, rule: (u32, usize, f64), fault: Fault) {
    let (proposals, depth, threshold) = rule;
    let mut energy = energy;
    if energy < threshold && fault == Fault::StopsWhenWeak {
        return ring.deposit_here(energy);
    } else if energy < threshold {
        if ring.uniform() * threshold >= energy {
            return;
        }
        if fault != Fault::Uncompensated {
            energy = threshold;
        }
    }
    if depth == 0 {
        return ring.deposit_here(energy);
    }
    let deeper = (proposals, depth - 1, threshold);
    let (own, child) = (2 * depth, 2 * depth + 1);
    ring.save(own);
    let mut left = energy;
    for _ in 0..proposals {
        let part = ring.propose() * energy / f64::from(proposals);
        if part > 0.0 {
            left -= part;
            ring.save_proposal(child);
            ring.settle(false);
            ring.load(child);
            faulty_iteration(ring, part, deeper, fault);
            ring.load(own);
        } else {
            ring.settle(false);
        }
    }
    if fault == Fault::ChildrenOnly {
        ring.deposit_here(left);
    } else {
        faulty_iteration(ring, left, deeper, fault);
    }
}

#[test]
fn faulty_iterations_are_found() {
    for (proposals, depth) in [(1, 3), (2, 3), (1, 6)] {
        let found = |fault: Fault| {
            let mutations = f64::from(proposals + 1).powi(depth as i32);
            let size = (2 * depth + 2, mutations);
            check(METROPOLIS, size, |ring, energy| {
                ring.restart();
                faulty_iteration(ring, energy, (proposals, depth, 2.0), fault);
            })
        };
        assert_eq!(found(Fault::Nothing), Ok(()));
        for fault in [
            Fault::ChildrenOnly,
            Fault::Uncompensated,
            Fault::StopsWhenWeak,
        ] {
            assert!(found(fault).is_err(), "{fault:?}, {proposals}, {depth}");
        }
    }
}
