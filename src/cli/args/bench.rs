//! The arguments of `lumiflow bench`.

use std::path::PathBuf;

use clap::Args;

use super::{Crop, SceneArgs, count, crop, key_value, seconds};

/// `lumiflow bench`.
#[derive(Debug, Args)]
pub(in crate::cli) struct BenchArgs {
    /// Mitsuba scene files (XML)
    #[arg(required = true, value_name = "SCENE")]
    pub(in crate::cli) scenes: Vec<PathBuf>,

    /// Algorithms to race, with commas between
    #[arg(
        short,
        long,
        value_name = "NAME,…",
        value_delimiter = ',',
        default_value = "path"
    )]
    pub(in crate::cli) integrators: Vec<String>,

    /// Set an option of all integrators, or of one, such as path.max_depth=8; repeatable
    #[arg(long = "set", value_name = "[NAME.]KEY=VALUE", value_parser = key_value)]
    pub(in crate::cli) settings: Vec<(String, String)>,

    /// What the image should be; {dir} stands for the scene's folder, {name} for its name
    /// [default: reference.exr beside the scene, with reference_var.exr if that is there]
    #[arg(long, value_name = "REF.exr")]
    pub(in crate::cli) reference: Option<String>,

    /// Variance of the reference's pixels: the layer "variance" of an EXR file, else its R, G, B
    #[arg(long, value_name = "V.exr")]
    pub(in crate::cli) reference_variance: Option<String>,

    /// Leave out the pixels that are not black in this image; "none" counts all
    /// [default: emitter_mask.png beside the scene, if that is there]
    #[arg(long, value_name = "PNG")]
    pub(in crate::cli) mask: Option<String>,

    /// Compare this part only: left, top, width and height in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    pub(in crate::cli) crop: Option<Crop>,

    /// Leave out that many rows at the top and at the bottom of the image
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(in crate::cli) skip_rows: u32,

    #[command(flatten)]
    pub(in crate::cli) effort: BenchEffort,

    /// Number of seeds, each a render of its own
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(in crate::cli) seeds: u32,

    /// The first of the seeds; the reference must have been made with others
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(in crate::cli) seed: u64,

    /// Threads that render
    #[arg(short, long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(in crate::cli) threads: u16,

    #[command(flatten)]
    pub(in crate::cli) scene: SceneArgs,

    /// Folder for bench.md, bench.csv, bench.json, and the images of the first seed
    #[arg(short, long, value_name = "DIR")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Print one line of JSON instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,

    /// No progress and no warnings, errors only
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}

/// How much to render, once for each of the values.
#[derive(Debug, Args)]
#[group(multiple = false, required = true)]
pub(in crate::cli) struct BenchEffort {
    /// Seconds to render for, by the clock: whole passes only, at least one
    #[arg(long, value_name = "SECONDS,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = seconds)]
    pub(in crate::cli) time: Vec<f64>,

    /// Samples a pixel
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = count())]
    pub(in crate::cli) spp: Vec<u32>,

    /// Passes to render; a pass is one sample in each pixel
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = count())]
    pub(in crate::cli) passes: Vec<u32>,
}
