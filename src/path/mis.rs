//! Multiple importance sampling.

use crate::math::lanes::Lanes;

/// How the weights of two techniques follow from their densities.
///
/// Every heuristic's weights sum to one wherever some technique has a positive density.
///
/// Source: Veach 1997, Sec. 9.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heuristic {
    /// In proportion to the density.
    Balance,
    /// In proportion to its square.
    #[default]
    Power,
    /// All to the technique with the largest density; ties go to the first technique.
    ///
    /// Densities that are equal but for rounding are a tie: each technique computes them from other
    /// numbers, and both would take or both would leave the sample.
    Maximum,
}

/// Densities count as equal up to this factor.
const TIE: f32 = 1.001;

impl Heuristic {
    /// All heuristics, with their names in options.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("balance", Self::Balance),
        ("power", Self::Power),
        ("maximum", Self::Maximum),
    ];

    /// Weight of the first of two techniques.
    ///
    /// - `first`, `second`: densities of the same sample in the same measure; not both zero.
    #[inline]
    pub fn first_weight(self, first: f32, second: f32) -> f32 {
        match self {
            Self::Balance => first / (first + second),
            Self::Power => {
                // As a ratio, so that squares of large densities do not overflow.
                let ratio = second / first;
                1.0 / (1.0 + ratio * ratio)
            }
            Self::Maximum => f32::from(u8::from(first * TIE >= second)),
        }
    }

    /// [`Heuristic::first_weight`] in each lane.
    #[inline(always)]
    pub fn first_weights(self, first: Lanes, second: Lanes) -> Lanes {
        match self {
            Self::Balance => first / (first + second),
            Self::Power => {
                let ratio = second / first;
                Lanes::ONE / (Lanes::ONE + ratio * ratio)
            }
            Self::Maximum => {
                let is_first = (first * TIE).cmpge(second);
                Lanes::select(is_first, Lanes::ONE, Lanes::ZERO)
            }
        }
    }

    /// Weight of the second of two techniques, as in [`Heuristic::first_weight`].
    #[inline]
    pub fn second_weight(self, first: f32, second: f32) -> f32 {
        match self {
            Self::Balance => second / (first + second),
            Self::Power => {
                let ratio = first / second;
                1.0 / (1.0 + ratio * ratio)
            }
            Self::Maximum => f32::from(u8::from(first * TIE < second)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one() {
        for (name, heuristic) in Heuristic::NAMES {
            for (a, b) in [
                (1.0, 2.0),
                (3.0, 3.0),
                (0.0, 1.0),
                (2.0, 0.0),
                (1e30, 1e-30),
            ] {
                let first = heuristic.first_weight(a, b);
                let lanes = heuristic.first_weights(Lanes::splat(a), Lanes::splat(b));
                assert_eq!(lanes, Lanes::splat(first), "{name} at {a}, {b}");
                let sum = first + heuristic.second_weight(a, b);
                assert!((sum - 1.0).abs() < 1e-6, "{name} at {a}, {b}: {sum}");
            }
        }
        assert_eq!(Heuristic::Balance.first_weight(1.0, 3.0), 0.25);
        assert_eq!(Heuristic::Power.first_weight(1.0, 3.0), 0.1);
        assert_eq!(Heuristic::Maximum.first_weight(1.0, 3.0), 0.0);
        for second in [1.0 - 1e-6, 1.0 + 1e-6] {
            assert_eq!(Heuristic::Maximum.first_weight(1.0, second), 1.0);
            assert_eq!(Heuristic::Maximum.second_weight(1.0, second), 0.0);
        }
    }
}
