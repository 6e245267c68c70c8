//! Populations: chains that take turns, a round of mutations at a time, with as many alive at once as
//! there is room for.
//!
//! The law of [`energy`](super) holds for a population, too: each member lives the same number of
//! rounds, whatever its energy, and what elimination takes from some it gives to the others.

mod elimination;
mod rule;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;

pub use elimination::survival_probabilities;
pub use rule::{Account, Births, PopulationRule, Scheme, Transfer};

/// Members, and those who wait for room.
///
/// `M` is what a member is to its owner: a state with whatever belongs to it.
#[derive(Clone, Debug)]
pub struct Population<M> {
    rule: PopulationRule,
    size: usize,
    members: Vec<Member<M>>,
    queue: VecDeque<(Births, M)>,
}

/// One member of a population.
#[derive(Clone, Debug)]
pub struct Member<M> {
    /// Its energy and its time.
    pub account: Account,
    /// What it is.
    pub state: M,
}

impl<M: Clone> Population<M> {
    /// An empty population.
    ///
    /// - `size`: most members alive at once, not counting children of a round; positive.
    pub fn new(rule: PopulationRule, size: usize) -> Self {
        Self {
            rule,
            size,
            members: Vec::with_capacity(size),
            queue: VecDeque::new(),
        }
    }

    /// Puts a seed with all its members into the queue.
    ///
    /// Nothing that was found is ever dropped: what does not fit waits.
    pub fn enqueue(&mut self, (births, state): (Births, M)) {
        if births.count > 0 {
            self.queue.push_back((births, state));
        }
    }

    /// True when somebody waits.
    pub fn has_queue(&self) -> bool {
        !self.queue.is_empty()
    }

    /// Lets members in from the queue, as far as there is room; `begin` is told of each.
    pub fn admit(&mut self, mut begin: impl FnMut(&mut Member<M>)) {
        while self.members.len() < self.size {
            let Some((births, state)) = self.queue.front_mut() else {
                return;
            };
            let mut member = Member {
                account: births.account,
                state: state.clone(),
            };
            begin(&mut member);
            self.members.push(member);
            births.count -= 1;
            if births.count == 0 {
                self.queue.pop_front();
            }
        }
    }

    /// A planted error.
    #[cfg(test)]
    fn forget_queue(&mut self) {
        self.queue.clear();
    }

    /// Room for members that nobody waits for.
    pub fn vacancies(&self) -> usize {
        let waiting = self
            .queue
            .iter()
            .map(|(births, _)| births.count as usize)
            .sum::<usize>();
        self.size.saturating_sub(self.members.len() + waiting)
    }

    /// True when nobody lives and nobody waits.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty() && self.queue.is_empty()
    }

    /// Those alive, in the order of their birth.
    pub fn members_mut(&mut self) -> &mut [Member<M>] {
        &mut self.members
    }

    /// Lets those go whose time is over, and children in, who live on even where there is no room.
    pub fn turn_over(&mut self, children: impl IntoIterator<Item = Member<M>>) {
        self.members.retain(|member| member.account.is_alive());
        self.members.extend(children);
    }

    /// Elimination: leaves a part of the room to members that were strong enough, by chance; what they
    /// take over from the others makes up for those.
    ///
    /// Does nothing while fewer are alive.
    ///
    /// - `rate`: part of the room that is made free, in `[0, 1)`.
    /// - `u`: uniform in `[0, 1)`.
    ///
    /// Differs: strength is weight times rounds left, and a survivor takes over weight, not time: a path
    /// whose life depends on its energy makes a biased picture. See `docs/pmc-er.md`.
    ///
    /// Source: Lai et al. 2007, Sec. 4.3.
    pub fn eliminate(&mut self, rate: f64, u: f64) {
        let rule = self.rule;
        let survivors = (1.0 - rate) * self.size as f64;
        let strengths: Vec<f64> = self
            .members
            .iter()
            .map(|member| rule.strength(&member.account))
            .collect();
        let probabilities = survival_probabilities(&strengths, survivors);
        let mut survives = elimination::systematic(u);
        let mut probabilities = probabilities.into_iter();
        self.members.retain_mut(|member| {
            // As many probabilities as members.
            let probability = probabilities.next().unwrap_or(1.0);
            let survives = survives(probability);
            if survives {
                rule.strengthen(&mut member.account, 1.0 / probability);
            }
            survives
        });
    }
}
