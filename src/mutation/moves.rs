//! What statistics tell apart.

use super::{Mutation, MutationStatistics};

/// Any way of making a proposal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// A mutation that keeps the signature.
    Perturbation(Mutation),
    /// The bidirectional mutation.
    Bidirectional,
    /// A small step of all coordinates in primary sample space.
    SmallStep,
    /// Fresh coordinates in primary sample space.
    LargeStep,
}

/// What became of all moves, by [`Move::index`].
pub type MoveStatistics = [MutationStatistics; Move::COUNT];

impl Move {
    /// Number of moves.
    pub const COUNT: usize = Mutation::COUNT + 3;

    /// All moves, by their index.
    pub fn all() -> impl Iterator<Item = Self> {
        let perturbations = Mutation::ALL.iter().map(|m| Self::Perturbation(*m));
        perturbations.chain([Self::Bidirectional, Self::SmallStep, Self::LargeStep])
    }

    /// Its place in [`MoveStatistics`].
    #[inline]
    pub const fn index(self) -> usize {
        match self {
            Self::Perturbation(mutation) => mutation as usize,
            Self::Bidirectional => Mutation::COUNT,
            Self::SmallStep => Mutation::COUNT + 1,
            Self::LargeStep => Mutation::COUNT + 2,
        }
    }

    /// Its name in statistics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Perturbation(mutation) => mutation.name(),
            Self::Bidirectional => "bidirectional",
            Self::SmallStep => "small_step",
            Self::LargeStep => "large_step",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_move_has_its_own_place() {
        let places: Vec<usize> = Move::all().map(Move::index).collect();
        assert_eq!(places, (0..Move::COUNT).collect::<Vec<_>>());
    }
}
