//! What is counted.

use std::hint::black_box;

use lumiflow::mutation::{Chain, Mutation};

use crate::chains::{self, Start};
use crate::{passes, scenes};

/// The scenes of whole passes.
const SCENES: [&str; 4] = [
    "cornell-box",
    "cornell-caustic",
    "coloured-mirrors",
    "torus-in-glass",
];

/// What passes are made by, with what an item is; chains are long enough that seeds hardly count.
const ALGORITHMS: [(&str, &str); 2] = [
    ("path", "path"),
    ("erpt mutations_per_sample=20", "mutation"),
];

/// Something to count.
pub(crate) enum Case {
    /// A pass of an integrator on a scene.
    Pass(&'static str, &'static str),
    /// Steps of a single kind of mutation.
    Steps(Option<Mutation>, &'static str, &'static str),
}

impl Case {
    /// All of them.
    pub(crate) fn all() -> Vec<Self> {
        let passes = ALGORITHMS
            .iter()
            .flat_map(|(algorithm, _)| SCENES.map(|scene| Self::Pass(algorithm, scene)));
        let steps = chains::CASES.map(|(mutation, name, scene)| Self::Steps(mutation, name, scene));
        passes.chain(steps).collect()
    }

    /// Its name, without blanks.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Pass(algorithm, scene) => {
                let name = algorithm.split(' ').next().unwrap_or_default();
                let item = ALGORITHMS.iter().find(|(text, _)| text == algorithm);
                format!("{}/{name}/{scene}", item.map_or("", |(_, item)| item))
            }
            Self::Steps(_, name, scene) => format!("step/{name}/{scene}"),
        }
    }

    /// Does the work; returns how many items it was.
    pub(crate) fn run(&self) -> u64 {
        match self {
            Self::Pass(algorithm, scene) => {
                let (scene, view) = scenes::load(&scenes::file_of(scene));
                let algorithm = passes::algorithm(algorithm);
                passes::on_one_thread(|| {
                    let render = passes::Passes::new(algorithm.as_ref(), &scene, &view.sensor);
                    let counters = work_to_count(|| render.run(0));
                    match counters.mutation_count() {
                        0 => counters.paths,
                        mutations => mutations,
                    }
                })
            }
            Self::Steps(mutation, _, scene) => {
                let (scene, view) = scenes::load(&scenes::file_of(scene));
                let start = Start::new(&scene, &view.sensor, *mutation);
                let mut chain = Chain::default();
                work_to_count(|| start.run(&mut chain));
                Start::steps()
            }
        }
    }
}

/// Valgrind counts from the beginning of this function to its end, which it finds by name.
#[inline(never)]
fn work_to_count<T>(work: impl FnOnce() -> T) -> T {
    black_box(work())
}
