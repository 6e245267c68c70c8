//! Counts of a check.

use super::address::Kind;
use super::compare::{Class, Query, Right};

/// Counts of rays of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KindTally {
    /// Rays traced.
    pub rays: u64,
    /// Of those, Embree hits something with.
    pub hits: u64,
    /// Closest hits that differ: ties, silhouettes, limits, real.
    pub closest: [u64; 4],
    /// Any-hit answers that differ, likewise.
    pub any: [u64; 4],
    /// Of all that differs, the referee sides with Embree, with obvhs, with both, with neither.
    pub right: [u64; 4],
}

/// Counts of a check by kind of ray.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// In the order of [`Kind::ALL`].
    pub kinds: [KindTally; Kind::ALL.len()],
}

impl KindTally {
    pub(super) fn count(&mut self, query: Query, class: Class, right: Right) {
        let counts = match query {
            Query::Closest => &mut self.closest,
            Query::Any => &mut self.any,
        };
        counts[class as usize] += 1;
        self.right[right as usize] += 1;
    }

    fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        for i in 0..4 {
            self.closest[i] += other.closest[i];
            self.any[i] += other.any[i];
            self.right[i] += other.right[i];
        }
    }
}

impl Tally {
    pub(super) fn add(&mut self, other: &Self) {
        for (own, other) in self.kinds.iter_mut().zip(&other.kinds) {
            own.add(other);
        }
    }

    /// The counts of all kinds together.
    pub fn total(&self) -> KindTally {
        let mut total = KindTally::default();
        self.kinds.iter().for_each(|kind| total.add(kind));
        total
    }

    /// Real disagreements.
    pub fn real(&self) -> u64 {
        let total = self.total();
        total.closest[Class::Real as usize] + total.any[Class::Real as usize]
    }

    /// The table for people: a line for each kind, and one for all.
    pub fn table(&self) -> String {
        let mut lines = vec![
            format!(
                "{:<12}{:>10}{:>10} |{:>35} |{:>26} |{:>32}",
                "", "", "", "closest hit", "any hit", "the referee sides with"
            ),
            format!(
                "{:<12}{:>10}{:>10} |{:>9}{:>12}{:>7}{:>7} |{:>12}{:>7}{:>7} |{:>8}{:>8}{:>7}{:>9}",
                "kind",
                "rays",
                "hits",
                "tie",
                "silhouette",
                "limit",
                "real",
                "silhouette",
                "limit",
                "real",
                "embree",
                "obvhs",
                "both",
                "neither"
            ),
        ];
        let rows = Kind::ALL.iter().zip(&self.kinds);
        lines.extend(rows.map(|(kind, counts)| line(kind.name(), counts)));
        lines.push(line("all", &self.total()));
        lines.join("\n")
    }
}

fn line(name: &str, counts: &KindTally) -> String {
    let [tie, silhouette, limit, real] = counts.closest;
    let [_, any_silhouette, any_limit, any_real] = counts.any;
    let [embree, obvhs, both, neither] = counts.right;
    format!(
        "{name:<12}{:>10}{:>10} |{tie:>9}{silhouette:>12}{limit:>7}{real:>7} |\
         {any_silhouette:>12}{any_limit:>7}{any_real:>7} |{embree:>8}{obvhs:>8}{both:>7}{neither:>9}",
        counts.rays, counts.hits
    )
}
