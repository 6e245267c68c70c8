//! Filters against the noise of chains: biased, off unless asked for, in a layer of their own.

use super::Places;
use crate::film::Window;
use crate::math::Rgb;
use crate::scene::options::{OptionError, OptionReader};

/// How the number of proposals that a pixel should have had is guessed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Expected {
    /// The mean of the neighbourhood's numbers.
    Box,
    /// Their median.
    Median,
    /// The mean of the neighbourhood's luminance, scaled to the mean number.
    Luminance,
}

/// Which filters are on.
///
/// Source: Cline et al. 2005, Sec. 4.4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NoiseFilter {
    expected: Option<Expected>,
    /// Side of the neighbourhood in pixels, odd.
    size: u32,
    /// Steps in a row on one pixel after which energy is dropped; zero for no limit.
    consecutive: u32,
}

impl NoiseFilter {
    /// No filter.
    pub(super) const OFF: Self = Self {
        expected: None,
        size: 1,
        consecutive: 0,
    };

    /// Reads the options.
    ///
    /// # Errors
    /// A value of the wrong kind or out of range.
    pub(super) fn from_options(options: &mut OptionReader<'_>) -> Result<Self, OptionError> {
        let names = ["off", "box", "median", "luminance"];
        let name = options.choice("proposal_filter", &names, "off")?;
        let expected = match name.as_str() {
            "box" => Some(Expected::Box),
            "median" => Some(Expected::Median),
            "luminance" => Some(Expected::Luminance),
            _ => None,
        };
        let size = options.integer("proposal_filter_size", 1..=101, 7)? as u32;
        if size % 2 == 0 {
            return Err(options.refused("proposal_filter_size", "an odd number"));
        }
        let consecutive = options.integer("consecutive_limit", 0..=1 << 20, 0)? as u32;
        Ok(Self {
            expected,
            size,
            consecutive,
        })
    }

    /// Whether there is a filtered layer.
    pub(super) fn is_on(&self) -> bool {
        self.expected.is_some() || self.consecutive > 0
    }

    /// Whether proposals must be counted.
    pub(super) fn needs_proposals(&self) -> bool {
        self.expected.is_some()
    }

    /// Steps in a row on one pixel after which energy is dropped.
    pub(super) fn consecutive_limit(&self) -> Option<u32> {
        (self.consecutive > 0).then_some(self.consecutive)
    }

    /// Makes the filtered layer: what the chains have left there, times the expected over the actual
    /// number of proposals, and the direct light; and the layer of the expected numbers.
    pub(super) fn resolve(&self, places: &Places, window: Window, means: &mut [Vec<f32>]) {
        let Some(place) = places.filtered else { return };
        let mut filtered = std::mem::take(&mut means[place]);
        if let (Some(expected), Some(proposals)) = (self.expected, places.proposals) {
            let counts = &means[proposals];
            let wanted = self.expected_counts(expected, counts, &filtered, window);
            for (pixel, (wanted, count)) in
                filtered.chunks_exact_mut(3).zip(wanted.iter().zip(counts))
            {
                if *count > 0.0 {
                    let factor = wanted / count;
                    pixel.iter_mut().for_each(|channel| *channel *= factor);
                }
            }
            if let Some(place) = places.expected {
                means[place] = wanted;
            }
        }
        if let Some(direct) = places.direct {
            for (sum, value) in filtered.iter_mut().zip(&means[direct]) {
                *sum += value;
            }
        }
        means[place] = filtered;
    }

    fn expected_counts(
        &self,
        expected: Expected,
        counts: &[f32],
        image: &[f32],
        window: Window,
    ) -> Vec<f32> {
        match expected {
            Expected::Box => self.neighbourhoods(counts, window, mean),
            Expected::Median => self.neighbourhoods(counts, window, median),
            Expected::Luminance => {
                let luminance: Vec<f32> = image
                    .chunks_exact(3)
                    .map(|c| Rgb::new(c[0], c[1], c[2]).luminance())
                    .collect();
                let mut blurred = self.neighbourhoods(&luminance, window, mean);
                let sum = |values: &[f32]| values.iter().copied().map(f64::from).sum::<f64>();
                let scale = sum(counts) / sum(&blurred).max(f64::MIN_POSITIVE);
                blurred
                    .iter_mut()
                    .for_each(|value| *value = (f64::from(*value) * scale) as f32);
                blurred
            }
        }
    }

    /// A statistic of the square around every pixel, as far as it lies in the window.
    fn neighbourhoods(
        &self,
        values: &[f32],
        window: Window,
        statistic: fn(&mut [f32]) -> f32,
    ) -> Vec<f32> {
        let (width, height) = (window.width as usize, window.height as usize);
        let reach = self.size as usize / 2;
        let mut around = Vec::with_capacity((self.size * self.size) as usize);
        let mut result = Vec::with_capacity(values.len());
        for y in 0..height {
            for x in 0..width {
                around.clear();
                for row in y.saturating_sub(reach)..(y + reach + 1).min(height) {
                    let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
                    around.extend_from_slice(&values[row * width..][columns]);
                }
                result.push(statistic(&mut around));
            }
        }
        result
    }
}

fn mean(values: &mut [f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
