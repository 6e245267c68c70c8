//! The `lumiflow` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    lumiflow::cli::run()
}
