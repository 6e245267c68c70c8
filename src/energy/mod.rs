//! How the energy of a sample flows along Markov chains, whatever the chains walk over.
//!
//! The law behind every rule: given a seed of energy `e`, the energy deposited at a chain's `j`-th step
//! is `c_j · e` in expectation, with `c_j` the same for every seed. Numbers of steps and depths never
//! depend on a state or its energy.

mod adaptation;
mod flow;
mod population;
#[cfg(test)]
mod ring;
#[cfg(test)]
mod tests;

pub use adaptation::{AcceptanceTally, choose_kernel, kernel_weights};
pub use flow::{FlowRule, Walker, chain_count, run_chain};
pub use population::{
    Account, Births, Member, Population, PopulationRule, Scheme, Transfer, survival_probabilities,
};
