//! Instructions a path and a mutation, counted by valgrind, beside those that were accepted.
//!
//! ```sh
//! cargo bench --bench instructions [-- --accept] [FILTER]
//! ```
//!
//! Counts do not depend on what else the machine does, and hardly from run to run. Those of Embree stand
//! apart: valgrind knows no AVX-512, so that Embree goes other ways than it would; only what is left is
//! compared. Fails where a count has grown by more than [`MOST_GROWTH`]. Counts depend on compiler and
//! processor; `counts.txt` keeps them by compiler.

#[path = "../support/chains.rs"]
mod chains;
#[path = "../support/passes.rs"]
mod passes;
#[path = "../support/scenes.rs"]
mod scenes;

mod cases;
mod counts;
mod profile;

use std::process::ExitCode;

use cases::Case;
use counts::Counts;

/// Growth of a count that is let pass, as a part of it.
const MOST_GROWTH: f64 = 0.02;

/// Follows the name of a case in the arguments of a process that is to be counted.
const CHILD: &str = "--count";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [first, name] = arguments.as_slice() {
        if first == CHILD {
            return count(name);
        }
    }
    let accept = arguments.iter().any(|argument| argument == "--accept");
    let filter = arguments
        .iter()
        .find(|argument| !argument.starts_with("--"));
    match compare(accept, filter.map(String::as_str)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("instructions: {problem}");
            ExitCode::FAILURE
        }
    }
}

/// What a process under valgrind does; the last line says of how many items.
fn count(name: &str) -> ExitCode {
    let Some(case) = Case::all().into_iter().find(|case| case.name() == name) else {
        eprintln!("instructions: there is no case {name}");
        return ExitCode::from(2);
    };
    println!("{}", case.run());
    ExitCode::SUCCESS
}

/// Counts all cases; true where none has grown.
fn compare(accept: bool, filter: Option<&str>) -> Result<bool, String> {
    let compiler = counts::compiler()?;
    let mut kept = Counts::read()?;
    println!("{compiler}; instructions an item: ours, Embree's\n");
    let (mut fine, mut known) = (true, true);
    for case in Case::all() {
        let name = case.name();
        if filter.is_some_and(|filter| !name.contains(filter)) {
            continue;
        }
        let found = profile::count(&name, CHILD)?;
        let before = kept.of(&compiler, &name);
        let growth = before.map(|before| found.ours / before - 1.0);
        let verdict = match growth {
            None => "not known yet".to_owned(),
            Some(growth) => format!("{:+.1} %", 100.0 * growth),
        };
        println!(
            "{name:40}{:10.0}{:10.0}  {verdict}",
            found.ours, found.embree
        );
        known &= before.is_some();
        fine &= growth.is_none_or(|growth| growth <= MOST_GROWTH);
        kept.set(&compiler, &name, found);
    }
    if accept {
        kept.write()?;
        return Ok(true);
    }
    if !known {
        println!("\nSome counts are not known for this compiler: --accept keeps them.");
    }
    if !fine {
        println!(
            "\nCounts have grown by more than {} %. If that is meant, --accept keeps the new ones.",
            100.0 * MOST_GROWTH
        );
    }
    Ok(fine && known)
}
