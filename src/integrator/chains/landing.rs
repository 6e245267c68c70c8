//! Where the energy of chains lands.

use crate::film::{Canvas, Filter, PassBuffer, Tile};
use crate::integrator::metropolis::Importance;
use crate::math::{Rgb, Vec2};

/// Where one unit of work lets energy land.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct Landing<'a> {
    pub(super) filter: &'a Filter,
    pub(super) redistributed: &'a PassBuffer,
    /// The part of it where most of the energy lands.
    pub(super) tile: Option<&'a Tile<'a>>,
    pub(super) filtered: Option<&'a PassBuffer>,
    pub(super) proposals: Option<&'a PassBuffer>,
    pub(super) acceptance: Option<&'a PassBuffer>,
    /// What energy is divided by where it lands.
    pub(super) importance: Option<&'a Importance>,
    /// After how many steps in a row on one pixel the filtered layer takes no more energy.
    pub(super) consecutive_limit: Option<u32>,
}

impl<'a> Landing<'a> {
    /// The same for energy that is counted times the importance of its place.
    pub(in crate::integrator) fn divided_by(self, importance: &'a Importance) -> Self {
        Self {
            importance: Some(importance),
            ..self
        }
    }

    /// The same by way of a tile of what chains make, see [`ChainFilm::tile`].
    pub(in crate::integrator) fn on_tile(self, tile: &'a Tile<'a>) -> Self {
        Self {
            tile: Some(tile),
            ..self
        }
    }

    /// Lets energy of a colour land.
    ///
    /// - `energy`: as luminance; the second number goes to the filtered layer.
    #[inline]
    pub(in crate::integrator) fn land(&self, raster: Vec2, colour: Rgb, energy: (f64, f64)) {
        let energy = self.importance.map_or(energy, |map| {
            let weight = map.at(raster);
            (energy.0 / weight, energy.1 / weight)
        });
        if energy.0 > 0.0 {
            let value = (colour * energy.0 as f32).to_array();
            match self.tile {
                Some(tile) => tile.add(self.filter, raster, value),
                None => self.redistributed.add(self.filter, raster, value),
            }
        }
        if let Some(filtered) = self.filtered.filter(|_| energy.1 > 0.0) {
            let value = (colour * energy.1 as f32).to_array();
            filtered.add(self.filter, raster, value);
        }
    }

    /// Lets a path's energy land where it is.
    pub(in crate::integrator) fn land_unmoved(&self, raster: Vec2, energy: Rgb) {
        self.land(raster, energy, (1.0, 1.0));
    }

    /// True when proposals are counted.
    #[inline]
    pub(in crate::integrator) fn counts_proposals(&self) -> bool {
        self.proposals.is_some() || self.acceptance.is_some()
    }

    /// Counts a proposal.
    pub(in crate::integrator) fn count_proposal(&self, raster: Vec2, acceptance: f64) {
        let pixel = Filter::pixel_box();
        if let Some(proposals) = self.proposals {
            proposals.add(&pixel, raster, [1.0]);
        }
        if let Some(layer) = self.acceptance {
            layer.add(&pixel, raster, [acceptance as f32]);
        }
    }
}
