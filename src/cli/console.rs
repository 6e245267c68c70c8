//! Talking to the user.

use std::io::{self, Write};

use super::failure::Failure;

/// Prints a result on stdout.
///
/// # Errors
/// When stdout cannot be written to; a reader that has seen enough and left is no error.
pub(super) fn print_line(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match writeln!(stdout, "{text}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line on stderr.
pub(super) fn say(text: &str) {
    // Nobody is left to tell when stderr is closed.
    let _ = writeln!(io::stderr(), "{text}");
}

/// Prints an error on stderr.
pub(super) fn complain(text: &str) {
    say(&format!("error: {text}"));
}

/// A number of seconds for people: `0.52 s`, `12.3 s`, `4 min 05 s`, `2 h 31 min`.
pub(super) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// A number of bytes for people: `4.5 KiB`, `12.3 MiB`, `1.50 GiB`.
pub(super) fn size(bytes: u64) -> String {
    let mebibytes = bytes as f64 / f64::from(1 << 20);
    if mebibytes < 1.0 {
        format!("{:.1} KiB", mebibytes * 1024.0)
    } else if mebibytes < 1000.0 {
        format!("{mebibytes:.1} MiB")
    } else {
        format!("{:.2} GiB", mebibytes / 1024.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_as_exact_as_people_want_them() {
        assert_eq!(size(12_897_485), "12.3 MiB");
        assert_eq!(size(3 << 29), "1.50 GiB");
        assert_eq!(size(4608), "4.5 KiB");
    }

    #[test]
    fn durations_are_as_exact_as_people_want_them() {
        assert_eq!(duration(0.5234), "0.52 s");
        assert_eq!(duration(12.34), "12.3 s");
        assert_eq!(duration(59.7), "1 min 00 s");
        assert_eq!(duration(245.2), "4 min 05 s");
        assert_eq!(duration(9060.0), "2 h 31 min");
    }
}
