//! The arguments of `lumiflow bench`.

use std::path::PathBuf;

use clap::Args;

use super::{Crop, SceneArgs, TracerArgs, count, crop, key_value, seconds, stops};

/// `lumiflow bench`.
#[derive(Debug, Args)]
pub(in crate::cli) struct BenchArgs {
    /// Mitsuba scene files (XML)
    #[arg(required = true, value_name = "SCENE")]
    pub(in crate::cli) scenes: Vec<PathBuf>,

    /// Algorithms to race, with commas between; options of one alone follow its name, as in
    /// erpt:chain_length=50:num_chains=2 [default: path, unless there are peers]
    #[arg(short, long, value_name = "NAME[:KEY=VALUE…],…", value_delimiter = ',')]
    pub(in crate::cli) integrators: Vec<String>,

    /// Race another program: a name, and a command for the shell, in which {scene}, {seconds} (or
    /// {spp} or {passes}, as the budgets are), {seed} and {out} stand for what to render, and
    /// {threads}, {width} and {height} may; do not put quotes around them; repeatable
    #[arg(long = "peer", value_name = "NAME=COMMAND", value_parser = key_value, requires = "output")]
    pub(in crate::cli) peers: Vec<(String, String)>,

    /// Seconds after which a peer is ended and has failed [default: a minute and three times its
    /// budget; no limit for --spp and --passes]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    pub(in crate::cli) peer_timeout: Option<f64>,

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

    /// Brightness of PNG files, and at which FLIP looks at the images, in stops
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub(in crate::cli) exposure: f32,

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

    #[command(flatten)]
    pub(in crate::cli) tracer: TracerArgs,

    /// Folder for tables, plots, crops and images; renders whose records are there already, of the
    /// same options, are not made again
    #[arg(short, long, value_name = "DIR")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Keep the images of all seeds, not of the first only
    #[arg(long, requires = "output")]
    pub(in crate::cli) all_images: bool,

    /// Show this part of the images side by side; repeatable [default: --crop, or else the middle,
    /// 256 pixels at most]
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop, requires = "output")]
    pub(in crate::cli) show: Vec<Crop>,

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

    /// Seconds of processor time, all threads together: whole passes only, at least one
    #[arg(long, value_name = "SECONDS,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = seconds)]
    pub(in crate::cli) cpu: Vec<f64>,

    /// Samples a pixel
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = count())]
    pub(in crate::cli) spp: Vec<u32>,

    /// Passes to render; a pass is one sample in each pixel
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = count())]
    pub(in crate::cli) passes: Vec<u32>,
}
