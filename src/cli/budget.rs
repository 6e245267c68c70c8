//! When to stop: after a number of passes, or before the time is over.

use std::time::Duration;

/// How long to render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// This many passes.
    Passes(u32),
    /// This long, in whole passes, at least one.
    Time(Duration),
    /// So much processor time, all threads together, in whole passes, at least one.
    CpuTime(Duration),
}

/// Times of the passes of a render, to tell how long the next one will take.
#[derive(Debug)]
pub(super) struct Budget {
    goal: Goal,
    /// When the last pass ended, from the start of the render.
    last: Duration,
    passes: u32,
    total: Duration,
    recent: [Duration; RECENT],
}

/// Number of passes among which the slowest counts.
const RECENT: usize = 4;

impl Budget {
    /// Starts the account.
    ///
    /// Times are those of the goal's own clock.
    ///
    /// - `prepared`: time since the start of the render when the first pass can begin.
    pub(super) fn new(goal: Goal, prepared: Duration) -> Self {
        Self {
            goal,
            last: prepared,
            passes: 0,
            total: Duration::ZERO,
            recent: [Duration::ZERO; RECENT],
        }
    }

    /// Takes note of the passes done until `elapsed`, and tells whether to start another.
    ///
    /// - `passes`: done so far.
    /// - `elapsed`: time since the start of the render.
    pub(super) fn allows_another(&mut self, passes: u32, elapsed: Duration) -> bool {
        if passes > self.passes {
            let time = elapsed.saturating_sub(self.last);
            self.recent[passes as usize % RECENT] = time;
            self.total = self.total.saturating_add(time);
            self.passes = passes;
        }
        self.last = elapsed;
        match self.goal {
            Goal::Passes(wanted) => passes < wanted,
            Goal::Time(_) | Goal::CpuTime(_) if passes == 0 => true,
            Goal::Time(limit) | Goal::CpuTime(limit) => {
                elapsed.saturating_add(self.expected()) <= limit
            }
        }
    }

    /// Expected time of the next pass: the mean, or the slowest of the last few.
    fn expected(&self) -> Duration {
        let mean = self.total / self.passes.max(1);
        self.recent.into_iter().fold(mean, Duration::max)
    }

    /// By how much a render that took `elapsed` overran its time.
    pub(super) fn overrun(&self, elapsed: Duration) -> Option<Duration> {
        match self.goal {
            Goal::Passes(_) => None,
            Goal::Time(limit) | Goal::CpuTime(limit) => {
                elapsed.checked_sub(limit).filter(|over| !over.is_zero())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(seconds: f64) -> Duration {
        Duration::from_secs_f64(seconds)
    }

    /// Passes that fit, with the time they end at, when each takes the time that `pass` says.
    fn passes(limit: f64, prepared: f64, pass: impl Fn(u32) -> f64) -> (u32, f64) {
        let mut budget = Budget::new(Goal::Time(seconds(limit)), seconds(prepared));
        let (mut done, mut now) = (0, prepared);
        while budget.allows_another(done, seconds(now)) {
            now += pass(done);
            done += 1;
        }
        (done, now)
    }

    #[test]
    fn counts_are_kept() {
        let mut budget = Budget::new(Goal::Passes(2), Duration::ZERO);
        assert!(budget.allows_another(0, seconds(1.0)));
        assert!(budget.allows_another(1, seconds(9.0)));
        assert!(!budget.allows_another(2, seconds(9.1)));
        assert_eq!(budget.overrun(seconds(1e6)), None);
    }

    #[test]
    fn no_pass_starts_that_would_overrun() {
        assert_eq!(passes(10.0, 0.0, |_| 3.0), (3, 9.0));
        assert_eq!(passes(10.0, 2.0, |_| 3.0), (2, 8.0));
        assert_eq!(passes(10.0, 0.0, |_| 2.5), (4, 10.0));
    }

    #[test]
    fn one_pass_is_always_made_and_its_overrun_is_known() {
        assert_eq!(passes(1.0, 2.0, |_| 30.0), (1, 32.0));
        let budget = Budget::new(Goal::Time(seconds(1.0)), seconds(2.0));
        assert_eq!(budget.overrun(seconds(32.0)), Some(seconds(31.0)));
        assert_eq!(budget.overrun(seconds(1.0)), None);
    }

    #[test]
    fn passes_that_grow_slower_are_foreseen() {
        // A mean of about one second would start a pass at 96 that ends at 101.
        let (done, end) = passes(100.0, 0.0, |pass| if pass < 80 { 1.0 } else { 5.0 });
        assert_eq!((done, end), (84, 100.0));
        let (_, end) = passes(98.0, 0.0, |pass| if pass < 80 { 1.0 } else { 5.0 });
        assert_eq!(end, 95.0);
    }
}
