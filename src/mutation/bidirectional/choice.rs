//! What is taken out of a path, and how much is put in.

use crate::path::CAPACITY;
use crate::random::Stream;

/// What stays of a path: vertices at either end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kept {
    /// Vertices from the sensor on, at least one: where only the sensor's stays, its point on the lens
    /// is sampled anew.
    pub(super) sensor: usize,
    /// Vertices at the light's end; none where a new light is found.
    pub(super) light: usize,
}

/// How new vertices are made between those that stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Split {
    /// Going on from the sensor's side.
    pub(super) sensor: usize,
    /// Going back from the light's side.
    pub(super) light: usize,
}

/// Chance of taking out all but the sensor.
const ALL: f64 = 0.25;

/// How much more or less is put in than was taken out, at most.
const FARTHEST: usize = 4;

/// Chance of taking out a number of vertices, before it is made one among those that are possible.
///
/// Source: Veach & Guibas 1997, for the shape: short pieces are most often changed.
fn weight_of_deletion(vertices: usize) -> f64 {
    match vertices {
        0 => 0.25,
        1 => 0.5,
        _ => 0.5_f64.powi(vertices as i32),
    }
}

/// Chance of putting in more or fewer vertices than were taken out, before it is made one.
fn weight_of_addition(difference: usize) -> f64 {
    match difference {
        0 => 0.5,
        _ => 0.6 * 0.25_f64.powi(difference as i32),
    }
}

/// Number of ways to take a number of vertices out of a path.
fn ways(deleted: usize, vertices: usize) -> usize {
    let ends = vertices - deleted;
    // One at least stays at the sensor; and of a path that keeps all vertices, one at the light.
    ends - usize::from(deleted == 0)
}

/// Sum of the weights of all numbers of vertices that can be taken out.
fn total_weight(vertices: usize) -> f64 {
    (0..vertices).map(weight_of_deletion).sum()
}

impl Kept {
    /// Number of vertices that are taken out.
    pub(super) fn deleted(self, vertices: usize) -> usize {
        vertices - self.sensor - self.light
    }

    /// Chooses what stays of a path.
    ///
    /// - `vertices`: of the path, at least two.
    pub(super) fn choose(vertices: usize, random: &mut Stream) -> Self {
        if f64::from(random.next_f32()) < ALL {
            return Self {
                sensor: 1,
                light: 0,
            };
        }
        let mut left = f64::from(random.next_f32()) * total_weight(vertices);
        let mut deleted = 0;
        while deleted + 1 < vertices && left >= weight_of_deletion(deleted) {
            left -= weight_of_deletion(deleted);
            deleted += 1;
        }
        let ways = ways(deleted, vertices);
        let way = ((random.next_f32() * ways as f32) as usize).min(ways - 1);
        Self {
            sensor: 1 + way,
            light: vertices - deleted - 1 - way,
        }
    }

    /// Probability of [`Kept::choose`] at a path; zero for what cannot stay of it.
    pub(super) fn probability(self, vertices: usize) -> f64 {
        if self.sensor + self.light > vertices {
            return 0.0;
        }
        let deleted = self.deleted(vertices);
        if deleted == 0 && self.light == 0 {
            return 0.0;
        }
        let some =
            weight_of_deletion(deleted) / total_weight(vertices) / ways(deleted, vertices) as f64;
        let all = f64::from(u8::from(self.sensor == 1 && self.light == 0));
        (1.0 - ALL) * some + ALL * all
    }

    /// The weights of numbers of vertices that may be put in, from the smallest possible one on.
    ///
    /// - `deleted`: vertices that were taken out.
    /// - `edges`: fewest and most edges that a path may have.
    fn additions(
        self,
        deleted: usize,
        edges: (usize, usize),
    ) -> impl Iterator<Item = (usize, f64)> + Clone {
        let kept = self.sensor + self.light;
        let fewest = (edges.0 + 1).saturating_sub(kept);
        // Something must change, and a light must be found where none has stayed.
        let fewest = fewest.max(usize::from(self.light == 0 || deleted == 0));
        let most = (edges.1.min(CAPACITY - 1) + 1).saturating_sub(kept);
        let low = fewest.max(deleted.saturating_sub(FARTHEST));
        let high = most.min(deleted + FARTHEST);
        (low..=high).map(move |added| (added, weight_of_addition(added.abs_diff(deleted))))
    }

    /// Chooses how many vertices are put in; `None` where no number will do.
    pub(super) fn choose_addition(
        self,
        deleted: usize,
        edges: (usize, usize),
        random: &mut Stream,
    ) -> Option<usize> {
        let additions = self.additions(deleted, edges);
        let total: f64 = additions.clone().map(|(_, weight)| weight).sum();
        let mut left = f64::from(random.next_f32()) * total;
        let mut chosen = None;
        for (added, weight) in additions {
            chosen = Some(added);
            if left < weight {
                break;
            }
            left -= weight;
        }
        chosen
    }

    /// Probability of [`Kept::choose_addition`].
    pub(super) fn addition_probability(
        self,
        (deleted, added): (usize, usize),
        edges: (usize, usize),
    ) -> f64 {
        let additions = self.additions(deleted, edges);
        let (mut own, mut total) = (0.0, 0.0);
        for (number, weight) in additions {
            total += weight;
            if number == added {
                own = weight;
            }
        }
        if own > 0.0 { own / total } else { 0.0 }
    }

    /// Whether new vertices can be made so.
    fn allows(self, split: Split) -> bool {
        let from_lens = self.sensor + split.sensor == 1;
        match self.light {
            // What is sampled on a light is not connected to the lens.
            0 => !(from_lens && split.light == 1),
            // A direction from a light's given point is not sampled.
            1 => split.light == 0 && !from_lens,
            _ => true,
        }
    }

    /// The ways of making a number of new vertices.
    pub(super) fn splits(self, added: usize) -> impl Iterator<Item = Split> + Clone {
        let split = move |sensor| Split {
            sensor,
            light: added - sensor,
        };
        (0..=added).map(split).filter(move |s| self.allows(*s))
    }

    /// Chooses a way of making new vertices, each with the same chance; `None` where there is none.
    pub(super) fn choose_split(self, added: usize, random: &mut Stream) -> Option<Split> {
        let splits = self.splits(added);
        let count = splits.clone().count();
        let index = (random.next_f32() * count as f32) as usize;
        splits.clone().nth(index).or_else(|| splits.last())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    #[test]
    fn probabilities_are_those_of_the_choices() {
        let mut random = Stream::new(5, Purpose::Check, 0, 0);
        for vertices in [2, 3, 4, 7] {
            let mut all = Vec::new();
            for sensor in 1..=vertices {
                for light in 0..=vertices - sensor {
                    all.push(Kept { sensor, light });
                }
            }
            let sum: f64 = all.iter().map(|kept| kept.probability(vertices)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{vertices}: {sum}");
            let count = 20_000;
            let mut found = vec![0_u32; all.len()];
            for _ in 0..count {
                let kept = Kept::choose(vertices, &mut random);
                found[all.iter().position(|k| *k == kept).unwrap()] += 1;
            }
            for (kept, found) in all.iter().zip(found) {
                let expected = kept.probability(vertices) * f64::from(count);
                let off = (f64::from(found) - expected).abs();
                assert!(
                    off <= 5.0 * expected.sqrt(),
                    "{kept:?}: {found}, {expected}"
                );
            }
        }
    }

    #[test]
    fn additions_have_the_probability_they_say() {
        let mut random = Stream::new(6, Purpose::Check, 0, 0);
        let edges = (3, 8);
        for (kept, deleted) in [
            (
                Kept {
                    sensor: 1,
                    light: 0,
                },
                4,
            ),
            (
                Kept {
                    sensor: 2,
                    light: 2,
                },
                0,
            ),
            (
                Kept {
                    sensor: 3,
                    light: 4,
                },
                1,
            ),
        ] {
            let count = 20_000;
            let mut found = [0_u32; 16];
            for _ in 0..count {
                let added = kept.choose_addition(deleted, edges, &mut random);
                found[added.unwrap()] += 1;
            }
            for (added, found) in found.into_iter().enumerate() {
                let p = kept.addition_probability((deleted, added), edges);
                let expected = p * f64::from(count);
                let off = (f64::from(found) - expected).abs();
                assert!(
                    off <= 5.0 * expected.sqrt(),
                    "{kept:?} {added}: {found}, {expected}"
                );
                let total = kept.sensor + kept.light + added;
                assert!(p == 0.0 || (edges.0 + 1..=edges.1 + 1).contains(&total));
            }
        }
    }
}
