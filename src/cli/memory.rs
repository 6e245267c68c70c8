//! Memory, as the system tells: what this process takes, and what it can still take.
//!
//! Read from Linux's own tables. What the system does not tell limits nothing.

use std::fs;
use std::path::{Path, PathBuf};

use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit};

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
    let now = kibibytes(&status, "VmRSS:")?;
    // The system brings the peak up to date a little later.
    let peak = kibibytes(&status, "VmHWM:")?.max(now);
    Some(Resident { now, peak })
}

/// Bytes that this process can still take: the least of what the machine has, what its control groups
/// leave, and what its own limit of address space (`ulimit -v`) leaves. `None` where nothing is told.
pub(super) fn available() -> Option<u64> {
    let machine = fs::read_to_string("/proc/meminfo").ok();
    let machine = machine.and_then(|table| kibibytes(&table, "MemAvailable:"));
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let groups = control_groups(&groups);
    let groups = groups.iter().filter_map(|group| group.room());
    groups.chain(machine).chain(address_space()).min()
}

/// What the limit of address space leaves.
fn address_space() -> Option<u64> {
    let (limit, _) = getrlimit(Resource::RLIMIT_AS).ok()?;
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let taken = kibibytes(&status, "VmSize:")?;
    (limit != RLIM_INFINITY).then(|| limit.saturating_sub(taken))
}

/// A control group, and what its files are called.
#[derive(Debug, PartialEq, Eq)]
struct ControlGroup {
    folder: PathBuf,
    names: Names,
}

/// Names of the files with the limit and with what is taken, and of the part of the latter that the
/// system gives up when it is needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Names {
    limit: &'static str,
    taken: &'static str,
    spare: &'static str,
}

/// Of the second version.
const UNIFIED: Names = Names {
    limit: "memory.max",
    taken: "memory.current",
    spare: "inactive_file ",
};

/// Of the first version.
const LEGACY: Names = Names {
    limit: "memory.limit_in_bytes",
    taken: "memory.usage_in_bytes",
    spare: "total_inactive_file ",
};

/// The groups that limit memory, by the table of those that this process is in: a limit holds for all
/// groups below.
fn control_groups(table: &str) -> Vec<ControlGroup> {
    let mut groups = Vec::new();
    for line in table.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(kinds), Some(path)) = (parts.next(), parts.next()) else {
            continue;
        };
        let (root, names) = match kinds {
            "" => ("/sys/fs/cgroup", UNIFIED),
            _ if kinds.split(',').any(|kind| kind == "memory") => ("/sys/fs/cgroup/memory", LEGACY),
            _ => continue,
        };
        let below = Path::new(path.trim_start_matches('/'));
        groups.extend(below.ancestors().map(|below| ControlGroup {
            folder: Path::new(root).join(below),
            names,
        }));
    }
    groups
}

impl ControlGroup {
    /// Bytes that it leaves; `None` where it limits nothing.
    fn room(&self) -> Option<u64> {
        let number = |name| {
            let text = fs::read_to_string(self.folder.join(name)).ok()?;
            text.trim().parse::<u64>().ok()
        };
        let (limit, taken) = (number(self.names.limit)?, number(self.names.taken)?);
        let table = fs::read_to_string(self.folder.join("memory.stat")).unwrap_or_default();
        let spare = table
            .lines()
            .find_map(|line| line.strip_prefix(self.names.spare)?.parse().ok());
        Some(limit.saturating_sub(taken.saturating_sub(spare.unwrap_or(0))))
    }
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
        let block_size = 64 << 20;
        let block = vec![1_u8; block_size as usize];
        let during = resident().expect("Linux tells");
        assert!(during.now > block_size, "{during:?}");
        drop(block);
        let after = resident().expect("Linux tells");
        assert!(
            after.peak > block_size && after.peak >= after.now,
            "{after:?}"
        );
        assert!(available().expect("Linux tells") > 0);
    }

    #[test]
    fn limits_of_groups_above_count() {
        let folders = |table| -> Vec<_> {
            let groups = control_groups(table).into_iter();
            groups
                .map(|group| (group.folder.display().to_string(), group.names))
                .collect()
        };
        let unified = |folder: &str| (folder.to_owned(), UNIFIED);
        assert_eq!(
            folders("0::/user/job\n"),
            [
                unified("/sys/fs/cgroup/user/job"),
                unified("/sys/fs/cgroup/user"),
                unified("/sys/fs/cgroup/"),
            ]
        );
        let legacy = |folder: &str| (folder.to_owned(), LEGACY);
        assert_eq!(
            folders("7:cpu:/a\n4:hugetlb,memory:/a\n"),
            [
                legacy("/sys/fs/cgroup/memory/a"),
                legacy("/sys/fs/cgroup/memory/"),
            ]
        );
    }

    #[test]
    fn a_group_leaves_its_limit_less_what_is_taken_for_good() {
        let folder = tempfile::tempdir().unwrap();
        let group = ControlGroup {
            folder: folder.path().to_owned(),
            names: UNIFIED,
        };
        let write = |name, text| fs::write(folder.path().join(name), text).unwrap();
        assert_eq!(group.room(), None);
        write("memory.max", "1000\n");
        write("memory.current", "700\n");
        assert_eq!(group.room(), Some(300));
        write("memory.stat", "anon 400\ninactive_file 250\n");
        assert_eq!(group.room(), Some(550));
        write("memory.max", "max\n");
        assert_eq!(group.room(), None);
    }
}
