//! How much of Embree's own speed is left when the renderer asks it.
//!
//! ```sh
//! cargo bench --bench throughput -- [--rounds N] [SCENE.xml...]
//! ```
//!
//! Renders each scene by `path` and `erpt` and keeps every ray that is asked about. Then, in turn and on
//! one thread: those rays by Embree in a loop of C, by the renderer's own faces, and the render itself.
//! All times are CPU times of the thread; ratios are of one round. The answers of all ways must agree,
//! or it fails.

#[path = "../support/passes.rs"]
mod passes;
#[path = "../support/scenes.rs"]
mod scenes;

mod recorded;
mod report;
mod rounds;

use std::path::PathBuf;
use std::process::ExitCode;

use recorded::Recorded;
use rounds::Round;

/// What is rendered on each scene: chains long enough that seeds hardly count.
const ALGORITHMS: [&str; 2] = ["path", "erpt mutations_per_sample=100"];

/// The project's scenes that are measured where none is named.
const DEFAULT: [&str; 6] = [
    "cornell-box",
    "cornell-caustic",
    "coloured-mirrors",
    "torus-in-glass",
    "door-ajar",
    "dragon",
];

fn main() -> ExitCode {
    let mut rounds = 15;
    let mut files: Vec<PathBuf> = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            // What cargo itself hands on.
            "--bench" => {}
            "--rounds" => match arguments.next().map(|count| count.parse()) {
                Some(Ok(count)) if count > 0 => rounds = count,
                _ => return usage("--rounds needs a number above zero"),
            },
            option if option.starts_with('-') => return usage(&format!("{option} is not known")),
            file => files.push(file.into()),
        }
    }
    if files.is_empty() {
        files = DEFAULT.map(scenes::file_of).into();
    }
    passes::on_one_thread(|| {
        report::head(rounds);
        for file in &files {
            for text in ALGORITHMS {
                let recorded = Recorded::new(file, text);
                let (scene, view) = scenes::load(file);
                let algorithm = passes::algorithm(text);
                let render = passes::Passes::new(algorithm.as_ref(), &scene, &view.sensor);
                let measured: Vec<Round> = (0..rounds)
                    .map(|_| Round::new(&scene, &recorded, &render))
                    .collect();
                report::row(file, &recorded, &measured);
            }
        }
        report::foot();
    });
    ExitCode::SUCCESS
}

fn usage(problem: &str) -> ExitCode {
    eprintln!("{problem}; usage: cargo bench --bench throughput -- [--rounds N] [SCENE.xml...]");
    ExitCode::from(2)
}
