//! From a direction back to the numbers that a sampler makes it of.

use super::Component;
use crate::math::warp::ONE_MINUS_EPSILON;
use crate::math::{Local, Vec2, warp};

/// The numbers that [`super::BsdfModel::sample`] is given, each in `[0, 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleNumbers {
    /// Chooses the lobe.
    pub u_lobe: f32,
    /// Make the direction.
    pub u: Vec2,
}

/// What was sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampled {
    /// A direction, by some finite lobe.
    Finite(Local),
    /// A Dirac component.
    Dirac(Component),
}

/// Random numbers for what a sample leaves open: it does not tell the lobe, nor all of the numbers.
#[derive(Clone, Copy, Debug)]
pub struct Spare {
    /// Chooses among the lobes that could have made the direction, in `[0, 1)`.
    pub lobe: f32,
    /// Stand in for the numbers that the lobe makes no use of.
    pub numbers: SampleNumbers,
}

impl SampleNumbers {
    /// The same, with the number of the lobe moved from `[0, 1)` to the part of it that begins at
    /// `low` and has the length `size`.
    #[inline]
    pub(super) fn within(self, low: f32, size: f32) -> Self {
        // Rounding must not lead to the next part.
        let end = (low + size) * ONE_MINUS_EPSILON;
        Self {
            u_lobe: (low + self.u_lobe * size).min(end),
            ..self
        }
    }

    /// The same, with other numbers for the direction; those out of range by rounding are moved in.
    #[inline]
    pub(super) fn with_direction(self, u: Vec2) -> Self {
        Self {
            u: warp::into_unit_square(u),
            ..self
        }
    }
}

impl Spare {
    /// Chooses a lobe in proportion to the densities with which each makes the direction, choice of
    /// the lobe included; what is left of the random number serves for the next choice.
    ///
    /// `None` where no lobe makes it.
    #[inline]
    pub(super) fn choose<const N: usize>(self, densities: [f32; N]) -> Option<(usize, Self)> {
        let sum: f32 = densities.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return None;
        }
        let mut rest = self.lobe * sum;
        let mut chosen = None;
        for (number, density) in densities.into_iter().enumerate() {
            if density > 0.0 {
                chosen = Some((number, (rest / density).clamp(0.0, ONE_MINUS_EPSILON)));
                if rest < density {
                    break;
                }
            }
            rest -= density;
        }
        chosen.map(|(number, lobe)| (number, Self { lobe, ..self }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_follow_densities_and_stay_in_their_parts() {
        let spare = |lobe| Spare {
            lobe,
            numbers: SampleNumbers {
                u_lobe: ONE_MINUS_EPSILON,
                u: Vec2::ZERO,
            },
        };
        let chosen = |lobe: f32, densities: [f32; 3]| {
            let chosen = spare(lobe).choose(densities);
            chosen.map(|(number, rest)| (number, rest.lobe))
        };
        assert_eq!(chosen(0.25, [1.0, 0.0, 3.0]), Some((2, 0.0)));
        assert_eq!(chosen(0.125, [1.0, 0.0, 3.0]), Some((0, 0.5)));
        assert_eq!(chosen(0.625, [1.0, 0.0, 3.0]), Some((2, 0.5)));
        assert_eq!(
            chosen(ONE_MINUS_EPSILON, [1.0, 0.0, 0.0]).map(|c| c.0),
            Some(0)
        );
        assert_eq!(chosen(0.5, [0.0; 3]), None);
        for (low, size) in [(0.0, 0.3), (0.3, 0.4), (0.7, 0.3)] {
            assert!(spare(0.0).numbers.within(low, size).u_lobe < low + size);
        }
    }
}
