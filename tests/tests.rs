//! All integration tests in one binary: one link step.

mod chi_square;
mod scattering;
mod support;
