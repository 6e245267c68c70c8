//! All integration tests in one binary: one link step.

mod chi_square;
mod cli;
mod mitsuba_materials;
mod scattering;
mod support;
