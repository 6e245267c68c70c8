//! Shows how far a render has come.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use indicatif::{ProgressBar, ProgressStyle};

use super::budget::Goal;
use super::console::{duration, say};
use crate::integrator::Progress;

/// Between two pictures of the bar, and between two lines where there is no terminal.
const BAR_INTERVAL: Duration = Duration::from_millis(100);
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Shows how far a render has come: a bar on a terminal, a line every ten seconds elsewhere.
pub(super) struct Monitor<'a> {
    /// Name of the scene.
    pub(super) name: &'a str,
    /// When the render ends.
    pub(super) goal: Goal,
    /// When it began.
    pub(super) start: Instant,
    /// Its processor time, from the same moment on.
    pub(super) cpu: Option<ProcessTime>,
    /// Units of work in a pass, and what it has done; `None` where only the time is known.
    pub(super) work: Option<(u32, &'a Progress)>,
}

/// Ends the watching thread, also when the work panics.
struct Stop<'a> {
    flag: &'a AtomicBool,
    watcher: Thread,
}

impl Drop for Stop<'_> {
    fn drop(&mut self) {
        self.flag.store(true, SeqCst);
        self.watcher.unpark();
    }
}

/// How far some work has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Status {
    /// Share of the work, or of the time, 0 to 1.
    share: f64,
    /// Millions of samples and of rays a second.
    rates: Option<(f64, f64)>,
    /// Seconds left, once there is something to tell them from.
    left: Option<f64>,
}

/// Shows how far some work has come while it runs: a bar on a terminal, a line every ten seconds
/// elsewhere.
///
/// - `name`: what stands before it.
/// - `status`: how far it has come.
pub(super) fn watch<R>(
    name: &str,
    status: impl Fn() -> Status + Sync,
    work: impl FnOnce() -> R,
) -> R {
    let flag = AtomicBool::new(false);
    thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            if std::io::stderr().is_terminal() {
                draw_bar(name, &status, &flag);
            } else {
                print_lines(name, &status, &flag);
            }
        });
        let _stop = Stop {
            flag: &flag,
            watcher: watcher.thread().clone(),
        };
        work()
    })
}

fn draw_bar(name: &str, status: &dyn Fn() -> Status, stopped: &AtomicBool) {
    const STEPS: f64 = 1000.0;
    let bar = ProgressBar::new(STEPS as u64).with_prefix(name.to_owned());
    if let Ok(style) = ProgressStyle::with_template("{prefix} {wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    while !stopped.load(SeqCst) {
        let status = status();
        bar.set_position((status.share * STEPS) as u64);
        bar.set_message(status.to_string());
        thread::park_timeout(BAR_INTERVAL);
    }
    bar.finish_and_clear();
}

fn print_lines(name: &str, status: &dyn Fn() -> Status, stopped: &AtomicBool) {
    let mut next = Instant::now() + LINE_INTERVAL;
    loop {
        thread::park_timeout(next.saturating_duration_since(Instant::now()));
        if stopped.load(SeqCst) {
            return;
        }
        if Instant::now() >= next {
            let status = status();
            say(&format!("{name}: {:.0} %, {status}", 100.0 * status.share));
            next += LINE_INTERVAL;
        }
    }
}

impl Monitor<'_> {
    /// Shows the progress while `work` runs.
    pub(super) fn during<R>(&self, work: impl FnOnce() -> R) -> R {
        watch(self.name, || self.status(self.start.elapsed()), work)
    }

    fn status(&self, elapsed: Duration) -> Status {
        let elapsed = elapsed.as_secs_f64();
        let per_second = |count: u64| count as f64 / elapsed.max(1e-9) / 1e6;
        let (share, left) = match self.goal {
            Goal::Passes(passes) => {
                let done = self.work.map_or(0.0, |(units_per_pass, progress)| {
                    let all = f64::from(passes) * f64::from(units_per_pass);
                    progress.units() as f64 / all
                });
                by_share(elapsed, done)
            }
            Goal::Time(limit) => {
                let limit = limit.as_secs_f64();
                ((elapsed / limit).min(1.0), Some((limit - elapsed).max(0.0)))
            }
            Goal::CpuTime(limit) => {
                let spent = self.cpu.and_then(|cpu| cpu.try_elapsed().ok());
                let spent = spent.map_or(0.0, |time| time.as_secs_f64());
                by_share(elapsed, spent / limit.as_secs_f64())
            }
        };
        Status {
            share,
            rates: self
                .work
                .map(|(_, progress)| (per_second(progress.paths()), per_second(progress.rays()))),
            left,
        }
    }
}

impl Status {
    /// Of work that has no rates to tell.
    ///
    /// - `start`: when it began.
    /// - `share`: of it that is done, 0 to 1.
    pub(super) fn of_share(start: Instant, share: f64) -> Self {
        let (share, left) = by_share(start.elapsed().as_secs_f64(), share);
        Self {
            share,
            rates: None,
            left,
        }
    }
}

/// The share, one at most, and the time left if the rest goes on as before.
fn by_share(elapsed: f64, share: f64) -> (f64, Option<f64>) {
    let share = share.min(1.0);
    let left = (share > 0.0).then(|| elapsed * (1.0 - share) / share);
    (share, left)
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let rates = self.rates;
        let rates =
            rates.map(|(samples, rays)| format!("{samples:.2} Msamples/s, {rays:.2} Mrays/s"));
        let left = self.left.map(|left| format!("{} left", duration(left)));
        let parts: Vec<String> = rates.into_iter().chain(left).collect();
        f.write_str(&parts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monitor(goal: Goal, progress: &Progress) -> Monitor<'_> {
        Monitor {
            name: "box",
            goal,
            start: Instant::now(),
            cpu: ProcessTime::try_now().ok(),
            work: Some((10, progress)),
        }
    }

    #[test]
    fn time_goes_by_the_clock() {
        let progress = Progress::default();
        let goal = Goal::Time(Duration::from_secs(40));
        let status = monitor(goal, &progress).status(Duration::from_secs(10));
        assert_eq!((status.share, status.left), (0.25, Some(30.0)));
        let late = monitor(goal, &progress).status(Duration::from_secs(50));
        assert_eq!((late.share, late.left), (1.0, Some(0.0)));
    }

    #[test]
    fn processor_time_goes_by_its_own_clock() {
        let progress = Progress::default();
        let mut monitor = monitor(Goal::CpuTime(Duration::from_secs(1_000_000)), &progress);
        let status = monitor.status(Duration::from_secs(10));
        assert!(status.share < 0.01, "{status:?}");
        monitor.work = None;
        let text = monitor.status(Duration::from_secs(10)).to_string();
        assert!(!text.contains("samples"), "{text}");
        assert_eq!(by_share(10.0, 0.25), (0.25, Some(30.0)));
    }

    #[test]
    fn nothing_done_tells_nothing_about_the_time_left() {
        let progress = Progress::default();
        let status = monitor(Goal::Passes(2), &progress).status(Duration::from_secs(1));
        assert_eq!((status.share, status.left), (0.0, None));
        assert_eq!(status.to_string(), "0.00 Msamples/s, 0.00 Mrays/s");
    }

    #[test]
    fn the_work_gives_its_result_and_a_panic_ends_the_watch() {
        let progress = Progress::default();
        let monitor = monitor(Goal::Passes(2), &progress);
        assert_eq!(monitor.during(|| 7), 7);
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            monitor.during(|| panic!("planted"));
        }));
        assert!(panicked.is_err());
    }
}
