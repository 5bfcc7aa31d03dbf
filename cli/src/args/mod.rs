//! What the command line takes.

mod settings;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub use settings::{Given, SettingsArgs};

/// Global-illumination previews of glTF scenes, with their error
#[derive(Parser)]
#[command(name = "hashcache", version, disable_help_subcommand = true)]
#[command(
    after_help = "Exit status: 0 done; 2 the command line is wrong; 1 anything else, with one line that says what."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand)]
pub enum Command {
    /// Render one image
    Render(Render),
    /// Render a camera move frame by frame, with each frame's time, error and flicker
    Fly(Fly),
    /// Show what a scene needs, the stages chosen for it, and why each is there
    Plan(Plan),
    /// Sweep settings: what each costs and how far its picture is from a reference
    Trade(Trade),
    /// Show triangles, extent, materials, lights, cameras, and what was ignored in the file
    Info(Info),
    /// Measure the difference of an image from a reference
    Compare(Compare),
}

/// `hashcache render`
#[derive(Args)]
pub struct Render {
    /// A .gltf or .glb file, or builtin:NAME (`hashcache info builtin:` lists them)
    pub scene: String,
    /// Write the image here, linear as .exr or .hdr, for a screen as .png; may be repeated
    /// [default: SCENE's name with .png in this folder, never over a file; nothing if --stats or --aov is given]
    #[arg(short, long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,
    /// Write settings, plan, times, rays and cache figures here as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Write albedo, normals, depth, and whatever else the stages know about the pixels into this folder, as NAME.exr each
    #[arg(long, value_name = "DIR")]
    pub aov: Option<PathBuf>,
    /// Show no progress, warnings or summary
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// `hashcache fly`
#[derive(Args)]
#[command(after_long_help = FLY_FILES)]
pub struct Fly {
    /// A .gltf or .glb file, or builtin:NAME (`hashcache info builtin:` lists them)
    pub scene: String,
    #[arg(long, value_name = "PATH.json", help = PATH_FILE)]
    pub path: PathBuf,
    /// The folder for all files; made if it is not there (its own folder must be). Files of the same names are replaced;
    /// frames of another, longer move in it are refused
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// Compare frames with those in this folder, of the same names and .exr; frames that it lacks have no error
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
    /// The kind of file of the frames: linear as exr or hdr, for a screen as png
    #[arg(long, value_enum, default_value_t = FrameFormat::Exr)]
    pub format: FrameFormat,
    /// Show no progress, warnings or summary
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// The kind of file of a move's frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FrameFormat {
    Exr,
    Hdr,
    Png,
}

impl FrameFormat {
    /// The ending of its files' names.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Hdr => "hdr",
            Self::Png => "png",
        }
    }
}

const PATH_FILE: &str = "\
The move: {\"keys\":[{\"time\":s, \"position\":[x,y,z], \"target\":[x,y,z], \"up\":[x,y,z], \"fov_y_deg\":a}, ...], \"frames\":N}, \
Catmull-Rom between keys; a key's \"light\" is a factor on all lights";

const FLY_FILES: &str = "\
Files:
  frame_0000.exr ...  the frames; --spp samples a pixel each, light cached in earlier frames is used again
  metrics.csv         a row a frame, its row follows the frame's file:
                      frame, time_s and cpu_s (wall; user + system of all threads; rendering alone), relmse,
                      relmse_trimmed, ms_ssim, flip, energy_ratio (as `hashcache compare`), flicker
  summary.json        written last: the keys of --stats for the whole move, and \"frames\": the rows of metrics.csv
A move that is broken off leaves whole frames, their rows, and no summary.json.

Flicker of a frame: the mean over pixels and channels of ((I1-I0) - (R1-R0))^2 / (R1^2 + 0.01) for frame I1, the one
before I0, and their references R1, R0: the relative squared form of the temporal loss of Chaitanya et al. 2017. Noise
of relMSE e that is new in each frame flickers by 2e; what is wrong in the same way in both frames does not flicker.
Where camera and lights rest, R1 = R0 is known without references, and I0 takes R1's place below the line.
Else the column is empty, as are those of a frame without reference.";

/// What a heat map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HeatMetric {
    Flip,
    Relative,
}

/// `hashcache plan`
#[derive(Args)]
pub struct Plan {
    /// A .gltf or .glb file, or builtin:NAME (`hashcache info builtin:` lists them)
    pub scene: String,
    /// Measure what leaving out what the scene does not need saves a sample: some seconds of tracing with and without each
    #[arg(long)]
    pub measure: bool,
    /// Write needs, plan, savings and settings here as JSON, by the keys of render's --stats
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// `hashcache trade`
#[derive(Args)]
#[command(after_long_help = TRADE_FILES)]
pub struct Trade {
    /// A .gltf or .glb file, or builtin:NAME (`hashcache info builtin:` lists them)
    pub scene: String,
    /// The folder for all files; made if it is not there (its own folder must be). An earlier sweep in it goes on
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// The picture as it should be, of the same size [default: DIR/reference.exr, path traced if it is not there]
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Samples a pixel of a reference that is path traced here, by a seed of its own
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(2..=i64::from(hashcache::MAX_SPP)), conflicts_with = "reference")]
    pub reference_spp: u32,
    /// Pictures for each row, with seeds from --seed on; from 2 on, columns hold means and their standard errors
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub seeds: u32,
    /// Values of a setting, each with each value of the others; may be repeated, and replaces the usual sweep
    #[arg(long, value_name = "KEY=V1,V2,...")]
    pub vary: Vec<String>,
    /// Leave out rows that would bring the CPU-seconds of this run, the reference's included, above this
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub max_cpu_s: Option<f64>,
    /// Show no progress or warnings
    #[arg(short, long)]
    pub quiet: bool,
    #[command(flatten)]
    pub settings: SettingsArgs,
}

/// A number of seconds, at least 0.
fn seconds(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number >= 0.0);
    number.ok_or_else(|| "not a number of at least 0".to_owned())
}

const TRADE_FILES: &str = "\
The usual sweep: every cache, filter and source of direct light, 1, 4, 16 and 64 samples a pixel, sizes of the grid's
cells and resolutions of the octree; what an option or --set fixes stays fixed. Settings that do not go together are
left out, and those of a cache are varied for that cache alone.

trade.csv gets a row as soon as its pictures are measured, cheap rows first; a sweep that is broken off leaves whole
rows, and the same command goes on where it stopped. Columns:
  scene, reference, seed, seeds   what was rendered, what it was compared with, the first seed, how many
  one for each varied setting     its value; empty where it has no effect
  settings                        all settings that are not at their default, as KEY=VALUE
  cpu_s, time_s                   user + system seconds of all threads, and wall seconds, of the frame
  build_cpu_s, build_time_s       the same before the frame: acceleration structure, cache, upload (the last seed's)
  relmse, relmse_trimmed, ms_ssim, flip, energy_ratio   as `hashcache compare`; ms_ssim needs 176x176 pixels
  X_se                            standard error of X over the seeds; empty for one seed
  cache_cells, cache_bytes        cells in use and memory of the cache (the last seed's)
Standard output: the front, that is the rows that no other row beats in both cpu_s and relmse.";

/// `hashcache info`
#[derive(Args)]
pub struct Info {
    /// A .gltf or .glb file, builtin:NAME, or builtin: alone for the list of names
    pub scene: String,
}

/// `hashcache compare`
#[derive(Args)]
pub struct Compare {
    /// The image: .exr, .hdr or .png (decoded to linear)
    pub image: PathBuf,
    /// What it should be, of the same size
    pub reference: PathBuf,
    /// Print one JSON object; numbers that do not exist (PSNR of equal images) are null
    #[arg(long)]
    pub json: bool,
    /// Draw each pixel's error into this file: black is none, through violet and orange to pale yellow, 1 and above
    #[arg(long, value_name = "FILE.png")]
    pub heat_map: Option<PathBuf>,
    /// The error drawn: flip, or the root of a pixel's relMSE
    #[arg(long, value_enum, value_name = "NAME", default_value_t = HeatMetric::Flip, requires = "heat_map")]
    pub heat_map_of: HeatMetric,
}
