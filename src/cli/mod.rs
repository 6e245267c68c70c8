//! The command line: the only layer that knows the clock, signals, threads and arguments.
//!
//! Images go to files, results to stdout, and everything else to stderr.

mod args;
mod bench;
mod budget;
mod compare;
mod console;
mod convert;
mod crosscheck;
mod execute;
mod failure;
mod help;
mod info;
mod memory;
mod monitor;
mod notes;
mod outputs;
mod pictures;
mod plan;
mod render;
mod scenes;
mod signals;
mod summary;
mod version;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use console::{complain, print_line};
use failure::Failure;

/// Exit code for our own bugs.
const BUG: u8 = 70;

/// Runs the command of this process.
///
/// The exit code is 0 when all is done, 2 for wrong use, 3 for a broken scene, 4 for files that
/// cannot be read or written and peers that fail, 5 for too little memory, 70 for a bug of ours, 130 after Ctrl-C and 143
/// after SIGTERM.
pub fn run() -> ExitCode {
    let arguments: Vec<String> = std::env::args_os()
        .map(|argument| argument.to_string_lossy().into_owned())
        .collect();
    ExitCode::from(guarded(&arguments, || match Cli::try_parse() {
        Ok(cli) => dispatch(&cli),
        Err(error) => {
            // Help, too, comes this way; a closed pipe is no reason to complain.
            let _ = error.print();
            u8::try_from(error.exit_code()).unwrap_or(2)
        }
    }))
}

/// Runs `command`; a panic in it is reported as what it is.
fn guarded(arguments: &[String], command: impl FnOnce() -> u8) -> u8 {
    catch_unwind(AssertUnwindSafe(command)).unwrap_or_else(|_| {
        complain(&format!(
            "this is a bug of lumiflow {}, not of yours; please report it with the lines above and \
             the scene\ncommand: {}",
            version::own(),
            arguments.join(" ")
        ));
        BUG
    })
}

/// Runs a parsed command to its exit code.
fn dispatch(cli: &Cli) -> u8 {
    let Some(command) = &cli.command else {
        // Without a command only --version is left; clap has shown the help otherwise.
        return finish(
            "",
            version::long()
                .and_then(|text| print_line(&text))
                .map(|()| 0),
        );
    };
    let result = match command {
        Command::Render(args) => render::run(args),
        Command::Info(args) => info::run(args).map(|()| 0),
        Command::Convert(args) => convert::run(args).map(|()| 0),
        Command::Compare(args) => compare::run(args).map(|()| 0),
        Command::Bench(args) => bench::run(args),
        Command::Crosscheck(args) => crosscheck::run(args),
    };
    finish(command.name(), result)
}

/// Says what went wrong, and gives the exit code.
fn finish(command: &str, result: Result<u8, Failure>) -> u8 {
    match result {
        Ok(code) => code,
        Err(failure) => {
            failure.report(command);
            failure.exit_code()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_our_bug() {
        let arguments = ["lumiflow".to_owned(), "render".to_owned()];
        assert_eq!(guarded(&arguments, || panic!("planted")), BUG);
        assert_eq!(guarded(&arguments, || 4), 4);
    }
}
