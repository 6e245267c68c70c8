//! Valgrind's counts of a process.

use std::io::ErrorKind;
use std::path::Path;
use std::process::Command;

/// Instructions for each item.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Count {
    /// All but Embree's.
    pub(crate) ours: f64,
    /// Those of Embree's library.
    pub(crate) embree: f64,
}

/// Counts a case in a process of its own.
///
/// - `option`: by which that process is told the case.
pub(crate) fn count(case: &str, option: &str) -> Result<Count, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let file = folder.path().join("profile");
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--quiet"])
        // Names in full each time, costs without the instructions' addresses.
        .args(["--compress-strings=no", "--compress-pos=no"])
        .args(["--collect-atstart=no", "--toggle-collect=*work_to_count*"])
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(program)
        .args([option, case])
        .output();
    let output = match output {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return Err("valgrind is not here; on Debian: apt-get install valgrind".to_owned());
        }
        Err(error) => return Err(format!("valgrind: {error}")),
        Ok(output) => output,
    };
    let (said, complaint) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    let items = said.trim().parse::<f64>();
    let items = match items {
        Ok(items) if output.status.success() && items > 0.0 => items,
        _ => return Err(format!("{case} failed under valgrind: {said}{complaint}")),
    };
    let (ours, embree) = sums(&file)?;
    if ours == 0 {
        return Err(format!("{case}: valgrind has counted nothing"));
    }
    Ok(Count {
        ours: ours as f64 / items,
        embree: embree as f64 / items,
    })
}

/// Instructions outside and inside of Embree's library.
fn sums(file: &Path) -> Result<(u64, u64), String> {
    let text = std::fs::read_to_string(file)
        .map_err(|error| format!("valgrind left no profile: {error}"))?;
    let (mut ours, mut embree) = (0, 0);
    let (mut in_embree, mut is_of_call) = (false, false);
    for line in text.lines() {
        if let Some(object) = line.strip_prefix("ob=") {
            in_embree = object.contains("libembree");
        } else if line.starts_with("calls=") {
            // The next line has what the callee took, which is counted where it was taken.
            is_of_call = true;
        } else if line.starts_with(|c: char| c.is_ascii_digit() || "+-*".contains(c)) {
            let cost = line.split(' ').nth(1).and_then(|cost| cost.parse().ok());
            let cost: u64 = cost.ok_or_else(|| format!("a line of the profile: {line}"))?;
            match (is_of_call, in_embree) {
                (true, _) => {}
                (false, true) => embree += cost,
                (false, false) => ours += cost,
            }
            is_of_call = false;
        }
    }
    Ok((ours, embree))
}
