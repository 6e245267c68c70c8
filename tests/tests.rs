//! All integration tests in one binary: one link step.

mod agreement;
mod balance;
mod chi_square;
mod cli;
mod density_forms;
mod determinism;
mod erpt;
mod furnace;
mod golden;
mod hidden_emitters;
mod import;
mod indifference;
mod invariance;
mod inversion;
mod kernels;
mod layering;
mod meshes;
mod mitsuba_materials;
mod paths;
mod pmc_er;
mod reference;
mod scales;
mod scattering;
mod sources;
mod support;
mod transitions;
