//! The arguments that choose a tracer, and those of `lumiflow crosscheck`, which compares two.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::SceneArgs;
use crate::accel::{Engine, Ray};
use crate::report::crosscheck::{RayAddress, parse_ray};

/// What finds the surfaces that rays meet.
#[derive(Debug, Args)]
pub(in crate::cli) struct TracerArgs {
    /// What finds the surfaces that rays meet
    #[arg(long, value_name = "NAME", default_value = "embree")]
    pub(in crate::cli) accel: EngineName,
}

/// Tracers by their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum EngineName {
    /// Embree, in single precision: no ray slips through between triangles
    Embree,
    /// Embree without that promise: faster, and less than one ray in a million slips through
    EmbreeFast,
    /// A tree of obvhs, walked in double precision: to check, not for speed
    Obvhs,
}

impl EngineName {
    /// The tracer of this name.
    pub(in crate::cli) fn engine(self) -> Engine {
        match self {
            Self::Embree => Engine::Embree,
            Self::EmbreeFast => Engine::EmbreeFast,
            Self::Obvhs => Engine::Obvhs,
        }
    }
}

/// `lumiflow crosscheck`.
#[derive(Debug, Args)]
pub(in crate::cli) struct CrosscheckArgs {
    /// Mitsuba scene file (XML), or a model (OBJ, glTF)
    #[arg(value_name = "SCENE")]
    pub(in crate::cli) file: PathBuf,

    /// Rays to compare, all kinds together
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    pub(in crate::cli) rays: u32,

    /// Start of the random numbers: another seed, other rays
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(in crate::cli) seed: u64,

    /// What obvhs is compared with: embree, or embree-fast
    #[arg(
        long,
        value_name = "NAME",
        default_value = "embree",
        hide_possible_values = true
    )]
    pub(in crate::cli) accel: EngineName,

    /// Trace one ray of the check again, and tell all about it
    #[arg(long, value_name = "INDEX/KIND", value_parser = RayAddress::parse, conflicts_with = "ray")]
    pub(in crate::cli) replay: Option<RayAddress>,

    /// Trace this ray, and tell all about it: origin, direction, nearest and farthest distance, in
    /// multiples of the direction
    #[arg(long, value_name = "OX,OY,OZ,DX,DY,DZ,NEAR,FAR", allow_hyphen_values = true, value_parser = parse_ray)]
    pub(in crate::cli) ray: Option<Ray>,

    /// Threads that trace [default: one a core]; what is found does not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(in crate::cli) threads: Option<u16>,

    #[command(flatten)]
    pub(in crate::cli) scene: SceneArgs,

    /// Print one line of JSON after the table
    #[arg(long)]
    pub(in crate::cli) json: bool,

    /// No progress and no warnings, errors only
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}
