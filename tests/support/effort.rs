//! How hard the statistical tests try: a little in every run of the suite, more for the proof.
//!
//! `./x prove` sets `LUMIFLOW_PROVE=1`, and `LUMIFLOW_PROVE_SEED` to a number that no run had
//! before. Each test file that uses this module is part of the proof.

use std::env;

/// How many times as many samples the proof takes.
const MORE: u32 = 16;

/// True for the proof, which tries all combinations where the suite tries some.
pub(crate) fn is_proof() -> bool {
    env::var("LUMIFLOW_PROVE").is_ok_and(|value| value == "1")
}

/// Number of samples where the suite takes `base`.
pub(crate) fn samples(base: u32) -> u32 {
    if is_proof() { base * MORE } else { base }
}

/// Seed where the suite takes `base`, which tells the tests apart.
///
/// # Panics
/// When `LUMIFLOW_PROVE_SEED` is not a whole number below 2³²: a proof must say what it ran on.
pub(crate) fn seed(base: u64) -> u64 {
    let fresh = match env::var("LUMIFLOW_PROVE_SEED") {
        Ok(text) if is_proof() => text.parse(),
        _ => Ok(0_u32),
    };
    let fresh = fresh.expect("LUMIFLOW_PROVE_SEED is a whole number below 2³²");
    base + (u64::from(fresh) << 32)
}

/// Level of a family of tests where the suite takes `base`.
///
/// A fixed seed errs never or always; fresh numbers err at this rate in every proof.
pub(crate) fn level(base: f64) -> f64 {
    if is_proof() { base / 100.0 } else { base }
}
