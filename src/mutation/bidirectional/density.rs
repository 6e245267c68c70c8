//! How likely a path's new vertices are made, by all ways together.

use super::SectionFault;
use super::choice::{Kept, Split};
use crate::path::{Path, PathSpace};

/// A path with the vertices that a mutation makes in it.
#[derive(Clone, Copy)]
pub(super) struct Section<'p> {
    pub(super) path: &'p Path,
    pub(super) kept: Kept,
    /// Pixels that paths are seen at.
    pub(super) pixels: f64,
    pub(super) fault: SectionFault,
}

impl Section<'_> {
    /// Index of the first vertex that stays at the light's end; the number of vertices where none does.
    fn first_kept(&self) -> usize {
        self.path.vertices().len() - self.kept.light
    }

    /// Number of new vertices.
    fn added(&self) -> usize {
        self.first_kept() - self.kept.sensor
    }

    /// Density of making the new vertices over the measurement contribution without the vertices'
    /// values, mean of all ways: each has the same chance.
    ///
    /// In this form deltas have cancelled, and so has what is the same for every way and for every
    /// path with the same vertices kept.
    pub(super) fn density(&self, space: &PathSpace<'_>) -> f64 {
        let mut sum = 0.0;
        let mut count = 0.0;
        for split in self.kept.splits(self.added()) {
            count += 1.0;
            let is_forgotten = self.fault.is(SectionFault::OneWay) && split.light > 1;
            if !is_forgotten {
                sum += self.density_of(space, split).unwrap_or(0.0);
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Density of making the new vertices in one way; `None` where that does not lead to them.
    fn density_of(&self, space: &PathSpace<'_>, split: Split) -> Option<f64> {
        let (vertices, last) = (self.path.vertices(), self.path.edges());
        let first_kept = self.first_kept();
        // The last vertex of the sensor's side.
        let end = self.kept.sensor + split.sensor - 1;
        let mut density = 1.0;
        for index in self.kept.sensor - 1..end {
            density *= if index == 0 {
                1.0 / self.pixels
            } else {
                let density = space.forward_density(self.path, index)?;
                self.fault.keep(SectionFault::Forward, density)
            };
        }
        if end == last {
            return space.can_be_met(self.path).then_some(density);
        }
        let is_open = |index: usize| vertices[index].event.is_connectable();
        if !is_open(end) || !is_open(end + 1) {
            return None;
        }
        let keep = |fault, factor| self.fault.keep(fault, factor);
        density /= if end == 0 {
            keep(SectionFault::Lens, space.pixels_per_area(self.path)?)
        } else {
            let per_area = space.solid_angle_per_area(&vertices[end], &vertices[end + 1]);
            keep(SectionFault::Connection, per_area)
        };
        if self.kept.light == 0 && split.light == 1 {
            return Some(
                density * keep(SectionFault::Explicit, space.explicit_density(self.path)?),
            );
        }
        if split.light == 0 {
            return Some(density);
        }
        // Light goes back from the first vertex that stays, or from a sampled ray of a light.
        let from = first_kept.min(last);
        density *= keep(
            SectionFault::Cosine,
            space.light_cosine(self.path, end + 1)?,
        );
        if from == last {
            density *= keep(SectionFault::Emission, space.emission_density(self.path)?);
        } else {
            density /= space.light_cosine(self.path, from)?;
        }
        for index in end + 2..=from {
            if index < last {
                density *= space.backward_density(self.path, index)?;
                let factor = space.backward_factor(self.path, index)?;
                density /= keep(SectionFault::Factor, factor);
            }
        }
        Some(density)
    }
}
