//! Ctrl-C and SIGTERM.
//!
//! While something is rendered, the first signal asks for a clean end: the pass under way is dropped
//! and the rest is written. Before that there is nothing to save, and a second signal means that the
//! user does not want to wait: both end the process at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering::SeqCst};
use std::thread;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use signal_hook::low_level;

use super::console::say;
use super::failure::Failure;

/// What the signals so far ask for.
#[derive(Debug, Default)]
pub(super) struct Interruption {
    /// Whether there is something to save, and from when on.
    saves: AtomicBool,
    cancelled: AtomicBool,
    /// The first signal; zero for none.
    signal: AtomicI32,
}

impl Interruption {
    /// Starts listening.
    ///
    /// # Errors
    /// When the system refuses.
    pub(super) fn listen() -> Result<Arc<Self>, Failure> {
        let refused = |error: std::io::Error| Failure::File(format!("no signals: {error}"));
        let mut signals = Signals::new([SIGINT, SIGTERM]).map_err(refused)?;
        let interruption = Arc::new(Self::default());
        let own = Arc::clone(&interruption);
        let listen = move || {
            for signal in signals.forever() {
                if let Some(farewell) = own.receive(signal) {
                    say(farewell);
                    low_level::exit(128 + signal);
                }
            }
        };
        thread::Builder::new()
            .name("signals".to_owned())
            .spawn(listen)
            .map_err(refused)?;
        Ok(interruption)
    }

    /// Takes note of a signal; the last words if the process is to end at once.
    fn receive(&self, signal: i32) -> Option<&'static str> {
        let first = self
            .signal
            .compare_exchange(0, signal, SeqCst, SeqCst)
            .is_ok();
        self.cancelled.store(true, SeqCst);
        match (first, self.saves.load(SeqCst)) {
            (true, true) => None,
            (true, false) => Some("stopped before anything was rendered; no file is written"),
            (false, _) => Some("stopped at once; what was not written is lost"),
        }
    }

    /// From now on a signal lets what is rendered be written first.
    pub(super) fn save_from_now_on(&self) {
        self.saves.store(true, SeqCst);
    }

    /// True once a signal has come.
    pub(super) fn cancelled(&self) -> &AtomicBool {
        &self.cancelled
    }

    /// Exit code that the first signal asks for.
    pub(super) fn exit_code(&self) -> Option<u8> {
        match self.signal.load(SeqCst) {
            0 => None,
            signal => Some(u8::try_from(128 + signal).unwrap_or(u8::MAX)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_signal_saves_and_the_second_ends() {
        let interruption = Interruption::default();
        interruption.save_from_now_on();
        assert_eq!(interruption.exit_code(), None);
        assert_eq!(interruption.receive(SIGTERM), None);
        assert!(interruption.cancelled().load(SeqCst));
        assert!(interruption.receive(SIGINT).is_some());
        assert_eq!(interruption.exit_code(), Some(143));
    }

    #[test]
    fn before_rendering_there_is_nothing_to_save() {
        let interruption = Interruption::default();
        assert!(interruption.receive(SIGINT).unwrap().contains("no file"));
        assert_eq!(interruption.exit_code(), Some(130));
    }
}
