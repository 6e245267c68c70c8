//! Other programs in the race: their commands, and running them.

use std::fs::{self, File};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use nix::sys::resource::{Usage, UsageWho, getrusage};
use nix::sys::signal::{Signal, killpg};
use nix::sys::time::{TimeVal, TimeValLike};
use nix::unistd::Pid;

use super::entrants::Effort;
use crate::cli::failure::Failure;
use crate::cli::signals::Interruption;
use crate::scene::import::xml::did_you_mean;

/// What may stand in braces.
const PLACEHOLDERS: [&str; 9] = [
    "scene", "seconds", "spp", "passes", "seed", "out", "threads", "width", "height",
];

/// Between two looks at a peer.
const LOOK: Duration = Duration::from_millis(5);

/// How long a peer may take to end when it is told to.
const GRACE: Duration = Duration::from_secs(5);

/// Most characters of a peer's output that a message quotes.
const QUOTED: usize = 200;

/// A command for the shell, with gaps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Peer {
    /// As it was given.
    pub(super) command: String,
    pieces: Vec<Piece>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    Gap(&'static str),
}

/// What a run took, with all processes that the peer started and waited for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ran {
    pub(super) wall_seconds: f64,
    pub(super) cpu_seconds: f64,
}

/// Why a run came to nothing.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Stopped {
    /// A signal to us.
    Interrupted,
    /// The peer's fault, as people should read it.
    Failed(String),
}

impl Peer {
    /// Understands a command.
    ///
    /// # Errors
    /// [`Failure::Usage`] for gaps that are unknown, in quotes, or missing: without scene, budget
    /// and picture there is nothing to measure.
    pub(super) fn new(name: &str, command: &str, efforts: &[Effort]) -> Result<Self, Failure> {
        let wrong = |message: String| Failure::Usage(format!("--peer {name}: {message}"));
        let pieces = pieces(command).map_err(wrong)?;
        let amounts = efforts.iter().map(|effort| effort.amount.0);
        for needed in ["scene", "out"].into_iter().chain(amounts) {
            if !pieces.contains(&Piece::Gap(needed)) {
                return Err(wrong(format!("{{{needed}}} is missing in \"{command}\"")));
            }
        }
        Ok(Self {
            command: command.to_owned(),
            pieces,
        })
    }

    /// The command with its gaps filled, each as one word of the shell.
    ///
    /// - `values`: one for each of the placeholders that the budget allows; what has none is empty.
    pub(super) fn line(&self, values: &[(&str, String)]) -> String {
        let fill = |piece: &Piece| match piece {
            Piece::Text(text) => text.clone(),
            Piece::Gap(gap) => {
                let found = values.iter().find(|(name, _)| name == gap);
                quoted(found.map_or("", |(_, value)| value))
            }
        };
        self.pieces.iter().map(fill).collect()
    }
}

/// A text as one word of the shell.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// Divides a command at its gaps.
fn pieces(command: &str) -> Result<Vec<Piece>, String> {
    let mut pieces = Vec::new();
    let mut text = String::new();
    let mut quote: Option<char> = None;
    let mut rest = command;
    while let Some(letter) = rest.chars().next() {
        if let Some(gap) = gap_at(rest, text.ends_with('$'))? {
            if let Some(quote) = quote {
                let message = "is put in quotes when it is filled in; write it without";
                return Err(format!("{{{gap}}} {message} {quote}"));
            }
            pieces.push(Piece::Text(std::mem::take(&mut text)));
            pieces.push(Piece::Gap(gap));
            rest = &rest[gap.len() + 2..];
            continue;
        }
        let escaped = letter == '\\' && quote != Some('\'');
        let taken: String = rest.chars().take(1 + usize::from(escaped)).collect();
        if !escaped && (letter == '\'' || letter == '"') {
            quote = match quote {
                None => Some(letter),
                Some(open) if open == letter => None,
                other => other,
            };
        }
        rest = &rest[taken.len()..];
        text.push_str(&taken);
    }
    pieces.push(Piece::Text(text));
    Ok(pieces)
}

/// The placeholder at the start of a text. Other braces are the shell's, but not a word in small
/// letters: that is a placeholder with a slip.
///
/// - `is_variable`: whether a `$` stands before.
fn gap_at(text: &str, is_variable: bool) -> Result<Option<&'static str>, String> {
    let inside = text.strip_prefix('{').and_then(|rest| rest.split_once('}'));
    let Some((word, _)) = inside.filter(|_| !is_variable) else {
        return Ok(None);
    };
    let known = PLACEHOLDERS.into_iter().find(|known| *known == word);
    let is_word = !word.is_empty() && word.chars().all(|c| c.is_ascii_lowercase());
    if known.is_none() && is_word {
        let hint = did_you_mean(word, PLACEHOLDERS);
        let all = PLACEHOLDERS.join(", ");
        return Err(format!(
            "unknown placeholder {{{word}}}{hint}; there are {all}"
        ));
    }
    Ok(known)
}

/// Runs a command to its end.
///
/// The peer and what it starts are a process group of their own, which is ended as a whole when the
/// time is over or a signal comes.
///
/// - `line`: for the shell.
/// - `limit`: after which the peer has failed.
/// - `log`: file that takes what it prints.
///
/// # Errors
/// Why there is no result.
pub(super) fn run(
    line: &str,
    limit: Option<Duration>,
    log: &Path,
    interruption: &Interruption,
) -> Result<Ran, Stopped> {
    let failed = |error: std::io::Error| Stopped::Failed(format!("it could not be run: {error}"));
    let output = File::create(log).map_err(failed)?;
    let errors = output.try_clone().map_err(failed)?;
    let used = children_seconds().map_err(failed)?;
    let start = Instant::now();
    let mut child = Command::new("sh")
        .args(["-c", line])
        .stdin(Stdio::null())
        .stdout(output)
        .stderr(errors)
        .process_group(0)
        .spawn()
        .map_err(failed)?;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        if interruption.exit_code().is_some() {
            end(&mut child);
            return Err(Stopped::Interrupted);
        }
        if let Some(limit) = limit.filter(|limit| start.elapsed() > *limit) {
            end(&mut child);
            let seconds = limit.as_secs_f64();
            return Err(Stopped::Failed(format!("it was ended after {seconds} s")));
        }
        thread::sleep(LOOK);
    };
    let wall_seconds = start.elapsed().as_secs_f64();
    if !status.success() {
        return Err(Stopped::Failed(ending(status, log)));
    }
    Ok(Ran {
        wall_seconds,
        cpu_seconds: children_seconds().map_err(failed)? - used,
    })
}

/// Processor time of all children that have ended, in seconds.
fn children_seconds() -> std::io::Result<f64> {
    let usage: Usage = getrusage(UsageWho::RUSAGE_CHILDREN)?;
    let seconds = |time: TimeVal| time.num_microseconds() as f64 * 1e-6;
    Ok(seconds(usage.user_time()) + seconds(usage.system_time()))
}

/// Ends a peer with all that it started: asks first, and then insists.
fn end(child: &mut Child) {
    let group = i32::try_from(child.id()).map(Pid::from_raw);
    // A group that is gone needs no signal.
    let send = |signal| group.is_ok_and(|group| killpg(group, signal).is_ok());
    send(Signal::SIGTERM);
    let asked = Instant::now();
    while matches!(child.try_wait(), Ok(None)) && asked.elapsed() < GRACE {
        thread::sleep(LOOK);
    }
    send(Signal::SIGKILL);
    let _ = child.wait();
}

/// How a peer ended, with the last line that it printed.
fn ending(status: ExitStatus, log: &Path) -> String {
    let bytes = fs::read(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let last = text.lines().rfind(|line| !line.trim().is_empty());
    let last = last.map_or_else(String::new, |line| {
        let line: String = line.trim().chars().take(QUOTED).collect();
        format!(": \"{line}\"")
    });
    format!(
        "it ended with {status}{last} (all of it in {})",
        log.display()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::budget::Goal;

    fn peer(command: &str) -> Result<Peer, String> {
        let effort = Effort {
            label: "5 s".to_owned(),
            goal: Goal::Time(Duration::from_secs(5)),
            amount: ("seconds", "5".to_owned()),
        };
        match Peer::new("other", command, &[effort]) {
            Ok(peer) => Ok(peer),
            Err(Failure::Usage(message)) => Err(message),
            Err(other) => panic!("{other:?}"),
        }
    }

    /// Runs a line for so many seconds at most.
    fn run_for(seconds: u64, line: &str) -> (Result<Ran, Stopped>, Duration) {
        let folder = tempfile::tempdir().unwrap();
        let start = Instant::now();
        let limit = Some(Duration::from_secs(seconds));
        let log = folder.path().join("log");
        let ran = run(line, limit, &log, &Interruption::default());
        (ran, start.elapsed())
    }

    #[test]
    fn gaps_are_filled_with_single_words() {
        let peer = peer("x --in={scene} \"${HOME}\" {seconds} -o {out} {seed}; { true; }").unwrap();
        let values = [
            ("scene", "it's $HOME.xml".to_owned()),
            ("seconds", "5".to_owned()),
            ("out", "a b.exr".to_owned()),
            ("seed", "1".to_owned()),
        ];
        assert_eq!(
            peer.line(&values),
            "x --in='it'\\''s $HOME.xml' \"${HOME}\" '5' -o 'a b.exr' '1'; { true; }"
        );
        let echo = format!("printf %s {}", quoted("it's \"$HOME\" \\ {a}"));
        let shown = Command::new("sh").args(["-c", &echo]).output().unwrap();
        assert_eq!(shown.stdout, b"it's \"$HOME\" \\ {a}");
    }

    #[test]
    fn commands_that_cannot_work_are_refused() {
        assert_eq!(
            peer("x {scene} {seconds}").unwrap_err(),
            "--peer other: {out} is missing in \"x {scene} {seconds}\""
        );
        assert!(
            peer("x {scene} {out} {spp}")
                .unwrap_err()
                .contains("{seconds} is missing")
        );
        let slip = peer("x {scene} {out} {second}").unwrap_err();
        assert!(
            slip.contains("unknown placeholder {second} (did you mean \"seconds\"?)"),
            "{slip}"
        );
        for quotes in [
            "x '{scene}' {out} {seconds}",
            "x \"a {scene}\" {out} {seconds}",
        ] {
            assert!(
                peer(quotes).unwrap_err().contains("write it without"),
                "{quotes}"
            );
        }
        assert!(peer("x \\\" {scene} \\' {out} {seconds}").is_ok());
    }

    #[test]
    fn time_is_that_of_all_processes_of_the_peer() {
        let busy = "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done";
        let (ran, _) = run_for(60, &format!("sleep 0.2; sh -c '{busy}'"));
        let ran = ran.unwrap();
        assert!(ran.wall_seconds > 0.2, "{ran:?}");
        assert!(
            ran.cpu_seconds > 0.005 && ran.cpu_seconds < ran.wall_seconds,
            "{ran:?}"
        );
    }

    #[test]
    fn what_lasts_too_long_is_ended_with_its_children() {
        let (ran, took) = run_for(1, "sleep 60 & sleep 60");
        assert_eq!(
            ran.unwrap_err(),
            Stopped::Failed("it was ended after 1 s".to_owned())
        );
        assert!(took < Duration::from_secs(30));
    }

    #[test]
    fn failures_quote_the_last_words() {
        let (ran, _) = run_for(60, "echo first; echo no such scene >&2; exit 3");
        let Err(Stopped::Failed(message)) = ran else {
            panic!("{ran:?}");
        };
        let part = "it ended with exit status: 3: \"no such scene\" (all of it in ";
        assert!(message.contains(part), "{message}");
    }
}
