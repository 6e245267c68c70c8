//! The parts of a render, one by one.
//!
//! ```sh
//! cargo bench --bench blocks [-- FILTER]
//! ```
//!
//! Times are CPU times, of all threads together: on a machine that does other work as well, those on the
//! wall say nothing.

#[path = "../support/chains.rs"]
mod chains;
#[path = "../support/passes.rs"]
mod passes;
#[path = "../support/scenes.rs"]
mod scenes;

mod cpu;
mod film;
mod load;
mod materials;
mod mutations;
mod rays;

use std::time::Duration;

use criterion::Criterion;
use lumiflow::accel;

use cpu::CpuTime;

fn main() {
    accel::prepare_worker();
    let mut criterion = Criterion::default()
        .with_measurement(CpuTime)
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1000))
        .configure_from_args();
    rays::add(&mut criterion);
    materials::add(&mut criterion);
    mutations::add(&mut criterion);
    film::add(&mut criterion);
    load::add(&mut criterion);
    criterion.final_summary();
}
