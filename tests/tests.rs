//! All integration tests in one binary: one link step.

mod agreement;
mod chi_square;
mod cli;
mod determinism;
mod erpt;
mod furnace;
mod golden;
mod hidden_emitters;
mod import;
mod invariance;
mod layering;
mod meshes;
mod mitsuba_materials;
mod reference;
mod scales;
mod scattering;
mod sources;
mod support;
