//! All integration tests in one binary: one link step.

mod chi_square;
mod determinism;
mod furnace;
mod mitsuba_materials;
mod scattering;
mod support;
