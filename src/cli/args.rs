//! The command line: what can be said, and the help that explains it.
#![expect(
    clippy::doc_markdown,
    reason = "the comments of fields are the help, which shows backticks as they are"
)]

mod bench;
mod tracer;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(super) use bench::{BenchArgs, BenchEffort};
pub(super) use tracer::{CrosscheckArgs, TracerArgs};

use super::help;

/// Everything that can stand after `lumiflow`.
#[derive(Debug, Parser)]
#[command(
    name = "lumiflow",
    about = "Renders Mitsuba scenes with hard light",
    after_help = help::EXIT_CODES,
    disable_version_flag = true,
    arg_required_else_help = true,
    max_term_width = 100
)]
pub(super) struct Cli {
    /// Print the version, and those of Embree, OpenEXR and obvhs
    #[arg(short = 'V', long)]
    pub(super) version: bool,

    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render scenes to EXR and PNG files
    #[command(after_long_help = help::integrators(), after_help = help::RENDER_EXAMPLES)]
    Render(Box<RenderArgs>),
    /// Load a scene and tell what is in it
    Info(InfoArgs),
    /// Make a PNG of an EXR file
    #[command(after_help = help::CONVERT_EXAMPLES)]
    Convert(ConvertArgs),
    /// Measure how far an image is from a reference
    #[command(after_help = help::COMPARE_EXAMPLES)]
    Compare(Box<CompareArgs>),
    /// Race integrators against references: error, time, and efficiency over several seeds
    #[command(after_help = help::BENCH_EXAMPLES)]
    Bench(Box<BenchArgs>),
    /// Trace a scene's rays with two tracers, and tell where they disagree
    #[command(after_help = help::CROSSCHECK_EXAMPLES)]
    Crosscheck(Box<CrosscheckArgs>),
}

impl Command {
    /// Its word on the command line.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Render(_) => "render",
            Self::Info(_) => "info",
            Self::Convert(_) => "convert",
            Self::Compare(_) => "compare",
            Self::Bench(_) => "bench",
            Self::Crosscheck(_) => "crosscheck",
        }
    }
}

/// How scene files are read.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// Set a parameter of the scene ($KEY in the file); repeatable, -Dspp=64 is fine, too
    #[arg(short = 'D', long = "define", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(super) definitions: Vec<(String, String)>,

    /// Also look for the scene's files in this folder; repeatable
    #[arg(short = 'a', long = "search-path", value_name = "FOLDER")]
    pub(super) search_paths: Vec<PathBuf>,

    /// Take every warning of the scene as an error
    #[arg(long, conflicts_with = "lenient")]
    pub(super) strict: bool,

    /// Replace what is not supported and warn, instead of refusing the scene
    #[arg(long)]
    pub(super) lenient: bool,

    /// Size of the image in pixels [default: the film's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<(u32, u32)>,
}

/// `lumiflow render`.
#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    /// Mitsuba scene files (XML), or models (OBJ, glTF)
    #[arg(required = true, value_name = "SCENE")]
    pub(super) scenes: Vec<PathBuf>,

    /// File to write: .exr or .png, repeatable; {name} stands for the scene's name, which is the
    /// file's without .xml, or the folder's for a file called scene.xml [default: {name}.exr]
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Vec<String>,

    /// Algorithm, such as path; the long help lists all [default: the scene's]
    #[arg(short, long, value_name = "NAME")]
    pub(super) integrator: Option<String>,

    /// Set an option of the integrator, such as max_depth=8; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub(super) settings: Vec<(String, String)>,

    #[command(flatten)]
    pub(super) scene: SceneArgs,

    #[command(flatten)]
    pub(super) tracer: TracerArgs,

    #[command(flatten)]
    pub(super) effort: EffortArgs,

    /// Threads that render [default: one a core]; the image does not depend on it
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,

    /// Start of the random numbers: another seed, another noise
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) seed: u64,

    /// Which of the scene's sensors, from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) sensor: usize,

    /// Reconstruction filter [default: the film's]
    #[arg(long, value_name = "NAME")]
    pub(super) filter: Option<FilterName>,

    /// Further layers of the EXR file, with commas between: albedo, sh_normal, geo_normal, depth,
    /// position, uv; variance (of the pixels' means); proposals, acceptance, chains (of erpt,
    /// pmc-er, mlt, pssmlt and mmlt); strategy, mutations, population_age (of pmc-er);
    /// techniques (of bdpt)
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(super) aov: Vec<String>,

    #[command(flatten)]
    pub(super) file: FileArgs,

    /// Print one line of JSON on stdout for each scene, when it is done
    #[arg(long)]
    pub(super) json: bool,

    /// No progress and no warnings, errors only
    #[arg(short, long)]
    pub(super) quiet: bool,
}

/// How much to render.
#[derive(Debug, Args)]
#[group(multiple = false)]
pub(super) struct EffortArgs {
    /// Samples a pixel [default: the scene's]
    #[arg(long, value_name = "N", value_parser = count())]
    pub(super) spp: Option<u32>,

    /// Seconds to render for, without loading and writing: whole passes only, at least one
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    pub(super) time: Option<f64>,

    /// Passes to render; a pass is one sample in each pixel
    #[arg(long, value_name = "N", value_parser = count())]
    pub(super) passes: Option<u32>,
}

/// How files are written.
#[derive(Debug, Args)]
pub(super) struct FileArgs {
    /// Store 16-bit floats in EXR files [default: what the film says]
    #[arg(long, conflicts_with = "float")]
    pub(super) half: bool,

    /// Store 32-bit floats in EXR files [default: what the film says]
    #[arg(long)]
    pub(super) float: bool,

    /// How EXR files are packed, all without loss
    #[arg(long, value_name = "METHOD", default_value = "zip")]
    pub(super) compression: CompressionName,

    /// Brightness of PNG files, in stops: +1 doubles it
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub(super) exposure: f32,
}

/// `lumiflow info`.
#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    /// Mitsuba scene file (XML), or a model (OBJ, glTF)
    #[arg(value_name = "SCENE")]
    pub(super) file: PathBuf,

    #[command(flatten)]
    pub(super) scene: SceneArgs,

    #[command(flatten)]
    pub(super) tracer: TracerArgs,

    /// Print one line of JSON instead
    #[arg(long)]
    pub(super) json: bool,
}

/// `lumiflow convert`.
#[derive(Debug, Args)]
pub(super) struct ConvertArgs {
    /// EXR file to read
    #[arg(value_name = "IN.exr")]
    pub(super) input: PathBuf,

    /// PNG file to write
    #[arg(value_name = "OUT.png")]
    pub(super) output: PathBuf,

    /// Brightness, in stops: +1 doubles it
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub(super) exposure: f32,

    /// Layer to show, such as albedo [default: the picture itself]
    #[arg(
        long,
        value_name = "NAME",
        default_value = "",
        hide_default_value = true
    )]
    pub(super) layer: String,
}

/// `lumiflow compare`.
#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// Image to judge: EXR, or anything that is read as a texture
    #[arg(value_name = "IMAGE")]
    pub(super) image: PathBuf,

    /// What it should be
    #[arg(value_name = "REFERENCE")]
    pub(super) reference: PathBuf,

    /// Variance of the image's pixels: the layer "variance" of an EXR file, else its R, G, B
    #[arg(long, value_name = "FILE")]
    pub(super) variance: Option<PathBuf>,

    /// Variance of the reference's pixels, likewise
    #[arg(long, value_name = "FILE")]
    pub(super) reference_variance: Option<PathBuf>,

    /// Leave out the pixels that are not black in this image
    #[arg(long, value_name = "PNG")]
    pub(super) mask: Option<PathBuf>,

    /// Compare this part only: left, top, width and height in pixels
    #[arg(long, value_name = "X,Y,W,H", value_parser = crop)]
    pub(super) crop: Option<Crop>,

    /// Side of the tiles of the z-test, in pixels
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub(super) tile: u32,

    /// Brightness at which FLIP looks at the images, in stops
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub(super) exposure: f32,

    /// Write a PNG of the relative error: red is too bright, blue too dark, white right
    #[arg(short, long, value_name = "HEAT.png")]
    pub(super) output: Option<PathBuf>,

    /// Print one line of JSON instead
    #[arg(long)]
    pub(super) json: bool,
}

/// A part of an image, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Crop {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

/// Filters by their names in scene files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FilterName {
    /// One pixel wide
    Box,
    /// Radius 1
    Tent,
    /// Standard deviation 0.5
    Gaussian,
    /// Blur and ringing 1/3
    Mitchell,
    /// Radius 2
    Catmullrom,
    /// Three lobes
    Lanczos,
}

/// Ways to pack EXR files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum CompressionName {
    /// Not at all
    None,
    /// Runs of equal bytes
    Rle,
    /// Deflate, each row by itself
    Zips,
    /// Deflate, 16 rows together
    Zip,
    /// Wavelets: good for noise
    Piz,
}

/// Longest side of an image, in pixels.
const LONGEST_SIDE: u32 = 32_768;

fn count() -> impl clap::builder::TypedValueParser<Value = u32> {
    clap::value_parser!(u32).range(1..=i64::from(i32::MAX))
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected KEY=VALUE".to_owned()),
    }
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once(['x', 'X', '×']);
    let side = |text: &str| text.trim().parse::<u32>().ok();
    let parsed = sides.and_then(|(width, height)| Some((side(width)?, side(height)?)));
    let Some((width, height)) = parsed else {
        return Err("expected WIDTHxHEIGHT in pixels, such as 640x360".to_owned());
    };
    let possible = 1..=LONGEST_SIDE;
    if !possible.contains(&width) || !possible.contains(&height) {
        return Err(format!("width and height go from 1 to {LONGEST_SIDE}"));
    }
    Ok((width, height))
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e9 => Ok(seconds),
        _ => Err("expected a positive number of seconds".to_owned()),
    }
}

fn stops(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(stops) if stops.abs() <= 64.0 => Ok(stops),
        _ => Err("expected a number from -64 to 64".to_owned()),
    }
}

fn crop(text: &str) -> Result<Crop, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, width, height]) if width > 0 && height > 0 => Ok(Crop {
            x,
            y,
            width,
            height,
        }),
        _ => Err("expected four whole numbers x,y,width,height, the last two above 0".to_owned()),
    }
}

#[cfg(test)]
mod tests;
