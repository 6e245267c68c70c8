//! All integration tests in one binary: one link step.

mod agreement;
mod chi_square;
mod cli;
mod determinism;
mod furnace;
mod mitsuba_materials;
mod scales;
mod scattering;
mod support;
