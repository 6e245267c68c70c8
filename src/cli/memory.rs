//! Memory of this process, as the system tells.

use std::fs;

/// Resident memory of this process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Resident {
    /// Now, in bytes.
    pub(super) now: u64,
    /// The most so far, in bytes.
    pub(super) peak: u64,
}

/// What this process takes; `None` where the system does not tell.
pub(super) fn resident() -> Option<Resident> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    Some(Resident {
        now: kibibytes(&status, "VmRSS:")?,
        peak: kibibytes(&status, "VmHWM:")?,
    })
}

/// A number of KiB in a table of the system, as bytes.
fn kibibytes(table: &str, name: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    let count: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(count * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_taken_once_stays_the_peak() {
        let block = vec![1_u8; 64 << 20];
        let during = resident().expect("Linux tells");
        assert!(during.now > block.len() as u64, "{during:?}");
        drop(block);
        let after = resident().expect("Linux tells");
        assert!(
            after.now < during.now && after.peak >= during.now,
            "{after:?}"
        );
    }
}
